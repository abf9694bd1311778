/* SPDX-License-Identifier: MIT */
/* Commands and refusals of the sequencer, in virtual time. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/test.h"
#include "tests/support/there_and_back.h"

static const grobo_play_frame *last_frame(void)
{
    assert_true(pump.n > 0);
    return &pump.frames[pump.n - 1];
}

static void expect_last(int64_t due_ms, int64_t time_ms, double left_rad)
{
    assert_int_equal(last_frame()->due_us, due_ms * MS);
    assert_int_equal(last_frame()->posture.time_us, time_ms * MS);
    assert_true(fabs(last_frame()->posture.angle_rad[0] - left_rad) < 1e-9);
}

/* ---- holding ---- */

TEST(a_pause_by_keys_rests_a_little_ahead_and_goes_on)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 500 * MS); /* 400 of 1000 ms on the way */
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5000 * MS);
    assert_int_equal(pump.n, 3);
    expect_last(500, 200, 0.5); /* 100 ms further */
    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5001 * MS);
    expect_last(5000, 500, 1.0); /* the 500 ms that are left */
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.n, 5);
    expect_last(5500, 2000, 0.0);
    assert_int_equal(pump.state_us, 7500 * MS);
}

TEST(a_hold_never_passes_the_key)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 1050 * MS);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 2000 * MS);
    expect_last(1050, 200, 1.0);
    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 2001 * MS);
    expect_last(2000, 2000, 0.0);
}

TEST(a_pause_after_a_late_frame_counts_from_when_it_left)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 90 * MS);
    sample_pump_stall(&pump, 510 * MS); /* due at 100, taken at 600: 500 ms are left */
    expect_last(100, 500, 1.0);
    sample_pump_run(&pump, 850 * MS);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 2000 * MS);
    expect_last(850, 200, 0.7); /* 0.5 of the way are made, and 100 ms further */
}

TEST(a_pause_in_an_approach_approaches_again)
{
    there_and_back_start(&by_key, 1.2); /* 1.146 s at 60 deg/s: 1150 ms */
    sample_pump_run(&pump, 475 * MS);
    expect_last(0, 1150, 0.0);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5000 * MS);
    expect_last(475, 200, 0.6);
    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5001 * MS);
    expect_last(5000, 580, 0.0);
    assert_int_equal(pump.state, GROBO_SEQUENCER_APPROACHING);
}

TEST(a_pause_before_anything_was_sent_moves_nothing)
{
    there_and_back_start(&by_key, 1.2);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, 0), 0);
    sample_pump_run(&pump, 5000 * MS);
    assert_int_equal(pump.n, 1);
    expect_last(0, 200, 1.2);
}

TEST(commands_that_meet_keep_posture_and_position_together)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 500 * MS);
    /* The frame for the new speed is not out when the pause comes: it rests where it is. */
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 50, pump.now_us), 0);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 1000 * MS);
    expect_last(500, 200, 0.4);
    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 1001 * MS);
    expect_last(1000, 1200, 1.0);
}

TEST(speed_after_a_stall_begins_at_the_key_that_is_reached)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 500 * MS);
    pump.now_us = 1500 * MS; /* key 1 was reached at 1100 */
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 50, pump.now_us), 0);
    sample_pump_run(&pump, 1501 * MS);
    expect_last(1500, 4000, 0.0);
    assert_int_equal(last_frame()->skipped, 0);
}

/* Stops a play at 500 ms; returns when it was idle, after the command. */
static int64_t stop_at_500(const grobo_play_options *options, bool at_once)
{
    there_and_back_start(options, 0.0);
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), 1);
    sample_pump_run(&pump, 500 * MS);
    assert_int_equal(grobo_sequencer_stop(&pump.seq, at_once, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.state, GROBO_SEQUENCER_IDLE);
    assert_int_equal(last_frame()->phase, GROBO_SEQUENCER_STOPPING);
    assert_int_equal(last_frame()->due_us, 500 * MS);
    return pump.state_us - 500 * MS;
}

TEST(stopping_keeps_its_bound_and_empties_the_queue)
{
    assert_int_equal(stop_at_500(&by_key, false), 200 * MS);
    expect_last(500, 200, 0.5);
    assert_int_equal(stop_at_500(&by_key, true), 10 * MS);
    expect_last(500, 10, 0.4);
    assert_int_equal(stop_at_500(&at_rate, false), 200 * MS);
    expect_last(500, 200, 0.6);
    assert_int_equal(stop_at_500(&at_rate, true), 10 * MS);
    expect_last(500, 10, 0.5);
    const grobo_play_options gentle = {.mode = GROBO_PLAY_RATE, .stop_us = 600 * MS};
    assert_int_equal(stop_at_500(&gentle, false), 600 * MS);
    expect_last(500, 600, 0.8);
}

TEST(a_smooth_stop_can_be_cut_short)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 500 * MS);
    assert_int_equal(grobo_sequencer_stop(&pump.seq, false, pump.now_us), 0);
    sample_pump_run(&pump, 600 * MS);
    assert_int_equal(grobo_sequencer_stop(&pump.seq, false, pump.now_us), 0); /* nothing new */
    assert_int_equal(grobo_sequencer_stop(&pump.seq, true, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.n, 4);
    expect_last(600, 10, 0.45);
    assert_int_equal(pump.state_us, 610 * MS);
}

TEST(stopping_while_paused_stays_there)
{
    there_and_back_start(&at_rate, 0.0);
    sample_pump_run(&pump, 500 * MS);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5000 * MS);
    assert_int_equal(grobo_sequencer_stop(&pump.seq, false, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    expect_last(5000, 200, 0.6);
    assert_int_equal(pump.state_us, 5200 * MS);
}

/* A stalled caller stops where the robot can be, not where the motion would be by now. */
TEST(stopping_after_a_stall_does_not_leap)
{
    there_and_back_start(&at_rate, 0.0);
    sample_pump_run(&pump, 200 * MS);
    pump.now_us = 900 * MS;
    assert_int_equal(grobo_sequencer_stop(&pump.seq, true, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    expect_last(900, 10, 0.22);
}

/* ---- seeking ---- */

TEST(seeking_goes_there_softly)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 200 * MS); /* at 0.1 rad */
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 2000 * MS, pump.now_us), 0);
    sample_pump_run(&pump, 201 * MS);
    expect_last(200, 390, 0.5); /* 0.4 rad at 60 deg/s: 382 ms */
    assert_int_equal(pump.state, GROBO_SEQUENCER_APPROACHING);
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.n, 4);
    expect_last(590, 1000, 0.0);
    assert_int_equal(pump.state_us, 1590 * MS);

    there_and_back_start(&at_rate, 0.0);
    sample_pump_run(&pump, 100 * MS);
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 3000 * MS, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    assert_true(last_frame()->posture.angle_rad[0] == 0.0);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(pump.n, 6 + 1 + 1); /* played, approach, the end */
}

TEST(seeking_while_paused_waits_for_resume)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 500 * MS);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 1000 * MS);
    size_t n = pump.n;
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 2000 * MS, pump.now_us), 0);
    sample_pump_run(&pump, 2000 * MS);
    assert_int_equal(pump.n, n);
    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 9000 * MS);
    expect_last(2000, 1000, 0.0); /* it rested at 0.5 rad already */
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 0, pump.now_us), GROBO_ERR_STATE);
    there_and_back_start(&by_key, 0.0);
    assert_int_equal(grobo_sequencer_seek(&pump.seq, -1, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 3000 * MS + 1, 0), GROBO_ERR_ARG);
}

/* ---- queue ---- */

TEST(queued_clips_follow_by_way_of_an_approach)
{
    static const sample_key elsewhere[] = {{50 * MS, ALL, {0.5, 0, 0}},
                                           {500 * MS, ALL, {0.7, 0, 0}}};
    grobo_play_progress p;
    there_and_back_start(&by_key, 0.0);
    sample_clip_init(&other, elsewhere, 2);
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, &at_rate), 1);
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &clip.clip, NULL), 2);
    sample_pump_run(&pump, 3100 * MS);
    expect_last(3100, 480, 0.5); /* 0.5 rad at 60 deg/s: 477.5 ms */
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.item, 2);
    assert_int_equal(p.queued, 1);
    sample_pump_run(&pump, 3580 * MS);
    expect_last(3580, 20, 0.5);
    sample_pump_run(&pump, 4140 * MS);
    expect_last(4140, 20, 0.7); /* 550 ms long */
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(pump.state_us, (4160 + 670 + 3000) * MS);
}

TEST(the_queue_has_a_cap)
{
    there_and_back_start(&by_key, 0.0);
    for (int i = 1; i <= GROBO_QUEUE_MAX; i++) {
        assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), i);
    }
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), GROBO_ERR_FULL);
    other.clip.n_joints = 2;
    sample_pump_run(&pump, 4000 * MS); /* the first of them has left the queue */
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), GROBO_ERR_ARG);
    other.clip.n_joints = SAMPLE_JOINTS;
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), GROBO_QUEUE_MAX);
    sample_pump_run(&pump, 600000 * MS);
    assert_int_equal(pump.n, 3 * (GROBO_QUEUE_MAX + 2));
}

/* ---- a start at a time ---- */

/* From half a way off, about half a second of approach. */
static void start_at(const grobo_play_options *how, int64_t start_us)
{
    grobo_play_options options = *how;
    options.start_us = start_us;
    there_and_back_start(&options, 0.5);
}

TEST(who_has_approached_waits_for_the_start)
{
    start_at(&by_key, 3000 * MS);
    sample_pump_run(&pump, 2999 * MS);
    assert_int_equal(pump.n, 1); /* the approach at its own speed, at once */
    assert_true(last_frame()->posture.time_us < 600 * MS);
    assert_int_equal(grobo_sequencer_get_state(&pump.seq), GROBO_SEQUENCER_APPROACHING);
    sample_pump_run(&pump, 3000 * MS);
    assert_int_equal(pump.n, 2);
    expect_last(3000, 1000, 1.0);
    start_at(&at_rate, 3000 * MS);
    sample_pump_run(&pump, 3100 * MS);
    assert_int_equal(pump.frames[1].due_us, 3000 * MS);
    assert_int_equal(pump.n, 7);
}

TEST(a_start_that_is_over_is_no_start)
{
    there_and_back_start(&by_key, 0.5);
    sample_pump_run(&pump, 2000 * MS);
    int64_t due_us = pump.frames[1].due_us;
    start_at(&by_key, due_us - 1);
    sample_pump_run(&pump, 2000 * MS);
    assert_int_equal(pump.frames[1].due_us, due_us);
}

TEST(a_pause_before_the_start_stands_where_it_is)
{
    start_at(&by_key, 3000 * MS);
    sample_pump_run(&pump, 2000 * MS);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5000 * MS);
    expect_last(2000, 200, 0.0);
    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 5200 * MS);
    expect_last(5100, 1000, 1.0); /* behind the first key's own time */
}

/* ---- refusals and failures ---- */

TEST(options_out_of_range_are_refused)
{
    static const grobo_play_options bad[] = {{.mode = (grobo_play_mode)2},
                                             {.speed_pct = 1001},
                                             {.rate_hz = 1001},
                                             {.from_us = -1},
                                             {.start_us = -1},
                                             {.start_us = GROBO_NEVER_US},
                                             {.from_us = 3000 * MS + 1},
                                             {.default_time_us = -1},
                                             {.stop_us = -1},
                                             {.late_us = -1},
                                             {.stop_us = INT64_MAX},
                                             {.default_time_us = INT64_MAX}};
    there_and_back_start(&by_key, 0.0);
    grobo_sequencer_reset(&pump.seq);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(there_and_back_again(bad[i]), GROBO_ERR_ARG);
    }
    clip.clip.sample = NULL;
    assert_int_equal(there_and_back_again(at_rate), GROBO_ERR_UNSUPPORTED);
    pump.seq.model = NULL;
    assert_int_equal(there_and_back_again((grobo_play_options){.mirror = true}),
                     GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_sequencer_get_state(&pump.seq), GROBO_SEQUENCER_IDLE);
    assert_int_equal(there_and_back_again((grobo_play_options){.from_us = 3000 * MS}), 0);
}

static int play_keys(const sample_key *list, size_t n)
{
    sample_clip_init(&clip, list, n);
    return there_and_back_again((grobo_play_options){0});
}

TEST(bad_clips_never_start)
{
    static const sample_key no_number[] = {{0, ALL, {0, 0, 0}}, {0, ALL, {0, (double)NAN, 0}}};
    static const sample_key backwards[] = {{0, ALL, {0, 0, 0}}, {-5 * MS, ALL, {0, 0, 0}}};
    static const sample_key too_early[] = {{-5 * MS, ALL, {0, 0, 0}}};
    static const sample_key hidden[] = {{0, 1, {0, (double)NAN, 0}}};
    there_and_back_start(&by_key, 0.0);
    grobo_sequencer_reset(&pump.seq);
    assert_int_equal(play_keys(there_and_back, 0), GROBO_ERR_EMPTY);
    assert_int_equal(play_keys(no_number, 2), GROBO_ERR_NAN);
    assert_int_equal(play_keys(backwards, 2), GROBO_ERR_ARG);
    assert_int_equal(play_keys(too_early, 1), GROBO_ERR_ARG);
    sample_clip_init(&clip, there_and_back, 3);
    clip.fail_at = 2;
    assert_int_equal(there_and_back_again(by_key), GROBO_ERR_UNREACHABLE);
    clip.sample_error = GROBO_ERR_STALE;
    assert_int_equal(there_and_back_again(at_rate), GROBO_ERR_STALE);
    clip.clip.key = NULL;
    assert_int_equal(there_and_back_again(by_key), GROBO_ERR_ARG);
    sample_clip_init(&clip, there_and_back, 3);
    clip.clip.length_us = -1;
    assert_int_equal(there_and_back_again(by_key), GROBO_ERR_ARG);
    sample_clip_init(&clip, there_and_back, 3);
    clip.clip.n_joints = 0;
    assert_int_equal(there_and_back_again(by_key), GROBO_ERR_EMPTY);
    clip.clip.n_joints = 4;
    assert_int_equal(there_and_back_again(by_key),
                     GROBO_ERR_ARG); /* neither the model's nor the start's */
    assert_int_equal(grobo_sequencer_get_state(&pump.seq), GROBO_SEQUENCER_IDLE);
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->frames, 0);
    assert_int_equal(play_keys(hidden, 1), 0); /* what is not set means nothing */
}

TEST(a_start_that_is_no_posture_of_the_robot_is_refused)
{
    grobo_posture from = sample_posture(0, (double)NAN, 0);
    sample_pump_init(&pump, NULL);
    sample_clip_init(&clip, there_and_back, 3);
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, &from, 0), GROBO_ERR_NAN);
    from.set = 5; /* the one without a number is not set: not known */
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, &from, 0), 0);
    sample_pump_run(&pump, 0);
    expect_last(0, 3000, 0.0);
    grobo_sequencer_reset(&pump.seq);
    from.n_joints = 2;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, &from, 0), GROBO_ERR_ARG);
}

TEST(a_clip_that_fails_in_mid_motion_says_so_once)
{
    grobo_play_progress p;
    there_and_back_start(&by_key, 0.0);
    clip.fail_at = 2;
    sample_pump_run(&pump, 1000 * MS);
    pump.now_us = 1100 * MS;
    assert_int_equal(sample_pump_take(&pump), GROBO_ERR_UNREACHABLE);
    assert_int_equal(sample_pump_take(&pump), 0);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FAILED);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.error, GROBO_ERR_UNREACHABLE);
    assert_int_equal(there_and_back_again(by_key), GROBO_ERR_STATE);
    grobo_sequencer_reset(&pump.seq);
    clip.fail_at = SIZE_MAX;
    assert_int_equal(there_and_back_again(by_key), 0);

    there_and_back_start(&at_rate, 0.0);
    sample_pump_run(&pump, 100 * MS);
    clip.sample_error = GROBO_ERR_UNREACHABLE;
    pump.now_us = 120 * MS;
    assert_int_equal(sample_pump_take(&pump), GROBO_ERR_UNREACHABLE);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FAILED);

    there_and_back_start(&at_rate, 0.0);
    sample_pump_run(&pump, 100 * MS);
    clip.sample_error = GROBO_ERR_UNREACHABLE;
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), GROBO_ERR_UNREACHABLE);
    assert_int_equal(sample_pump_take(&pump), 0);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FAILED);
}

TEST(a_queued_clip_without_ground_fails_when_its_turn_comes)
{
    static const sample_key left[] = {{100 * MS, 1, {0.1, 0, 0}}};
    sample_pump_init(&pump, NULL);
    sample_clip_init(&clip, left, 1);
    sample_clip_init(&other, there_and_back, 3);
    other.clip.relative = true; /* increments for joints that nobody knows anything of */
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, NULL, 0), 0);
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), 1);
    sample_pump_run(&pump, 0);
    pump.now_us = 100 * MS;
    assert_int_equal(sample_pump_take(&pump), GROBO_ERR_EMPTY);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FAILED);
}

TEST(a_posture_out_of_all_reason_takes_the_longest_time)
{
    there_and_back_start(&by_key, 1e9);
    sample_pump_run(&pump, 0);
    expect_last(0, 163830, 0.0);
}
