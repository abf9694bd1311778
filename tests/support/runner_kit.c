/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

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
    grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .motion_dir = "/nowhere"};

    (void)folder_set_up();
    make(config);
    assert_int_equal(grobo_runner_set_motion_dir(runner, folder), GROBO_OK);
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

int runner_motion_size(grobo_runner *of)
{
    grobo_motion *motion = NULL;
    int n = grobo_runner_get_motion(of, &motion);

    grobo_motion_free(motion);
    return n;
}

void runner_assert_elbow_at(double angle_deg)
{
    double angle_rad = -99;

    assert_int_equal(grobo_runner_read_angle(runner, ELBOW, &angle_rad, 0), GROBO_OK);
    assert_true(grobo_deg_from_rad(angle_rad) > angle_deg - 0.6);
    assert_true(grobo_deg_from_rad(angle_rad) < angle_deg + 0.6);
}
