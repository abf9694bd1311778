/* SPDX-License-Identifier: MIT */
/* What a sequencer says of itself. */
#include "sequencer_i.h"

#include <string.h>

grobo_sequencer_state grobo_sequencer_get_state(const grobo_sequencer *seq)
{
    return seq->state;
}

const char *grobo_sequencer_state_name(grobo_sequencer_state state)
{
    static const char *const names[GROBO_SEQUENCER_STATES] = {
        "idle", "approaching", "playing", "paused", "stopping", "finished", "failed"};
    return (unsigned)state < GROBO_SEQUENCER_STATES ? names[state] : "unknown";
}

#define TO(state) (1u << GROBO_SEQUENCER_##state)

bool grobo_sequencer_may_go(grobo_sequencer_state from, grobo_sequencer_state to)
{
    static const uint8_t goals[GROBO_SEQUENCER_STATES] = {
        [GROBO_SEQUENCER_IDLE] = TO(APPROACHING) | TO(FAILED),
        [GROBO_SEQUENCER_APPROACHING] =
            TO(PLAYING) | TO(PAUSED) | TO(STOPPING) | TO(FINISHED) | TO(FAILED) | TO(IDLE),
        [GROBO_SEQUENCER_PLAYING] =
            TO(APPROACHING) | TO(PAUSED) | TO(STOPPING) | TO(FINISHED) | TO(FAILED) | TO(IDLE),
        [GROBO_SEQUENCER_PAUSED] = TO(APPROACHING) | TO(STOPPING) | TO(FAILED) | TO(IDLE),
        [GROBO_SEQUENCER_STOPPING] = TO(FAILED) | TO(IDLE),
        [GROBO_SEQUENCER_FINISHED] = TO(APPROACHING) | TO(FAILED) | TO(IDLE),
        [GROBO_SEQUENCER_FAILED] = TO(IDLE),
    };
    if ((unsigned)from >= GROBO_SEQUENCER_STATES || (unsigned)to >= GROBO_SEQUENCER_STATES) {
        return false;
    }
    return (goals[from] & (1u << to)) != 0;
}

/* Frames of the grid before a position, counted from the beginning of the pass. */
static uint64_t frames_until(const grobo_play_options *options, int64_t pos_us)
{
    int64_t speed = 1000000LL * options->speed_pct;
    return (uint64_t)((pos_us * options->rate_hz * 100 + speed - 1) / speed);
}

static void count_steps(const grobo_sequencer *seq, grobo_play_progress *progress)
{
    const grobo_play_options *options = &seq->item.options;
    size_t n = seq->item.clip.n_keys;
    if (options->mode == GROBO_PLAY_RATE) {
        progress->steps = frames_until(options, seq->item.span_us) + 1;
        /* The frame of this very position is out. */
        int64_t after_us = seq->state == GROBO_SEQUENCER_PLAYING ? 1 : 0;
        progress->step = frames_until(options, progress->t_us + after_us);
    } else {
        progress->steps = n;
        progress->step = options->reverse ? n - seq->key.i : seq->key.i + 1;
        progress->step -= seq->waits && (seq->state == GROBO_SEQUENCER_APPROACHING ||
                                         seq->state == GROBO_SEQUENCER_PLAYING);
    }
    if (seq->state == GROBO_SEQUENCER_FINISHED || progress->step > progress->steps) {
        progress->step = progress->steps;
    }
}

void grobo_sequencer_progress(const grobo_sequencer *seq, int64_t now_us,
                              grobo_play_progress *progress)
{
    memset(progress, 0, sizeof *progress);
    progress->state = seq->state;
    progress->error = seq->error;
    progress->item = seq->n_items;
    progress->queued = seq->queue_n;
    if (seq->n_items == 0) {
        return;
    }
    progress->pass = seq->pass;
    progress->passes = seq->item.options.repeat;
    progress->total_us = seq->item.span_us;
    progress->t_us =
        seq->state == GROBO_SEQUENCER_PLAYING ? grobo_i_pos_at(seq, now_us) : seq->anchor_pos_us;
    count_steps(seq, progress);
}

const grobo_play_stats *grobo_sequencer_stats(const grobo_sequencer *seq)
{
    return &seq->stats;
}
