/* SPDX-License-Identifier: MIT */
/* Playing: the frames on the wire, their times, and what a motion may be told on its way. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;
static const rig_key nod[] = {
    {0, {{NECK, 0}}},     {500, {{NECK, 30}}},  {1000, {{NECK, -30}, {SHOULDER, 60}}},
    {1700, {{NECK, 10}}}, {2000, {{NECK, 20}}},
};

static void start(const grobo_robot_config *config)
{
    rig_start(&rig, config, NULL);
    rig_clip_init(&clip, nod, sizeof nod / sizeof nod[0]);
}

/* Frames that move all 20 joints, after the approach, which is the first. */
static size_t motion_frames(rig_frame *frames, size_t capacity)
{
    size_t n = 0;
    for (size_t i = 0; i < rig.n_sent; i++) {
        if (rig.sent[i].size == 110 && n < capacity) {
            frames[n++] = rig.sent[i];
        }
    }
    return n;
}

/* Of a 110-byte frame (protocol 5). */
static int angle_ddeg(const rig_frame *frame, int motor)
{
    const uint8_t *p = &frame->bytes[5 * (motor - 1) + 10];
    return (int16_t)(p[0] | p[1] << 8);
}

static int time_cs(const rig_frame *frame, int motor)
{
    const uint8_t *p = &frame->bytes[5 * (motor - 1) + 12];
    return p[0] | p[1] << 8;
}

static void play(const grobo_play_options *options)
{
    rig_power(&rig);
    rig_forget(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, options), GROBO_OK);
}

TEST(keys_are_frames_with_their_times)
{
    static rig_frame frames[64];
    start(&quiet);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    size_t n = motion_frames(frames, 64);
    assert_int_equal(n, 5);
    static const int neck_ddeg[] = {0, 300, -300, 100, 200};
    static const int cs[] = {0, 50, 50, 70, 30};
    for (size_t i = 1; i < n; i++) {
        assert_int_equal(angle_ddeg(&frames[i], 2), neck_ddeg[i]);
        assert_int_equal(time_cs(&frames[i], 2), cs[i]);
    }
    assert_int_equal(frames[2].at_us - frames[1].at_us, 500000);
    assert_int_equal(frames[3].at_us - frames[2].at_us, 500000);
    assert_int_equal(frames[4].at_us - frames[3].at_us, 700000);
    rig_run(&rig, 100000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.1);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->late_frames, 0);
    const grobo_event *end = rig_last(&rig, GROBO_EVENT_PLAY);
    assert_int_equal(end->u.play.to, GROBO_SEQUENCER_FINISHED);
}

TEST(frames_at_a_rate_leave_on_their_grid)
{
    static rig_frame frames[256];
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 30};
    start(NULL);
    play(&options);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    size_t n = motion_frames(frames, 256);
    assert_in_range(n, 60, 63);
    for (size_t i = 3; i < n; i++) {
        int64_t off_us = frames[i].at_us - frames[2].at_us - ((int64_t)(i - 2) * 1000000) / 30;
        assert_true(off_us >= -1 && off_us <= 1);
    }
    rig_run(&rig, 200000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.1);
    grobo_jitter jitter;
    grobo_robot_jitter(&rig.robot, &jitter);
    assert_int_equal(jitter.max_us, 0);
    assert_in_range(jitter.frames, 60, 63);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->late_frames, 0);
}

/* When the first frame behind the approach leaves, of a robot whose neck stands there. */
static int64_t first_leaves_at(double neck_deg, int64_t start_us)
{
    static rig_frame frames[64];
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .start_us = start_us};
    start(&quiet);
    rig_power(&rig);
    const grobo_posture turned = rig_posture(&rig, NECK, neck_deg, 1000);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &turned), GROBO_OK);
    play(&options);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    assert_true(motion_frames(frames, 64) >= 2);
    return frames[1].at_us;
}

TEST(robots_begin_together_however_far_they_approach)
{
    int64_t start_us = rig_epoch_us + 8000000;
    int64_t near_us = first_leaves_at(1, start_us);
    int64_t far_us = first_leaves_at(-40, start_us);
    assert_in_range(near_us, start_us, start_us + 1000);
    assert_in_range(far_us, start_us, start_us + 1000);
}

TEST(gaps_between_frames_are_read_in)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 30,
                                  .repeat = 5};
    grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    start(&busy);
    play(&options);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_forget(&rig);
    rig_run(&rig, 1000000);
    assert_in_range(rig_count(&rig, GROBO_EVENT_JOINT), 30, 120);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    grobo_jitter jitter;
    grobo_robot_jitter(&rig.robot, &jitter);
    assert_int_equal(jitter.max_us, 0);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->late_frames, 0);
}

TEST(first_move_is_slow_and_from_where_the_robot_is)
{
    static rig_frame frames[16];
    grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP, .seed = 5};
    rig_start(&rig, &quiet, &limp);
    rig_clip_init(&clip, nod, sizeof nod / sizeof nod[0]);
    double most_deg = 0;
    for (int j = 0; j < 20; j++) {
        double init_deg = grobo_deg_from_rad(rig.driver->model->joints[j].init_rad);
        most_deg = fmax(most_deg, fabs(rig_angle_deg(&rig, j) - init_deg));
    }
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    assert_true(motion_frames(frames, 16) >= 1);
    int64_t least_us = (int64_t)(most_deg / 60 * 1e6);
    assert_in_range(time_cs(&frames[0], 2) * 10000LL, least_us - 10000, least_us + 20000);
    for (int motor = 1; motor <= 20; motor++) {
        assert_int_equal(time_cs(&frames[0], motor), time_cs(&frames[0], 2));
    }
}

TEST(targets_outside_limits_end_the_motion)
{
    static const rig_key wild[] = {
        {0, {{NECK, 0}}}, {500, {{NECK, 20}}}, {1000, {{NECK, 51}}}, {2000, {{NECK, 0}}}};
    start(&quiet);
    rig_clip_init(&clip, wild, 4);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FAILED);
    const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_int_equal(trip->u.trip.trip, GROBO_TRIP_LIMIT);
    assert_int_equal(trip->u.trip.joint, NECK);
    assert_true(fabs(trip->u.trip.value - 51) < 1e-9 && !trip->u.trip.latched);
    assert_int_equal(rig_last(&rig, GROBO_EVENT_PLAY)->u.play.error, GROBO_ERR_LIMIT);
    rig_run(&rig, 500000);
    assert_true(rig_angle_deg(&rig, NECK) < 20.1);
}

TEST(targets_outside_limits_are_clamped_if_told_so)
{
    static const rig_key wild[] = {{0, {{NECK, 0}}}, {1000, {{NECK, 70}}}};
    grobo_robot_config config = quiet;
    config.limit_policy = GROBO_LIMIT_CLAMP;
    start(&config);
    rig_clip_init(&clip, wild, 2);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    rig_run(&rig, 100000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 50) < 0.1);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->clamped, 1);
}

TEST(too_fast_a_target_gets_more_time)
{
    static const rig_key jerk[] = {{0, {{NECK, -40}}}, {100, {{NECK, 40}, {SHOULDER, 25}}}};
    static rig_frame frames[16];
    start(&quiet);
    rig_clip_init(&clip, jerk, 2);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(motion_frames(frames, 16), 2);
    /* 80 degrees at 375 deg/s need 0.22 s; the shoulder keeps its 0.1 s. */
    assert_int_equal(time_cs(&frames[1], 2), 22);
    assert_int_equal(time_cs(&frames[1], 3), 10);
    assert_in_range(grobo_robot_get_counters(&rig.robot)->stretched, 1, 2);
}

TEST(speed_limit_is_kept)
{
    static rig_frame frames[16];
    grobo_robot_config slow = quiet;
    slow.speed_limit_pct = 20; /* 75 deg/s for the neck */
    start(&slow);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    assert_int_equal(motion_frames(frames, 16), 5);
    assert_int_equal(time_cs(&frames[1], 2), 50);
    assert_in_range(time_cs(&frames[2], 2), 79, 81); /* 60 degrees */
}

TEST(pause_resume_and_stop)
{
    start(&quiet);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 300000);
    assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_PAUSED);
    double held_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - held_deg) < 0.01);
    assert_int_equal(grobo_robot_resume(&rig.robot), GROBO_OK);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_PLAYING);
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
    rig_run(&rig, 400000);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    assert_false(grobo_robot_moving(&rig.robot));
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_ERR_STATE);
}

TEST(only_one_motion_at_a_time)
{
    start(&quiet);
    play(NULL);
    grobo_posture target = rig_posture(&rig, NECK, 0, 100);
    assert_int_equal(grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &clip.clip, NULL), 1);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
}

TEST(a_short_stall_skips_a_long_one_stops)
{
    static rig_frame frames[256];
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 50,
                                  .unwatched = true};
    start(&quiet);
    play(&options);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 305000);
    rig_forget(&rig);
    rig_stall(&rig, 100000);
    assert_int_equal(motion_frames(frames, 256), 1); /* the present one, no burst */
    assert_in_range(grobo_robot_get_counters(&rig.robot)->late_frames, 4, 6);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 100000);
    rig_stall(&rig, 400000);
    rig_run(&rig, 400000);
    const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_non_null(trip);
    assert_int_equal(trip->u.trip.trip, GROBO_TRIP_HOST_STALL);
    assert_false(trip->u.trip.latched);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->stalls, 1);
}

static void mute_all(grobo_sim_cable cable)
{
    for (int j = 0; j < 20; j++) {
        assert_int_equal(grobo_sim_set_cable(&rig.sim, j, cable), 0);
    }
}

TEST(a_lost_last_posture_is_repeated)
{
    start(&quiet);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 1650000);
    mute_all(GROBO_SIM_CABLE_MUTE);
    rig_run(&rig, 150000); /* the last frame left at 1.7 s */
    mute_all(GROBO_SIM_CABLE_IN);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) > 5);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_NONE); /* it is the engine's own */
    assert_true(grobo_robot_settling(&rig.robot));
    rig_run(&rig, 1500000);
    assert_false(grobo_robot_settling(&rig.robot));
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.1);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP));
}

TEST(what_the_engine_does_afterwards_makes_way)
{
    start(&quiet);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    grobo_posture target = rig_posture(&rig, NECK, 0, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_false(grobo_robot_settling(&rig.robot));
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.1);
}

TEST(a_single_target_is_not_taken_back_afterwards)
{
    for (int ms = 0; ms < 200; ms += 5) {
        start(&quiet);
        play(NULL);
        rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
        rig_run(&rig, ms * 1000);
        grobo_posture target = rig_posture(&rig, NECK, -10, 200);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 3000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) + 10) < 0.1);
    }
}

TEST(a_lost_approach_is_repeated)
{
    static const rig_key far[] = {{0, {{NECK, 40}}}, {500, {{NECK, 30}}}};
    start(&quiet);
    rig_clip_init(&clip, far, 2);
    rig_power(&rig);
    rig_forget(&rig);
    int number = grobo_robot_play(&rig.robot, &clip.clip, NULL);
    while (grobo_robot_play_state(&rig.robot) == GROBO_SEQUENCER_IDLE) {
        rig_run(&rig, 1000);
    }
    mute_all(GROBO_SIM_CABLE_MUTE);
    rig_run(&rig, 20000);
    mute_all(GROBO_SIM_CABLE_IN);
    rig_expect(&rig, number, GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 40) < 2);
}

/* So short an approach is over before it could be read back, and at 50 Hz nothing can be read after
 * it: the job ends in a later pass, and is not to judge that one's approach by what it read. */
TEST(an_approach_is_judged_by_its_own_readings)
{
    static const rig_key reach[] = {{0, {{NECK, 0}}}, {1000, {{HIP, -90}}}};
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 50,
                                  .unwatched = true, .repeat = 3};
    start(&quiet);
    rig_clip_init(&clip, reach, 2);
    for (int j = 0; j < 20; j++) {
        double off_deg = j == CHEST ? -3.5 : 3.5;
        double init_deg = grobo_deg_from_rad(rig.driver->model->joints[j].init_rad);
        assert_int_equal(
            grobo_sim_set_angle(&rig.sim, j, (int32_t)lround((init_deg + off_deg) * 1000), 0), 0);
    }
    rig_power(&rig);
    int number = grobo_robot_play(&rig.robot, &clip.clip, &options);
    while (grobo_robot_play_state(&rig.robot) == GROBO_SEQUENCER_IDLE) {
        rig_run(&rig, 1000);
    }
    mute_all(GROBO_SIM_CABLE_MUTE); /* the approach is lost */
    rig_run(&rig, 20000);
    mute_all(GROBO_SIM_CABLE_IN);
    double before_deg = rig_angle_deg(&rig, HIP);
    double init_deg = grobo_deg_from_rad(rig.driver->model->joints[HIP].init_rad);
    while (grobo_robot_play_state(&rig.robot) != GROBO_SEQUENCER_FINISHED) {
        rig_run(&rig, 2000);
        double deg = rig_angle_deg(&rig, HIP);
        /* 90 deg/s in the motion, 60 back; where it starts the first frame makes up for 3.5. */
        assert_true(fabs(deg - before_deg) < 0.002 * 100 || fabs(deg - init_deg) < 4);
        before_deg = deg;
    }
    rig_expect(&rig, number, GROBO_OK);
}

static int lean(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                grobo_posture *target)
{
    (void)self;
    (void)ctx;
    assert_true(sensed->set == GROBO_JOINTS_ALL(20));
    target->angle_rad[R_KNEE] -= grobo_rad_from_deg(5);
    return 0;
}

TEST(the_stabilizer_corrects_and_is_checked)
{
    static rig_frame frames[16];
    static const rig_key low[] = {{0, {{R_KNEE, -100}}}, {1000, {{R_KNEE, -127}}}};
    grobo_driver driver = *grobo_gr001_driver(GROBO_WIRING_BOARD);
    driver.stabilize = lean;
    rig_start_driver(&rig, &driver, &quiet, NULL);
    rig_clip_init(&clip, low, 2);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_FAILED);
    assert_true(motion_frames(frames, 16) >= 1);
    assert_int_equal(angle_ddeg(&frames[0], 12), -1050);
    const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_int_equal(trip->u.trip.joint, R_KNEE);
    assert_true(fabs(trip->u.trip.value + 132) < 1e-9);
}

/* What went out was corrected already. */
TEST(a_repeated_posture_is_not_corrected_twice)
{
    static const rig_key low[] = {
        {0, {{R_KNEE, -40}}}, {500, {{R_KNEE, -50}}}, {1000, {{R_KNEE, -80}}}};
    grobo_driver driver = *grobo_gr001_driver(GROBO_WIRING_BOARD);
    driver.stabilize = lean;
    rig_start_driver(&rig, &driver, &quiet, NULL);
    rig_clip_init(&clip, low, 3);
    play(NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 450000);
    mute_all(GROBO_SIM_CABLE_MUTE);
    rig_run(&rig, 150000); /* the last frame left at 0.5 s */
    mute_all(GROBO_SIM_CABLE_IN);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 55) < 1);
    rig_run(&rig, 1500000);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 85) < 0.1);
}

/* One servo has missed the approach, which begins anew: the others are on their way already. */
TEST(a_cancel_stops_an_approach_that_begins_anew)
{
    static const rig_key far[] = {{0, {{NECK, 40}, {SHOULDER, 90}}}, {500, {{NECK, 40}}}};
    rig_start_at(&rig, 0, &quiet);
    rig_clip_init(&clip, far, 2);
    int number = grobo_robot_play(&rig.robot, &clip.clip, NULL);
    rig_wait_play(&rig, GROBO_SEQUENCER_APPROACHING);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 30000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_wait_play(&rig, GROBO_SEQUENCER_IDLE);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_PLAY);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    rig_run(&rig, 300000);
    double here_deg = rig_angle_deg(&rig, SHOULDER);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - here_deg) < 0.01);
}
