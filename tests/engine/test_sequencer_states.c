/* SPDX-License-Identifier: MIT */
/* Every state of the sequencer under every command, and anything in any order. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/there_and_back.h"

/* ---- transitions ---- */

TEST(transitions_are_those_of_the_table)
{
    /* Typed anew: from a row's state to a column's. */
    static const char *const table[GROBO_SEQUENCER_STATES] = {
        /*               I A P p S F X */
        /* idle */ ".A....X",
        /* approaching */ "I.PpSFX",
        /* playing */ "IA.pSFX",
        /* paused */ "IA..S.X",
        /* stopping */ "I.....X",
        /* finished */ "IA....X",
        /* failed */ "I......",
    };
    for (int from = -1; from <= GROBO_SEQUENCER_STATES; from++) {
        for (int to = -1; to <= GROBO_SEQUENCER_STATES; to++) {
            bool inside = from >= 0 && from < GROBO_SEQUENCER_STATES && to >= 0 &&
                          to < GROBO_SEQUENCER_STATES;
            bool expected = inside && table[from][to] != '.';
            assert_int_equal(
                grobo_sequencer_may_go((grobo_sequencer_state)from, (grobo_sequencer_state)to),
                expected);
        }
    }
    assert_string_equal(grobo_sequencer_state_name(GROBO_SEQUENCER_IDLE), "idle");
    assert_string_equal(grobo_sequencer_state_name(GROBO_SEQUENCER_FAILED), "failed");
    assert_string_equal(grobo_sequencer_state_name((grobo_sequencer_state)7), "unknown");
}

enum { PLAY, ENQUEUE, PAUSE, RESUME, STOP, STOP_AT_ONCE, SEEK, SET_SPEED, FAIL, COMMANDS };

static int give(int command)
{
    switch (command) {
    case PLAY:
        return there_and_back_again(by_key);
    case ENQUEUE:
        return grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL);
    case PAUSE:
        return grobo_sequencer_pause(&pump.seq, pump.now_us);
    case RESUME:
        return grobo_sequencer_resume(&pump.seq, pump.now_us);
    case STOP:
    case STOP_AT_ONCE:
        return grobo_sequencer_stop(&pump.seq, command == STOP_AT_ONCE, pump.now_us);
    case SEEK:
        return grobo_sequencer_seek(&pump.seq, 500 * MS, pump.now_us);
    case SET_SPEED:
        return grobo_sequencer_set_speed(&pump.seq, 150, pump.now_us);
    default:
        return grobo_sequencer_fail(&pump.seq, GROBO_ERR_IO);
    }
}

static void bring_to(grobo_sequencer_state goal, const grobo_play_options *options)
{
    there_and_back_start(options, 1.0);
    sample_pump_run(&pump, 100 * MS); /* approaching: 1 rad is far */
    if (goal == GROBO_SEQUENCER_PLAYING || goal == GROBO_SEQUENCER_FINISHED) {
        sample_pump_run(&pump, goal == GROBO_SEQUENCER_PLAYING ? 2000 * MS : 9000 * MS);
    } else if (goal == GROBO_SEQUENCER_PAUSED) {
        (void)give(PAUSE);
    } else if (goal == GROBO_SEQUENCER_STOPPING) {
        (void)give(STOP);
    } else if (goal == GROBO_SEQUENCER_FAILED) {
        (void)give(FAIL);
    } else if (goal == GROBO_SEQUENCER_IDLE) {
        grobo_sequencer_reset(&pump.seq);
    }
    (void)sample_pump_take(&pump);
    assert_int_equal(pump.state, goal);
}

TEST(each_command_is_taken_in_its_states_only)
{
    /* Rows as the states; columns as the commands. */
    static const char *const taken[GROBO_SEQUENCER_STATES] = {
        /*               P E p R S s k v X */
        /* idle */ "P........",
        /* approaching */ ".Ep.SskvX",
        /* playing */ ".Ep.SskvX",
        /* paused */ ".E.RSskvX",
        /* stopping */ "....Ss..X",
        /* finished */ "P........",
        /* failed */ ".........",
    };
    for (int mode = 0; mode < 2; mode++) {
        for (int s = 0; s < GROBO_SEQUENCER_STATES; s++) {
            for (int command = 0; command < COMMANDS; command++) {
                bring_to((grobo_sequencer_state)s, mode == 0 ? &by_key : &at_rate);
                int result = give(command);
                if (taken[s][command] == '.') {
                    assert_int_equal(result, GROBO_ERR_STATE);
                    assert_int_equal(grobo_sequencer_get_state(&pump.seq), s);
                } else {
                    assert_true(result >= 0);
                }
                sample_pump_run(&pump, 60000 * MS); /* with all that the pump asserts */
                grobo_sequencer_reset(&pump.seq);
                (void)sample_pump_take(&pump);
                assert_int_equal(pump.state, GROBO_SEQUENCER_IDLE);
            }
        }
    }
}

TEST(arguments_of_commands_are_checked)
{
    there_and_back_start(&by_key, 0.0);
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 0, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 1001, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sequencer_fail(&pump.seq, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sequencer_get_state(&pump.seq), GROBO_SEQUENCER_APPROACHING);
}

/* ---- anything in any order ---- */

/*
 * Commands, stalls and service in any order. The pump asserts what always holds; here: what is
 * sent lies between what the clip and the start have, as everything in between is a mixture.
 */
TEST(whatever_happens_frames_stay_in_bounds)
{
    uint32_t seed = 20;
    for (int round = 0; round < 300; round++) {
        grobo_play_options options;
        grobo_posture from = sample_posture(0.5, 0.5, 0.5);
        there_and_back_start(&by_key, 0.0);
        grobo_sequencer_reset(&pump.seq);
        (void)sample_pump_take(&pump);
        options = sample_options(&seed, 200, 3000000);
        assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, 0), 0);
        for (int i = 0; i < 40; i++) {
            uint32_t what = next_random(&seed) % (3 * COMMANDS);
            (void)sample_pump_take(&pump);
            if (what < COMMANDS && what != FAIL && what != PLAY) {
                (void)give((int)what);
            } else if (what % 3 == 0) {
                pump.now_us += next_random(&seed) % 900000;
            } else {
                sample_pump_run(&pump, pump.now_us + next_random(&seed) % 300000);
            }
        }
        for (size_t i = 0; i < pump.n; i++) {
            for (int j = 0; j < SAMPLE_JOINTS; j++) {
                assert_true(fabs(pump.frames[i].posture.angle_rad[j]) <= 1.0 + 1e-9);
            }
        }
    }
}
