/* SPDX-License-Identifier: MIT */
/* The states of a sequencer in words, and which may follow which: playing needs neither. */
#include <grobo/core/sequencer.h>

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
