/* SPDX-License-Identifier: MIT */
/*
 * A runner's motion and files over the simulator, from a thread that is not the loop's: once
 * while a runner's thread runs the loop, and once without, where the calls run it themselves.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/files.h"
#include "tests/support/folder.h"
#include "tests/support/runner_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { POSTURES = 4, STEP_US = 100000 };

/* Whole degrees that differ from joint to joint and from posture to posture, within limits. */
static double angle_deg(int n, int joint)
{
    const grobo_joint *limits = &grobo_i_gr001_model.joints[joint];
    double deg = (3 * joint + 5 * n) % 23 - 11;

    deg = fmin(deg, floor(grobo_deg_from_rad(limits->max_rad)));
    return fmax(deg, ceil(grobo_deg_from_rad(limits->min_rad)));
}

static void have_every_joint(void)
{
    grobo_motion *motion;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion), GROBO_OK);
    assert_int_equal(grobo_posture_init(&posture, 20), GROBO_OK);
    posture.time_us = STEP_US;
    for (int n = 0; n < POSTURES; n++) {
        for (int j = 0; j < 20; j++) {
            assert_int_equal(grobo_posture_set_deg(&posture, j, angle_deg(n, j)), GROBO_OK);
        }
        assert_int_equal(grobo_motion_append(motion, &posture), GROBO_OK);
    }
    assert_int_equal(grobo_runner_set_motion(runner, motion), POSTURES);
    grobo_motion_free(motion);
}

/* The motion of n postures is that of have_every_joint(), with frames between where sampled. */
static void expect_every_joint(int n, bool sampled)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;
    int64_t at_us = 0;
    int found = 0;

    assert_true(sampled ? n > POSTURES : n == POSTURES);
    assert_int_equal(grobo_runner_get_motion(runner, &motion), n);
    for (int i = 0; i < n; i++) {
        assert_int_equal(grobo_motion_get(motion, (size_t)i, &posture), 0);
        at_us += posture.time_us;
        if (at_us < (found + 1) * STEP_US - 1) {
            continue;
        }
        assert_true(llabs(at_us - (found + 1) * STEP_US) <= 1);
        assert_true(posture.set == EVERY_JOINT);
        for (int j = 0; j < 20; j++) {
            assert_true(fabs(grobo_deg_from_rad(posture.angle_rad[j]) - angle_deg(found, j)) <
                        0.01);
        }
        found++;
    }
    assert_int_equal(found, POSTURES);
    grobo_motion_free(motion);
}

TEST_WITH(with_and_without_thread, motions_are_saved_and_loaded)
{
    static const grobo_motion_format formats[] = {GROBO_FORMAT_M, GROBO_FORMAT_PSEQ,
                                                  GROBO_FORMAT_YAML, GROBO_FORMAT_MSEQ};
    char path[sizeof folder + 64];

    for (size_t i = 0; i < 4; i++) {
        have_every_joint();
        assert_int_equal(grobo_runner_save_motion(runner, formats[i], "a", NULL, 0), POSTURES);
        grobo_runner_clear_motion(runner);
        assert_int_equal(runner_motion_size(runner), 0);
        int n = grobo_runner_load_motion_format(runner, formats[i], "a", NULL);
        assert_int_equal(runner_motion_size(runner), n);
        expect_every_joint(n, formats[i] == GROBO_FORMAT_YAML);
    }
    have_every_joint();
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, NULL, path, sizeof path),
                     POSTURES);
    assert_string_equal(strrchr(path, '/'), "/Motion1.m");
    runner_have_motion(1);
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, NULL, path, sizeof path), 1);
    assert_string_equal(strrchr(path, '/'), "/Motion2.m");
    expect_every_joint(grobo_runner_load_motion(runner, "Motion1", NULL), false);

    /* Another format is not replaced, whatever the name says. */
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, "a.pseq", NULL, 0),
                     GROBO_ERR_EXISTS);
    assert_true(grobo_runner_load_motion(runner, "a.pseq", NULL) >= 3);

    /* a.m comes before a.yaml, a.pseq and a.mseq; b is there as b.yaml only. */
    runner_have_motion(1);
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, "a.m", path, sizeof path), 1);
    assert_string_equal(strrchr(path, '/'), "/a.m");
    runner_have_motion(3);
    assert_true(grobo_runner_save_motion(runner, GROBO_FORMAT_YAML, "b", NULL, 0) >= 3);
    assert_int_equal(grobo_runner_load_motion(runner, "a", NULL), 1);
    assert_true(grobo_runner_load_motion(runner, "b", NULL) >= 3);
    assert_true(grobo_runner_load_motion(runner, "a.pseq", NULL) >= 3);
}

TEST_WITH(with_and_without_thread, what_cannot_be_loaded_leaves_nothing)
{
    grobo_diagnostics *list;
    char path[8];

    assert_int_equal(grobo_diagnostics_new(NULL, &list), GROBO_OK);
    runner_have_motion(2);
    assert_int_equal(grobo_runner_load_motion(runner, "none", list), GROBO_ERR_NOENT);
    assert_int_equal(runner_motion_size(runner), 0);
    runner_have_motion(2);
    assert_int_equal(grobo_runner_load_motion(runner, NULL, list), GROBO_ERR_ARG);
    assert_int_equal(runner_motion_size(runner), 0);
    runner_have_motion(2);
    assert_int_equal(grobo_runner_load_motion(runner, "../a", list), GROBO_ERR_PERM);
    assert_int_equal(runner_motion_size(runner), 0);
    put_file(in_folder("bad.m"), "this is no motion\n");
    runner_have_motion(2);
    assert_true(grobo_runner_load_motion_format(runner, GROBO_FORMAT_M, "bad", list) < 0);
    assert_int_equal(runner_motion_size(runner), 0);
    grobo_diagnostic said;
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), 0);
    grobo_diagnostics_free(list);

    runner_have_motion(2);
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, "../a", NULL, 0),
                     GROBO_ERR_PERM);
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, "", NULL, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_PSEQ, NULL, NULL, 0),
                     GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_save_motion(runner, GROBO_FORMAT_M, "a", path, sizeof path),
                     GROBO_ERR_SPACE);
    assert_int_equal(grobo_runner_load_motion(runner, "a", NULL), GROBO_ERR_NOENT);
}

/* Six angles would move the first six of twenty joints. */
TEST_WITH(with_and_without_thread, a_motion_of_another_robot_is_not_loaded)
{
    const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .model = &grobo_i_gr001_model};
    const char *text = "500 0 0 0 0 0 0\n";
    grobo_motion *motion;

    assert_int_equal(grobo_motion_read_memory(text, strlen(text), &options, NULL, &motion), 0);
    assert_int_equal(grobo_runner_set_motion(runner, motion), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_target_body(motion, "so101"), 0);
    assert_int_equal(grobo_runner_set_motion(runner, motion), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_target_body(motion, "GR001"), 0);
    assert_int_equal(grobo_runner_set_motion(runner, motion), 1);
    grobo_motion_free(motion);
    put_file(in_folder("a.m"), text);
    assert_int_equal(grobo_runner_load_motion(runner, "a", NULL), GROBO_ERR_ARG);
    assert_int_equal(runner_motion_size(runner), 0);
}
