/* SPDX-License-Identifier: MIT */
/* The engine's jobs on a robot without faults. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

TEST_WITH(rig_wirings, check_is_answered)
{
    rig_start(&rig, &quiet, NULL);
    rig_expect(&rig, grobo_robot_check(&rig.robot), GROBO_OK);
    assert_int_equal(rig.n_sent, 1);
    if (rig_wiring == GROBO_WIRING_BOARD) {
        assert_memory_equal(rig.sent[0].bytes, "\x41\x00", 2);
    }
}

TEST_WITH(rig_wirings, one_job_at_a_time)
{
    rig_start(&rig, &quiet, NULL);
    int number = grobo_robot_check(&rig.robot);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_CHECK);
    assert_int_equal(grobo_robot_check(&rig.robot), GROBO_ERR_STATE);
    rig_expect(&rig, number, GROBO_OK);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_NONE);
}

TEST_WITH(rig_wirings, all_joints_are_sensed)
{
    grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP, .seed = 7};
    rig_start(&rig, &quiet, &limp);
    int number = grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_OK);
    assert_true(job->failed == 0);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_JOINT), 20);
    for (int j = 0; j < 20; j++) {
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&rig.robot, j, &info), 0);
        assert_int_equal(info.status, GROBO_OK);
        assert_true(fabs(grobo_deg_from_rad(info.state.angle_rad) - rig_angle_deg(&rig, j)) <
                    0.051);
        assert_true(info.torque_known && info.state.torque == GROBO_TORQUE_OFF);
        assert_in_range(info.state.voltage_mv, 7000, 7500);
        assert_in_range(info.angle_age_us, 0, 300000);
        assert_false(info.has_target);
    }
}

TEST_WITH(rig_wirings, torque_comes_on_where_the_joints_are)
{
    grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP, .seed = 3,
                             .jump_on_torque = true};
    double before_deg[20];
    rig_start(&rig, &quiet, &limp);
    for (int j = 0; j < 20; j++) {
        before_deg[j] = rig_angle_deg(&rig, j);
    }
    rig_power(&rig);
    rig_run(&rig, 500000);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_ON);
        assert_true(fabs(rig_angle_deg(&rig, j) - before_deg[j]) < 0.1);
    }
    assert_int_equal(rig.torque_on, 20);
}

TEST_WITH(rig_wirings, torque_goes_off_and_brakes_by_group)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, 0x3, GROBO_TORQUE_OFF), 0);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, 0x4, GROBO_TORQUE_BRAKE), 0);
    assert_int_equal(rig_torque(&rig, 0), GROBO_TORQUE_OFF);
    assert_int_equal(rig_torque(&rig, 1), GROBO_TORQUE_OFF);
    assert_int_equal(rig_torque(&rig, 2), GROBO_TORQUE_BRAKE);
    assert_int_equal(rig_torque(&rig, 3), GROBO_TORQUE_ON);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP));
}

TEST_WITH(rig_wirings, move_arrives_in_its_time)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture first = rig_posture(&rig, 13, 0, 100);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &first), GROBO_OK);
    rig_forget(&rig);
    grobo_posture target = rig_posture(&rig, 13, 30, 500);
    int64_t begun_us = rig.now_us;
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_in_range(rig.now_us - begun_us, 500000, 620000);
    assert_true(fabs(rig_angle_deg(&rig, 13) - 30) < 0.1);
    assert_true(rig_packet_was_sent(&rig, "\xFA\xAF\x02\x00\x1E\x04\x01\x2C\x01\x32\x00\x06", 12));
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(&rig.robot, 13, &info), 0);
    assert_true(info.has_target && fabs(grobo_deg_from_rad(info.target_rad) - 30) < 1e-9);
}

TEST_WITH(rig_wirings, move_switches_torque_on)
{
    rig_start(&rig, &quiet, NULL);
    grobo_posture target;
    grobo_posture_init_pose(&target, rig.driver->model);
    target.time_us = 300000;
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_ON);
        double want_deg = grobo_deg_from_rad(rig.driver->model->joints[j].init_rad);
        assert_true(fabs(rig_angle_deg(&rig, j) - want_deg) < 0.1);
    }
}

TEST_WITH(rig_wirings, manual_torque_is_left_to_the_caller)
{
    grobo_robot_config config = quiet;
    config.manual_torque = true;
    rig_start(&rig, &config, NULL);
    grobo_posture target = rig_posture(&rig, 13, 5, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_ERR_STATE);
    assert_int_equal(rig_torque(&rig, 13), GROBO_TORQUE_OFF);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
}

TEST_WITH(rig_wirings, a_loop_of_ones_own_sends_targets)
{
    rig_start(&rig, &quiet, NULL);
    grobo_posture target = rig_posture(&rig, 13, 30, 20);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STALE);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
    rig_power(&rig);
    rig_forget(&rig);
    for (int i = 0; i < 50; i++) { /* 30 degrees at 60 deg/s, whatever is asked */
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 20000);
        assert_true(rig_angle_deg(&rig, 13) < (i + 1) * 0.02 * 60 + 0.3);
    }
    rig_run(&rig, 20000);
    assert_true(fabs(rig_angle_deg(&rig, 13) - 30) < 0.5);
    target = rig_posture(&rig, 13, -30, 20); /* from now on as fast as the servo */
    for (int i = 0; i < 12; i++) {
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 20000);
    }
    assert_true(fabs(rig_angle_deg(&rig, 13) + 30) < 0.5);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_JOB), 0);
    target = rig_posture(&rig, 13, -60, 20);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_LIMIT);
}

/* Nothing is sent again before it is known to have been lost. */
TEST_WITH(rig_wirings, a_move_that_could_not_be_read_back_is_read_again)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, 0, -60, 500);
    int number = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 900000);
    rig_forget(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, 0, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 300000); /* 60 degrees at 60 deg/s are over */
    assert_int_equal(grobo_sim_set_cable(&rig.sim, 0, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(rig.n_sent > 3);
    for (size_t i = 0; i < rig.n_sent; i++) {
        const uint8_t *bytes = rig.sent[i].bytes;
        assert_int_equal(bytes[bytes[0] == 0xFA ? 3 : 5], GROBO_RS30X_WANT_GIVEN);
    }
}

/* Whoever turns a joint round while a reading is on the wire: the frame leaves when that is over,
 * and the joint has gone on meanwhile. The rig looks at each frame as it leaves. */
TEST_WITH(rig_wirings, a_target_that_waits_for_the_line_is_no_faster)
{
    grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    rig_start(&rig, &busy, NULL);
    rig_power(&rig);
    for (int i = 0; i < 300; i++) {
        grobo_posture target = rig_posture(&rig, 0, i % 2 == 0 ? 30 : -150, 10);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 60000 + i % 7 * 1000);
    }
}

TEST_WITH(rig_wirings, bus_wiring_does_the_same)
{
    rig_start_driver(&rig, grobo_gr001_driver(GROBO_WIRING_BUS), &quiet, NULL);
    rig_expect(&rig, grobo_robot_check(&rig.robot), GROBO_OK);
    grobo_posture target = rig_posture(&rig, 19, 40, 300);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, 19) - 40) < 0.1);
}
