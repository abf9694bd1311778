/* SPDX-License-Identifier: MIT */
/*
 * Everything is a move: from a posture at one real time to another at a later one. An approach is
 * one, the way to a key is one, a hold (pause, stop) is one; each has one frame, handed out when
 * it begins. Playing at a rate is the exception: its frames lie on a grid.
 */
#include "sequencer_i.h"

#include <string.h>

#define SECOND_US 1000000LL

/* What a state's function says besides 1 (a frame), 0 (nothing due) and errors: look again. */
enum { AGAIN = 2 };

/* ---- real time and position ---- */

int64_t grobo_i_pos_at(const grobo_sequencer *seq, int64_t t_us)
{
    int64_t pos_us =
        seq->anchor_pos_us + (t_us - seq->anchor_us) * seq->item.options.speed_pct / 100;
    if (pos_us < seq->anchor_pos_us) {
        return seq->anchor_pos_us;
    }
    return pos_us > seq->item.span_us ? seq->item.span_us : pos_us;
}

static int64_t time_of(const grobo_sequencer *seq, int64_t pos_us)
{
    int64_t speed_pct = seq->item.options.speed_pct;
    return seq->anchor_us + ((pos_us - seq->anchor_pos_us) * 100 + speed_pct / 2) / speed_pct;
}

/* Real time of frame i; the one division keeps rounding from adding up. */
static int64_t grid_time(const grobo_sequencer *seq, int64_t i)
{
    int64_t rate_hz = seq->item.options.rate_hz;
    return seq->grid_us + (i * SECOND_US + rate_hz / 2) / rate_hz;
}

/* The last frame of the grid that is due at t_us, t_us >= grid_us. */
static int64_t grid_index(const grobo_sequencer *seq, int64_t t_us)
{
    int64_t rate_hz = seq->item.options.rate_hz;
    return ((t_us - seq->grid_us + 1) * rate_hz - 1 - rate_hz / 2) / SECOND_US;
}

/* The frame that carries the end of the pass. */
static int64_t grid_last(const grobo_sequencer *seq)
{
    int64_t i = grid_index(seq, time_of(seq, seq->item.span_us));
    while (grobo_i_pos_at(seq, grid_time(seq, i)) < seq->item.span_us) {
        i++;
    }
    return i;
}

static int64_t in_units(int64_t time_us)
{
    return (time_us + GROBO_PLAY_TIME_UNIT_US / 2) / GROBO_PLAY_TIME_UNIT_US *
           GROBO_PLAY_TIME_UNIT_US;
}

/* ---- frames ---- */

static int hand_out(grobo_sequencer *seq, int64_t now_us, int64_t time_us, grobo_play_frame *frame)
{
    int64_t late_us = now_us - seq->due_us;
    if (time_us < GROBO_PLAY_TIME_UNIT_US) {
        time_us = GROBO_PLAY_TIME_UNIT_US;
    }
    frame->posture = seq->to;
    frame->posture.time_us = time_us > GROBO_PLAY_TIME_MAX_US ? GROBO_PLAY_TIME_MAX_US : time_us;
    frame->due_us = seq->due_us;
    frame->skipped = seq->skipped;
    frame->phase = seq->state;

    seq->stats.frames++;
    seq->stats.late_frames += late_us > seq->item.options.late_us;
    seq->stats.max_late_us = late_us > seq->stats.max_late_us ? late_us : seq->stats.max_late_us;
    seq->skipped = 0;
    seq->waits = false;
    return 1;
}

static void skip_frames(grobo_sequencer *seq, int64_t n)
{
    seq->stats.skipped_frames += (uint64_t)n;
    seq->stats.late_frames += (uint64_t)n;
    seq->skipped += (uint32_t)n;
}

static bool is_late(const grobo_sequencer *seq, int64_t now_us)
{
    return now_us - seq->due_us > seq->item.options.late_us;
}

/* ---- moves ---- */

static int fail(grobo_sequencer *seq, int error)
{
    seq->state = GROBO_SEQUENCER_FAILED;
    seq->error = error;
    seq->queue_n = 0;
    seq->waits = false;
    return error;
}

static void set_move(grobo_sequencer *seq, int64_t from_us, int64_t to_us, bool has_frame)
{
    seq->from_us = from_us;
    seq->to_us = to_us;
    seq->due_us = from_us;
    seq->waits = has_frame;
}

/* What was the goal is where the robot is now. */
static void arrive(grobo_sequencer *seq)
{
    grobo_posture_merge(&seq->from, &seq->to);
}

/* How much of the present move is made. */
static double part_at(const grobo_sequencer *seq, int64_t t_us)
{
    if (seq->waits || t_us <= seq->from_us) {
        return 0.0;
    }
    return t_us >= seq->to_us ? 1.0
                              : (double)(t_us - seq->from_us) / (double)(seq->to_us - seq->from_us);
}

/*
 * Begins to play at a position, by way of an approach; one of no length where the robot is there.
 * By keys the move to the first key has a time of its own, and a frame in any case.
 */
static int begin_at(grobo_sequencer *seq, int64_t pos_us, int64_t t_us, bool soft)
{
    bool by_key = seq->item.options.mode == GROBO_PLAY_KEY;
    int result = by_key ? grobo_i_key_seek(seq, pos_us) : grobo_i_sample(seq, pos_us);
    if (result < 0) {
        return fail(seq, result);
    }
    int64_t time_us = soft ? grobo_i_approach_time(seq) : 0;
    if (by_key && pos_us == 0) {
        int64_t own_us = grobo_i_key_first_time(seq) * 100 / seq->item.options.speed_pct;
        own_us = own_us < GROBO_PLAY_TIME_UNIT_US ? GROBO_PLAY_TIME_UNIT_US : own_us;
        time_us = own_us > time_us ? own_us : time_us;
    }
    seq->state = GROBO_SEQUENCER_APPROACHING;
    seq->anchor_us = t_us;
    seq->anchor_pos_us = pos_us;
    set_move(seq, t_us, t_us + time_us, time_us > 0 && seq->to.set != 0);
    return 0;
}

/* The pass is over: again, the next clip, or the end. */
static int end_pass(grobo_sequencer *seq)
{
    arrive(seq);
    if (seq->pass < seq->item.options.repeat) {
        seq->pass++;
        return begin_at(seq, 0, seq->to_us, true);
    }
    if (seq->queue_n > 0) {
        grobo_i_item_load(seq, &seq->queue[seq->queue_head]);
        seq->queue_head = (seq->queue_head + 1) % GROBO_QUEUE_MAX;
        seq->queue_n--;
        return begin_at(seq, seq->item.options.from_us, seq->to_us, true);
    }
    seq->state = GROBO_SEQUENCER_FINISHED;
    seq->anchor_pos_us = seq->item.span_us;
    seq->waits = false;
    return 0;
}

/* KEY: begins the move to the next key, where the last one ended. */
static int next_move(grobo_sequencer *seq)
{
    arrive(seq);
    if (!grobo_i_key_has_next(seq)) {
        return end_pass(seq);
    }
    int result = grobo_i_key_next(seq);
    if (result < 0) {
        return fail(seq, result);
    }
    set_move(seq, seq->to_us, time_of(seq, grobo_i_key_pos(seq)), !seq->silent);
    return 0;
}

/* From anchor_pos_us on, at a real time. */
static int start_playing(grobo_sequencer *seq, int64_t t_us)
{
    seq->state = GROBO_SEQUENCER_PLAYING;
    seq->anchor_us = t_us;
    arrive(seq);
    if (seq->item.options.mode == GROBO_PLAY_RATE) {
        seq->grid_us = t_us;
        seq->index = 0;
        set_move(seq, t_us, t_us, true);
        return 0;
    }
    /* `to` may lie behind its key, on the way to the next. */
    int result = grobo_i_key_load(seq, seq->key.i);
    if (result < 0) {
        return fail(seq, result);
    }
    seq->to_us = t_us;
    return next_move(seq);
}

/* ---- a function a state ---- */

static int approaching(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    int64_t time_us = seq->to_us - seq->from_us;
    if (!seq->waits) {
        if (now_us < seq->to_us) {
            return 0;
        }
        int result = start_playing(seq, seq->to_us);
        return result < 0 ? result : AGAIN;
    }
    if (now_us < seq->due_us) {
        return 0;
    }
    if (is_late(seq, now_us)) { /* never faster for it */
        seq->from_us = now_us;
        seq->to_us = now_us + time_us;
    }
    return hand_out(seq, now_us, in_units(time_us), frame);
}

static int playing_keys(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    if (seq->waits && now_us < seq->due_us) {
        return 0;
    }
    bool is_last = !grobo_i_key_has_next(seq);
    if (seq->waits && (now_us < seq->to_us || is_last)) {
        /* From absolute times, so that neither lateness nor rounding adds up. */
        bool late = is_late(seq, now_us);
        int64_t start_us = late ? now_us : seq->from_us;
        int64_t time_us =
            in_units(seq->to_us - seq->anchor_us) - in_units(start_us - seq->anchor_us);
        int result = hand_out(seq, now_us, time_us, frame);
        if (late && is_last && seq->to_us < now_us + frame->posture.time_us) {
            seq->to_us = now_us + frame->posture.time_us;
        }
        return result;
    }
    if (now_us < seq->to_us) {
        return 0;
    }
    if (seq->waits) {
        skip_frames(seq, 1);
    }
    int result = next_move(seq);
    return result < 0 ? result : AGAIN;
}

static int playing_at_rate(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    if (!seq->waits) {
        if (now_us < seq->to_us) {
            return 0;
        }
        int result = end_pass(seq);
        return result < 0 ? result : AGAIN;
    }
    if (now_us < seq->due_us) {
        return 0;
    }
    int64_t last = grid_last(seq);
    int64_t i = grid_index(seq, now_us);
    i = i > last ? last : i;
    i = i < seq->index ? seq->index : i;
    skip_frames(seq, i - seq->index);
    seq->due_us = grid_time(seq, i);
    int result = grobo_i_sample(seq, grobo_i_pos_at(seq, seq->due_us));
    if (result < 0) {
        return fail(seq, result);
    }
    int64_t period_us = SECOND_US / seq->item.options.rate_hz;
    (void)hand_out(seq, now_us, period_us, frame);
    arrive(seq);
    seq->index = i + 1;
    seq->waits = i < last;
    /* The last one is given the time to get there. */
    seq->to_us = (is_late(seq, now_us) ? now_us : seq->due_us) + frame->posture.time_us;
    seq->due_us = grid_time(seq, seq->index);
    return 1;
}

static int playing(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    return seq->item.options.mode == GROBO_PLAY_KEY ? playing_keys(seq, now_us, frame)
                                                    : playing_at_rate(seq, now_us, frame);
}

/* PAUSED and STOPPING. */
static int holding(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    if (seq->waits && now_us >= seq->due_us) {
        return hand_out(seq, now_us, in_units(seq->to_us - seq->from_us), frame);
    }
    if (seq->state == GROBO_SEQUENCER_STOPPING && now_us >= seq->to_us) {
        seq->state = GROBO_SEQUENCER_IDLE;
    }
    return 0;
}

static int look(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    switch (seq->state) {
    case GROBO_SEQUENCER_APPROACHING:
        return approaching(seq, now_us, frame);
    case GROBO_SEQUENCER_PLAYING:
        return playing(seq, now_us, frame);
    case GROBO_SEQUENCER_PAUSED:
    case GROBO_SEQUENCER_STOPPING:
        return holding(seq, now_us, frame);
    case GROBO_SEQUENCER_IDLE:
    case GROBO_SEQUENCER_FINISHED:
    case GROBO_SEQUENCER_FAILED:
        return 0;
    }
    return 0;
}

int grobo_sequencer_next(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame)
{
    int result;
    do {
        result = look(seq, now_us, frame);
    } while (result == AGAIN);
    return result;
}

int64_t grobo_sequencer_deadline(const grobo_sequencer *seq)
{
    switch (seq->state) {
    case GROBO_SEQUENCER_APPROACHING:
    case GROBO_SEQUENCER_PLAYING:
    case GROBO_SEQUENCER_STOPPING:
        return seq->waits ? seq->due_us : seq->to_us;
    case GROBO_SEQUENCER_PAUSED:
        return seq->waits ? seq->due_us : GROBO_NEVER_US;
    case GROBO_SEQUENCER_IDLE:
    case GROBO_SEQUENCER_FINISHED:
    case GROBO_SEQUENCER_FAILED:
        return GROBO_NEVER_US;
    }
    return GROBO_NEVER_US;
}

/* ---- commands ---- */

static bool is_under_way(const grobo_sequencer *seq)
{
    return seq->state == GROBO_SEQUENCER_APPROACHING || seq->state == GROBO_SEQUENCER_PLAYING;
}

static bool is_active(const grobo_sequencer *seq)
{
    return is_under_way(seq) || seq->state == GROBO_SEQUENCER_PAUSED;
}

void grobo_sequencer_init(grobo_sequencer *seq, const grobo_model *model)
{
    memset(seq, 0, sizeof *seq);
    seq->model = model;
}

int grobo_sequencer_play(grobo_sequencer *seq, const grobo_clip *clip,
                         const grobo_play_options *options, const grobo_posture *start,
                         int64_t now_us)
{
    grobo_play_item item;
    if (seq->state != GROBO_SEQUENCER_IDLE && seq->state != GROBO_SEQUENCER_FINISHED) {
        return GROBO_ERR_STATE;
    }
    int result = grobo_i_item_make(&item, seq->model, clip, options, start);
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
    seq->error = 0;
    grobo_i_item_load(seq, &item);
    return begin_at(seq, item.options.from_us, now_us, start != NULL);
}

int grobo_sequencer_enqueue(grobo_sequencer *seq, const grobo_clip *clip,
                            const grobo_play_options *options)
{
    if (!is_active(seq)) {
        return GROBO_ERR_STATE;
    }
    if (seq->queue_n == GROBO_QUEUE_MAX) {
        return GROBO_ERR_FULL;
    }
    if (clip->n_joints != seq->item.clip.n_joints) {
        return GROBO_ERR_ARG;
    }
    unsigned slot = (seq->queue_head + seq->queue_n) % GROBO_QUEUE_MAX;
    int result = grobo_i_item_make(&seq->queue[slot], seq->model, clip, options, NULL);
    return result < 0 ? result : (int)++seq->queue_n;
}

/*
 * Makes the present move one to rest: to the posture that lies half of time_us ahead, in time_us,
 * which is the way a joint goes while it slows down evenly. Never past the end of the move.
 */
static int hold(grobo_sequencer *seq, int64_t time_us, int64_t now_us)
{
    if (seq->state == GROBO_SEQUENCER_PLAYING && seq->item.options.mode == GROBO_PLAY_RATE) {
        /* A stalled caller's robot has not gone further than to the frame that waits. */
        int64_t t_us = now_us < seq->due_us || !seq->waits ? now_us : seq->due_us;
        seq->anchor_pos_us = grobo_i_pos_at(seq, t_us + time_us / 2);
        int result = grobo_i_sample(seq, seq->anchor_pos_us);
        if (result < 0) {
            return fail(seq, result);
        }
    } else {
        grobo_posture here, rest;
        int64_t rest_us = now_us + time_us / 2;
        rest_us = rest_us > seq->to_us ? seq->to_us : rest_us;
        rest_us = seq->waits ? seq->from_us : rest_us;
        grobo_i_between(&here, &seq->from, &seq->to, part_at(seq, now_us));
        grobo_i_between(&rest, &seq->from, &seq->to, part_at(seq, rest_us));
        if (seq->state == GROBO_SEQUENCER_PLAYING) {
            seq->anchor_pos_us = grobo_i_pos_at(seq, rest_us);
        }
        grobo_posture_merge(&seq->from, &here);
        seq->to = rest;
    }
    if (time_us < GROBO_PLAY_TIME_UNIT_US) {
        time_us = GROBO_PLAY_TIME_UNIT_US;
    }
    set_move(seq, now_us, now_us + time_us, seq->to.set != 0);
    return 0;
}

int grobo_sequencer_pause(grobo_sequencer *seq, int64_t now_us)
{
    if (!is_under_way(seq)) {
        return GROBO_ERR_STATE;
    }
    int result = hold(seq, seq->item.options.stop_us, now_us);
    if (result == 0) {
        seq->state = GROBO_SEQUENCER_PAUSED;
    }
    return result;
}

int grobo_sequencer_resume(grobo_sequencer *seq, int64_t now_us)
{
    if (seq->state != GROBO_SEQUENCER_PAUSED) {
        return GROBO_ERR_STATE;
    }
    arrive(seq);
    return begin_at(seq, seq->anchor_pos_us, now_us, true);
}

int grobo_sequencer_stop(grobo_sequencer *seq, bool at_once, int64_t now_us)
{
    bool stopping = seq->state == GROBO_SEQUENCER_STOPPING;
    if (!is_active(seq) && !stopping) {
        return GROBO_ERR_STATE;
    }
    seq->queue_n = 0;
    if (stopping && !at_once) {
        return 0;
    }
    int result = hold(seq, at_once ? 0 : seq->item.options.stop_us, now_us);
    if (result == 0) {
        seq->state = GROBO_SEQUENCER_STOPPING;
    }
    return result;
}

int grobo_sequencer_seek(grobo_sequencer *seq, int64_t pos_us, int64_t now_us)
{
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
    int result = hold(seq, 0, now_us);
    if (result < 0) {
        return result;
    }
    arrive(seq);
    return begin_at(seq, pos_us, now_us, true);
}

/* While PLAYING. By keys it is the same move in another time, and its frame goes out once more. */
static void change_speed(grobo_sequencer *seq, uint16_t speed_pct, int64_t now_us)
{
    int64_t pos_us = grobo_i_pos_at(seq, now_us);
    bool by_key = seq->item.options.mode == GROBO_PLAY_KEY;
    int64_t end_us = by_key ? grobo_i_key_pos(seq) : seq->item.span_us;

    seq->anchor_pos_us = pos_us > end_us ? end_us : pos_us;
    seq->anchor_us = now_us;
    seq->item.options.speed_pct = speed_pct;
    if (by_key) {
        grobo_posture here;
        bool has_frame = seq->waits || (!seq->silent && seq->anchor_pos_us < end_us);
        grobo_i_between(&here, &seq->from, &seq->to, part_at(seq, now_us));
        grobo_posture_merge(&seq->from, &here);
        set_move(seq, seq->anchor_us, time_of(seq, end_us), has_frame);
    }
}

int grobo_sequencer_set_speed(grobo_sequencer *seq, int speed_pct, int64_t now_us)
{
    if (!is_active(seq)) {
        return GROBO_ERR_STATE;
    }
    if (speed_pct < 1 || speed_pct > GROBO_PLAY_SPEED_MAX_PCT) {
        return GROBO_ERR_ARG;
    }
    if (seq->state == GROBO_SEQUENCER_PLAYING) {
        change_speed(seq, (uint16_t)speed_pct, now_us);
    }
    seq->item.options.speed_pct = (uint16_t)speed_pct;
    return 0;
}

int grobo_sequencer_fail(grobo_sequencer *seq, int error)
{
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
    seq->state = GROBO_SEQUENCER_IDLE;
    seq->error = 0;
    seq->queue_n = 0;
    seq->waits = false;
}
