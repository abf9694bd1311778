/* SPDX-License-Identifier: MIT */
/* The last value that is taken and the first that is not; what is over leaves nothing behind. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/test.h"
#include "tests/support/there_and_back.h"

static grobo_play_progress progress(void)
{
    grobo_play_progress p;
    memset(&p, 0xA5, sizeof p);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    return p;
}

static int play(grobo_play_options options)
{
    sample_pump_init(&pump, &sample_model);
    return there_and_back_again(options);
}

/* ---- options and clips ----------------------------------------------------------------------- */

TEST(options_at_their_bounds_are_taken)
{
    static const grobo_play_options last[] = {
        {.speed_pct = GROBO_PLAY_SPEED_MAX_PCT},     {.speed_pct = 1},
        {.rate_hz = GROBO_PLAY_RATE_MAX_HZ},         {.from_us = 3000 * MS},
        {.default_time_us = GROBO_PLAY_TIME_MAX_US}, {.default_time_us = 1},
        {.stop_us = GROBO_PLAY_TIME_MAX_US},         {.stop_us = 1},
        {.late_us = GROBO_PLAY_TIME_MAX_US},         {.late_us = 1}};
    static const grobo_play_options behind[] = {{.default_time_us = GROBO_PLAY_TIME_MAX_US + 1},
                                                {.stop_us = GROBO_PLAY_TIME_MAX_US + 1},
                                                {.late_us = GROBO_PLAY_TIME_MAX_US + 1}};
    there_and_back_start(&by_key, 0.0);
    for (size_t i = 0; i < sizeof last / sizeof last[0]; i++) {
        assert_int_equal(play(last[i]), 0);
    }
    for (size_t i = 0; i < sizeof behind / sizeof behind[0]; i++) {
        assert_int_equal(play(behind[i]), GROBO_ERR_ARG);
    }
    assert_int_equal(play((grobo_play_options){.repeat = -INT32_MAX}), 0);
    assert_int_equal(progress().passes, INT32_MAX);
    assert_int_equal(play((grobo_play_options){.repeat = -INT32_MAX + 1}), 0);
    assert_int_equal(progress().passes, INT32_MAX - 1);
}

/* A clip for as many joints as it says, which goes nowhere. */
static int no_way(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const grobo_clip *many = ctx;
    (void)grobo_posture_init(posture, many->n_joints);
    posture->set = 1;
    posture->time_us = 10 * MS;
    *at_us = (int64_t)(i + 1) * 10 * MS;
    return 0;
}

TEST(a_clip_may_have_as_many_joints_as_there_can_be)
{
    grobo_clip many = {.key = no_way, .n_keys = 2};
    for (int past = 0; past < 2; past++) {
        many.ctx = &many;
        many.n_joints = (uint8_t)(GROBO_JOINTS_MAX + past);
        sample_pump_init(&pump, NULL);
        assert_int_equal(grobo_sequencer_play(&pump.seq, &many, NULL, NULL, 0),
                         past ? GROBO_ERR_ARG : 0);
    }
}

static int64_t last_key_us;
static double last_rad;

/* Two keys; the second is where and what the test says. */
static int late_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *posture = sample_posture(0, 0, i == 0 ? 0 : last_rad);
    posture->time_us = i == 0 ? 10 * MS : 20 * MS;
    *at_us = i == 0 ? 10 * MS : last_key_us;
    return 0;
}

static int late_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    int64_t at_us;
    (void)t_us;
    return late_key(ctx, 1, posture, &at_us);
}

static int play_late(int64_t key_us, double rad)
{
    grobo_clip late = {.key = late_key, .n_keys = 2, .n_joints = SAMPLE_JOINTS};
    last_key_us = key_us;
    last_rad = rad;
    sample_pump_init(&pump, &sample_model);
    return grobo_sequencer_play(&pump.seq, &late, NULL, NULL, 0);
}

TEST(keys_rise_in_time_up_to_the_longest)
{
    assert_int_equal(play_late(10 * MS + 1, 0), 0);
    assert_int_equal(play_late(10 * MS, 0), GROBO_ERR_ARG);
    assert_int_equal(play_late(5 * MS, 0), GROBO_ERR_ARG);
    assert_int_equal(play_late(-1, 0), GROBO_ERR_ARG);
    assert_int_equal(play_late(GROBO_PLAY_LENGTH_MAX_US, 0), 0);
    assert_int_equal(play_late(GROBO_PLAY_LENGTH_MAX_US + 1, 0), GROBO_ERR_CAP);
    assert_int_equal(play_late(GROBO_PLAY_LENGTH_MAX_US * 10, 0), GROBO_ERR_CAP);
    assert_int_equal(play_late(20 * MS, (double)INFINITY), GROBO_ERR_NAN);
    assert_int_equal(play_late(20 * MS, (double)-INFINITY), GROBO_ERR_NAN);
    last_rad = 0;
    grobo_clip clip_at_rate = {.key = late_key,
                               .sample = late_sample,
                               .n_keys = 2,
                               .n_joints = SAMPLE_JOINTS,
                               .length_us = GROBO_PLAY_LENGTH_MAX_US};
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip_at_rate, &at_rate, NULL, 0), 0);
    sample_pump_init(&pump, &sample_model);
    clip_at_rate.length_us++;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip_at_rate, &at_rate, NULL, 0),
                     GROBO_ERR_CAP);
}

TEST(a_relative_clip_at_a_rate_needs_to_know_where_it_starts)
{
    grobo_posture from = sample_posture(0, 0, 0);
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, there_and_back, 3);
    clip.clip.relative = true;
    from.set = LEFT | MIDDLE;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &at_rate, &from, 0),
                     GROBO_ERR_EMPTY);
    from.set = ALL;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &at_rate, &from, 0), 0);
}

/* The ground of a joint is that joint's own. */
TEST(increments_need_the_ground_of_their_own_joint)
{
    static const sample_key right[] = {{100 * MS, RIGHT, {0, 0.1, 0}},
                                       {100 * MS, RIGHT, {0, 0.1, 0}}};
    static const sample_key left[] = {{100 * MS, LEFT, {0.3, 0, 0}}};
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, left, 1);
    sample_clip_init(&other, right, 2);
    other.clip.relative = true;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, NULL, 0), 0);
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), 1);
    sample_pump_run(&pump, 0);
    pump.now_us = 100 * MS;
    assert_int_equal(sample_pump_take(&pump), GROBO_ERR_EMPTY); /* LEFT is known, RIGHT is not */

    grobo_posture from = sample_posture(0, 0.5, 0);
    from.set = RIGHT;
    sample_pump_init(&pump, &sample_model);
    assert_int_equal(grobo_sequencer_play(&pump.seq, &other.clip, NULL, &from, 0), 0);
    sample_pump_run(&pump, 1000 * MS);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
    assert_true(fabs(pump.frames[pump.n - 1].posture.angle_rad[1] - 0.7) < 1e-12);
}

/* Joints that are not set have no way to go, whatever stands in their place. */
TEST(an_approach_looks_at_the_joints_that_are_set)
{
    static const sample_key left[] = {{10 * MS, LEFT, {0.1, 9, 9}}, {10 * MS, LEFT, {0.1, 9, 9}}};
    grobo_posture from = sample_posture(0.0, 0, 0);
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, left, 2);
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, &from, 0), 0);
    sample_pump_run(&pump, 0);
    assert_int_equal(pump.frames[0].posture.time_us, 100 * MS); /* 0.1 rad at 60 deg/s: 95.5 ms */
    /* Nearer than the wire's half unit is there: no frame at a rate, but the first one. */
    static const sample_key still[] = {{0, ALL, {0.1, 0, 0}}, {1000 * MS, ALL, {0.1, 0, 0}}};
    for (int far = 0; far < 2; far++) {
        double apart_rad = (far ? 0.06 : 0.04) * 0.017453292519943295;
        from = sample_posture(0.1 + apart_rad, 0, 0);
        sample_pump_init(&pump, &sample_model);
        sample_clip_init(&clip, still, 2);
        assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &at_rate, &from, 0), 0);
        sample_pump_run(&pump, 0);
        assert_int_equal(pump.frames[0].phase,
                         far ? GROBO_SEQUENCER_APPROACHING : GROBO_SEQUENCER_PLAYING);
    }
}

/* ---- commands -------------------------------------------------------------------------------- */

TEST(commands_take_their_bounds)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 500 * MS);
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 1, pump.now_us), 0);
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 1000, pump.now_us), 0);
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 1001, pump.now_us), GROBO_ERR_ARG);
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 0, pump.now_us), GROBO_ERR_ARG);
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 0, pump.now_us), 0);
    sample_pump_run(&pump, pump.now_us);
    assert_true(fabs(pump.frames[pump.n - 1].posture.angle_rad[0]) < 1e-12);
    assert_int_equal(grobo_sequencer_seek(&pump.seq, 3000 * MS, pump.now_us), 0);
    assert_int_equal(grobo_sequencer_fail(&pump.seq, GROBO_ERR_IO), 0);
}

/* Approaches keep their speed; what comes behind has the new one. */
TEST(speed_may_be_set_before_playing_begins)
{
    for (int paused = 0; paused < 2; paused++) {
        there_and_back_start(&by_key, 1.2); /* an approach of 1150 ms */
        sample_pump_run(&pump, 100 * MS);
        if (paused) {
            assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
            sample_pump_run(&pump, 1000 * MS);
        }
        assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 50, pump.now_us), 0);
        if (paused) {
            assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
        }
        sample_pump_run(&pump, 9000 * MS);
        assert_int_equal(pump.frames[pump.n - 2].posture.time_us, 2000 * MS);
        assert_int_equal(pump.frames[pump.n - 1].posture.time_us, 4000 * MS);
    }
}

TEST(a_second_pass_begins_at_the_beginning)
{
    const grobo_play_options options[] = {
        {.repeat = 2, .from_us = 1000 * MS, .default_time_us = 100 * MS},
        {.mode = GROBO_PLAY_RATE, .rate_hz = 10, .repeat = 2, .from_us = 1000 * MS}};
    for (int i = 0; i < 2; i++) {
        there_and_back_start(&options[i], 1.0);
        sample_pump_run(&pump, 60000 * MS);
        int ups = 0;
        for (size_t k = 1; k < pump.n; k++) { /* up to 1 rad in the second pass alone */
            ups += pump.frames[k].posture.angle_rad[0] > 0.95 &&
                   pump.frames[k - 1].posture.angle_rad[0] < 0.95;
        }
        assert_int_equal(ups, 1);
    }
}

/* The time of a hold is the one that was asked for, to the nearest unit, whenever it comes. */
TEST(a_hold_takes_the_time_it_was_given)
{
    static const int64_t stops_us[] = {123456, 126000, 4000, 10000, 99999};
    static const int64_t times_us[] = {120000, 130000, 10000, 10000, 100000};
    for (size_t i = 0; i < sizeof stops_us / sizeof stops_us[0]; i++) {
        for (int64_t us = 0; us < 40000; us += 3333) {
            const grobo_play_options options = {.mode = i % 2 ? GROBO_PLAY_KEY : GROBO_PLAY_RATE,
                                                .stop_us = stops_us[i]};
            there_and_back_start(&options, 0.0);
            sample_pump_run(&pump, 503 * MS + us);
            assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
            sample_pump_run(&pump, 5000 * MS);
            assert_int_equal(pump.frames[pump.n - 1].posture.time_us, times_us[i]);
        }
    }
}

/* A move of whole units has that time, though it begins late. */
TEST(a_late_first_move_keeps_its_time)
{
    static const sample_key odd[] = {{1000003, ALL, {0.1, 0, 0}}, {500001, ALL, {0.2, 0, 0}}};
    for (int64_t us = 5001; us < 20000; us += 1111) {
        grobo_posture from = sample_posture(0.1, 0, 0);
        sample_pump_init(&pump, &sample_model);
        sample_clip_init(&clip, odd, 2);
        assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, NULL, &from, 0), 0);
        sample_pump_stall(&pump, us);
        sample_pump_run(&pump, us + 1000003);
        assert_int_equal(pump.frames[0].posture.time_us, 1000 * MS);
        assert_int_equal(pump.frames[1].due_us, us + 1000003);
        assert_int_equal(pump.frames[1].posture.time_us, 500 * MS);
    }
}

TEST(late_is_what_comes_behind_the_bound)
{
    for (int64_t us = 4999; us <= 5001; us++) {
        there_and_back_start(&by_key, 0.0);
        sample_pump_run(&pump, 50 * MS);
        sample_pump_stall(&pump, 50 * MS + us);
        assert_int_equal(grobo_sequencer_stats(&pump.seq)->late_frames, us > 5000);
        assert_int_equal(grobo_sequencer_stats(&pump.seq)->max_late_us, us);
    }
}

/* ---- what is over is over -------------------------------------------------------------------- */

TEST(before_anything_was_played_there_is_no_progress)
{
    static const grobo_play_progress none;
    memset(&pump, 0xA5, sizeof pump);
    sample_pump_init(&pump, &sample_model);
    memset(&pump.seq, 0xA5, sizeof pump.seq);
    grobo_sequencer_init(&pump.seq, &sample_model);
    grobo_play_progress p = progress();
    assert_memory_equal(&p, &none, sizeof p);
    assert_int_equal(grobo_sequencer_deadline(&pump.seq), GROBO_NEVER_US);
    assert_int_equal(grobo_sequencer_stats(&pump.seq)->frames, 0);
}

TEST(what_ends_a_play_empties_the_queue)
{
    for (int way = 0; way < 3; way++) {
        there_and_back_start(&by_key, 0.0);
        sample_pump_run(&pump, 500 * MS);
        assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), 1);
        assert_int_equal(progress().queued, 1);
        if (way == 0) {
            assert_int_equal(grobo_sequencer_stop(&pump.seq, false, pump.now_us), 0);
        } else if (way == 1) {
            assert_int_equal(grobo_sequencer_fail(&pump.seq, GROBO_ERR_IO), 0);
            assert_int_equal(progress().error, GROBO_ERR_IO);
        } else {
            grobo_sequencer_reset(&pump.seq);
        }
        assert_int_equal(progress().queued, 0);
    }
}

TEST(a_reset_forgets_the_failure_and_what_waited)
{
    there_and_back_start(&at_rate, 0.0);
    sample_pump_run(&pump, 500 * MS);
    pump.now_us += 100 * MS;
    clip.sample_error = GROBO_ERR_STALE; /* four frames are skipped, and the fifth fails */
    assert_int_equal(sample_pump_take(&pump), GROBO_ERR_STALE);
    assert_int_equal(progress().error, GROBO_ERR_STALE);
    grobo_sequencer_reset(&pump.seq);
    sample_pump_look(&pump);
    assert_int_equal(progress().error, 0);
    clip.sample_error = 0;
    size_t n = pump.n;
    assert_int_equal(there_and_back_again(at_rate), 0);
    sample_pump_look(&pump);
    sample_pump_run(&pump, pump.now_us);
    assert_int_equal(pump.frames[n].skipped, 0);
    /* A frame that waits is not handed out behind a reset. */
    there_and_back_start(&by_key, 1.0);
    grobo_sequencer_reset(&pump.seq);
    assert_int_equal(grobo_sequencer_deadline(&pump.seq), GROBO_NEVER_US);
    sample_pump_look(&pump);
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.n, 0);
}

/* Where the clip before ended says nothing when nobody knows where the robot is. */
TEST(a_play_from_nowhere_does_not_begin_where_the_last_ended)
{
    there_and_back_start(&by_key, 0.0);
    sample_pump_run(&pump, 9000 * MS);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
    size_t n = pump.n;
    const grobo_play_options slow = {.default_time_us = 1000 * MS};
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &slow, NULL, pump.now_us), 0);
    sample_pump_look(&pump);
    sample_pump_run(&pump, pump.now_us + 50 * MS);
    assert_int_equal(pump.n, n + 1);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, pump.now_us + 1000 * MS);
    assert_int_equal(pump.n, n + 1); /* half of a way from nowhere is nowhere */
}

/* A clip that breaks after it was looked through fails where the first key is read again. */
TEST(a_clip_that_breaks_in_the_approach_fails_at_its_end)
{
    there_and_back_start(&by_key, 1.0);
    sample_pump_run(&pump, 900 * MS);
    clip.fail_at = 0;
    pump.now_us = 960 * MS;
    assert_int_equal(sample_pump_take(&pump), GROBO_ERR_UNREACHABLE);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FAILED);
    assert_int_equal(pump.n, 1);
}

/* The ring of clips goes round, each comes once and in turn. */
TEST(queued_clips_come_in_turn)
{
    static sample_key ends[3 * GROBO_QUEUE_MAX][1];
    static sample_clip clips[3 * GROBO_QUEUE_MAX];
    there_and_back_start(&by_key, 0.0);
    int next = 0;
    for (int i = 0; i < 3 * GROBO_QUEUE_MAX; i++) {
        ends[i][0] = (sample_key){10 * MS, ALL, {0.01 * (i + 1), 0, 0}};
        sample_clip_init(&clips[i], ends[i], 1);
    }
    while (pump.state != GROBO_SEQUENCER_FINISHED) {
        while (next < 3 * GROBO_QUEUE_MAX &&
               grobo_sequencer_enqueue(&pump.seq, &clips[next].clip, NULL) > 0) {
            next++;
        }
        sample_pump_run(&pump, pump.now_us + MS);
    }
    assert_int_equal(pump.n, 3 + 3 * GROBO_QUEUE_MAX);
    for (int i = 0; i < 3 * GROBO_QUEUE_MAX; i++) {
        assert_true(fabs(pump.frames[3 + i].posture.angle_rad[0] - 0.01 * (i + 1)) < 1e-12);
    }
    assert_int_equal(progress().item, 1 + 3 * GROBO_QUEUE_MAX);
}

/* A clip that waits is checked and mirrored by the robot's table, as the first is. */
TEST(a_queued_clip_knows_the_robot)
{
    static const sample_key left[] = {{100 * MS, LEFT, {0.3, 0, 0}}};
    const grobo_play_options options = {.mirror = true};
    there_and_back_start(&by_key, 0.0);
    sample_clip_init(&other, left, 1);
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, &options), 1);
    sample_pump_run(&pump, 9000 * MS);
    const grobo_posture *last = &pump.frames[pump.n - 1].posture;
    assert_true(fabs(last->angle_rad[1] + 0.3) < 1e-12);
    other.fail_at = 0;
    there_and_back_start(&by_key, 0.0);
    other.fail_at = 0;
    assert_int_equal(grobo_sequencer_enqueue(&pump.seq, &other.clip, NULL), GROBO_ERR_UNREACHABLE);
    assert_int_equal(progress().queued, 0);
}

/* Frames handed out, at each moment, by keys and at a rate. */
TEST(steps_count_what_was_handed_out)
{
    const grobo_play_options all[] = {by_key,
                                      {.default_time_us = 100 * MS, .reverse = true},
                                      {.mode = GROBO_PLAY_RATE, .rate_hz = 10}};
    for (int i = 0; i < 3; i++) {
        there_and_back_start(&all[i], i == 1 ? 0.0 : 0.0);
        for (int64_t ms = 0; ms < 3400; ms += 7) {
            assert_int_equal(progress().step, pump.n);
            sample_pump_run(&pump, ms * MS);
            assert_int_equal(progress().step, pump.n);
        }
        assert_int_equal(progress().step, progress().steps);
        assert_int_equal(pump.n, progress().steps);
    }
}
