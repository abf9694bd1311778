/* SPDX-License-Identifier: MIT */
/* What a sequencer says of itself. */
#include "src/play/sequencer.h"

grobo_sequencer_state grobo_sequencer_get_state(const grobo_sequencer *seq)
{
    return seq == NULL ? GROBO_SEQUENCER_IDLE : seq->state;
}

void grobo_i_see_if_late(grobo_sequencer *seq)
{
    seq->late = seq->now_us - seq->due_us > seq->item.options.late_us;
}

void grobo_i_count_skipped(grobo_sequencer *seq)
{
    seq->stats.skipped_frames++;
    seq->stats.late_frames++;
    seq->skipped++;
}

const grobo_play_stats *grobo_sequencer_stats(const grobo_sequencer *seq)
{
    return seq == NULL ? NULL : &seq->stats;
}
