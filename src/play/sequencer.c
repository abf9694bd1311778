/* SPDX-License-Identifier: MIT */
/*
 * Everything is a move: from a posture at one real time to another at a later one. An approach is
 * one, the way to a key is one, a hold (pause, stop) is one; each has one frame, handed out when
 * it begins. Playing at a rate is the exception: its frames lie on a grid.
 */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/play/sequencer.h"

#define SECOND_US 1000000u

_Static_assert(GROBO_QUEUE_MAX < 256, "queue_head and queue_n are bytes");

/* What always holds between two calls. */
static void assert_sound(const grobo_sequencer *seq)
{
    const grobo_play_options *options = &seq->item.options;
    GROBO_ASSERT(seq->queue_head < GROBO_QUEUE_MAX && seq->queue_n <= GROBO_QUEUE_MAX);
    GROBO_ASSERT((seq->state == GROBO_SEQUENCER_FAILED) == (seq->error < 0));
    if (seq->state == GROBO_SEQUENCER_IDLE || seq->state == GROBO_SEQUENCER_FINISHED ||
        seq->state == GROBO_SEQUENCER_FAILED) {
        GROBO_ASSERT(!seq->waits && seq->queue_n == 0);
        return;
    }
    GROBO_ASSERT(seq->state != GROBO_SEQUENCER_STOPPING || seq->queue_n == 0);
    GROBO_ASSERT(seq->to.n_joints == seq->item.clip.n_joints);
    GROBO_ASSERT(options->speed_pct > 0 && options->speed_pct <= GROBO_PLAY_SPEED_MAX_PCT);
    GROBO_ASSERT(options->mode == GROBO_PLAY_KEY || options->rate_hz > 0);
    GROBO_ASSERT(seq->pass >= 1 && seq->pass <= options->repeat);
    GROBO_ASSERT(seq->anchor_pos_us >= 0 && seq->anchor_pos_us <= seq->item.span_us);
    bool on_grid = seq->state == GROBO_SEQUENCER_PLAYING && options->mode == GROBO_PLAY_RATE;
    GROBO_ASSERT(on_grid || seq->from_us <= seq->to_us);
    GROBO_ASSERT(options->mode != GROBO_PLAY_KEY || seq->key.i < seq->item.clip.n_keys);
}

static bool is_under_way(const grobo_sequencer *seq)
{
    return seq->state == GROBO_SEQUENCER_APPROACHING || seq->state == GROBO_SEQUENCER_PLAYING;
}

/* ---- real time and position ---- */

static int32_t longer(int32_t a_us, int32_t b_us)
{
    return a_us > b_us ? a_us : b_us;
}

int64_t grobo_i_pos_at(const grobo_sequencer *seq, int64_t t_us)
{
    int64_t pos_us =
        seq->anchor_pos_us + (t_us - seq->anchor_us) * seq->item.options.speed_pct / 100;
    return grobo_i_sooner(grobo_i_later(pos_us, seq->anchor_pos_us), seq->item.span_us);
}

/* RATE: the frame behind the one that waits is the one that waits. Whole microseconds and the rest
 * are counted apart, which keeps rounding from adding up. */
static void advance_grid(grobo_sequencer *seq)
{
    uint32_t rate_hz = seq->item.options.rate_hz;
    uint32_t period_us = SECOND_US / rate_hz;
    seq->due_us = seq->grid_us;
    seq->grid_us += period_us;
    seq->grid_rest += SECOND_US - period_us * rate_hz;
    if (seq->grid_rest >= rate_hz) {
        seq->grid_rest -= rate_hz;
        seq->grid_us++;
    }
}

/* ---- frames ---- */

/* The time of a frame, that of a move in whole units: from its beginning to its end, both rounded
 * as times since the anchor, so that neither lateness nor rounding adds up. */
static int32_t time_of_frame(const grobo_sequencer *seq)
{
    const grobo_play_options *options = &seq->item.options;
    if (seq->state == GROBO_SEQUENCER_PLAYING && options->mode == GROBO_PLAY_RATE) {
        return (int32_t)(SECOND_US / options->rate_hz);
    }
    int64_t before_us = seq->from_us - seq->anchor_us + GROBO_PLAY_TIME_UNIT_US / 2;
    int32_t time_us = (int32_t)(before_us % GROBO_PLAY_TIME_UNIT_US) +
                      (int32_t)grobo_i_sooner(seq->to_us - seq->from_us, GROBO_PLAY_TIME_MAX_US);
    return time_us - time_us % GROBO_PLAY_TIME_UNIT_US;
}

static int hand_out(grobo_sequencer *seq, grobo_play_frame *frame)
{
    GROBO_ASSERT(seq->waits && seq->due_us <= seq->now_us);
    frame->posture = seq->to;
    frame->posture.time_us = longer(time_of_frame(seq), GROBO_PLAY_TIME_UNIT_US);
    frame->due_us = seq->due_us;
    frame->skipped = seq->skipped;
    frame->phase = seq->state;

    seq->stats.frames++;
    seq->stats.late_frames += seq->late;
    seq->stats.max_late_us = grobo_i_later(seq->now_us - seq->due_us, seq->stats.max_late_us);
    seq->skipped = 0;
    seq->waits = false;
    return 1;
}

/* ---- moves ---- */

static int fail(grobo_sequencer *seq, int error)
{
    GROBO_ASSERT(error < 0);
    seq->state = GROBO_SEQUENCER_FAILED;
    seq->error = error;
    seq->queue_n = 0;
    seq->waits = false;
    assert_sound(seq);
    return error;
}

/* Begins a move where and when the last one ended. */
static void set_move(grobo_sequencer *seq, bool has_frame, int64_t to_us)
{
    seq->from_us = seq->to_us;
    seq->due_us = seq->to_us;
    seq->to_us = to_us;
    seq->waits = has_frame;
}

/* The same, to a position at its time. */
static void move_to(grobo_sequencer *seq, bool has_frame, int64_t pos_us)
{
    int64_t way_us = (pos_us - seq->anchor_pos_us) * 100;
    int32_t speed_pct = seq->item.options.speed_pct;
    set_move(seq, has_frame, seq->anchor_us + (way_us + speed_pct / 2) / speed_pct);
}

/* Makes one end of the present move what lies on the way at a time. */
static void cut(grobo_sequencer *seq, grobo_posture *end, int64_t t_us)
{
    double part = 1.0;
    if (seq->waits || t_us <= seq->from_us) {
        part = 0.0;
    } else if (t_us < seq->to_us) {
        part = (double)(t_us - seq->from_us) / (double)(seq->to_us - seq->from_us);
    }
    grobo_i_between(end, &seq->from, &seq->to, part);
}

/*
 * Begins to play at anchor_pos_us, by way of an approach from where the last move ended; one of no
 * length where the robot is there. By keys the move to the first key has a time of its own, and a
 * frame in any case.
 */
static int begin(grobo_sequencer *seq, bool soft)
{
    bool by_key = seq->item.options.mode == GROBO_PLAY_KEY;
    int64_t pos_us = seq->anchor_pos_us;
    int result = by_key ? grobo_i_key_seek(seq, pos_us) : grobo_i_sample(seq, pos_us);
    if (result < 0) {
        return fail(seq, result);
    }
    int32_t approach_us = soft ? grobo_i_approach_time(seq) : 0;
    int64_t time_us = approach_us;
    if (by_key && pos_us == 0) {
        time_us = grobo_i_key_first_time(seq) * 100 / seq->item.options.speed_pct;
        time_us = grobo_i_later(time_us, longer(approach_us, GROBO_PLAY_TIME_UNIT_US));
    }
    seq->state = GROBO_SEQUENCER_APPROACHING;
    seq->anchor_us = seq->to_us;
    set_move(seq, time_us > 0 && seq->to.set != 0, seq->to_us + time_us);
    assert_sound(seq);
    return 0;
}

/* The pass is over: again, the next clip, or the end. */
static int end_pass(grobo_sequencer *seq)
{
    if (seq->pass < seq->item.options.repeat) {
        seq->pass++;
        seq->anchor_pos_us = 0;
        return begin(seq, true);
    }
    if (seq->queue_n > 0) {
        grobo_i_item_load(seq);
        return begin(seq, true);
    }
    seq->state = GROBO_SEQUENCER_FINISHED;
    seq->anchor_pos_us = seq->item.span_us;
    return 0;
}

/* KEY: begins the move to the next key, where the last one ended. */
static int next_move(grobo_sequencer *seq)
{
    grobo_i_arrive(seq);
    if (!grobo_i_key_has_next(seq)) {
        return end_pass(seq);
    }
    int result = grobo_i_key_next(seq);
    if (result == 0) {
        move_to(seq, !seq->silent, grobo_i_key_pos(seq));
    }
    return result;
}

/* From anchor_pos_us on, where the approach ended. */
static int start_playing(grobo_sequencer *seq)
{
    seq->state = GROBO_SEQUENCER_PLAYING;
    seq->anchor_us = seq->to_us;
    if (seq->item.options.mode == GROBO_PLAY_RATE) {
        seq->grid_us = seq->to_us;
        seq->grid_rest = seq->item.options.rate_hz / 2u;
        advance_grid(seq);
        move_to(seq, true, seq->item.span_us);
        return 0;
    }
    /* `to` may lie behind its key, on the way to the next. */
    int result = grobo_i_key_load(seq, seq->key.i);
    return result < 0 ? result : next_move(seq);
}

/* ---- a function a state, called when its deadline is there: 1 a frame, 0 none, or error ---- */

static int approaching(grobo_sequencer *seq, grobo_play_frame *frame)
{
    if (!seq->waits && seq->item.options.start_us > seq->to_us) {
        grobo_i_arrive(seq);
        set_move(seq, false, seq->item.options.start_us);
        return 0;
    }
    if (!seq->waits) {
        return start_playing(seq);
    }
    if (seq->late) { /* never faster for it */
        seq->to_us += seq->now_us - seq->from_us;
        seq->from_us = seq->now_us;
        seq->anchor_us = seq->now_us;
    }
    return hand_out(seq, frame);
}

static int playing_keys(grobo_sequencer *seq, grobo_play_frame *frame)
{
    bool is_last = !grobo_i_key_has_next(seq);
    if (seq->waits && (seq->now_us < seq->to_us || is_last)) {
        if (seq->late) {
            seq->from_us = seq->now_us;
        }
        int result = hand_out(seq, frame);
        if (is_last && seq->late) {
            seq->to_us = grobo_i_later(seq->to_us, seq->now_us + frame->posture.time_us);
        }
        return result;
    }
    if (seq->waits) {
        grobo_i_count_skipped(seq);
    }
    return next_move(seq);
}

/* The move is the whole pass; the frame at its end or behind it is the last. */
static int playing_at_rate(grobo_sequencer *seq, grobo_play_frame *frame)
{
    if (!seq->waits) {
        return end_pass(seq);
    }
    bool is_last = seq->due_us >= seq->to_us;
    int result =
        grobo_i_sample(seq, is_last ? seq->item.span_us : grobo_i_pos_at(seq, seq->due_us));
    if (result < 0) {
        return result;
    }
    (void)hand_out(seq, frame);
    grobo_i_arrive(seq);
    if (is_last) { /* it is given the time to get there */
        seq->to_us = (seq->late ? seq->now_us : seq->due_us) + frame->posture.time_us;
    } else {
        advance_grid(seq);
        seq->waits = true;
    }
    return 1;
}

/* PAUSED and STOPPING. */
static int holding(grobo_sequencer *seq, grobo_play_frame *frame)
{
    if (seq->waits) {
        return hand_out(seq, frame);
    }
    seq->state = GROBO_SEQUENCER_IDLE;
    return 0;
}

/* What is due: by a rate only the latest frame, and none behind the end of the pass. */
static int look(grobo_sequencer *seq, grobo_play_frame *frame)
{
    bool plays = seq->state == GROBO_SEQUENCER_PLAYING;
    bool at_rate = plays && seq->item.options.mode == GROBO_PLAY_RATE;
    while (at_rate && seq->waits && seq->grid_us <= seq->now_us && seq->due_us < seq->to_us) {
        advance_grid(seq);
        grobo_i_count_skipped(seq);
    }
    grobo_i_see_if_late(seq);
    if (at_rate) {
        return playing_at_rate(seq, frame);
    }
    if (plays) {
        return playing_keys(seq, frame);
    }
    return seq->state == GROBO_SEQUENCER_APPROACHING ? approaching(seq, frame)
                                                     : holding(seq, frame);
}

int grobo_sequencer_next(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    if (frame == NULL || seq == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = 0;
    seq->now_us = now_us;
    while (result == 0 && now_us >= grobo_sequencer_deadline(seq)) {
        result = look(seq, frame);
    }
    result = result < 0 ? fail(seq, result) : result;
    assert_sound(seq);
    return result;
}

int64_t grobo_sequencer_deadline(const grobo_sequencer *seq)
{
    if (seq == NULL) {
        return GROBO_NEVER_US;
    }
    if (seq->waits) {
        return seq->due_us;
    }
    return is_under_way(seq) || seq->state == GROBO_SEQUENCER_STOPPING ? seq->to_us
                                                                       : GROBO_NEVER_US;
}

/* ---- commands ---- */

static bool is_active(const grobo_sequencer *seq)
{
    return is_under_way(seq) || seq->state == GROBO_SEQUENCER_PAUSED;
}

void grobo_sequencer_init(grobo_sequencer *seq, const grobo_model *model)
{
    if (seq == NULL) {
        return;
    }
    memset(seq, 0, sizeof *seq);
    seq->model = model;
}

int grobo_sequencer_play(grobo_sequencer *seq, const grobo_clip *clip,
                         const grobo_play_options *options, const grobo_posture *start,
                         int64_t now_us)
{
    if (seq == NULL || clip == NULL) {
        return GROBO_ERR_ARG;
    }
    if (seq->state != GROBO_SEQUENCER_IDLE && seq->state != GROBO_SEQUENCER_FINISHED) {
        return GROBO_ERR_STATE;
    }
    int result = grobo_i_item_make(&seq->queue[seq->queue_head], seq->model, clip, options, start);
    if (result < 0) {
        return result;
    }
    if (start != NULL) {
        seq->from = *start;
    } else {
        if (clip->relative) {
            return GROBO_ERR_EMPTY;
        }
        (void)grobo_posture_init(&seq->from, clip->n_joints);
    }
    seq->skipped = 0;
    seq->queue_n = 1;
    seq->to_us = now_us;
    grobo_i_item_load(seq);
    return begin(seq, start != NULL);
}

int grobo_sequencer_enqueue(grobo_sequencer *seq, const grobo_clip *clip,
                            const grobo_play_options *options)
{
    if (seq == NULL || clip == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!is_active(seq)) {
        return GROBO_ERR_STATE;
    }
    if (seq->queue_n == GROBO_QUEUE_MAX) {
        return GROBO_ERR_FULL;
    }
    if (clip->n_joints != seq->item.clip.n_joints) {
        return GROBO_ERR_ARG;
    }
    int slot = (seq->queue_head + seq->queue_n) % GROBO_QUEUE_MAX;
    int result = grobo_i_item_make(&seq->queue[slot], seq->model, clip, options, NULL);
    return result < 0 ? result : ++seq->queue_n;
}

/*
 * Makes the present move one to rest: to the posture that lies half of time_us ahead, in time_us,
 * which is the way a joint goes while it slows down evenly. Never past the end of the move.
 */
static int hold(grobo_sequencer *seq, grobo_sequencer_state state, int32_t time_us)
{
    int64_t now_us = seq->now_us;
    if (seq->state == GROBO_SEQUENCER_PLAYING && seq->item.options.mode == GROBO_PLAY_RATE) {
        /* A stalled caller's robot has not gone further than to the frame that waits. */
        int64_t t_us = seq->waits ? grobo_i_sooner(now_us, seq->due_us) : now_us;
        seq->anchor_pos_us = grobo_i_pos_at(seq, t_us + time_us / 2);
        int result = grobo_i_sample(seq, seq->anchor_pos_us);
        if (result < 0) {
            return fail(seq, result);
        }
    } else {
        int64_t rest_us =
            seq->waits ? seq->from_us : grobo_i_sooner(now_us + time_us / 2, seq->to_us);
        cut(seq, &seq->from, now_us);
        seq->from_us = now_us;
        cut(seq, &seq->to, rest_us);
        if (seq->state == GROBO_SEQUENCER_PLAYING) {
            seq->anchor_pos_us = grobo_i_pos_at(seq, rest_us);
        }
    }
    seq->to_us = now_us;
    seq->anchor_us = now_us;
    set_move(seq, seq->to.set != 0, now_us + longer(time_us, GROBO_PLAY_TIME_UNIT_US));
    seq->state = state;
    assert_sound(seq);
    return 0;
}

/* GROBO_PLAY_TIME_MAX_US at most. */
static int32_t stop_time(const grobo_sequencer *seq)
{
    return (int32_t)seq->item.options.stop_us;
}

int grobo_sequencer_pause(grobo_sequencer *seq, int64_t now_us)
{
    if (seq == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!is_under_way(seq)) {
        return GROBO_ERR_STATE;
    }
    seq->now_us = now_us;
    return hold(seq, GROBO_SEQUENCER_PAUSED, stop_time(seq));
}

/* From a hold, to anchor_pos_us. */
static int set_off(grobo_sequencer *seq, int64_t now_us)
{
    grobo_i_arrive(seq);
    seq->to_us = now_us;
    return begin(seq, true);
}

int grobo_sequencer_resume(grobo_sequencer *seq, int64_t now_us)
{
    if (seq == NULL) {
        return GROBO_ERR_ARG;
    }
    if (seq->state != GROBO_SEQUENCER_PAUSED) {
        return GROBO_ERR_STATE;
    }
    return set_off(seq, now_us);
}

int grobo_sequencer_stop(grobo_sequencer *seq, bool at_once, int64_t now_us)
{
    if (seq == NULL) {
        return GROBO_ERR_ARG;
    }
    bool stopping = seq->state == GROBO_SEQUENCER_STOPPING;
    if (!is_active(seq) && !stopping) {
        return GROBO_ERR_STATE;
    }
    seq->queue_n = 0;
    if (stopping && !at_once) {
        return 0;
    }
    seq->now_us = now_us;
    return hold(seq, GROBO_SEQUENCER_STOPPING, at_once ? 0 : stop_time(seq));
}

int grobo_sequencer_seek(grobo_sequencer *seq, int64_t pos_us, int64_t now_us)
{
    if (seq == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!is_active(seq)) {
        return GROBO_ERR_STATE;
    }
    if (pos_us < 0 || pos_us > seq->item.span_us) {
        return GROBO_ERR_ARG;
    }
    if (seq->state == GROBO_SEQUENCER_PAUSED) {
        seq->anchor_pos_us = pos_us;
        return 0;
    }
    seq->now_us = now_us;
    int result = hold(seq, GROBO_SEQUENCER_APPROACHING, 0);
    if (result == 0) {
        seq->anchor_pos_us = pos_us;
        result = set_off(seq, now_us);
    }
    return result;
}

/* While PLAYING. By keys it is the same move in another time, and its frame goes out once more. */
static void change_speed(grobo_sequencer *seq, uint16_t speed_pct)
{
    bool by_key = seq->item.options.mode == GROBO_PLAY_KEY;
    int64_t end_us = by_key ? grobo_i_key_pos(seq) : seq->item.span_us;
    int64_t pos_us = grobo_i_pos_at(seq, seq->now_us);
    int64_t due_us = seq->due_us;

    seq->anchor_pos_us = grobo_i_sooner(pos_us, end_us);
    seq->anchor_us = seq->now_us;
    seq->item.options.speed_pct = speed_pct;
    if (by_key) {
        bool has_frame = seq->waits || (!seq->silent && seq->anchor_pos_us < end_us);
        cut(seq, &seq->from, seq->now_us);
        seq->to_us = seq->now_us;
        move_to(seq, has_frame, end_us);
    } else if (seq->waits) {
        move_to(seq, true, end_us);
        seq->due_us = due_us;
    }
}

int grobo_sequencer_set_speed(grobo_sequencer *seq, int speed_pct, int64_t now_us)
{
    if (seq == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!is_active(seq)) {
        return GROBO_ERR_STATE;
    }
    if (speed_pct < 1 || speed_pct > GROBO_PLAY_SPEED_MAX_PCT) {
        return GROBO_ERR_ARG;
    }
    if (seq->state == GROBO_SEQUENCER_PLAYING) {
        seq->now_us = now_us;
        change_speed(seq, (uint16_t)speed_pct);
    }
    seq->item.options.speed_pct = (uint16_t)speed_pct;
    assert_sound(seq);
    return 0;
}

int grobo_sequencer_fail(grobo_sequencer *seq, int error)
{
    if (seq == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!is_active(seq) && seq->state != GROBO_SEQUENCER_STOPPING) {
        return GROBO_ERR_STATE;
    }
    if (error >= 0) {
        return GROBO_ERR_ARG;
    }
    (void)fail(seq, error);
    return 0;
}

void grobo_sequencer_reset(grobo_sequencer *seq)
{
    if (seq == NULL) {
        return;
    }
    seq->state = GROBO_SEQUENCER_IDLE;
    seq->error = 0;
    seq->queue_n = 0;
    seq->waits = false;
}
