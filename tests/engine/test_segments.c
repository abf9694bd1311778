/* SPDX-License-Identifier: MIT */
/*
 * Goals in segments: what an arm does when its host is gone, and that it does what a whole goal
 * would while the host is there.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { JOINTS = 20, SECOND_US = 1000000, MOVE_MS = 3000, LOOK_US = 5000 };

/* The neck, from -45 to 45 degrees. */
#define FROM_DEG (-45.0)
#define TO_DEG 45.0
#define SPEED_DPS ((TO_DEG - FROM_DEG) * 1000 / MOVE_MS)
/* Frames have passed the board and the servos' bus by then. */
#define LINE_US 40000
/* The wire's unit of an angle is 0.1 degree. */
#define ROUNDING_DEG 0.06

static grobo_test_rig rig;
static rig_clip clip;
static grobo_driver arm = GROBO_TABLE_INIT(grobo_driver);

static void start(const grobo_robot_config *config, const grobo_sim_config *sim)
{
    arm = *grobo_gr001_driver(rig_wiring);
    arm.arm = true;
    rig_start_driver(&rig, &arm, config, sim);
    rig_power(&rig);
    grobo_posture there = rig_posture(&rig, NECK, FROM_DEG, 1000);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &there), GROBO_OK);
    rig_forget(&rig);
}

static int begin_move(void)
{
    grobo_posture target = rig_posture(&rig, NECK, TO_DEG, MOVE_MS);
    return grobo_robot_move(&rig.robot, &target);
}

/* Until the neck moves. */
static void wait_for_move(void)
{
    double before_deg = rig_angle_deg(&rig, NECK);
    for (int i = 0; i < 2000 && fabs(rig_angle_deg(&rig, NECK) - before_deg) < 0.01; i++) {
        rig_run(&rig, 1000);
    }
    assert_true(fabs(rig_angle_deg(&rig, NECK) - before_deg) >= 0.01);
}

/* How far a joint may go on at this speed: 400 ms, the end rounded on the wire. */
static double segment_deg(double speed_dps)
{
    return speed_dps * 0.4 + ROUNDING_DEG;
}

/* The host is gone from now on: how far the joint that goes farthest goes on. All of them stand
 * after a segment. */
static double travel_of_the_dead(void)
{
    double before_deg[JOINTS];
    double stands_deg[JOINTS];
    double most_deg = 0;
    for (int j = 0; j < JOINTS; j++) {
        before_deg[j] = rig_angle_deg(&rig, j);
    }
    rig.wake_us = rig.now_us + 60LL * SECOND_US;
    rig_run(&rig, GROBO_SEGMENT_US + LINE_US);
    for (int j = 0; j < JOINTS; j++) {
        stands_deg[j] = rig_angle_deg(&rig, j);
        most_deg = fmax(most_deg, fabs(stands_deg[j] - before_deg[j]));
    }
    rig_run(&rig, 5LL * SECOND_US);
    for (int j = 0; j < JOINTS; j++) {
        assert_true(rig_angle_deg(&rig, j) == stands_deg[j]);
    }
    return most_deg;
}

static int sent_goals(void)
{
    int goals = 0;
    for (size_t i = 0; i < rig.n_sent; i++) {
        const uint8_t *packet;
        goals += rig_packet(&rig.sent[i], &packet) > 8 && packet[4] == GROBO_RS30X_GOAL;
    }
    return goals;
}

/* ---- a host that is gone --------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_dead_host_stops_a_move_at_any_moment)
{
    double least_deg = 1000;
    double most_deg = 0;
    for (int64_t dead_us = 0; dead_us < 2800000; dead_us += 61000) {
        start(&quiet, NULL);
        (void)begin_move();
        wait_for_move();
        rig_run(&rig, dead_us);
        double deg = travel_of_the_dead();
        least_deg = fmin(least_deg, deg);
        most_deg = fmax(most_deg, deg);
    }
    print_message("# a move goes on by %.2f to %.2f deg, at %.0f deg/s\n", least_deg, most_deg,
                  SPEED_DPS);
    assert_true(most_deg <= segment_deg(SPEED_DPS));
    assert_true(least_deg > segment_deg(SPEED_DPS) / 2); /* it had enough to go on for a stall */
}

TEST_WITH(rig_wirings, a_dead_host_stops_it_on_a_line_that_loses_bytes)
{
    for (uint32_t seed = 1; seed <= 20; seed++) {
        grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = seed};
        start(&quiet, &sim);
        assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_DROP, 0.003), 0);
        (void)begin_move();
        wait_for_move();
        rig_run(&rig, 130000LL * seed);
        double deg = travel_of_the_dead();
        assert_true(deg <= segment_deg(SPEED_DPS));
    }
}

/* From anywhere to the initial posture, all joints at a time. */
TEST_WITH(rig_wirings, a_dead_host_stops_all_joints)
{
    for (uint32_t seed = 1; seed <= 8; seed++) {
        grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP,
                                 .seed = seed};
        grobo_posture init;
        arm = *grobo_gr001_driver(rig_wiring);
        arm.arm = true;
        rig_start_driver(&rig, &arm, NULL, &limp);
        rig_power(&rig);
        grobo_posture_init_pose(&init, arm.model);
        assert_true(grobo_robot_move(&rig.robot, &init) > 0);
        rig_forget(&rig); /* holding before torque came on was a goal, too */
        while (sent_goals() == 0) {
            rig_run(&rig, 1000);
        }
        rig_run(&rig, 90000LL * seed);
        double deg = travel_of_the_dead();
        assert_true(deg > 1 && deg <= segment_deg(60));
    }
}

TEST_WITH(rig_wirings, a_dead_host_stops_an_approach)
{
    static const rig_key far[] = {{0, {{NECK, 45}}}, {9000, {{NECK, -45}}}};
    for (int mode = GROBO_PLAY_KEY; mode <= GROBO_PLAY_RATE; mode++) {
        grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = (grobo_play_mode)mode};
        start(NULL, NULL);
        rig_clip_init(&clip, far, 2);
        (void)grobo_robot_play(&rig.robot, &clip.clip, &options);
        wait_for_move();
        rig_run(&rig, 300000);
        assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_APPROACHING);
        assert_true(travel_of_the_dead() <= segment_deg(60));
    }
}

/* A key posture of many seconds. */
TEST_WITH(rig_wirings, a_dead_host_stops_a_long_key)
{
    static const rig_key slow[] = {{0, {{NECK, FROM_DEG}}}, {9000, {{NECK, 45}}}};
    start(NULL, NULL);
    rig_clip_init(&clip, slow, 2);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 3LL * SECOND_US);
    double deg = travel_of_the_dead();
    assert_true(deg <= segment_deg(10));
}

TEST_WITH(rig_wirings, a_humanoid_finishes_its_move_unless_asked)
{
    static const grobo_goals asked[] = {GROBO_GOALS_DEFAULT, GROBO_GOALS_WHOLE,
                                        GROBO_GOALS_SEGMENTS};
    for (int i = 0; i < 6; i++) {
        grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                     .sense_interval_us = GROBO_SENSE_NEVER, .goals = asked[i % 3]};
        bool is_arm = i >= 3;
        start(&config, NULL);
        if (!is_arm) {
            rig_start(&rig, &config, NULL);
            rig_power(&rig);
        }
        grobo_posture target = rig_posture(&rig, NECK, TO_DEG, MOVE_MS);
        (void)grobo_robot_move(&rig.robot, &target);
        wait_for_move();
        rig_run(&rig, 500000);
        bool whole =
            asked[i % 3] == GROBO_GOALS_WHOLE || (asked[i % 3] == GROBO_GOALS_DEFAULT && !is_arm);
        rig.wake_us = rig.now_us + 60LL * SECOND_US;
        rig_run(&rig, 5LL * SECOND_US);
        assert_int_equal(fabs(rig_angle_deg(&rig, NECK) - TO_DEG) < 0.1, whole);
    }
}

/* ---- a host that is there -------------------------------------------------------------------- */

enum { LOOKS = 2000 };

typedef struct course {
    double deg[LOOKS]; /* of the neck, every LOOK_US since it began to move */
    int64_t moved_us;  /* until it stood */
    int64_t ended_us;  /* until the job was over */
    int32_t goal;      /* register, at the end */
} course;

static course whole, parts;

/* stall_us: of the host, 200 ms long, counted from the beginning; negative: none. */
static void run_move(course *to, const grobo_robot_config *like, grobo_goals goals,
                     int64_t stall_us)
{
    grobo_robot_config config = *like;
    config.goals = goals;
    start(&config, NULL);
    int number = begin_move();
    assert_true(number > 0);
    wait_for_move();
    int64_t from_us = rig.now_us;
    to->moved_us = to->ended_us = -1;
    for (int i = 0; i < LOOKS; i++) {
        to->deg[i] = rig_angle_deg(&rig, NECK);
        if (i > 0 && to->deg[i] != to->deg[i - 1]) {
            to->moved_us = rig.now_us - from_us;
        }
        if (to->ended_us < 0 && rig_count(&rig, GROBO_EVENT_JOB) > 0) {
            to->ended_us = rig.now_us - from_us;
        }
        if (stall_us >= 0 && rig.now_us - from_us >= stall_us) {
            rig.wake_us = rig.now_us + 200000;
            stall_us = -1;
        }
        rig_run(&rig, LOOK_US);
    }
    rig_expect(&rig, number, GROBO_OK);
    assert_int_equal(grobo_sim_get_register(&rig.sim, NECK, GROBO_RS30X_GOAL, &to->goal), 0);
}

static void compare(const char *what)
{
    double most_deg = 0;
    for (int i = 0; i < LOOKS; i++) {
        most_deg = fmax(most_deg, fabs(whole.deg[i] - parts.deg[i]));
    }
    print_message("# %s: apart by %.3f deg, moves %lld and %lld ms, jobs end after %lld and %lld "
                  "ms\n",
                  what, most_deg, (long long)whole.moved_us / 1000,
                  (long long)parts.moved_us / 1000, (long long)whole.ended_us / 1000,
                  (long long)parts.ended_us / 1000);
    assert_true(most_deg <= ROUNDING_DEG);
    assert_true(whole.deg[LOOKS - 1] == parts.deg[LOOKS - 1]);
    assert_int_equal(whole.goal, parts.goal);
    assert_true(llabs(whole.moved_us - parts.moved_us) <= LOOK_US);
    assert_true(llabs(whole.ended_us - parts.ended_us) <= LOOK_US);
}

/* Also beside readings, which take the line. */
TEST_WITH(rig_wirings, segments_lie_on_the_way_of_the_whole)
{
    static const grobo_robot_config watched = {GROBO_ROBOT_CONFIG_INIT};
    static const grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    run_move(&whole, &quiet, GROBO_GOALS_WHOLE, -1);
    run_move(&parts, &quiet, GROBO_GOALS_DEFAULT, -1);
    compare("alone");
    assert_in_range(sent_goals(), MOVE_MS / 100 - 1, MOVE_MS / 100 + 1);
    run_move(&parts, &watched, GROBO_GOALS_DEFAULT, -1);
    compare("watched");
    run_move(&parts, &busy, GROBO_GOALS_DEFAULT, -1);
    compare("beside readings");
}

TEST_WITH(rig_wirings, a_short_stall_is_no_pause)
{
    run_move(&whole, &quiet, GROBO_GOALS_WHOLE, -1);
    for (int64_t stall_us = 0; stall_us < 3000000; stall_us += 230000) {
        run_move(&parts, &quiet, GROBO_GOALS_DEFAULT, stall_us);
        double most_deg = 0;
        for (int i = 0; i < LOOKS; i++) {
            most_deg = fmax(most_deg, fabs(whole.deg[i] - parts.deg[i]));
        }
        assert_true(most_deg <= 10000 * SPEED_DPS / 1e6 + ROUNDING_DEG); /* a unit of time */
        assert_int_equal(parts.goal, whole.goal);
        assert_int_equal(rig_count(&rig, GROBO_EVENT_TRIP), 0);
    }
}

TEST_WITH(rig_wirings, lost_frames_are_made_good)
{
    for (uint32_t seed = 1; seed <= 10; seed++) {
        grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = seed};
        start(NULL, &sim);
        assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_DROP, 0.003), 0);
        rig_expect(&rig, begin_move(), GROBO_OK);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - TO_DEG) < 0.1);
    }
}

TEST_WITH(rig_wirings, a_move_within_a_segment_is_one_frame)
{
    start(&quiet, NULL);
    grobo_posture target = rig_posture(&rig, NECK, FROM_DEG + 10, GROBO_SEGMENT_US / 1000);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_int_equal(rig_sent_ms(&rig, NECK_ID), GROBO_SEGMENT_US / 1000);
}

/* ---- ends ------------------------------------------------------------------------------------ */

/* Another program has left the neck 25 degrees outside of its limits: the first move is slow from
 * there on. */
TEST_WITH(rig_wirings, a_joint_from_outside_its_limits_is_slow)
{
    const grobo_robot_config slow = {GROBO_ROBOT_CONFIG_INIT, .approach_dps = 10,
                                     .sense_interval_us = GROBO_SENSE_NEVER,
                                     .goals = GROBO_GOALS_SEGMENTS};
    rig_start_narrow(&rig);
    rig_power(&rig);
    assert_int_equal(grobo_robot_configure(&rig.robot, &slow), GROBO_OK);
    assert_int_equal(grobo_sim_set_register(&rig.sim, NECK, GROBO_RS30X_GOAL, 450), 0);
    rig_run(&rig, SECOND_US);
    grobo_posture target = rig_posture(&rig, NECK, 0, 100);
    int number = grobo_robot_move(&rig.robot, &target);
    double before_deg = rig_angle_deg(&rig, NECK);
    assert_true(before_deg > 44);
    while (grobo_robot_is_pending(&rig.robot, number)) {
        rig_run(&rig, SECOND_US / 10);
        double deg = rig_angle_deg(&rig, NECK);
        assert_true(before_deg - deg < 1.3);
        before_deg = deg;
    }
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.2);
}

static void expect_at_rest(void)
{
    double deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 3LL * SECOND_US);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - deg) < 0.05);
}

/* What is left of the move is not made when the host is back. */
TEST_WITH(rig_wirings, a_long_stall_ends_the_move)
{
    start(&quiet, NULL);
    int number = begin_move();
    wait_for_move();
    rig_run(&rig, 1000000);
    rig_stall(&rig, 1000000);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_non_null(trip);
    assert_int_equal(trip->u.trip.trip, GROBO_TRIP_HOST_STALL);
    assert_false(trip->u.trip.latched);
    assert_int_equal(trip->u.trip.joint, -1);
    assert_in_range(trip->u.trip.value, 800, 1000);
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), 0);
    assert_true(fabs(grobo_deg_from_rad(info.target_rad) - rig_angle_deg(&rig, NECK)) < 0.1);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->stalls, 1);
    expect_at_rest();
    rig_forget(&rig);
    grobo_posture first = rig_posture(&rig, SHOULDER, rig_angle_deg(&rig, SHOULDER) + 20, 100);
    assert_int_equal(grobo_robot_send(&rig.robot, &first), GROBO_OK);
    rig_run(&rig, 500000);
    /* A slow one: 20 degrees at 60 deg/s. */
    assert_in_range(rig_sent_ms(&rig, rig.driver->model->joints[SHOULDER].motor), 320, 340);
    rig_expect(&rig, begin_move(), GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - TO_DEG) < 0.1);
}

TEST_WITH(rig_wirings, a_long_stall_ends_an_approach)
{
    static const rig_key far[] = {{0, {{NECK, 45}}}, {9000, {{NECK, -45}}}};
    start(NULL, NULL);
    rig_clip_init(&clip, far, 2);
    int number = grobo_robot_play(&rig.robot, &clip.clip, NULL);
    assert_true(number > 0);
    wait_for_move();
    rig_run(&rig, 300000);
    rig_stall(&rig, 5LL * SECOND_US);
    rig_run(&rig, 20000);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    assert_int_equal(rig_last(&rig, GROBO_EVENT_TRIP)->u.trip.trip, GROBO_TRIP_HOST_STALL);
    assert_int_equal(rig_last(&rig, GROBO_EVENT_PLAY)->u.play.to, GROBO_SEQUENCER_IDLE);
    expect_at_rest();
}

static void stop_move(void)
{
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
}

static void cancel_move(void)
{
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
}

static void trip_move(void)
{
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 67), 0);
    while (rig_count(&rig, GROBO_EVENT_TRIP) == 0) {
        rig_run(&rig, 1000);
    }
}

static void estop_move(void)
{
    assert_true(grobo_robot_estop(&rig.robot) > 0);
}

static void leave_move(void)
{
    assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
}

TEST_WITH(rig_wirings, what_stops_a_move_stops_its_segments)
{
    void (*const ways[])(void) = {stop_move, cancel_move, trip_move, estop_move, leave_move};
    for (int i = 0; i < 5; i++) {
        for (int64_t at_us = 400000; at_us < 800000; at_us += 33000) {
            grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
            start(&config, NULL);
            (void)begin_move();
            wait_for_move();
            rig_run(&rig, at_us);
            ways[i]();
            double deg = rig_angle_deg(&rig, NECK);
            rig_run(&rig, 250000);
            assert_true(fabs(rig_angle_deg(&rig, NECK) - deg) < SPEED_DPS * 0.15);
            expect_at_rest();
        }
    }
}

/* A line that is back finds nothing to renew. */
TEST_WITH(rig_wirings, a_lost_line_ends_the_segments)
{
    start(&quiet, NULL);
    int number = begin_move();
    wait_for_move();
    rig_run(&rig, 500000);
    grobo_robot_link_down(&rig.robot, rig.now_us);
    rig_expect(&rig, number, GROBO_ERR_UNPLUGGED);
    rig_run(&rig, 100000);
    grobo_robot_link_up(&rig.robot, rig.now_us);
    rig_run(&rig, GROBO_SEGMENT_US);
    expect_at_rest();
    assert_true(fabs(rig_angle_deg(&rig, NECK) - TO_DEG) > 10);
}

/* What the motion sends is not spoilt by what was left of the way to its beginning. */
TEST_WITH(rig_wirings, a_motion_takes_the_place_of_its_approach)
{
    static const rig_key far[] = {{0, {{NECK, 0}}}, {2000, {{NECK, 40}}}, {4000, {{NECK, -40}}}};
    static double deg[2][LOOKS];
    for (int i = 0; i < 2; i++) {
        grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                     .goals = i == 0 ? GROBO_GOALS_WHOLE : GROBO_GOALS_DEFAULT};
        grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE};
        start(&config, NULL);
        rig_clip_init(&clip, far, 3);
        assert_true(grobo_robot_play(&rig.robot, &clip.clip, &options) > 0);
        wait_for_move();
        for (int k = 0; k < LOOKS; k++) {
            deg[i][k] = rig_angle_deg(&rig, NECK);
            rig_run(&rig, LOOK_US);
        }
        assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_FINISHED);
    }
    double most_deg = 0;
    for (int k = 0; k < LOOKS; k++) {
        most_deg = fmax(most_deg, fabs(deg[0][k] - deg[1][k]));
    }
    print_message("# an approach and its motion: apart by %.3f deg\n", most_deg);
    assert_true(most_deg < 0.5);
}
