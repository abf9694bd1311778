/* SPDX-License-Identifier: MIT */
/* How far a sequencer is: for who shows it, playing needs none of it. */
#include <string.h>

#include "src/play/sequencer.h"

/* Frames of the grid before a position, counted from the beginning of the pass. */
static uint64_t frames_until(const grobo_play_options *options, int64_t pos_us)
{
    int32_t speed = 10000 * options->speed_pct; /* x rate_hz: microseconds of motion a frame */
    return (uint64_t)((pos_us * options->rate_hz + speed - 1) / speed);
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
    if (seq == NULL || progress == NULL) {
        return;
    }
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
