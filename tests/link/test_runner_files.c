/* SPDX-License-Identifier: MIT */
/*
 * A runner's motion and files over the simulator, from a thread that is not the loop's: once
 * while a runner's thread runs the loop, and once without, where the calls run it themselves.
 */
#include <stdint.h>
#include <string.h>

#include "tests/support/files.h"
#include "tests/support/folder.h"
#include "tests/support/runner_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static void put_motion(const char *name, grobo_motion_format format, int n)
{
    const grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .format = format,
                                         .model = &grobo_i_gr001_model};
    runner_have_motion(n);
    grobo_motion *motion = runner_motion(runner);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), in_folder(name), &options, NULL),
                     GROBO_OK);
    grobo_motion_free(motion);
}

TEST_WITH(with_and_without_thread, motions_are_found_and_loaded)
{
    /* a.m comes before a.yaml, a.pseq and a.mseq; b is there as b.yaml only. */
    put_motion("a.pseq", GROBO_FORMAT_PSEQ, 4);
    put_motion("a.mseq", GROBO_FORMAT_MSEQ, 5);
    put_motion("b.yaml", GROBO_FORMAT_YAML, 3);
    assert_int_equal(grobo_runner_load_motion(runner, "a", NULL), 4);
    put_motion("a.m", GROBO_FORMAT_M, 1);
    assert_int_equal(grobo_runner_load_motion(runner, "a", NULL), 1);
    assert_int_equal(runner_motion_size(runner), 1);
    assert_int_equal(grobo_runner_load_motion(runner, "a.mseq", NULL), 5);
    assert_true(grobo_runner_load_motion(runner, "b", NULL) >= 3);
}

TEST_WITH(with_and_without_thread, what_cannot_be_loaded_leaves_nothing)
{
    grobo_diagnostics *list;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), GROBO_OK);
    runner_have_motion(2);
    assert_int_equal(grobo_runner_load_motion(runner, "none", list), GROBO_ERR_NOENT);
    assert_int_equal(runner_motion_size(runner), 0);
    runner_have_motion(2);
    assert_int_equal(grobo_runner_load_motion(runner, NULL, list), GROBO_ERR_ARG);
    assert_int_equal(runner_motion_size(runner), 0);
    runner_have_motion(2);
    assert_int_equal(grobo_runner_load_motion(runner, "../a", list), GROBO_ERR_OUTSIDE);
    assert_int_equal(runner_motion_size(runner), 0);
    put_file(in_folder("bad.m"), "this is no motion\n");
    runner_have_motion(2);
    assert_true(grobo_runner_load_motion(runner, "bad", list) < 0);
    assert_int_equal(runner_motion_size(runner), 0);
    grobo_diagnostic said;
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), 0);
    grobo_diagnostics_free(list);

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
