/* SPDX-License-Identifier: MIT */
/* Each safety rule on its own, under the fault it is for. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;
static const grobo_robot_config watching = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
static const rig_key sway[] = {
    {0, {{NECK, 0}}}, {1000, {{NECK, 30}}}, {3000, {{NECK, -30}}}, {4000, {{NECK, 0}}}};

static void start_playing(const grobo_robot_config *config)
{
    rig_start(&rig, config, NULL);
    rig_clip_init(&clip, sway, 4);
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .repeat = 100};
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 700000);
    rig_forget(&rig);
}

static const grobo_trip_info *expect_trip(grobo_trip reason, int64_t within_us)
{
    int64_t until_us = rig.now_us + within_us;
    while (rig_last(&rig, GROBO_EVENT_TRIP) == NULL && rig.now_us < until_us) {
        rig_run(&rig, 10000);
    }
    const grobo_event *event = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_non_null(event);
    if (event->u.trip.trip != reason) {
        fail_msg("tripped by %s, not %s", grobo_trip_name(event->u.trip.trip),
                 grobo_trip_name(reason));
    }
    return &event->u.trip;
}

/* Stopped, latched, refuses to move, and moves again after a reset. */
static void expect_latched(grobo_trip reason)
{
    grobo_trip_info info;
    grobo_robot_tripped(&rig.robot, &info);
    assert_true(info.latched && info.trip == reason);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    for (int i = 0; reason == GROBO_TRIP_LOST_REPLIES && i < 300; i++) {
        rig_run(&rig, 10000); /* what is silent cannot be read to be halted */
    }
    assert_false(grobo_robot_moving(&rig.robot));
    double here_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_torque(&rig.robot, 1, GROBO_TORQUE_ON), GROBO_ERR_LATCHED);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, 1, GROBO_SENSE_FULL), GROBO_OK);
}

static void expect_reset_works(void)
{
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 10) < 0.1);
}

TEST_WITH(rig_wirings, bad_targets_are_refused_at_once)
{
    double value = 0;
    rig_start(&rig, &quiet, NULL);
    grobo_posture target = rig_posture(&rig, NECK, 50.1, 500);
    assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_robot_fault(&rig.robot, &value), NECK);
    assert_true(fabs(value - 50.1) < 1e-9);
    target.angle_rad[NECK] = NAN;
    assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_NAN);
    target.angle_rad[NECK] = INFINITY;
    assert_true(grobo_robot_move(&rig.robot, &target) < 0);
    target.n_joints = 19;
    assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_ARG);
    target = rig_posture(&rig, NECK, 50, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
}

TEST_WITH(rig_wirings, a_joint_that_cannot_be_sensed_is_not_moved)
{
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 10000);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    const grobo_event_job *job =
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_ERR_TIMEOUT);
    assert_int_equal(job->joint, NECK);
    assert_int_equal((int)lround(rig_angle_deg(&rig, NECK)), 0);
    rig_clip_init(&clip, sway, 4);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_ERR_TIMEOUT);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
}

TEST_WITH(rig_wirings, torque_of_the_others_comes_on)
{
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 10000);
    const grobo_event_job *job = rig_expect(
        &rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_ON), GROBO_ERR_TIMEOUT);
    assert_true(job->failed == GROBO_JOINT_BIT(NECK));
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), j == NECK ? GROBO_TORQUE_OFF : GROBO_TORQUE_ON);
    }
}

/* A driver that allows the neck less than the simulated servo's stops do. */
TEST_WITH(rig_wirings, a_joint_outside_its_limits_is_not_switched_on)
{
    rig_start_narrow(&rig);

    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 25000, 0), 0);
    const grobo_event_job *job = rig_expect(
        &rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_ON), GROBO_ERR_LIMIT);
    assert_true(job->failed == GROBO_JOINT_BIT(NECK) && job->joint == NECK);
    assert_true(fabs(job->value - 25) < 0.1);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);

    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 21900, 0), 0); /* a little is drawn in */
    rig_power(&rig);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
}

TEST_WITH(rig_wirings, over_temperature_stops)
{
    start_playing(&watching);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 67), 0);
    const grobo_trip_info *trip = expect_trip(GROBO_TRIP_TEMPERATURE, 1000000);
    assert_int_equal(trip->joint, L_ELBOW);
    assert_true(trip->value >= 66);
    expect_latched(GROBO_TRIP_TEMPERATURE);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 30), 0);
    expect_reset_works();
}

TEST_WITH(rig_wirings, a_servo_that_cut_its_torque_stops)
{
    grobo_robot_config config = watching;
    config.temperature_c = -1; /* not ours: the servo's own limit */
    start_playing(&config);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 120), 0);
    const grobo_trip_info *trip = expect_trip(GROBO_TRIP_OVERHEATED, 1000000);
    assert_int_equal(trip->joint, L_ELBOW);
    assert_true(trip->value >= 100);
    expect_latched(GROBO_TRIP_OVERHEATED);
}

TEST_WITH(rig_wirings, the_first_reason_stays)
{
    start_playing(&watching);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 67), 0);
    expect_trip(GROBO_TRIP_TEMPERATURE, 1000000);
    grobo_sim_set_supply(&rig.sim, 5500);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_TRIP), 1);
    expect_latched(GROBO_TRIP_TEMPERATURE);
    rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
    grobo_trip_info info;
    grobo_robot_tripped(&rig.robot, &info);
    assert_int_equal(info.trip, GROBO_TRIP_ESTOP); /* but for what a person said */
}

TEST_WITH(rig_wirings, a_trip_ends_a_move_where_it_is)
{
    rig_start(&rig, &watching, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 45, 5000);
    int number = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 67), 0);
    rig_expect(&rig, number, GROBO_ERR_LATCHED);
    rig_clip_init(&clip, sway, 4);
    assert_true(rig_angle_deg(&rig, NECK) < 25);
    expect_latched(GROBO_TRIP_TEMPERATURE);
}

TEST_WITH(rig_wirings, a_tripped_robot_holds_instead_of_sitting_down)
{
    start_playing(&watching);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 67), 0);
    expect_trip(GROBO_TRIP_TEMPERATURE, 1000000);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_SIT), GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 40) < 0.1);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_ON);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF), GROBO_OK);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_OFF);
}

TEST_WITH(rig_wirings, torque_does_not_come_on_in_a_motion)
{
    start_playing(&quiet);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, 1, GROBO_TORQUE_OFF), GROBO_OK);
    assert_int_equal(grobo_robot_torque(&rig.robot, 1, GROBO_TORQUE_ON), GROBO_ERR_STATE);
}

TEST_WITH(rig_wirings, sustained_over_current_stops)
{
    start_playing(&watching);
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 800), 0);
    rig_run(&rig, 400000);
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 0), 0);
    rig_run(&rig, 2000000);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP)); /* a peak is none */
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 800), 0);
    const grobo_trip_info *trip = expect_trip(GROBO_TRIP_CURRENT, 2500000);
    assert_int_equal(trip->joint, R_KNEE);
    assert_true(trip->value >= 800);
    expect_latched(GROBO_TRIP_CURRENT);
}

TEST_WITH(rig_wirings, low_voltage_stops)
{
    start_playing(&watching);
    grobo_sim_set_supply(&rig.sim, 5800);
    const grobo_trip_info *trip = expect_trip(GROBO_TRIP_VOLTAGE, 1000000);
    assert_true(trip->value < 6000 && trip->value > 5000);
    expect_latched(GROBO_TRIP_VOLTAGE);
}

TEST_WITH(rig_wirings, lost_replies_stop)
{
    start_playing(&watching);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
    const grobo_trip_info *trip = expect_trip(GROBO_TRIP_LOST_REPLIES, 5000000);
    assert_int_equal(trip->joint, R_KNEE);
    assert_true(trip->value >= 5);
    expect_latched(GROBO_TRIP_LOST_REPLIES);
}

TEST_WITH(rig_wirings, a_silent_servo_of_a_resting_robot_trips_nothing)
{
    rig_start(&rig, &watching, NULL);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 5000000);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP));
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(&rig.robot, R_KNEE, &info), 0);
    assert_int_equal(info.status, GROBO_ERR_TIMEOUT);
}

TEST_WITH(rig_wirings, a_brown_out_stops)
{
    start_playing(&watching);
    grobo_sim_set_supply(&rig.sim, 3000);
    rig_run(&rig, 100000);
    grobo_sim_set_supply(&rig.sim, 7400);
    expect_trip(GROBO_TRIP_TORQUE_LOST, 5000000);
    expect_latched(GROBO_TRIP_TORQUE_LOST);
    expect_reset_works();
}

TEST_WITH(rig_wirings, emergency_stop_is_first_verified_and_latched)
{
    start_playing(&watching);
    int64_t asked_us = rig.now_us;
    int number = grobo_robot_estop(&rig.robot);
    assert_true(number > 0);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_OK);
    assert_true(job->failed == 0 && job->kind == GROBO_JOB_ESTOP);
    const uint8_t *packet;
    assert_true(rig.n_sent > 0 && rig_packet(&rig.sent[0], &packet) == 48 && packet[4] == 0x24);
    assert_in_range(rig.sent[0].at_us - asked_us, 0, 40000);
    assert_in_range(rig.now_us - asked_us, 0, 400000);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_BRAKE);
    }
    expect_latched(GROBO_TRIP_ESTOP);
    expect_reset_works();
}

TEST_WITH(rig_wirings, emergency_stop_waits_for_no_silent_servo)
{
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, 0, GROBO_SIM_CABLE_MUTE), 0);
    (void)grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL);
    rig_run(&rig, 1000); /* the first reading waits 20 ms and more for its reply */
    rig_forget(&rig);
    int64_t asked_us = rig.now_us;
    (void)grobo_robot_estop(&rig.robot);
    rig_run(&rig, 15000);
    const uint8_t *packet;
    assert_true(rig.n_sent >= 1 && rig_packet(&rig.sent[0], &packet) == 48);
    assert_true(rig.sent[0].at_us - asked_us < 10000);
}

TEST_WITH(rig_wirings, nothing_queued_follows_an_emergency_stop)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 60,
                                  .unwatched = true}; /* too much */
    rig_start(&rig, &watching, NULL);
    rig_clip_init(&clip, sway, 4);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    for (int i = 0; i < 10; i++) { /* whatever waits just then */
        rig_run(&rig, 503000 + 1700 * i);
        rig_forget(&rig);
        rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
        rig_run(&rig, 200000);
        for (size_t k = 0; k < rig.n_sent; k++) {
            const uint8_t *packet;
            assert_int_not_equal(rig_packet(&rig.sent[k], &packet), 108);
        }
        assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), 0);
    }
}

/* Deaf to whatever switches torque, as in the moments of restarts, but not to questions. */
static void mute_for_torque(grobo_test_rig *on, const uint8_t *bytes, size_t n)
{
    const rig_frame *last = &on->sent[on->n_sent - 1];
    const uint8_t *p;
    (void)bytes;
    assert_int_equal(last->size, n);
    (void)rig_packet(last, &p);
    bool torque = p[4] == GROBO_RS30X_TORQUE && p[6] > 0;
    assert_int_equal(
        grobo_sim_set_cable(&on->sim, NECK, torque ? GROBO_SIM_CABLE_MUTE : GROBO_SIM_CABLE_IN), 0);
}

TEST_WITH(rig_wirings, emergency_stop_does_not_give_up_who_answers)
{
    rig_start_at(&rig, 0, &quiet);
    rig.on_frame = mute_for_torque;
    int number = grobo_robot_estop(&rig.robot);
    for (int ms = 0; ms < 5000; ms += 100) {
        rig_run(&rig, 100000);
        rig.n_sent = 0;
    }
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    rig.on_frame = NULL;
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
}

TEST_WITH(rig_wirings, emergency_stop_gives_up_where_nobody_answers)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(grobo_sim_set_cable(&rig.sim, j, GROBO_SIM_CABLE_MUTE), 0);
    }
    int64_t asked_us = rig.now_us;
    rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_ERR_TIMEOUT);
    assert_in_range(rig.now_us - asked_us, 5000000, 10100000);
    grobo_trip_info info;
    grobo_robot_tripped(&rig.robot, &info);
    assert_true(info.latched);
}

TEST_WITH(rig_wirings, emergency_stop_repeats_until_it_took)
{
    grobo_robot_config config = quiet;
    config.estop_torque = GROBO_ESTOP_OFF;
    start_playing(&config);
    assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_SILENT, 0.3), 0);
    const grobo_event_job *job = rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
    assert_true(job->failed == 0);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_OFF);
    }
}

TEST_WITH(rig_wirings, emergency_stop_takes_the_place_of_a_job)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 2000);
    int move = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 800000);
    int stop = grobo_robot_estop(&rig.robot);
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_ERR_STATE);
    rig_expect(&rig, move, GROBO_ERR_CANCELED);
    rig_expect(&rig, stop, GROBO_OK);
}

static unsigned asked;

static void stop_at_each_trip(grobo_test_rig *r, const grobo_event *event)
{
    if (event->kind == GROBO_EVENT_TRIP) {
        assert_true(++asked < 10);
        (void)grobo_robot_estop(&r->robot);
    }
}

/* A program that makes an emergency stop of each trip, and so of the emergency stop. */
TEST_WITH(rig_wirings, emergency_stop_may_be_the_answer_to_a_trip)
{
    for (int has_line = 0; has_line < 2; has_line++) {
        start_playing(&watching);
        asked = 0;
        rig.on_event = stop_at_each_trip;
        if (has_line) {
            assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 75), GROBO_OK);
            (void)expect_trip(GROBO_TRIP_ESTOP, 3000000);
        } else {
            grobo_robot_link_down(&rig.robot, rig.now_us);
            assert_int_equal(grobo_robot_estop(&rig.robot), GROBO_ERR_CLOSED);
            grobo_robot_link_up(&rig.robot, rig.now_us);
        }
        rig_run(&rig, 1000000);
        rig.on_event = NULL;
        assert_int_equal(asked, has_line ? 2 : 1);
        assert_int_equal(rig_last(&rig, GROBO_EVENT_JOB)->u.job.result, GROBO_OK);
        assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
    }
}

static bool leaves;

static void stop_at_each_failure(grobo_test_rig *r, const grobo_event *event)
{
    if (event->kind == GROBO_EVENT_JOB && event->u.job.result < 0) {
        assert_true(++asked < 10);
        (void)(leaves ? grobo_robot_exit(&r->robot, GROBO_EXIT_OFF) : grobo_robot_estop(&r->robot));
    }
}

/* A program that stops, or leaves, where any job fails; and that ends all others. */
TEST_WITH(rig_wirings, a_stop_may_be_the_answer_to_a_job_that_fails)
{
    for (int exits = 0; exits < 2; exits++) {
        rig_start_at(&rig, 0, &quiet);
        grobo_posture aim = rig_posture(&rig, NECK, 30, 5000);
        assert_true(grobo_robot_move(&rig.robot, &aim) > 0);
        aim = rig_posture(&rig, R_ELBOW, -30, 6000); /* of the same time it would join the first */
        assert_true(grobo_robot_move(&rig.robot, &aim) > 0);
        rig_run(&rig, 500000);
        asked = 0;
        leaves = exits;
        assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), GROBO_OK);
        int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_FULL);
        rig.on_event = stop_at_each_failure;
        (void)rig_wait(&rig, number);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_IN), GROBO_OK);
        rig_run(&rig, 3000000);
        rig.on_event = NULL;
        assert_int_equal(asked, 3);
        assert_int_equal(rig_last(&rig, GROBO_EVENT_JOB)->u.job.result, GROBO_OK);
        assert_int_equal(rig_torque(&rig, NECK), exits ? GROBO_TORQUE_OFF : GROBO_TORQUE_BRAKE);
    }
}

/* No halt leaves behind it: who lets go then waits for nothing that moves yet, unheard. */
TEST_WITH(rig_wirings, who_was_not_stopped_is_let_go)
{
    rig_start_at(&rig, 0, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 30, 60000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    assert_true(rig_wait(&rig, grobo_robot_estop(&rig.robot))->result < 0);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF), GROBO_OK);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
}

TEST_WITH(rig_wirings, exit_holds_sits_or_lets_go)
{
    start_playing(&quiet);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_DEFAULT), GROBO_OK);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    assert_false(grobo_robot_moving(&rig.robot));

    int64_t asked_us = rig.now_us;
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_SIT), GROBO_OK);
    assert_in_range(rig.now_us - asked_us, 1000000, 10000000);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 120) < 0.1);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_OFF);
    }

    start_playing(&quiet);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF), GROBO_OK);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_OFF);
}

TEST_WITH(rig_wirings, exit_takes_the_place_of_a_job_and_is_bounded)
{
    grobo_robot_config config = quiet;
    config.exit_bound_us = 300000;
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 2000);
    int move = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 800000);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(grobo_sim_set_cable(&rig.sim, j, GROBO_SIM_CABLE_MUTE), 0);
    }
    int64_t asked_us = rig.now_us;
    int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF);
    rig_expect(&rig, number, GROBO_ERR_TIMEOUT);
    assert_in_range(rig.now_us - asked_us, 250000, 320000);

    rig_expect(&rig, move, GROBO_ERR_CANCELED);
    /* Without a bound it takes what it takes, from a clock that is not at its beginning. */
    config.exit_bound_us = GROBO_NEVER_US;
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF), GROBO_OK);
}

TEST_WITH(rig_wirings, a_limp_robot_is_not_made_to_sit)
{
    rig_start(&rig, &quiet, NULL);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_SIT), GROBO_OK);
    assert_int_equal(rig.torque_on, 0);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) + 40) < 0.1);
}

/* In free mode a joint that is let go is switched on again: not once the robot has stopped. Here
 * the stop comes out of a reading for which the frame that switches on has to wait. */
TEST_WITH(rig_wirings, nothing_is_switched_on_after_a_trip)
{
    for (int ms = 100; ms < 400; ms++) {
        grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP};
        rig_start(&rig, &quiet, &limp);
        assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), 0);
        rig_run(&rig, ms * 1000);
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, 0, 75), 0);
        rig_wait(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL));
        rig_run(&rig, 100000); /* the rig looks at every frame */
        grobo_trip_info trip;
        grobo_robot_tripped(&rig.robot, &trip);
        assert_true(trip.latched);
    }
}

/* The arm is taught, and a leg holds the robot: it may be hot, and has no less of a battery. */
TEST_WITH(rig_wirings, who_holds_is_watched_while_others_are_taught)
{
    for (int low = 0; low < 2; low++) {
        grobo_trip_info trip;
        rig_start(&rig, &quiet, NULL);
        rig_power(&rig);
        assert_int_equal(grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(NECK), true), 0);
        rig_run(&rig, 5000000);
        if (low) {
            grobo_sim_set_supply(&rig.sim, 5000);
        } else {
            assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 75), 0);
        }
        rig_run(&rig, 1100000); /* each in a second */
        grobo_robot_tripped(&rig.robot, &trip);
        assert_true(trip.latched);
        assert_int_equal(trip.trip, low ? GROBO_TRIP_VOLTAGE : GROBO_TRIP_TEMPERATURE);
    }
}
