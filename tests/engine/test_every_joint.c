/* SPDX-License-Identifier: MIT */
/* Each rule holds for each joint, and for that one alone. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { JOINTS = 20 };

static grobo_test_rig rig;

static const grobo_joint *joint_of(int joint)
{
    return &rig.driver->model->joints[joint];
}

static double middle_deg(int joint)
{
    const grobo_joint *limits = joint_of(joint);
    return round(grobo_deg_from_rad(limits->min_rad + limits->max_rad) / 2);
}

static int raw_goal(int joint, double deg, int time_ms)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    grobo_rs30x_goal goal = {(uint8_t)joint_of(joint)->motor, (int16_t)lround(deg * 10),
                             (uint16_t)(time_ms / 10)};
    int n = grobo_frame_goals(grobo_wiring_protocol(rig_wiring), &goal, 1, frame, sizeof frame);
    assert_true(n > 0);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

static int raw_torque(int joint, grobo_torque torque)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    int n = grobo_frame_torque(grobo_wiring_protocol(rig_wiring), (uint8_t)joint_of(joint)->motor,
                               torque, frame, sizeof frame);
    assert_true(n > 0);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

static int send(int joint, double deg, int time_ms)
{
    grobo_posture target = rig_posture(&rig, joint, deg, time_ms);
    return grobo_robot_send(&rig.robot, &target);
}

static grobo_posture middle(void)
{
    grobo_posture target;
    assert_int_equal(grobo_posture_init(&target, JOINTS), 0);
    for (int j = 0; j < JOINTS; j++) {
        assert_int_equal(grobo_posture_set_deg(&target, j, middle_deg(j)), 0);
    }
    target.time_us = 1000000;
    return target;
}

/* All joints hold in the middle of their ranges, and the slow first move is behind. */
static void start_in_the_middle(const grobo_robot_config *config)
{
    rig_start(&rig, config, NULL);
    rig_power(&rig);
    grobo_posture target = middle();
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    rig_forget(&rig);
}

static void expect_others_stay(int joint)
{
    for (int j = 0; j < JOINTS; j++) {
        assert_true(j == joint || fabs(rig_angle_deg(&rig, j) - middle_deg(j)) < 0.06);
    }
}

/* ---- who may be moved ------------------------------------------------------------------------ */

TEST(one_that_was_not_read_is_not_moved)
{
    for (int j = 0; j < JOINTS; j++) {
        double value;
        rig_start(&rig, &quiet, NULL);
        rig_expect(
            &rig,
            grobo_robot_sense(&rig.robot, rig_all(&rig) & ~GROBO_JOINT_BIT(j), GROBO_SENSE_ALL),
            GROBO_OK);
        assert_int_equal(send(j, middle_deg(j), 5000), GROBO_ERR_STALE);
        assert_int_equal(grobo_robot_fault(&rig.robot, &value), j);
        assert_int_equal(raw_goal(j, middle_deg(j), 5000), GROBO_ERR_STALE);
        assert_int_equal(raw_torque(j, GROBO_TORQUE_ON), GROBO_ERR_STALE);
        for (int k = 0; k < JOINTS; k++) { /* the others were read, but do not hold */
            assert_true(k == j || send(k, middle_deg(k), 5000) == GROBO_ERR_STATE);
        }
    }
}

TEST(one_without_torque_is_not_sent_anywhere)
{
    start_in_the_middle(&quiet);
    for (int j = 0; j < JOINTS; j++) {
        rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_OFF),
                   GROBO_OK);
        for (int k = 0; k < JOINTS; k++) {
            assert_int_equal(send(k, middle_deg(k), 500), k == j ? GROBO_ERR_STATE : GROBO_OK);
            rig_run(&rig, 5000);
            assert_int_equal(rig_torque(&rig, k), k == j ? GROBO_TORQUE_OFF : GROBO_TORQUE_ON);
        }
        assert_int_equal(raw_torque(j, GROBO_TORQUE_ON), GROBO_ERR_STATE);
        rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_ON),
                   GROBO_OK);
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_ON);
    }
}

TEST(one_that_a_raw_frame_let_go_does_not_hold)
{
    start_in_the_middle(&quiet);
    for (int j = 0; j < JOINTS; j++) {
        rig_expect(&rig, raw_torque(j, GROBO_TORQUE_BRAKE), GROBO_OK);
        for (int k = 0; k < JOINTS; k++) {
            assert_int_equal(send(k, middle_deg(k), 500), k == j ? GROBO_ERR_STATE : GROBO_OK);
            rig_run(&rig, 5000);
        }
        rig_power(&rig);
    }
}

TEST(one_alone_is_switched_on_where_it_is)
{
    for (int j = 0; j < JOINTS; j++) {
        grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .seed = (uint32_t)j,
                                 .start = GROBO_SIM_START_LIMP};
        rig_start(&rig, &quiet, &limp);
        rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_ON),
                   GROBO_OK);
        for (int k = 0; k < JOINTS; k++) {
            assert_int_equal(rig_torque(&rig, k), k == j ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
        }
        assert_int_equal(rig.torque_on, 1);
    }
}

/* ---- limits and speed ------------------------------------------------------------------------ */

TEST(each_goes_to_its_limits_and_not_beyond)
{
    start_in_the_middle(&quiet);
    for (int j = 0; j < JOINTS; j++) {
        const double ends_deg[] = {grobo_deg_from_rad(joint_of(j)->min_rad),
                                   grobo_deg_from_rad(joint_of(j)->max_rad)};
        for (int end = 0; end < 2; end++) {
            double beyond_deg = ends_deg[end] + (end == 0 ? -0.2 : 0.2);
            double value = 0;
            assert_int_equal(send(j, beyond_deg, 1000), GROBO_ERR_LIMIT);
            assert_int_equal(grobo_robot_fault(&rig.robot, &value), j);
            assert_true(fabs(value - beyond_deg) < 1e-9);
            if (fabs(beyond_deg) < 150) { /* the wire has no more */
                assert_int_equal(raw_goal(j, beyond_deg, 1000), GROBO_ERR_LIMIT);
            }
            assert_int_equal(send(j, ends_deg[end], 1000), GROBO_OK);
            rig_run(&rig, 1100000);
            assert_true(fabs(rig_angle_deg(&rig, j) - ends_deg[end]) < 0.06);
        }
        assert_int_equal(send(j, middle_deg(j), 1000), GROBO_OK);
        rig_run(&rig, 1100000);
        expect_others_stay(-1);
    }
}

/* In units of 10 ms, up; what the wire's rounding may add is not held against it. */
static int least_ms(int joint, double way_deg, double most_dps)
{
    double most = fmin(most_dps, grobo_deg_from_rad(joint_of(joint)->max_speed_rad_s));
    return (int)(ceil((way_deg - 0.1) / most * 100 - 1e-9) * 10);
}

TEST(each_gets_the_time_that_it_needs)
{
    for (int pct = 40; pct <= 100; pct += 60) {
        grobo_robot_config config = quiet;
        config.speed_limit_pct = pct;
        start_in_the_middle(&config);
        uint64_t stretched = grobo_robot_get_counters(&rig.robot)->stretched;
        for (int j = 0; j < JOINTS; j++) {
            double most_dps = grobo_deg_from_rad(joint_of(j)->max_speed_rad_s) * pct / 100;
            for (int way_deg = 6; way_deg <= 10; way_deg += 4) {
                int needed_ms = least_ms(j, way_deg, most_dps);
                int id = joint_of(j)->motor;
                assert_int_equal(send(j, middle_deg(j) + way_deg, needed_ms), GROBO_OK);
                rig_run(&rig, 200000);
                assert_int_equal(rig_sent_ms(&rig, id), needed_ms);
                assert_int_equal(grobo_robot_get_counters(&rig.robot)->stretched, stretched);
                assert_int_equal(send(j, middle_deg(j), needed_ms - 10), GROBO_OK);
                rig_run(&rig, 200000);
                assert_int_equal(rig_sent_ms(&rig, id), needed_ms);
                assert_int_equal(grobo_robot_get_counters(&rig.robot)->stretched, ++stretched);
                rig_forget(&rig);
            }
        }
    }
}

/* A raw frame is as it is: in time or refused. */
TEST(a_raw_goal_must_leave_each_its_time)
{
    start_in_the_middle(&quiet);
    for (int j = 0; j < JOINTS; j++) {
        double most_dps = grobo_deg_from_rad(joint_of(j)->max_speed_rad_s);
        double value;
        int needed_ms = least_ms(j, 9, most_dps);
        assert_int_equal(raw_goal(j, middle_deg(j) + 9, needed_ms - 10), GROBO_ERR_SPEED);
        assert_int_equal(grobo_robot_fault(&rig.robot, &value), j);
        rig_expect(&rig, raw_goal(j, middle_deg(j) + 9, needed_ms), GROBO_OK);
        rig_run(&rig, 200000);
        assert_true(fabs(rig_angle_deg(&rig, j) - middle_deg(j) - 9) < 0.06);
        rig_expect(&rig, raw_goal(j, middle_deg(j), needed_ms), GROBO_OK);
        rig_run(&rig, 200000);
        expect_others_stay(-1);
    }
}

/* From the second move on, in a move all arrive together: with the one that needs longest. */
TEST(in_a_move_all_take_the_longest_time)
{
    start_in_the_middle(&quiet);
    for (int slow = 0; slow < JOINTS; slow++) {
        grobo_posture target = middle();
        double most_dps = grobo_deg_from_rad(joint_of(slow)->max_speed_rad_s);
        for (int j = 0; j < JOINTS; j++) {
            double by_deg = slow % 2 == 0 ? 1 : -1;
            assert_int_equal(
                grobo_posture_set_deg(&target, j, middle_deg(j) + (j == slow ? 9 : 1) * by_deg), 0);
        }
        target.time_us = 10000;
        rig_forget(&rig);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        const uint8_t *p = NULL;
        for (size_t i = 0; i < rig.n_sent; i++) {
            const uint8_t *at;
            if (rig_packet(&rig.sent[i], &at) > 30 && at[4] == GROBO_RS30X_GOAL) {
                p = at;
            }
        }
        assert_non_null(p);
        assert_int_equal(p[6], JOINTS);
        for (int k = 0; k < JOINTS; k++) {
            const uint8_t *entry = p + 7 + k * p[5];
            assert_int_equal((entry[3] | entry[4] << 8) * 10, least_ms(slow, 9, most_dps));
        }
        target = middle();
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    }
}

/* ---- bounds of the watch --------------------------------------------------------------------- */

static grobo_joint_state read_state(int joint)
{
    grobo_joint_info info;
    int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL);
    rig_expect(&rig, number, GROBO_OK);
    assert_int_equal(grobo_robot_joint(&rig.robot, joint, &info), 0);
    return info.state;
}

/* Reads on for 1.5 s with these bounds. */
static grobo_trip tripped_by(const grobo_robot_config *config)
{
    grobo_trip_info trip;
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    assert_int_equal(grobo_robot_configure(&rig.robot, config), GROBO_OK);
    for (int i = 0; i < 15; i++) {
        (void)read_state(R_KNEE);
        rig_run(&rig, 100000);
    }
    grobo_robot_tripped(&rig.robot, &trip);
    return trip.trip;
}

TEST(what_is_at_its_bound_is_within)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 300), 0);
    const grobo_joint_state now = read_state(R_KNEE);
    for (int past = 0; past < 2; past++) {
        grobo_robot_config config = quiet;
        config.current_ma = now.current_ma - past;
        assert_int_equal(tripped_by(&config), past ? GROBO_TRIP_CURRENT : GROBO_TRIP_NONE);
        config = quiet;
        config.voltage_mv = now.voltage_mv + past;
        assert_int_equal(tripped_by(&config), past ? GROBO_TRIP_VOLTAGE : GROBO_TRIP_NONE);
        config = quiet;
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 50.5), 0);
        config.temperature_c = read_state(R_KNEE).temperature_c - past;
        assert_int_equal(tripped_by(&config), past ? GROBO_TRIP_TEMPERATURE : GROBO_TRIP_NONE);
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 25), 0);
    }
    grobo_robot_config cold = quiet; /* the least that there is */
    cold.temperature_c = 1;
    assert_int_equal(tripped_by(&cold), GROBO_TRIP_TEMPERATURE);
    const grobo_robot_config nothing = {
        GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER,
        .current_ma = -1,        .voltage_mv = -1,
        .temperature_c = -1,     .lost_replies = -1};
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 900), 0);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 69), 0);
    assert_int_equal(tripped_by(&nothing), GROBO_TRIP_NONE);
}

/* So many in a row of one joint, while something moves. */
TEST(lost_replies_are_counted)
{
    for (int limit = 1; limit <= 4; limit++) {
        grobo_robot_config config = quiet;
        grobo_trip_info trip;
        config.lost_replies = limit;
        config.retries = -1;
        start_in_the_middle(&config);
        assert_int_equal(send(NECK, middle_deg(NECK) + 5, 60000), GROBO_OK);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
        for (int i = 1; i <= limit; i++) {
            grobo_robot_tripped(&rig.robot, &trip);
            assert_int_equal(trip.trip, GROBO_TRIP_NONE);
            (void)rig_wait(
                &rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_FULL));
        }
        grobo_robot_tripped(&rig.robot, &trip);
        assert_int_equal(trip.trip, GROBO_TRIP_LOST_REPLIES);
        assert_int_equal(trip.joint, R_KNEE);
        assert_true(trip.value == limit);
    }
}

/* ---- stopping and watching ------------------------------------------------------------------- */

TEST(each_is_stopped_where_it_is)
{
    start_in_the_middle(&quiet);
    for (int j = 0; j < JOINTS; j++) {
        assert_int_equal(send(j, middle_deg(j) + 9, 3000), GROBO_OK);
        rig_run(&rig, 1000000);
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
        rig_run(&rig, 300000);
        double gone_deg = rig_angle_deg(&rig, j) - middle_deg(j);
        assert_true(gone_deg > 2.8 && gone_deg < 3.4);
        assert_false(grobo_robot_moving(&rig.robot));
        rig_run(&rig, 1000000);
        assert_true(fabs(rig_angle_deg(&rig, j) - middle_deg(j) - gone_deg) < 0.01);
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_ERR_STATE);
        assert_int_equal(send(j, middle_deg(j), 500), GROBO_OK);
        rig_run(&rig, 600000);
        expect_others_stay(-1);
    }
}

/* One that moves is let go when it stands: else it would fly on. */
TEST(each_is_let_go_where_it_stands)
{
    for (int j = 0; j < JOINTS; j++) {
        start_in_the_middle(&quiet);
        assert_int_equal(send(j, middle_deg(j) + 9, 500), GROBO_OK);
        rig_run(&rig, 200000);
        int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF);
        double before_deg = 0;
        while (rig_torque(&rig, j) == GROBO_TORQUE_ON) {
            before_deg = rig_angle_deg(&rig, j);
            rig_run(&rig, 2000);
        }
        assert_true(fabs(rig_angle_deg(&rig, j) - before_deg) < 0.01);
        rig_expect(&rig, number, GROBO_OK);
    }
}

TEST(a_trip_names_the_joint)
{
    for (int j = 0; j < JOINTS; j++) {
        for (int what = 0; what < 3; what++) {
            static const grobo_trip reasons[] = {GROBO_TRIP_TEMPERATURE, GROBO_TRIP_TORQUE_LOST,
                                                 GROBO_TRIP_LOST_REPLIES};
            static const grobo_robot_config watching = {GROBO_ROBOT_CONFIG_INIT,
                                                        .sense_interval_us = 100000};
            rig_start(&rig, &watching, NULL);
            rig_power(&rig);
            if (what == 0) {
                assert_int_equal(grobo_sim_set_temperature(&rig.sim, j, 70), 0);
            } else if (what == 1) {
                assert_int_equal(grobo_sim_set_register(&rig.sim, j, GROBO_RS30X_TORQUE, 0), 0);
            } else {
                int mover = j == NECK ? CHEST : NECK;
                assert_int_equal(grobo_sim_set_cable(&rig.sim, j, GROBO_SIM_CABLE_MUTE), 0);
                assert_int_equal(send(mover, middle_deg(mover) + 1, 20000), GROBO_OK);
            }
            rig_run(&rig, 4000000);
            assert_int_equal(rig_count(&rig, GROBO_EVENT_TRIP), 1);
            assert_int_equal(grobo_robot_get_counters(&rig.robot)->trips, 1);
            const grobo_trip_info *trip = &rig_last(&rig, GROBO_EVENT_TRIP)->u.trip;
            assert_int_equal(trip->trip, reasons[what]);
            assert_int_equal(trip->joint, j);
            assert_true(trip->latched);
        }
    }
}
