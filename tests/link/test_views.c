/* SPDX-License-Identifier: MIT */
/* The views of the engine, gr001.h and hrpsys.h, on a robot that runs: on its runner's thread. */
#include <string.h>

#include <grobo/core/gr001.h>
#include <grobo/core/hrpsys.h>
#include <grobo/core/runner.h>

#include "tests/support/test.h"

enum { NECK = 13, NECK_ID = 2 };

static grobo_runner *runner;
static grobo_hrpsys hrpsys;

static int set_up(void)
{
    static const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                             .sense_interval_us = GROBO_SENSE_NEVER};
    const grobo_runner_config config = {
        GROBO_RUNNER_CONFIG_INIT, .session = &(grobo_session_config){
                                      GROBO_SESSION_CONFIG_INIT, .device = "sim", .robot = &robot}};
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    return 0;
}

static int tear_down(void)
{
    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

/* Does something with the engine on the thread that runs it, and waits until it is done. */
typedef int (*engine_fn)(grobo_robot *robot);

static int on_engine(void *arg, grobo_runner *from)
{
    grobo_session *session = grobo_runner_session(from);
    const engine_fn *fn = arg;
    int result = (*fn)(grobo_session_robot(session));
    return result;
}

static int engine(engine_fn fn)
{
    int result = grobo_runner_call(runner, on_engine, &fn);
    assert_int_equal(grobo_runner_wait(runner, 0), GROBO_OK);
    return result;
}

/* Reads until the neck is there: the last frame takes its time on the line. */
static void assert_neck_comes_to(int angle_ddeg)
{
    double angle_rad = -99;
    for (int i = 0; i < 200 && !(grobo_ddeg_from_rad(angle_rad) >= angle_ddeg - 5); i++) {
        assert_int_equal(grobo_runner_read_angle(runner, NECK, &angle_rad, 0), GROBO_OK);
    }
    assert_in_range(grobo_ddeg_from_rad(angle_rad), angle_ddeg - 5, angle_ddeg + 5);
}

static int arms_on(grobo_robot *robot)
{
    return grobo_gr001_servo(robot, GROBO_GR001_ARMS, GROBO_TORQUE_ON);
}

static int neck_to_twelve(grobo_robot *robot)
{
    return grobo_gr001_move(robot, NECK_ID, 120, 20);
}

TEST_WITH(fixture, a_motor_moves_by_its_number)
{
    grobo_posture posture;
    assert_true(engine(arms_on) > 0);
    assert_int_equal(grobo_runner_read_posture(runner, &posture, 0), 20);
    assert_int_equal(grobo_runner_get_servo_state(runner, 14), GROBO_TORQUE_ON);
    assert_int_equal(grobo_runner_get_servo_state(runner, NECK), GROBO_TORQUE_OFF);
    assert_true(engine(neck_to_twelve) > 0);
    assert_neck_comes_to(120);
}

static int hrpsys_on(grobo_robot *robot)
{
    grobo_hrpsys_init(&hrpsys, robot);
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 100000), GROBO_OK);
    return grobo_hrpsys_servo_name(&hrpsys, "all", true);
}

static int hrpsys_step(grobo_robot *robot)
{
    double angle_rad[20];
    (void)robot;
    int known = grobo_hrpsys_read_joint_angles(&hrpsys, GROBO_NEVER_US, angle_rad, 20);
    assert_int_equal(known, 20);
    angle_rad[NECK] = grobo_rad_from_deg(5);
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, angle_rad, 20), GROBO_OK);
    return grobo_hrpsys_one_step(&hrpsys);
}

TEST_WITH(fixture, a_step_moves_as_hrpsys_does)
{
    assert_true(engine(hrpsys_on) > 0);
    assert_int_equal(engine(hrpsys_step), GROBO_OK);
    assert_neck_comes_to(50);
}
