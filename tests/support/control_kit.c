/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/control_kit.h"
#include "tests/support/folder.h"

grobo_control *control;

static void make(grobo_control_config config)
{
    /* No test here is of a late host: a busy machine ends no motion. */
    const grobo_robot_config patient = {GROBO_ROBOT_CONFIG_INIT, .stall_us = 30000000};
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM,
                                          .baud_bps = 1000000, .robot = &patient};

    config.session = &session;
    assert_int_equal(grobo_control_new(&config, &control), GROBO_OK);
}

int control_set_up(void)
{
    grobo_control_config config = {GROBO_CONTROL_CONFIG_INIT, .motion_dir = "/nowhere"};

    (void)folder_set_up();
    make(config);
    assert_int_equal(grobo_control_set_motion_dir(control, folder), GROBO_OK);
    return 0;
}

int control_set_up_threaded(void)
{
    (void)control_set_up();
    assert_int_equal(grobo_control_start_thread(control), GROBO_OK);
    return 0;
}

int control_tear_down(void)
{
    static const char *const files[] = {"Motion1.m", "Motion2.m", "a.m",   "a.yaml",
                                        "a.pseq",    "a.mseq",    "bad.m", "b.yaml"};

    assert_int_equal(grobo_control_free(control), GROBO_OK);
    folder_remove(files, sizeof files / sizeof files[0]);
    return 0;
}

const test_fixture with_and_without_thread[2] = {
    {NULL, control_set_up, control_tear_down},
    {"threaded", control_set_up_threaded, control_tear_down}};

void control_come_up(void)
{
    assert_int_equal(grobo_control_connect(control, 0), GROBO_OK);
    assert_true(grobo_control_is_connected(control));
}

void control_have_motion(int n)
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
    assert_int_equal(grobo_control_set_motion(control, motion), n);
    grobo_motion_free(motion);
}

int control_motion_size(grobo_control *of)
{
    grobo_motion *motion = NULL;
    int n = grobo_control_get_motion(of, &motion);

    grobo_motion_free(motion);
    return n;
}

void control_assert_elbow_at(double angle_deg)
{
    double angle_rad = -99;

    assert_int_equal(grobo_control_read_angle(control, ELBOW, &angle_rad, 0), GROBO_OK);
    assert_true(grobo_deg_from_rad(angle_rad) > angle_deg - 0.6);
    assert_true(grobo_deg_from_rad(angle_rad) < angle_deg + 0.6);
}
