/* SPDX-License-Identifier: MIT */
/* A start that is told after the approach: for who begins several robots together. */
#include "src/play/sequencer.h"

bool grobo_sequencer_is_ready(const grobo_sequencer *seq)
{
    return seq != NULL && seq->state == GROBO_SEQUENCER_APPROACHING && !seq->waits &&
           seq->item.options.start_us == GROBO_START_LATER && seq->to_us == GROBO_START_LATER;
}

int grobo_sequencer_start_at(grobo_sequencer *seq, int64_t start_us, int64_t now_us)
{
    if (seq == NULL || start_us < 0 || start_us > GROBO_START_LATER) {
        return GROBO_ERR_ARG;
    }
    if (!grobo_sequencer_is_ready(seq)) {
        return GROBO_ERR_STATE;
    }
    if (start_us < now_us) {
        return GROBO_ERR_STALE;
    }
    seq->item.options.start_us = start_us;
    seq->to_us = start_us;
    return GROBO_OK;
}
