/* SPDX-License-Identifier: MIT */
/* Playing by keys, in virtual time. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/sample_clip.h"
#include "tests/support/test.h"

#define PI 3.14159265358979323846

static sample_pump pump;
static sample_clip clip;

/* As a .m file gives it: 1000, 500 and 250 ms. */
static const sample_key three[] = {{1000 * MS, ALL, {0.1, 0.2, 0.3}},
                                   {500 * MS, ALL, {0.2, 0.0, 0.3}},
                                   {250 * MS, ALL, {0.3, 0.1, -0.3}}};

/* Keys that set some joints only, one that sets none, times left to the player. */
static const sample_key partial[] = {{0, LEFT, {0.1, 0, 0}},
                                     {200 * MS, RIGHT, {0, 0.2, 0}},
                                     {300 * MS, 0, {0, 0, 0}},
                                     {0, LEFT, {-0.1, 0, 0}},
                                     {400 * MS, LEFT | RIGHT, {0.3, -0.2, 0}}};

/* One frame that is expected. NAN: joint not set. */
typedef struct expected {
    int64_t due_ms, time_ms;
    double angle_rad[SAMPLE_JOINTS];
} expected;

static void expect_frames(const expected *frames, size_t n)
{
    assert_int_equal(pump.n, n);
    for (size_t i = 0; i < n; i++) {
        const grobo_play_frame *got = &pump.frames[i];
        assert_int_equal(got->due_us, frames[i].due_ms * MS);
        assert_int_equal(got->posture.time_us, frames[i].time_ms * MS);
        for (int j = 0; j < SAMPLE_JOINTS; j++) {
            double angle_rad;
            int result = grobo_posture_get_rad(&got->posture, j, &angle_rad);
            if (isnan(frames[i].angle_rad[j])) {
                assert_int_equal(result, GROBO_ERR_EMPTY);
            } else {
                assert_int_equal(result, 0);
                assert_true(fabs(angle_rad - frames[i].angle_rad[j]) < 1e-9);
            }
        }
    }
}

#define EXPECT(...)                                                                                \
    do {                                                                                           \
        const expected want_[] = {__VA_ARGS__};                                                    \
        expect_frames(want_, sizeof want_ / sizeof want_[0]);                                      \
    } while (0)

static int start(const sample_key *keys, size_t n, const grobo_play_options *options,
                 const grobo_posture *from)
{
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, keys, n);
    return grobo_sequencer_play(&pump.seq, &clip.clip, options, from, 0);
}

/* Plays from a posture near the first key, to the end. */
static void play_all(const sample_key *keys, size_t n, grobo_play_options options)
{
    grobo_posture from = sample_posture(0.1, 0.2, 0.3);
    assert_int_equal(start(keys, n, &options, &from), 0);
    sample_pump_run(&pump, 3600 * 1000 * MS);
}

static void expect_finished_at(int64_t ms)
{
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(pump.state_us, ms * MS);
    assert_int_equal(grobo_sequencer_deadline(&pump.seq), GROBO_NEVER_US);
}

TEST(a_key_posture_is_one_frame_with_its_time)
{
    play_all(three, 3, (grobo_play_options){0});
    EXPECT({0, 1000, {0.1, 0.2, 0.3}}, {1000, 500, {0.2, 0.0, 0.3}}, {1500, 250, {0.3, 0.1, -0.3}});
    assert_int_equal(pump.frames[0].phase, GROBO_SEQUENCER_APPROACHING);
    assert_int_equal(pump.frames[1].phase, GROBO_SEQUENCER_PLAYING);
    expect_finished_at(1750);
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->frames, 3);
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->late_frames, 0);
}

TEST(the_first_move_is_soft)
{
    static const struct {
        double far_deg;
        uint16_t approach_deg_s;
        int64_t time_ms;
    } rows[] = {
        {90.0, 0, 1500},  /* 90 / 60 s */
        {30.0, 0, 1000},  /* 0.5 s: the key's own second is longer */
        {90.0, 20, 4500}, /* 90 / 20 s */
        {90.3, 0, 1510},  /* 1.505 s, in whole units and never faster */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_play_options options = {.approach_deg_s = rows[i].approach_deg_s};
        grobo_posture from = sample_posture(0.1 - rows[i].far_deg * PI / 180, 0.2, 0.3);
        assert_int_equal(start(three, 3, &options, &from), 0);
        sample_pump_run(&pump, 10000 * MS);
        EXPECT({0, rows[i].time_ms, {0.1, 0.2, 0.3}}, {rows[i].time_ms, 500, {0.2, 0.0, 0.3}},
               {rows[i].time_ms + 500, 250, {0.3, 0.1, -0.3}});
    }
}

TEST(a_joint_nobody_sensed_is_taken_to_be_far)
{
    grobo_posture from = sample_posture(0.1, 0.2, 0.3);
    from.set = LEFT | RIGHT;
    assert_int_equal(start(three, 3, NULL, &from), 0);
    sample_pump_run(&pump, 0);
    EXPECT({0, 3000, {0.1, 0.2, 0.3}}); /* 180 / 60 s */
    assert_int_equal(start(three, 3, NULL, NULL), 0);
    sample_pump_run(&pump, 0);
    EXPECT({0, 1000, {0.1, 0.2, 0.3}}); /* nothing to start from: no approach */
}

TEST(an_approach_gets_its_full_time_however_late)
{
    grobo_posture from = sample_posture(0.1 - PI / 2, 0.2, 0.3);
    assert_int_equal(start(three, 3, NULL, &from), 0);
    sample_pump_stall(&pump, 700 * MS);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 1500, {0.1, 0.2, 0.3}}, {2200, 500, {0.2, 0.0, 0.3}}, {2700, 250, {0.3, 0.1, -0.3}});
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->late_frames, 1);
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->max_late_us, 700 * MS);
}

TEST(partial_keys_add_up_and_empty_ones_send_nothing)
{
    play_all(partial, 5, (grobo_play_options){.default_time_us = 150 * MS});
    EXPECT({0, 150, {0.1, (double)NAN, (double)NAN}}, {150, 200, {0.1, 0.2, (double)NAN}},
           {650, 150, {-0.1, 0.2, (double)NAN}}, {800, 400, {0.3, -0.2, (double)NAN}});
    expect_finished_at(1200);
}

TEST(reverse_takes_keys_away_again)
{
    grobo_posture from = sample_posture(0.3, -0.2, 0.0);
    const grobo_play_options options = {.reverse = true};
    assert_int_equal(start(partial, 5, &options, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 100, {0.3, -0.2, (double)NAN}}, {100, 400, {-0.1, 0.2, (double)NAN}},
           {500, 100, {0.1, 0.2, (double)NAN}}, {900, 200, {0.1, (double)NAN, (double)NAN}});
    expect_finished_at(1100);
}

TEST(rounding_of_times_never_adds_up)
{
    static sample_key keys[SAMPLE_KEYS_MAX];
    for (int i = 0; i < SAMPLE_KEYS_MAX; i++) {
        keys[i] = (sample_key){i == 0 ? 100 * MS : 33333, ALL, {0.001 * i, 0, 0}};
    }
    play_all(keys, SAMPLE_KEYS_MAX, (grobo_play_options){0});
    int64_t sum_us = 0;
    int64_t first_us = pump.frames[1].due_us;
    assert_int_equal(pump.n, SAMPLE_KEYS_MAX);
    for (int i = 1; i < SAMPLE_KEYS_MAX; i++) {
        const grobo_play_frame *frame = &pump.frames[i];
        assert_int_equal(frame->due_us, first_us + 33333 * (i - 1));
        assert_int_equal(frame->posture.time_us % GROBO_PLAY_TIME_UNIT_US, 0);
        sum_us += frame->posture.time_us;
        assert_true(llabs(sum_us - 33333LL * i) <= GROBO_PLAY_TIME_UNIT_US / 2);
    }
}

TEST(repeats_run_again_by_way_of_an_approach)
{
    /* Back to the first key: 0.6 rad at 60 deg/s take 573 ms, but the key has a second. */
    play_all(three, 3, (grobo_play_options){.repeat = 2});
    EXPECT({0, 1000, {0.1, 0.2, 0.3}}, {1000, 500, {0.2, 0.0, 0.3}}, {1500, 250, {0.3, 0.1, -0.3}},
           {1750, 1000, {0.1, 0.2, 0.3}}, {2750, 500, {0.2, 0.0, 0.3}},
           {3250, 250, {0.3, 0.1, -0.3}});
    expect_finished_at(3500);
    /* Negative: in reverse. The way to the last key is an approach of 0.6 rad. */
    play_all(three, 3, (grobo_play_options){.repeat = -2});
    EXPECT({0, 580, {0.3, 0.1, -0.3}}, {580, 250, {0.2, 0.0, 0.3}}, {830, 500, {0.1, 0.2, 0.3}},
           {1330, 580, {0.3, 0.1, -0.3}}, {1910, 250, {0.2, 0.0, 0.3}},
           {2160, 500, {0.1, 0.2, 0.3}});
    expect_finished_at(2660);
    play_all(three, 3, (grobo_play_options){.repeat = INT32_MIN});
    assert_true(pump.n > 8000);
    grobo_play_progress p;
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.passes, INT32_MAX);
}

TEST(the_mirror_swaps_left_and_right)
{
    grobo_posture from = sample_posture(-0.2, -0.1, 0.3);
    const grobo_play_options options = {.mirror = true};
    assert_int_equal(start(three, 3, &options, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 1000, {-0.2, -0.1, 0.3}}, {1000, 500, {0.0, -0.2, 0.3}},
           {1500, 250, {-0.1, -0.3, -0.3}});
}

TEST(speed_scales_times_but_not_the_approach)
{
    play_all(three, 3, (grobo_play_options){.speed_pct = 200});
    EXPECT({0, 500, {0.1, 0.2, 0.3}}, {500, 250, {0.2, 0.0, 0.3}}, {750, 130, {0.3, 0.1, -0.3}});
    expect_finished_at(875);
    grobo_posture from = sample_posture(0.1 - PI / 2, 0.2, 0.3);
    const grobo_play_options slow = {.speed_pct = 50};
    assert_int_equal(start(three, 3, &slow, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 2000, {0.1, 0.2, 0.3}}, {2000, 1000, {0.2, 0.0, 0.3}},
           {3000, 500, {0.3, 0.1, -0.3}});
    const grobo_play_options fast = {.speed_pct = 1000};
    assert_int_equal(start(three, 3, &fast, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 1500, {0.1, 0.2, 0.3}}, {1500, 50, {0.2, 0.0, 0.3}}, {1550, 30, {0.3, 0.1, -0.3}});
}

TEST(speed_changes_in_the_middle_of_a_move)
{
    grobo_posture from = sample_posture(0.1, 0.2, 0.3);
    assert_int_equal(start(three, 3, NULL, &from), 0);
    sample_pump_run(&pump, 1200 * MS); /* 200 of 500 ms on the way to key 1 */
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 50, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 1000, {0.1, 0.2, 0.3}}, {1000, 500, {0.2, 0.0, 0.3}}, {1200, 600, {0.2, 0.0, 0.3}},
           {1800, 500, {0.3, 0.1, -0.3}});
    expect_finished_at(2300);
}

TEST(playing_from_the_middle_begins_between_keys)
{
    /* 300 ms past key 0: 3/5 of the way to key 1. */
    grobo_posture from = sample_posture(0.16, 0.08 + PI / 3, 0.3);
    const grobo_play_options options = {.from_us = 300 * MS};
    assert_int_equal(start(three, 3, &options, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 1000, {0.16, 0.08, 0.3}}, {1000, 200, {0.2, 0.0, 0.3}},
           {1200, 250, {0.3, 0.1, -0.3}});
    expect_finished_at(1450);
    /* There already: no frame is needed to get there. */
    from = sample_posture(0.16, 0.08, 0.3);
    assert_int_equal(start(three, 3, &options, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 200, {0.2, 0.0, 0.3}}, {200, 250, {0.3, 0.1, -0.3}});
    /* On a key. */
    const grobo_play_options on_key = {.from_us = 500 * MS};
    assert_int_equal(start(three, 3, &on_key, &from), 0);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 80, {0.2, 0.0, 0.3}}, {80, 250, {0.3, 0.1, -0.3}});
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->skipped_frames, 0);
}

TEST(a_stall_skips_keys_and_keeps_their_joints)
{
    grobo_posture from = sample_posture(0.1, 0.0, 0.0);
    assert_int_equal(start(partial, 5, NULL, &from), 0);
    sample_pump_run(&pump, 50 * MS);
    pump.now_us = 50 * MS;
    /* Due at 100 (RIGHT), 600 (LEFT back), 700 (both): at 650 the second is under way. */
    sample_pump_stall(&pump, 600 * MS);
    assert_int_equal(pump.n, 2);
    assert_int_equal(pump.frames[1].skipped, 1);
    assert_int_equal(pump.frames[1].due_us, 600 * MS);
    sample_pump_run(&pump, 9000 * MS);
    EXPECT({0, 100, {0.1, (double)NAN, (double)NAN}}, {600, 50, {-0.1, 0.2, (double)NAN}},
           {700, 400, {0.3, -0.2, (double)NAN}});
    const grobo_play_stats *stats = grobo_sequencer_stats(&pump.seq);
    assert_int_equal(stats->frames, 3);
    assert_int_equal(stats->skipped_frames, 1);
    assert_int_equal(stats->late_frames, 2);
    assert_int_equal(stats->max_late_us, 50 * MS);
    expect_finished_at(1100);
}

TEST(a_stall_past_the_end_still_sends_the_last_key)
{
    grobo_posture from = sample_posture(0.1, 0.2, 0.3);
    assert_int_equal(start(three, 3, NULL, &from), 0);
    sample_pump_run(&pump, 500 * MS);
    sample_pump_stall(&pump, 60000 * MS);
    sample_pump_run(&pump, 90000 * MS);
    EXPECT({0, 1000, {0.1, 0.2, 0.3}}, {1500, 10, {0.3, 0.1, -0.3}});
    expect_finished_at(60510);
}

/* Plays the clip once more, to the end. Returns when it began, ms. */
static int64_t again(const grobo_play_options *options, const grobo_posture *from)
{
    int64_t at_us = pump.now_us;
    pump.n = 0;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, options, from, at_us), 0);
    sample_pump_run(&pump, at_us + 9000 * MS);
    return at_us / MS;
}

TEST(increments_go_onto_where_the_clip_starts)
{
    static const sample_key steps[] = {{100 * MS, LEFT, {0.1, 0, 0}},
                                       {100 * MS, LEFT | RIGHT, {0.2, -0.1, 0}},
                                       {100 * MS, RIGHT, {0, -0.1, 0}}};
    grobo_posture from = sample_posture(1.0, 2.0, 3.0);
    grobo_play_options options = {.repeat = 2};
    sample_pump_init(&pump, NULL);
    sample_clip_init(&clip, steps, 3);
    clip.clip.relative = true;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, NULL, 0),
                     GROBO_ERR_EMPTY);
    from.set = LEFT;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, 0),
                     GROBO_ERR_EMPTY);
    from.set = ALL;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, 0), 0);
    sample_pump_run(&pump, 9000 * MS);
    /* Again from the same start, by an approach: 0.2 rad at 60 deg/s = 191 ms. */
    EXPECT({0, 100, {1.1, (double)NAN, (double)NAN}}, {100, 100, {1.3, 1.9, (double)NAN}},
           {200, 100, {1.3, 1.8, (double)NAN}}, {300, 200, {1.1, (double)NAN, (double)NAN}},
           {500, 100, {1.3, 1.9, (double)NAN}}, {600, 100, {1.3, 1.8, (double)NAN}});
    options = (grobo_play_options){.reverse = true};
    int64_t at = again(&options, &from);
    EXPECT({at, 290, {1.3, 1.8, (double)NAN}}, {at + 290, 100, {1.3, 1.9, (double)NAN}},
           {at + 390, 100, {1.1, (double)NAN, (double)NAN}});
    options = (grobo_play_options){.from_us = 50 * MS};
    at = again(&options, &from);
    EXPECT({at, 200, {1.2, (double)NAN, (double)NAN}}, {at + 200, 50, {1.3, 1.9, (double)NAN}},
           {at + 250, 100, {1.3, 1.8, (double)NAN}});
}

TEST(progress_counts_keys)
{
    grobo_play_progress p;
    grobo_posture from = sample_posture(0.1, 0.2, 0.3);
    const grobo_play_options options = {.repeat = 3};
    assert_int_equal(start(three, 3, &options, &from), 0);
    grobo_sequencer_progress(&pump.seq, 0, &p);
    assert_int_equal(p.step, 0);
    sample_pump_run(&pump, 1200 * MS);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.state, GROBO_SEQUENCER_PLAYING);
    assert_int_equal(p.item, 1);
    assert_int_equal(p.pass, 1);
    assert_int_equal(p.passes, 3);
    assert_int_equal(p.t_us, 200 * MS);
    assert_int_equal(p.total_us, 750 * MS);
    assert_int_equal(p.step, 2);
    assert_int_equal(p.steps, 3);
    sample_pump_run(&pump, 1800 * MS);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.pass, 2);
    assert_int_equal(p.step, 1);
    sample_pump_run(&pump, 9000 * MS);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.state, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(p.pass, 3);
    assert_int_equal(p.t_us, 750 * MS);
    assert_int_equal(p.step, 3);
}
