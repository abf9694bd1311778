/* SPDX-License-Identifier: MIT */
/*
 * A control's target and motion over the simulator, from a thread that is not the loop's: once
 * while a control thread runs the loop, and once without, where the calls run it themselves.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "control_kit.h"
#include "files.h"
#include "folder.h"

/* ---- the target --------------------------------------------------------------------------- */

static void a_target_is_sent_once(void **state)
{
    (void)state;
    control_come_up();
    assert_int_equal(grobo_control_start_motion(control), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_control_set_joint(control, ELBOW, grobo_rad_from_deg(10)), GROBO_OK);
    assert_int_equal(grobo_control_start_motion(control), GROBO_OK);
    assert_int_equal(grobo_control_is_moving(control), 1);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    assert_int_equal(grobo_control_is_moving(control), 0);
    assert_int_equal(grobo_control_command_count(control), 0);
    control_assert_elbow_at(10);

    assert_int_equal(grobo_control_init_position(control), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    control_assert_elbow_at(0);
}

/* Asks for a move behind a reading that is under way: it has to wait for its turn. */
static int ask_behind_a_reading(grobo_control *from, void *arg)
{
    int r = grobo_session_sense(grobo_control_session(from), EVERY_JOINT, GROBO_SENSE_FULL);

    (void)arg;
    for (int i = 0; i < 2 && r >= 0; i++) {
        r = grobo_control_start_motion(from);
    }
    return r < 0 ? r : grobo_control_command_count(from);
}

static void a_target_that_waits_is_counted(void **state)
{
    (void)state;
    control_come_up();
    assert_int_equal(grobo_control_set_joint(control, ELBOW, grobo_rad_from_deg(5)), GROBO_OK);
    assert_int_equal(grobo_control_call(control, ask_behind_a_reading, NULL), 1);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    assert_int_equal(grobo_control_command_count(control), 0);
    control_assert_elbow_at(5);

    /* And may be taken back before it is sent. */
    assert_int_equal(grobo_control_set_joint(control, ELBOW, grobo_rad_from_deg(9)), GROBO_OK);
    assert_int_equal(grobo_control_call(control, ask_behind_a_reading, NULL), 1);
    assert_int_equal(grobo_control_stop_motion(control, false), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_ERR_CANCELED);
    assert_int_equal(grobo_control_stop_motion(control, false), GROBO_ERR_STATE);
}

/* ---- the motion --------------------------------------------------------------------------- */

static void the_motion_is_kept(void **state)
{
    grobo_motion *copy = NULL;
    grobo_posture posture;

    (void)state;
    assert_int_equal(grobo_control_motion_size(control), 0);
    assert_int_equal(grobo_control_get_last_posture(control, &posture), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_control_get_first_posture(control, &posture), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_control_append_current_posture(control), GROBO_ERR_STALE);
    control_come_up();
    assert_int_equal(grobo_control_read_posture(control, &posture, 0), 20);
    assert_int_equal(grobo_control_append_current_posture(control), 1);
    assert_int_equal(grobo_control_append_current_posture_us(control, 700000), 2);
    assert_int_equal(grobo_control_append_current_posture_us(control, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_control_motion_size(control), 2);
    assert_int_equal(grobo_control_get_first_posture(control, &posture), GROBO_OK);
    assert_int_equal(posture.time_us, 100000);
    assert_int_equal(grobo_control_get_last_posture(control, &posture), GROBO_OK);
    assert_int_equal(posture.time_us, 700000);
    assert_int_equal(grobo_control_get_motion(control, &copy), 2);
    grobo_control_clear_motion(control);
    assert_int_equal(grobo_control_motion_size(control), 0);
    assert_int_equal(grobo_motion_size(copy), 2);
    assert_int_equal(grobo_motion_set_joints(copy, 21), 21);
    assert_int_equal(grobo_control_set_motion(control, copy), GROBO_ERR_ARG);
    grobo_motion_free(copy);
}

static double nth_deg(size_t n)
{
    grobo_posture posture;
    double angle_deg = -99;

    assert_int_equal(grobo_control_get_nth_posture(control, n, &posture), GROBO_OK);
    assert_int_equal(grobo_posture_get_deg(&posture, ELBOW, &angle_deg), GROBO_OK);
    return angle_deg;
}

static void postures_count_in_playing_direction(void **state)
{
    grobo_posture posture = {.n_joints = 7};

    (void)state;
    control_have_motion(3);
    assert_int_equal((int)(nth_deg(0) + 0.5), 2);
    assert_int_equal((int)(nth_deg(2) + 0.5), 6);
    assert_int_equal(grobo_control_get_nth_posture(control, 3, &posture), GROBO_ERR_EMPTY);
    grobo_control_set_reverse(control, true);
    assert_int_equal((int)(nth_deg(0) + 0.5), 6);
    assert_int_equal((int)(nth_deg(2) + 0.5), 2);
    assert_int_equal(grobo_control_get_nth_posture(control, 3, &posture), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_control_get_nth_posture(control, SIZE_MAX, &posture), GROBO_ERR_EMPTY);
    assert_int_equal(posture.n_joints, 7);
    assert_int_equal(grobo_control_get_first_posture(control, &posture), GROBO_OK);
    assert_true(grobo_deg_from_rad(posture.angle_rad[ELBOW]) > 5.9);
    assert_int_equal(grobo_control_get_last_posture(control, &posture), GROBO_OK);
    assert_true(grobo_deg_from_rad(posture.angle_rad[ELBOW]) < 2.1);
    grobo_control_set_reverse(control, false);
    (void)grobo_control_set_motion_count(control, -1);
    assert_int_equal((int)(nth_deg(0) + 0.5), 6);
}

static void the_nth_posture_is_gone_to(void **state)
{
    grobo_posture target;

    (void)state;
    control_have_motion(3);
    assert_int_equal(grobo_control_do_nth_motion(control, 1), GROBO_ERR_CLOSED);
    control_come_up();
    assert_int_equal(grobo_control_do_nth_motion(control, 3), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_control_do_nth_motion(control, 1), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    control_assert_elbow_at(4);
    grobo_control_get_target_posture(control, &target);
    assert_int_equal(target.time_us, 0);
    grobo_control_set_reverse(control, true);
    assert_int_equal(grobo_control_do_nth_motion(control, 0), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    control_assert_elbow_at(6);
}

static void motions_are_saved_and_loaded(void **state)
{
    static const grobo_motion_format formats[] = {GROBO_FORMAT_M, GROBO_FORMAT_PSEQ,
                                                  GROBO_FORMAT_YAML, GROBO_FORMAT_MSEQ};
    char path[sizeof folder + 64];

    (void)state;
    for (size_t i = 0; i < 4; i++) {
        control_have_motion(3);
        assert_int_equal(grobo_control_save_motion(control, formats[i], "a", NULL, 0), 3);
        grobo_control_clear_motion(control);
        assert_true(grobo_control_load_motion_format(control, formats[i], "a", NULL) >= 3);
        assert_true(grobo_control_motion_size(control) >= 3);
    }
    control_have_motion(2);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_M, NULL, path, sizeof path),
                     2);
    assert_string_equal(strrchr(path, '/'), "/Motion1.m");
    control_have_motion(1);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_M, NULL, path, sizeof path),
                     1);
    assert_string_equal(strrchr(path, '/'), "/Motion2.m");
    assert_int_equal(grobo_control_load_motion(control, "Motion1", NULL), 2);

    /* a.m comes before a.yaml, a.pseq and a.mseq; b is there as b.yaml only. */
    control_have_motion(1);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_M, "a.m", path, sizeof path),
                     1);
    assert_string_equal(strrchr(path, '/'), "/a.m");
    control_have_motion(3);
    assert_true(grobo_control_save_motion(control, GROBO_FORMAT_YAML, "b", NULL, 0) >= 3);
    assert_int_equal(grobo_control_load_motion(control, "a", NULL), 1);
    assert_true(grobo_control_load_motion(control, "b", NULL) >= 3);
    assert_true(grobo_control_load_motion(control, "a.pseq", NULL) >= 3);
}

static void what_cannot_be_loaded_leaves_nothing(void **state)
{
    grobo_diagnostics *list;
    char path[8];

    (void)state;
    assert_int_equal(grobo_diagnostics_new(&list, NULL), GROBO_OK);
    control_have_motion(2);
    assert_int_equal(grobo_control_load_motion(control, "none", list), GROBO_ERR_NOENT);
    assert_int_equal(grobo_control_motion_size(control), 0);
    control_have_motion(2);
    assert_int_equal(grobo_control_load_motion(control, NULL, list), GROBO_ERR_ARG);
    assert_int_equal(grobo_control_motion_size(control), 0);
    control_have_motion(2);
    assert_int_equal(grobo_control_load_motion(control, "../a", list), GROBO_ERR_PERM);
    assert_int_equal(grobo_control_motion_size(control), 0);
    put_file(in_folder("bad.m"), "this is no motion\n");
    control_have_motion(2);
    assert_true(grobo_control_load_motion_format(control, GROBO_FORMAT_M, "bad", list) < 0);
    assert_int_equal(grobo_control_motion_size(control), 0);
    assert_true(grobo_diagnostics_count(list) > 0);
    grobo_diagnostics_free(list);

    control_have_motion(2);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_M, "../a", NULL, 0),
                     GROBO_ERR_PERM);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_M, "", NULL, 0),
                     GROBO_ERR_ARG);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_PSEQ, NULL, NULL, 0),
                     GROBO_ERR_ARG);
    assert_int_equal(grobo_control_save_motion(control, GROBO_FORMAT_M, "a", path, sizeof path),
                     GROBO_ERR_SPACE);
    assert_int_equal(grobo_control_load_motion(control, "a", NULL), GROBO_ERR_NOENT);
}

/* ---- playing ------------------------------------------------------------------------------ */

static int passes_of(grobo_control *from, void *arg)
{
    grobo_play_progress progress;

    (void)arg;
    grobo_robot_progress(grobo_session_robot(grobo_control_session(from)), grobo_now_us(),
                         &progress);
    return progress.passes;
}

static void the_motion_is_played(void **state)
{
    (void)state;
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_ERR_CLOSED);
    control_come_up();
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_ERR_EMPTY);
    control_have_motion(4);
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_OK);
    assert_true(grobo_control_is_playing(control));
    assert_int_equal(grobo_control_is_moving(control), 1);
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_ERR_STATE);
    int left = grobo_control_command_count(control);
    assert_in_range(left, 1, 4);
    grobo_control_clear_motion(control); /* what is played is not touched */
    assert_in_range(grobo_control_command_count(control), 0, left); /* one after the other goes */
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    assert_false(grobo_control_is_playing(control));
    assert_int_equal(grobo_control_command_count(control), 0);
    control_assert_elbow_at(8);
}

static void a_negative_count_plays_in_reverse(void **state)
{
    const grobo_play_options at_a_rate = {.mode = GROBO_PLAY_RATE, .rate_hz = 50};

    (void)state;
    control_come_up();
    control_have_motion(4);
    assert_int_equal(grobo_control_set_motion_count(control, -2), -2);
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    assert_int_equal(grobo_control_call(control, passes_of, NULL), 2);
    control_assert_elbow_at(2);
    assert_int_equal(grobo_control_set_motion_count(control, 1), 1);
    assert_int_equal(grobo_control_play_motion(control, &at_a_rate), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    control_assert_elbow_at(8);
    grobo_control_set_reverse(control, true);
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_OK);
    control_assert_elbow_at(2);
}

static void playing_is_stopped(void **state)
{
    (void)state;
    control_come_up();
    control_have_motion(4);
    assert_int_equal(grobo_control_set_motion_count(control, 10000), 10000);
    for (int at_once = 0; at_once < 2; at_once++) {
        assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_OK);
        assert_int_equal(grobo_control_wait(control, 400000), GROBO_ERR_TIMEOUT);
        assert_true(grobo_control_command_count(control) >= 0);
        assert_int_equal(grobo_control_stop_motion(control, at_once != 0), GROBO_OK);
        assert_int_equal(grobo_control_wait(control, 0), GROBO_ERR_CANCELED);
    }
    /* A motion that has not begun yet is forgotten. */
    assert_int_equal(grobo_control_play_motion(control, NULL), GROBO_OK);
    assert_int_equal(grobo_control_estop(control), GROBO_OK);
    assert_int_equal(grobo_control_wait(control, 0), GROBO_ERR_CANCELED);
    assert_false(grobo_control_is_playing(control));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_AND_WITHOUT_THREAD(a_target_is_sent_once),
        WITH_AND_WITHOUT_THREAD(a_target_that_waits_is_counted),
        WITH_AND_WITHOUT_THREAD(the_motion_is_kept),
        WITH_AND_WITHOUT_THREAD(postures_count_in_playing_direction),
        WITH_AND_WITHOUT_THREAD(the_nth_posture_is_gone_to),
        WITH_AND_WITHOUT_THREAD(motions_are_saved_and_loaded),
        WITH_AND_WITHOUT_THREAD(what_cannot_be_loaded_leaves_nothing),
        WITH_AND_WITHOUT_THREAD(the_motion_is_played),
        WITH_AND_WITHOUT_THREAD(a_negative_count_plays_in_reverse),
        WITH_AND_WITHOUT_THREAD(playing_is_stopped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
