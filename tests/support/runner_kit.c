/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

#include <grobo/core/robot.h>

#include "src/link/runner/runner.h"
#include "tests/support/folder.h"
#include "tests/support/runner_kit.h"

grobo_runner *runner;

static void make(grobo_runner_config config)
{
    /* No test here is of a late host: a busy machine ends no motion. */
    const grobo_robot_config patient = {GROBO_ROBOT_CONFIG_INIT, .stall_us = 30000000};
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                          .baud_bps = 1000000, .robot = &patient};

    config.session = &session;
    assert_int_equal(grobo_runner_new(&config, &runner), GROBO_OK);
}

int runner_set_up(void)
{
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .motion_dir = folder};

    (void)folder_set_up();
    make(config);
    return 0;
}

int runner_set_up_threaded(void)
{
    (void)runner_set_up();
    assert_int_equal(grobo_runner_start(runner), GROBO_OK);
    return 0;
}

int runner_tear_down(void)
{
    static const char *const files[] = {"Motion1.m", "Motion2.m", "a.m",   "a.yaml",
                                        "a.pseq",    "a.mseq",    "bad.m", "b.yaml"};

    assert_int_equal(grobo_runner_free(runner), GROBO_OK);
    folder_remove(files, sizeof files / sizeof files[0]);
    return 0;
}

const test_fixture with_and_without_thread[2] = {
    {NULL, runner_set_up, runner_tear_down},
    {"threaded", runner_set_up_threaded, runner_tear_down}};

void runner_come_up(void)
{
    assert_int_equal(grobo_runner_connect(runner, 0), GROBO_OK);
    assert_true(grobo_runner_is_connected(runner));
}

void runner_have_motion(int n)
{
    grobo_motion *motion;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion), GROBO_OK);
    assert_int_equal(grobo_posture_init(&posture, 20), GROBO_OK);
    posture.set = EVERY_JOINT;
    posture.time_us = 40000;
    for (int i = 1; i <= n; i++) {
        assert_int_equal(grobo_posture_set_deg(&posture, ELBOW, 2.0 * i), GROBO_OK);
        assert_int_equal(grobo_motion_append(motion, &posture), GROBO_OK);
    }
    assert_int_equal(grobo_runner_set_motion(runner, motion), n);
    grobo_motion_free(motion);
}

grobo_motion *runner_motion(grobo_runner *of)
{
    grobo_motion *motion = NULL;

    grobo_i_runner_lock(of);
    int r = grobo_motion_dup(of->motion, &motion);
    grobo_i_runner_unlock(of);
    assert_int_equal(r, GROBO_OK);
    return motion;
}

int runner_motion_size(grobo_runner *of)
{
    grobo_motion *motion = runner_motion(of);
    int n = (int)grobo_motion_size(motion);

    grobo_motion_free(motion);
    return n;
}

bool runner_plays(grobo_runner *of)
{
    grobo_i_runner_lock(of);
    bool plays = of->play != PLAY_NONE;
    grobo_i_runner_unlock(of);
    return plays;
}

bool runner_moves(grobo_runner *of)
{
    const grobo_robot *robot = grobo_runner_robot(of);

    return runner_plays(of) || grobo_robot_moving(robot) ||
           grobo_robot_job(robot) == GROBO_JOB_MOVE;
}

int runner_torque(grobo_runner *of, grobo_joint_mask joints, grobo_torque mode, int64_t timeout_us)
{
    return grobo_runner_torque(of, joints, mode, timeout_us);
}

static int ask_check(void *arg, grobo_runner *of)
{
    (void)arg;
    return grobo_robot_check(grobo_runner_robot(of));
}

int runner_check(grobo_runner *of, int64_t timeout_us)
{
    return grobo_runner_request(of, ask_check, NULL, timeout_us);
}

int runner_torque_of(grobo_runner *of, int joint)
{
    grobo_joint_info info;

    assert_int_equal(grobo_robot_joint(grobo_runner_robot(of), joint, &info), GROBO_OK);
    return info.torque_known ? (int)info.state.torque : GROBO_ERR_EMPTY;
}

int runner_move_elbow(grobo_runner *of, double angle_deg, int64_t time_us)
{
    grobo_posture target;

    (void)grobo_posture_init(&target, 20);
    (void)grobo_posture_set_deg(&target, ELBOW, angle_deg);
    target.time_us = time_us;
    return grobo_robot_move(grobo_runner_robot(of), &target);
}

int runner_go_to_zero(grobo_runner *of)
{
    grobo_posture target;

    (void)grobo_posture_init(&target, 20);
    target.set = EVERY_JOINT;
    return grobo_robot_move(grobo_runner_robot(of), &target);
}

void runner_assert_elbow_at(double angle_deg)
{
    double angle_rad = -99;

    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_OK);
    assert_true(grobo_deg_from_rad(angle_rad) > angle_deg - 0.6);
    assert_true(grobo_deg_from_rad(angle_rad) < angle_deg + 0.6);
}
