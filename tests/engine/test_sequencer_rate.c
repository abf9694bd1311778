/* SPDX-License-Identifier: MIT */
/* Playing at a rate, in virtual time. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "tests/support/sample_clip.h"
#include "tests/support/test.h"

#define PI 3.14159265358979323846

static sample_pump pump;
static sample_clip clip;

/* LEFT tells the position: 0.01 rad a second for a minute. */
static const sample_key minute[] = {{0, ALL, {0.0, 0, 0}}, {60000 * MS, ALL, {0.6, 0, 0}}};
/* RIGHT tells it backwards: 2.05 s, which ends between the frames of most rates. */
static const sample_key brief[] = {{0, ALL, {0.0, 0.205, 0}}, {2050 * MS, ALL, {0.205, 0.0, 1}}};

static void start(const sample_key *keys, grobo_play_options options, double left_rad)
{
    grobo_posture from = sample_posture(left_rad, keys[0].angle_rad[1], keys[0].angle_rad[2]);
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, keys, 2);
    options.mode = GROBO_PLAY_RATE;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, 0), 0);
}

static const grobo_play_frame *frame_at(size_t i)
{
    assert_true(i < pump.n);
    return &pump.frames[i];
}

/* The position that a frame of `minute` stands for, us. */
static double position_of(size_t i)
{
    return frame_at(i)->posture.angle_rad[0] * 1e8;
}

static const grobo_play_stats *stats(void)
{
    return grobo_sequencer_stats(&pump.seq);
}

TEST(frames_never_drift)
{
    static const struct {
        uint16_t rate_hz;
        size_t frames;
    } rows[] = {{50, 3001}, {30, 1801}, {7, 421}, {60, 3601}, {1, 61}, {100, 6001}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        double rate_hz = rows[k].rate_hz;
        start(minute, (grobo_play_options){.rate_hz = rows[k].rate_hz}, 0.0);
        sample_pump_run(&pump, 100000 * MS);
        assert_int_equal(pump.n, rows[k].frames);
        for (size_t i = 0; i < pump.n; i++) {
            double due_us = (double)i * 1e6 / rate_hz;
            assert_true(fabs((double)frame_at(i)->due_us - due_us) <= 0.5);
            assert_true(fabs(position_of(i) - due_us) <= 0.51);
            assert_int_equal(frame_at(i)->posture.time_us, (int64_t)(1e6 / rate_hz));
        }
        assert_int_equal(frame_at(pump.n - 1)->due_us, 60000 * MS);
        assert_true(frame_at(pump.n - 1)->posture.angle_rad[0] == 0.6);
        assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
        assert_int_equal(pump.state_us, 60000 * MS + (int64_t)(1e6 / rate_hz));
        assert_int_equal(stats()->late_frames, 0);
    }
}

/* Served up to 3 ms late every time, in a fixed pattern: deadlines stay where they were. */
TEST(lateness_of_one_frame_is_not_that_of_the_next)
{
    start(minute, (grobo_play_options){0}, 0.0);
    (void)sample_pump_take(&pump);
    for (int64_t i = 1; pump.state != GROBO_SEQUENCER_FINISHED; i++) {
        pump.now_us = grobo_sequencer_deadline(&pump.seq) + i % 4 * MS;
        (void)sample_pump_take(&pump);
    }
    assert_int_equal(pump.n, 3001);
    for (size_t i = 0; i < pump.n; i++) {
        assert_int_equal(frame_at(i)->due_us, (int64_t)i * 20 * MS);
        assert_true(fabs(position_of(i) - (double)i * 20e3) < 1e-3);
    }
    assert_int_equal(stats()->max_late_us, 3 * MS);
    assert_int_equal(stats()->late_frames, 0);
}

TEST(a_clip_of_years_is_refused)
{
    static const sample_key years[] = {{0, 7, {0, 0, 0}},
                                       {GROBO_PLAY_LENGTH_MAX_US, 7, {0.1, 0.1, 0.1}},
                                       {INT64_MAX / 4, 7, {0.2, 0.2, 0.2}}};
    static const grobo_play_mode modes[] = {GROBO_PLAY_KEY, GROBO_PLAY_RATE};
    grobo_play_options options = {.speed_pct = 1, .rate_hz = GROBO_PLAY_RATE_MAX_HZ};
    grobo_play_progress progress;
    for (int i = 0; i < 2; i++) {
        options.mode = modes[i];
        sample_pump_init(&pump, &sample_model);
        sample_clip_init(&clip, years, 3);
        assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, NULL, 0),
                         GROBO_ERR_CAP);
        sample_clip_init(&clip, years, 2);
        assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, NULL, 0), 0);
        grobo_sequencer_progress(&pump.seq, 0, &progress);
        assert_true(progress.total_us == GROBO_PLAY_LENGTH_MAX_US);
        assert_true(progress.steps == (i == 0 ? 2 : (uint64_t)progress.total_us / 10 + 1));
        assert_int_equal(grobo_sequencer_seek(&pump.seq, progress.total_us, 0), 0);
    }
}

TEST(a_stall_skips_to_the_present_without_a_burst)
{
    start(minute, (grobo_play_options){0}, 0.0);
    sample_pump_run(&pump, 1000 * MS);
    assert_int_equal(pump.n, 51);
    sample_pump_stall(&pump, 507 * MS); /* frames 51..74 pass by, 75 is the present one */
    assert_int_equal(pump.n, 52);
    assert_int_equal(frame_at(51)->due_us, 1500 * MS);
    assert_int_equal(frame_at(51)->skipped, 24);
    assert_true(fabs(position_of(51) - 1500e3) < 1e-3);
    assert_int_equal(stats()->skipped_frames, 24);
    assert_int_equal(stats()->late_frames, 25); /* and that one is 7 ms late itself */
    assert_int_equal(stats()->max_late_us, 7 * MS);
    assert_int_equal(grobo_sequencer_deadline(&pump.seq), 1520 * MS);
    sample_pump_run(&pump, 100000 * MS);
    assert_int_equal(frame_at(52)->skipped, 0);
    assert_int_equal(pump.n, 3001 - 24);
    assert_true(frame_at(pump.n - 1)->posture.angle_rad[0] == 0.6);
}

TEST(a_stall_past_the_end_still_sends_the_last_posture)
{
    start(brief, (grobo_play_options){.repeat = 2}, 0.0);
    sample_pump_run(&pump, 1000 * MS);
    sample_pump_stall(&pump, 60000 * MS);
    assert_int_equal(pump.n, 52);
    assert_true(frame_at(51)->posture.angle_rad[0] == 0.205);
    assert_int_equal(frame_at(51)->due_us, 2060 * MS);
    assert_int_equal(frame_at(51)->skipped, 52); /* 1020 .. 2040 ms */
    /* The next pass is not hurried for it: it begins when the posture is reached, softly. */
    sample_pump_run(&pump, 61019 * MS);
    assert_int_equal(pump.n, 52);
    sample_pump_run(&pump, 61020 * MS);
    assert_int_equal(pump.n, 53);
    assert_int_equal(frame_at(52)->phase, GROBO_SEQUENCER_APPROACHING);
    assert_int_equal(frame_at(52)->posture.time_us, 960 * MS); /* 1 rad at 60 deg/s: 955 ms */
    sample_pump_run(&pump, 100000 * MS);
    assert_int_equal(pump.state_us, 61020 * MS + 960 * MS + 2060 * MS + 20 * MS);
}

TEST(the_end_between_two_frames_is_sent_with_the_second)
{
    start(brief, (grobo_play_options){0}, 0.0);
    sample_pump_run(&pump, 10000 * MS);
    assert_int_equal(pump.n, 104); /* 0..2040 ms, and 2060 */
    assert_int_equal(frame_at(103)->due_us, 2060 * MS);
    assert_true(frame_at(103)->posture.angle_rad[0] == 0.205);
    assert_true(frame_at(103)->posture.angle_rad[1] == 0.0);
    assert_int_equal(pump.state_us, 2080 * MS);
}

/* A third of a second is no whole microsecond: neither the frame's time nor the end's. */
TEST(the_end_on_a_frame_is_sent_with_that_frame)
{
    static const sample_key second[] = {{0, ALL, {0.0, 0, 0}}, {1000 * MS, ALL, {0.1, 0, 0}}};
    start(second, (grobo_play_options){.rate_hz = 3, .speed_pct = 300}, 0.0);
    sample_pump_run(&pump, 10000 * MS);
    assert_int_equal(pump.n, 2);
    assert_int_equal(frame_at(1)->due_us, 333333);
    assert_true(frame_at(1)->posture.angle_rad[0] == 0.1);
    grobo_play_progress p;
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.steps, 2);
}

TEST(the_first_move_is_soft)
{
    start(minute, (grobo_play_options){0}, PI / 2);
    sample_pump_run(&pump, 1540 * MS);
    assert_int_equal(frame_at(0)->phase, GROBO_SEQUENCER_APPROACHING);
    assert_int_equal(frame_at(0)->posture.time_us, 1500 * MS);
    assert_true(frame_at(0)->posture.angle_rad[0] == 0.0);
    assert_int_equal(frame_at(1)->due_us, 1500 * MS);
    assert_true(position_of(1) == 0.0);
    assert_int_equal(frame_at(2)->due_us, 1520 * MS);
    assert_true(fabs(position_of(2) - 20e3) < 1e-3);
}

TEST(a_pause_keeps_the_phase)
{
    start(minute, (grobo_play_options){.stop_us = 100 * MS}, 0.0);
    sample_pump_run(&pump, 1010 * MS);
    assert_int_equal(grobo_sequencer_pause(&pump.seq, pump.now_us), 0);
    size_t held = pump.n;
    sample_pump_run(&pump, 8000 * MS);
    /* One frame: half of the stop time ahead, in the stop time. */
    assert_int_equal(pump.n, held + 1);
    assert_int_equal(frame_at(held)->due_us, 1010 * MS);
    assert_int_equal(frame_at(held)->phase, GROBO_SEQUENCER_PAUSED);
    assert_int_equal(frame_at(held)->posture.time_us, 100 * MS);
    assert_true(fabs(position_of(held) - 1060e3) < 1e-3);
    assert_int_equal(grobo_sequencer_deadline(&pump.seq), GROBO_NEVER_US);

    assert_int_equal(grobo_sequencer_resume(&pump.seq, pump.now_us), 0);
    sample_pump_run(&pump, 100000 * MS);
    for (size_t i = held + 1; i < held + 100; i++) {
        int64_t since_us = (int64_t)(i - held - 1) * 20 * MS;
        assert_int_equal(frame_at(i)->due_us, 8000 * MS + since_us);
        assert_true(fabs(position_of(i) - (double)(1060 * MS + since_us)) < 1e-3);
    }
    assert_int_equal(pump.state_us, 8000 * MS + (60000 - 1060) * MS + 20 * MS);
    assert_int_equal(stats()->late_frames, 0);
}

TEST(speed_changes_keep_grid_and_position)
{
    start(minute, (grobo_play_options){.speed_pct = 200}, 0.0);
    sample_pump_run(&pump, 1010 * MS); /* position 2020 ms */
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 50, pump.now_us), 0);
    sample_pump_run(&pump, 1200 * MS);
    assert_true(fabs(position_of(50) - 2000e3) < 1e-3);
    for (size_t i = 51; i < 60; i++) {
        assert_int_equal(frame_at(i)->due_us, (int64_t)i * 20 * MS);
        assert_true(fabs(position_of(i) - (2025e3 + (double)(i - 51) * 10e3)) < 1e-3);
    }
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 1000, pump.now_us), 0);
    sample_pump_run(&pump, 100000 * MS);
    assert_true(frame_at(pump.n - 1)->posture.angle_rad[0] == 0.6);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
}

TEST(speed_may_change_behind_the_end)
{
    start(brief, (grobo_play_options){0}, 0.0);
    sample_pump_run(&pump, 2055 * MS); /* the motion is over, its last frame is not out yet */
    assert_int_equal(grobo_sequencer_set_speed(&pump.seq, 300, pump.now_us), 0);
    sample_pump_run(&pump, 10000 * MS);
    assert_int_equal(pump.n, 104);
    assert_int_equal(frame_at(103)->due_us, 2060 * MS);
    assert_true(frame_at(103)->posture.angle_rad[0] == 0.205);
    assert_int_equal(stats()->skipped_frames, 0);
}

TEST(reverse_mirror_and_from_work_together)
{
    /* Backwards LEFT falls from 0.205; mirrored it is RIGHT and negative. From 1 s: 0.105. */
    start(brief, (grobo_play_options){.reverse = true, .mirror = true, .from_us = 1000 * MS}, 0.0);
    sample_pump_run(&pump, 10000 * MS);
    const grobo_posture *first = &frame_at(1)->posture;
    const grobo_posture *last = &frame_at(pump.n - 1)->posture;
    assert_int_equal(frame_at(0)->phase, GROBO_SEQUENCER_APPROACHING);
    assert_true(fabs(first->angle_rad[1] + 0.105) < 1e-9);
    assert_true(fabs(first->angle_rad[0] + 0.1) < 1e-9);
    assert_true(fabs(last->angle_rad[1]) < 1e-12);
    assert_true(fabs(last->angle_rad[0] + 0.205) < 1e-12);
    assert_int_equal(pump.n, 1 + 54); /* 0, 20 .. 1040, and 1060 ms for the end at 1050 */
}

TEST(progress_counts_frames)
{
    grobo_play_progress p;
    start(minute, (grobo_play_options){.rate_hz = 30}, 0.0);
    sample_pump_run(&pump, 10000 * MS);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.t_us, 10000 * MS);
    assert_int_equal(p.total_us, 60000 * MS);
    assert_int_equal(p.step, pump.n);
    assert_int_equal(p.steps, 1801);
    sample_pump_run(&pump, 100000 * MS);
    grobo_sequencer_progress(&pump.seq, pump.now_us, &p);
    assert_int_equal(p.passes, 1);
    assert_int_equal(p.t_us, 60000 * MS);
    assert_int_equal(p.step, 1801);
}

TEST(a_clip_of_one_posture_is_one_frame)
{
    grobo_posture from = sample_posture(0, 0, 0);
    const grobo_play_options options = {.mode = GROBO_PLAY_RATE};
    sample_pump_init(&pump, NULL);
    sample_clip_init(&clip, minute, 1);
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, 0), 0);
    sample_pump_run(&pump, 1000 * MS);
    assert_int_equal(pump.n, 1);
    assert_int_equal(pump.state, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(pump.state_us, 20 * MS);
}

TEST(a_relative_clip_at_a_rate_adds_its_way)
{
    grobo_posture from = sample_posture(1.0, 0.5, 0.25);
    const grobo_play_options options = {.mode = GROBO_PLAY_RATE};
    sample_pump_init(&pump, NULL);
    sample_clip_init(&clip, minute, 2);
    clip.clip.relative = true;
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, 0), 0);
    sample_pump_run(&pump, 100000 * MS);
    const grobo_posture *last = &frame_at(pump.n - 1)->posture;
    assert_true(fabs(last->angle_rad[0] - 1.6) < 1e-12);
    assert_true(last->angle_rad[1] == 0.5 && last->angle_rad[2] == 0.25);
}

TEST(a_fast_rate_never_asks_for_full_speed)
{
    start(brief, (grobo_play_options){.rate_hz = 1000}, 0.0);
    sample_pump_run(&pump, 10000 * MS);
    assert_int_equal(pump.n, 2051);
    assert_int_equal(frame_at(7)->posture.time_us, GROBO_PLAY_TIME_UNIT_US); /* 0 would be that */
}
