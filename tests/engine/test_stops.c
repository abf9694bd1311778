/* SPDX-License-Identifier: MIT */
/* What ends when the robot stops, what must not come on, and when the watch trips. */
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip, other;

static const rig_key sway[] = {{0, {{NECK, 0}}}, {1000, {{NECK, 30}}}, {3000, {{NECK, -30}}}};

static int raw_goal(int id, int tenths, int units)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    grobo_rs30x_goal goal = {(uint8_t)id, (int16_t)tenths, (uint16_t)units};
    int n = grobo_frame_goals(grobo_wiring_protocol(rig_wiring), &goal, 1, frame, sizeof frame);
    assert_true(n > 0);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

static int raw_torque(int id, grobo_torque torque)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_frame_torque(grobo_wiring_protocol(rig_wiring), (uint8_t)id, torque, frame,
                               sizeof frame);
    assert_true(n > 0);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

/* A reading of one joint, with heat, current and voltage. */
static void read_joint(int joint)
{
    int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL);
    rig_expect(&rig, number, GROBO_OK);
}

static grobo_trip tripped(void)
{
    grobo_trip_info info;
    grobo_robot_tripped(&rig.robot, &info);
    return info.trip;
}

/* A frame with a goal that left, at rig.sent[from] or behind. */
static const rig_frame *goal_sent(size_t from)
{
    for (size_t i = from; i < rig.n_sent; i++) {
        const uint8_t *p;
        (void)rig_packet(&rig.sent[i], &p);
        if (p[4] == GROBO_RS30X_GOAL && p[6] > 0) {
            return &rig.sent[i];
        }
    }
    return NULL;
}

/* All joints were moved once, so that the slow first move is behind; the neck is at `deg`. */
static void start_at(double deg)
{
    grobo_posture target;
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    target = rig_posture(&rig, NECK, deg, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    rig_forget(&rig);
}

/* Now and for a second the neck stands still. */
static void expect_rest(void)
{
    double here_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
}

/* ---- the watch ------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, three_low_readings_in_a_row_trip)
{
    rig_start(&rig, &quiet, NULL);
    /* A stop reads those that were never read. */
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINTS_ALL(20), GROBO_SENSE_FULL),
               GROBO_OK);
    for (int i = 0; i < 3; i++) { /* two, and one that is as it should be */
        grobo_sim_set_supply(&rig.sim, 5800);
        read_joint(NECK);
        read_joint(R_KNEE);
        assert_int_equal(tripped(), GROBO_TRIP_NONE);
        grobo_sim_set_supply(&rig.sim, 7400);
        read_joint(CHEST);
    }
    grobo_sim_set_supply(&rig.sim, 5800);
    read_joint(NECK);
    read_joint(R_KNEE);
    assert_int_equal(tripped(), GROBO_TRIP_NONE);
    read_joint(CHEST);
    assert_int_equal(tripped(), GROBO_TRIP_VOLTAGE);
    /* After a reset they are counted anew. */
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    read_joint(NECK);
    read_joint(R_KNEE);
    assert_int_equal(tripped(), GROBO_TRIP_NONE);
    read_joint(CHEST);
    assert_int_equal(tripped(), GROBO_TRIP_VOLTAGE);
}

/* Reads a joint every 100 ms for so long; when it first was above its limit. */
static void read_for(int joint, int64_t us)
{
    int64_t until_us = rig.now_us + us;
    while (rig.now_us < until_us) {
        int64_t next_us = rig.now_us + 100000;
        read_joint(joint);
        rig_run(&rig, next_us - rig.now_us);
    }
}

/* A second of it, without a break: what was before a break does not count. */
TEST_WITH(rig_wirings, current_trips_when_it_was_high_for_a_second)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 800), 0);
        read_for(R_KNEE, 900000);
        assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 0), 0);
        read_joint(R_KNEE);
        assert_int_equal(tripped(), GROBO_TRIP_NONE);
    }
    rig_run(&rig, 2000000);
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 800), 0);
    rig_forget(&rig);
    int64_t high_us = rig.now_us; /* from its first reading on */
    while (tripped() == GROBO_TRIP_NONE && rig.now_us - high_us < 3000000) {
        read_for(R_KNEE, 100000);
    }
    assert_int_equal(tripped(), GROBO_TRIP_CURRENT);
    assert_in_range(rig_last(&rig, GROBO_EVENT_TRIP)->u.trip.at_us - high_us, 1000000, 1130000);
}

/* ---- stopping -------------------------------------------------------------------------------- */

/* The goal waits behind a frame for all joints; the stop comes before it leaves. */
TEST_WITH(rig_wirings, a_stop_cancels_what_waits_for_the_line)
{
    for (int way = 0; way < 3; way++) {
        start_at(0);
        grobo_posture all;
        grobo_posture_init_pose(&all, rig.driver->model);
        all.time_us = 200000;
        assert_int_equal(grobo_robot_send(&rig.robot, &all), GROBO_OK);
        rig_run(&rig, 1000);
        assert_int_equal(rig.n_sent, 1);
        grobo_posture target = rig_posture(&rig, NECK, 40, 5000);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        switch (way) {
        case 0:
            assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
            break;
        case 1:
            assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
            break;
        default:
            assert_true(grobo_robot_estop(&rig.robot) > 0);
            break;
        }
        rig_run(&rig, 500000);
        assert_true(fabs(rig_angle_deg(&rig, NECK)) < 1);
        expect_rest();
    }
}

/* A stop is asked for, and latched at once: what was to stop does, and what is asked for behind the
 * latch does not leave. */
TEST_WITH(rig_wirings, a_latch_lets_a_stop_leave_that_waits)
{
    start_at(-40);
    grobo_posture target = rig_posture(&rig, NECK, 40, 5000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_true(grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL) > 0);
    rig_run(&rig, 2000); /* its first request is out */
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
    assert_int_equal(grobo_robot_latch(&rig.robot), GROBO_OK);
    rig.halts_at_estop = true; /* those from before */
    rig_run(&rig, 200000);
    rig.halts_at_estop = false;
    assert_true(rig_angle_deg(&rig, NECK) < -20);
    expect_rest();
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_LATCHED);
}

/* A servo that does not answer is waited for by whoever asked, not by the stop. */
TEST_WITH(rig_wirings, a_stop_does_not_wait_for_a_silent_servo)
{
    start_at(-40);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
    grobo_posture target = rig_posture(&rig, NECK, 40, 5000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_true(grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_FULL) > 0);
    rig_run(&rig, 8000); /* its request is out */
    rig_forget(&rig);
    int64_t asked_us = rig.now_us;
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
    rig_run(&rig, 15000);
    const rig_frame *halt = goal_sent(0);
    assert_non_null(halt);
    assert_in_range(halt->at_us - asked_us, 0, 10000);
}

/* Nor is a joint thrown back: its goal lies ahead of where it is when the frame gets there, which
 * may be behind a frame for all the others. */
TEST_WITH(rig_wirings, a_stopped_joint_never_goes_back)
{
    for (int ms = 240, busy = 0; ms <= 2000; ms += busy * 220, busy = !busy) {
        start_at(-45);
        grobo_posture target = rig_posture(&rig, NECK, 45, ms);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, ms * 400);
        grobo_posture others;
        grobo_posture_init_pose(&others, rig.driver->model);
        others.set &= ~GROBO_JOINT_BIT(NECK);
        assert_true(!busy || grobo_robot_send(&rig.robot, &others) == GROBO_OK);
        rig_run(&rig, 500);
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
        double asked_deg = rig_angle_deg(&rig, NECK);
        double last_deg = asked_deg;
        for (int t = 0; t < 300; t++) {
            rig_run(&rig, 1000);
            double deg = rig_angle_deg(&rig, NECK);
            assert_true(deg >= last_deg - 0.11);
            last_deg = fmax(deg, last_deg);
        }
        /* 50 ms ahead, at the speed that it had; and that is its rest. */
        assert_true(last_deg - asked_deg <= 90 * 55.0 / ms + 0.2);
        assert_true(last_deg - asked_deg >= 90 * 45.0 / ms - 0.2);
        assert_true(last_deg < 44);
        expect_rest();
    }
}

/* A weak supply: the joint falls back behind a way that it cannot go. It stops where it is. */
TEST_WITH(rig_wirings, a_weak_joint_stops_where_it_is)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = GROBO_SENSE_NEVER, .voltage_mv = -1};
    for (int ms = 300; ms <= 400; ms += 20) {
        rig_start(&rig, &config, NULL);
        rig_power(&rig);
        grobo_posture target = rig_posture(&rig, SHOULDER, -100, 1000);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        grobo_sim_set_supply(&rig.sim, 7400 * 2 / 3);
        target = rig_posture(&rig, SHOULDER, 100, 10);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, ms * 1000);
        read_joint(SHOULDER);
        double then_deg = rig_angle_deg(&rig, SHOULDER);
        assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
        rig_run(&rig, 200000);
        double on_deg = rig_angle_deg(&rig, SHOULDER) - then_deg;
        assert_true(on_deg > 0 && on_deg < 22); /* the way is 56 to 68 degrees further */
        expect_rest();
    }
}

/* A reset makes what begins behind it slow; the end of a motion does not take longer by that. */
TEST_WITH(rig_wirings, a_smooth_stop_is_no_longer_after_a_reset)
{
    static const rig_key leap[] = {
        {0, {{SHOULDER, 100}}}, {100, {{SHOULDER, -100}}}, {4000, {{SHOULDER, -100}}}};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = 30};
    for (int pauses = 0; pauses < 2; pauses++) {
        start_at(0);
        rig_clip_init(&clip, leap, 3);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 200000);
        assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
        assert_int_equal(
            pauses ? grobo_robot_pause(&rig.robot) : grobo_robot_stop(&rig.robot, false), GROBO_OK);
        rig_run(&rig, 300000);
        double here_deg = rig_angle_deg(&rig, SHOULDER);
        rig_run(&rig, 1000000);
        assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - here_deg) < 0.01);
    }
}

/* A joint holds, and is sent on its way, while the same job still verifies others. */
TEST_WITH(rig_wirings, a_joint_sent_while_torque_comes_on_is_stopped_where_it_is)
{
    const grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP, .seed = 7};
    rig_start(&rig, NULL, &limp);
    int number = grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_ON);
    double here_deg = rig_angle_deg(&rig, HIP);
    grobo_posture target = rig_posture(&rig, HIP, here_deg + (here_deg < -60 ? 90 : -90), 3000);
    int result = GROBO_ERR_STATE;
    while (result < 0 && grobo_robot_job(&rig.robot) == GROBO_JOB_TORQUE) {
        rig_run(&rig, 1000);
        result = grobo_robot_send(&rig.robot, &target);
    }
    assert_int_equal(result, GROBO_OK);
    rig_expect(&rig, number, GROBO_OK);
    rig_run(&rig, 200000);
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
    rig_run(&rig, 300000);
    here_deg = rig_angle_deg(&rig, HIP);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, HIP) - here_deg) < 0.01);
}

/* A raw goal for a joint without torque moves nothing, and nothing is there to stop. */
TEST_WITH(rig_wirings, a_stop_sends_no_joint_that_has_no_torque)
{
    start_at(0);
    grobo_joint_mask neck = GROBO_JOINT_BIT(NECK);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, neck, GROBO_TORQUE_BRAKE), GROBO_OK);
    rig_expect(&rig, raw_goal(NECK_ID, 400, 200), GROBO_OK);
    rig_run(&rig, 500000);
    rig_forget(&rig);
    (void)grobo_robot_stop(&rig.robot, true);
    rig_run(&rig, 100000);
    assert_null(goal_sent(0));
}

/* The clip that waited in the queue is gone with the first stop, and stays so. */
TEST_WITH(rig_wirings, a_stop_empties_the_queue)
{
    for (int twice = 0; twice < 3; twice++) {
        grobo_play_progress progress;
        rig_start(&rig, &quiet, NULL);
        rig_power(&rig);
        rig_clip_init(&clip, sway, 3);
        rig_clip_init(&other, sway, 3);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 500000);
        assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), 1);
        assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), 2);
        for (int i = 0; i <= twice; i++) {
            assert_int_equal(grobo_robot_stop(&rig.robot, i == 2), GROBO_OK);
            grobo_robot_progress(&rig.robot, &progress);
            assert_int_equal(progress.queued, 0);
            assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), GROBO_ERR_STATE);
            rig_run(&rig, 30000);
        }
        rig_run(&rig, 1000000);
        assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
        expect_rest();
    }
}

/* ---- trips ----------------------------------------------------------------------------------- */

/* The reading that trips comes while a raw frame waits for the line behind it. */
TEST_WITH(rig_wirings, a_trip_ends_a_raw_job)
{
    int ended = 0;
    for (int us = 0; us < 60000; us += 1000) {
        grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
        rig_start(&rig, &config, NULL);
        rig_power(&rig);
        rig_run(&rig, 100000 + us);
        for (int j = 0; j < 20; j++) {
            assert_int_equal(grobo_sim_set_temperature(&rig.sim, j, 75), 0);
        }
        rig_forget(&rig);
        int number = raw_goal(NECK_ID, 300, 100);
        assert_true(number > 0);
        const grobo_event_job *job = rig_wait(&rig, number);
        bool left = goal_sent(0) != NULL && goal_sent(0)->at_us == rig.sent[0].at_us;
        assert_true(job->result == GROBO_ERR_LATCHED || left);
        ended += job->result == GROBO_ERR_LATCHED;
        rig_run(&rig, 300000);
        assert_int_equal(tripped(), GROBO_TRIP_TEMPERATURE);
        assert_true(fabs(rig_angle_deg(&rig, NECK)) < 5);
        expect_rest();
    }
    assert_true(ended > 0);
}

/* The job itself reads the heat: no torque comes on, the job says why, and the rig looks. */
TEST_WITH(rig_wirings, a_trip_ends_torque_that_comes_on)
{
    int without = 0;
    for (int ms = 0; ms < 400; ms += 7) {
        rig_start(&rig, &quiet, NULL);
        int number = grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_ON);
        rig_run(&rig, ms * 1000);
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 75), 0);
        const grobo_event_job *job = rig_wait(&rig, number);
        if (tripped() == GROBO_TRIP_NONE) {
            assert_int_equal(job->result, GROBO_OK); /* the neck had been read before */
            continue;
        }
        assert_int_equal(job->result, GROBO_ERR_LATCHED);
        assert_int_equal(rig_last(&rig, GROBO_EVENT_TRIP)->u.trip.joint, NECK);
        assert_true(rig_last(&rig, GROBO_EVENT_JOB)->now_us ==
                    rig_last(&rig, GROBO_EVENT_TRIP)->now_us); /* it reads no further */
        rig_run(&rig, 500000);
        without += rig_torque(&rig, NECK) == GROBO_TORQUE_OFF;
    }
    assert_true(without > 0);
}

/* What only switches off goes on: it is on the safe side. */
TEST_WITH(rig_wirings, a_trip_does_not_end_torque_that_goes_off)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 75), 0);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_OFF), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_OFF);
    }
}

/* ---- what others do, and what raw frames do -------------------------------------------------- */

/* A joint on its way by another program's order, nobody knows where to, is left alone. */
TEST_WITH(rig_wirings, a_raw_goal_is_refused_for_a_joint_that_others_move)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 20000,
                                 .lost_replies = -1};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    grobo_event_fn on_event = rig.robot.on_event;
    assert_int_equal(grobo_robot_init(&rig.robot, rig.driver, NULL, &config, rig.now_us), 0);
    rig_host(&rig);
    grobo_robot_on_event(&rig.robot, on_event, &rig);
    grobo_robot_link_up(&rig.robot, rig.now_us);
    rig_run(&rig, 1000000);
    /* The servo does not say how long it takes: it was asked for its speed and angle only. */
    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 45000, 2000000), 0);
    rig_run(&rig, 1000000);
    assert_int_equal(raw_goal(NECK_ID, 250, 100), GROBO_ERR_STATE);
    grobo_posture target = rig_posture(&rig, NECK, 25, 1000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
    rig_run(&rig, 5000000); /* it is at rest again */
    rig_expect(&rig, raw_goal(NECK_ID, 10, 100), GROBO_OK);
}

/* A joint that a raw frame let go does not hold: known at once, before it is read again. */
TEST_WITH(rig_wirings, torque_taken_by_a_raw_frame_is_gone)
{
    static const grobo_torque modes[] = {GROBO_TORQUE_OFF, GROBO_TORQUE_BRAKE};
    for (int i = 0; i < 2; i++) {
        start_at(0);
        rig_expect(&rig, raw_torque(NECK_ID, modes[i]), GROBO_OK);
        grobo_posture target = rig_posture(&rig, NECK, 10, 500);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
        assert_int_equal(raw_torque(NECK_ID, GROBO_TORQUE_ON), GROBO_ERR_STATE);
        rig_run(&rig, 100000);
        assert_int_equal(rig_torque(&rig, NECK), modes[i]);
        read_joint(NECK);
        assert_int_equal(tripped(), GROBO_TRIP_NONE); /* it was asked for */
        rig_power(&rig);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 1000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - 10) < 0.1);
    }
}

/* A frame for all joints takes a second on this line (0.1 s on a bus, whose servos know none as
 * slow), and what is behind it is as late. */
TEST_WITH(rig_wirings, a_move_begins_when_its_frame_leaves)
{
    grobo_robot_config config = quiet;
    bool by_board = rig_wiring == GROBO_WIRING_BOARD;
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .baud_bps = by_board ? 1200 : 9600};
    config.bus.baud_bps = sim.baud_bps;
    rig_start(&rig, &config, &sim);
    rig_power(&rig);
    grobo_posture all;
    grobo_posture_init_pose(&all, rig.driver->model);
    all.time_us = 5000000;
    rig_expect(&rig, grobo_robot_move(&rig.robot, &all), GROBO_OK);
    all.time_us = 100000;
    assert_int_equal(grobo_robot_send(&rig.robot, &all), GROBO_OK);
    rig_run(&rig, 10000);
    grobo_posture target = rig_posture(&rig, NECK, 40, by_board ? 1000 : 200);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    while (grobo_robot_moving(&rig.robot)) {
        rig_run(&rig, 10000);
    }
    assert_true(rig_angle_deg(&rig, NECK) > 30); /* but for the frame's own time */
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 40) < 0.1);
}

/* ---- what fails ------------------------------------------------------------------------------ */

/* A servo whose own limits are narrower than the model's takes no goal beyond them: it is told
 * again, then the motion is given up, and what is on its way is stopped. */
TEST_WITH(rig_wirings, an_approach_that_never_takes_is_given_up)
{
    static const rig_key far[] = {{0, {{NECK, 40}, {R_KNEE, -100}}}, {1000, {{NECK, 0}}}};
    grobo_robot_config config = quiet;
    config.approach_dps = 10;
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_register(&rig.sim, NECK, GROBO_RS30X_CW_LIMIT, 100), 0);
    rig_clip_init(&clip, far, 2);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_ERR_MISMATCH);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    rig_run(&rig, 300000);
    double knee_deg = rig_angle_deg(&rig, R_KNEE);
    assert_true(knee_deg > -95); /* it was on its way, and is stopped */
    rig_run(&rig, 3000000);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) - knee_deg) < 0.01);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 11);
}

static int (*sound_sample)(void *ctx, int64_t t_us, grobo_posture *posture);

static int sample_that_breaks(void *ctx, int64_t t_us, grobo_posture *posture)
{
    return t_us > 40000 && t_us < 900000 ? GROBO_ERR_EMPTY : sound_sample(ctx, t_us, posture);
}

/* What it asks for is more than a joint can do, so that one is still on its way when the clip
 * breaks: it is stopped there, as by a stop. */
TEST_WITH(rig_wirings, a_clip_that_breaks_stops_the_robot)
{
    static const rig_key jump[] = {{0, {{NECK, -45}}}, {33, {{NECK, 45}}}, {1000, {{NECK, 45}}}};
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 30};
    start_at(-45);
    rig_clip_init(&clip, jump, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    sound_sample = clip.clip.sample;
    clip.clip.sample = sample_that_breaks;
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_FAILED);
    assert_int_equal(rig_last(&rig, GROBO_EVENT_PLAY)->u.play.error, GROBO_ERR_EMPTY);
    assert_true(rig_angle_deg(&rig, NECK) > -45);
    rig_run(&rig, 200000);
    assert_in_range(rig_angle_deg(&rig, NECK) + 45, 1, 60);
    expect_rest();
}

/* A move beside it is not done where it was stopped, nor does a raw goal leave that waits. */
TEST_WITH(rig_wirings, a_clip_that_breaks_ends_what_moves_beside_it)
{
    static const rig_key stay[] = {{0, {{NECK, -45}}}, {2000, {{NECK, -45}}}};
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE, .rate_hz = 20};
    for (int commands = 0; commands < 2; commands++) {
        start_at(-45);
        rig_clip_init(&clip, stay, 2);
        clip.only = GROBO_JOINT_BIT(NECK);
        sound_sample = clip.clip.sample;
        clip.clip.sample = sample_that_breaks;
        options.from_us = commands ? 1000000 : 0;
        options.reverse = !commands; /* it breaks after 1.1 s, or under a command */
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        grobo_posture target = rig_posture(&rig, R_ELBOW, -60, 3000);
        int beside = grobo_robot_move(&rig.robot, &target);
        rig_run(&rig, commands ? 500000 : 1080000);
        rig.robot.bus.free_us += 100000; /* the line is taken */
        int raw = raw_goal(rig.driver->model->joints[SHOULDER].motor, 0, 100);
        assert_true(!commands || grobo_robot_seek(&rig.robot, 100000) == GROBO_ERR_EMPTY);
        rig_expect(&rig, beside, GROBO_ERR_CANCELED);
        rig_expect(&rig, raw, GROBO_ERR_CANCELED);
        rig_run(&rig, 500000);
        double here_deg = rig_angle_deg(&rig, R_ELBOW);
        rig_run(&rig, 3000000);
        assert_true(here_deg > -59 && fabs(rig_angle_deg(&rig, R_ELBOW) - here_deg) < 0.01);
    }
}

static unsigned goals_left; /* before the driver fails */
static int (*sound_posture)(const grobo_driver *self, void *ctx, const grobo_target *target,
                            int part, grobo_exchange *exchange);

static int posture_that_fails(const grobo_driver *self, void *ctx, const grobo_target *target,
                              int part, grobo_exchange *exchange)
{
    if (part == 0 && goals_left == 0) {
        return GROBO_ERR_SPACE;
    }
    goals_left -= part == 0;
    return sound_posture(self, ctx, target, part, exchange);
}

/* The job ends with the driver's reason, and nothing more moves. */
TEST_WITH(rig_wirings, a_target_that_makes_no_frame_ends_what_asked_for_it)
{
    for (int way = 0; way < 3; way++) {
        grobo_driver driver = *grobo_gr001_driver(rig_wiring);
        grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                      .rate_hz = 20};
        sound_posture = driver.posture;
        driver.posture = posture_that_fails;
        goals_left = UINT_MAX;
        rig_start_driver(&rig, &driver, &quiet, NULL);
        rig_power(&rig);
        grobo_posture target = rig_posture(&rig, NECK, 10, 500);
        switch (way) {
        case 0:
            goals_left = 0;
            rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_ERR_SPACE);
            break;
        case 1:
            goals_left = 0;
            assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_SPACE);
            break;
        default:
            rig_clip_init(&clip, sway, 3);
            rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), 0);
            rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
            goals_left = 10;
            rig_wait_play(&rig, GROBO_SEQUENCER_FAILED);
            assert_int_equal(rig_last(&rig, GROBO_EVENT_PLAY)->u.play.error, GROBO_ERR_SPACE);
            break;
        }
        rig_run(&rig, 100000);
        rig_forget(&rig);
        expect_rest();
        assert_null(goal_sent(0));
        goals_left = UINT_MAX; /* the robot is not lost for it */
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - 10) < 0.1);
    }
}
