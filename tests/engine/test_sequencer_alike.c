/* SPDX-License-Identifier: MIT */
/* Plays that must give the same frames: on another clock, served more often, asked otherwise. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/there_and_back.h"

static sample_pump first;

/* Partial keys, an empty one, one without a time: what a clip may have. LEFT and MIDDLE move. */
static const sample_key mixed[] = {{130 * MS, ALL, {0.1, 0.2, 0.3}},
                                   {0, LEFT, {0.5, 0, 0}},
                                   {250 * MS, 0, {0, 0, 0}},
                                   {310 * MS, RIGHT, {0, -0.4, 0}},
                                   {470 * MS, ALL, {-0.2, 0.1, 0.9}}};

static grobo_play_options random_options(uint32_t *seed)
{
    grobo_play_options options = sample_options(seed, 100, 600000);
    options.default_time_us = next_random(seed) % 200000;
    options.stop_us = next_random(seed) % 400000;
    return options;
}

static void random_command(uint32_t *seed)
{
    grobo_play_options options;
    sample_pump_look(&pump);
    switch (next_random(seed) % 16) {
    case 0:
        (void)grobo_sequencer_pause(&pump.seq, pump.now_us);
        break;
    case 1:
    case 2:
        (void)grobo_sequencer_resume(&pump.seq, pump.now_us);
        break;
    case 3:
        (void)grobo_sequencer_stop(&pump.seq, next_random(seed) % 2, pump.now_us);
        break;
    case 4:
        (void)grobo_sequencer_seek(&pump.seq, next_random(seed) % 900000, pump.now_us);
        break;
    case 5:
        (void)grobo_sequencer_set_speed(&pump.seq, (int)(next_random(seed) % 300), pump.now_us);
        break;
    case 6:
    case 7:
        options = random_options(seed);
        (void)grobo_sequencer_enqueue(&pump.seq, &other.clip, &options);
        break;
    case 8:
        if (pump.state == GROBO_SEQUENCER_FAILED) {
            grobo_sequencer_reset(&pump.seq);
        }
        options = random_options(seed);
        (void)there_and_back_again(options);
        break;
    default:
        break;
    }
    sample_pump_look(&pump);
}

/* Anything in any order, on a clock that begins at origin_us. Served `more` times between. */
static void live(uint32_t seed, int64_t origin_us, int more)
{
    grobo_play_options options;
    grobo_posture from = sample_posture(0.5, -0.5, 0.5);
    uint32_t random = seed;
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, mixed, 5);
    sample_clip_init(&other, there_and_back, 3);
    pump.now_us = origin_us;
    options = random_options(&random);
    (void)grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, origin_us);
    for (int i = 0; i < 30; i++) {
        bool stalls = next_random(&random) % 4 == 0;
        int64_t time_us = next_random(&random) % (stalls ? 90000 : 400000);
        (void)sample_pump_take(&pump);
        if (stalls) {
            pump.now_us += time_us;
        } else {
            for (int k = 1; k <= more; k++) {
                sample_pump_run(&pump, pump.now_us + time_us / (more + 1));
                (void)sample_pump_take(&pump);
            }
            sample_pump_run(&pump, pump.now_us + time_us - time_us / (more + 1) * more);
        }
        random_command(&random);
    }
    (void)sample_pump_take(&pump);
}

/* The same as `first`, so much later. */
static void expect_alike(int64_t later_us)
{
    grobo_play_progress a;
    grobo_play_progress b;
    assert_int_equal(pump.n, first.n);
    for (size_t i = 0; i < pump.n; i++) {
        const grobo_play_frame *x = &first.frames[i];
        const grobo_play_frame *y = &pump.frames[i];
        assert_true(y->due_us - x->due_us == later_us);
        assert_true(y->posture.time_us == x->posture.time_us);
        assert_true(y->phase == x->phase && y->skipped == x->skipped);
        assert_true(y->posture.set == x->posture.set);
        for (int j = 0; j < SAMPLE_JOINTS; j++) {
            assert_true((x->posture.set & GROBO_JOINT_BIT(j)) == 0 ||
                        fabs(y->posture.angle_rad[j] - x->posture.angle_rad[j]) < 1e-12);
        }
    }
    assert_int_equal(grobo_sequencer_get_state(&pump.seq), grobo_sequencer_get_state(&first.seq));
    grobo_sequencer_progress(&first.seq, first.now_us, &a);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &b);
    assert_true(a.t_us == b.t_us && a.total_us == b.total_us && a.step == b.step);
    assert_true(a.item == b.item && a.pass == b.pass && a.queued == b.queued);
    assert_true(pump.state_us - first.state_us == later_us);
    assert_memory_equal(grobo_sequencer_stats(&first.seq), grobo_sequencer_stats(&pump.seq),
                        sizeof(grobo_play_stats));
}

TEST(nothing_depends_on_where_the_clock_begins)
{
    static const int64_t origins_us[] = {1, 7777777, INT64_C(86400000000) * 365};
    for (uint32_t seed = 0; seed < 150; seed++) {
        live(seed, 0, 0);
        first = pump;
        for (int i = 0; i < 3; i++) {
            live(seed, origins_us[i], 0);
            expect_alike(origins_us[i]);
        }
    }
}

TEST(looking_more_often_changes_nothing)
{
    for (uint32_t seed = 1000; seed < 1100; seed++) {
        live(seed, 5000000, 0);
        first = pump;
        live(seed, 5000000, 3);
        expect_alike(0);
    }
}
