/* SPDX-License-Identifier: MIT */
/* Who says that a joint stands has read it: two positions, or its goal read back and reached. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/family_kit.h"
#include "tests/support/rig.h"

enum { JOINTS = FAMILY_JOINTS, MILLI = 1000, SECOND = 1000000 };

static family_kit kit;

/* ---- creeping joints ------------------------------------------------------------------------- */

static const grobo_robot_config unread = {
    GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER, .goals = GROBO_GOALS_WHOLE};

/* Another program has sent all joints on their way, so slowly. */
static void set_creeping(const family *f, double dps)
{
    family_start(&kit, f, &unread, NULL);
    assert_int_equal(family_move(&kit, 60, 2000), GROBO_OK);
    double way_deg = fmin(20 * dps, 115);
    grobo_posture p = family_posture(&kit, 60 - way_deg, (int)(way_deg / dps * 1000));
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, 1500 * MILLI);
}

static void another_program(const family *f)
{
    grobo_robot_config config = unread;
    config.bus.baud_bps = f->baud_bps;
    config.bus.echo = f->echo;
    assert_int_equal(grobo_robot_init(&kit.robot, &kit.driver, NULL, &config, kit.now_us), 0);
    family_listen(&kit);
}

static void stands_from_now_on(double dps, const char *how)
{
    double at_deg[JOINTS];
    for (int j = 0; j < JOINTS; j++) {
        at_deg[j] = family_angle_deg(&kit, j);
    }
    family_run(&kit, SECOND);
    for (int j = 0; j < JOINTS; j++) {
        double on_deg = fabs(family_angle_deg(&kit, j) - at_deg[j]);
        if (on_deg > 0.6) {
            fail_msg("%s: verified at %g deg/s by %s, and joint %d went on by %.1f degrees",
                     kit.family->name, dps, how, j, on_deg);
        }
    }
}

static const double creeps_dps[] = {1, 2, 3, 5, 6, 7.5, 10, 14};

static void who_leaves_says_so_of_joints_that_stand(void **state)
{
    (void)state;
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        for (size_t i = 0; i < sizeof creeps_dps / sizeof creeps_dps[0]; i++) {
            for (int emergency = 0; emergency < 2; emergency++) {
                set_creeping(f, creeps_dps[i]);
                another_program(f);
                int number = emergency ? grobo_robot_estop(&kit.robot)
                                       : grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
                int64_t begun_us = kit.now_us;
                assert_int_equal(family_wait(&kit, number), GROBO_OK);
                assert_true(kit.now_us - begun_us < 2 * (int64_t)SECOND);
                stands_from_now_on(creeps_dps[i], emergency ? "an emergency stop" : "exit");
            }
        }
    }
}

/* Who stands where it was sent is shown to by its goal, at once; where no servo tells that, by two
 * positions, and those that were read before count. */
static void who_stands_where_it_was_sent_is_believed_at_once(void **state)
{
    (void)state;
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        bool tells_goal = strcmp(f->name, "ics") != 0;
        for (int watched = 0; watched < 2; watched++) {
            grobo_robot_config config = unread;
            config.sense_interval_us = watched ? 300 * MILLI : GROBO_SENSE_NEVER;
            family_start(&kit, f, &config, NULL);
            assert_int_equal(family_move(&kit, 30, 1000), GROBO_OK);
            family_run(&kit, 2 * (int64_t)SECOND);
            int64_t begun_us = kit.now_us;
            int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
            assert_int_equal(family_wait(&kit, number), GROBO_OK);
            double took_ms = (double)(kit.now_us - begun_us) / 1000;
            if (took_ms > (watched || tells_goal ? 250 : 1000)) {
                fail_msg("%s: %.0f ms", f->name, took_ms);
            }
        }
    }
}

/* ---- a short bound --------------------------------------------------------------------------- */

static void a_short_bound_switches_torque_off(void **state)
{
    (void)state;
    static const int bounds_ms[] = {5, 20, 100, 300};
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        for (size_t i = 0; i < sizeof bounds_ms / sizeof bounds_ms[0]; i++) {
            grobo_robot_config config = unread;
            config.exit_bound_us = bounds_ms[i] * MILLI;
            family_start(&kit, f, &config, NULL);
            assert_int_equal(family_move(&kit, 30, 1000), GROBO_OK);
            grobo_posture p = family_posture(&kit, -30, 3000);
            assert_true(grobo_robot_move(&kit.robot, &p) > 0);
            family_run(&kit, SECOND);
            int64_t begun_us = kit.now_us;
            (void)family_wait(&kit, grobo_robot_exit(&kit.robot, GROBO_EXIT_OFF));
            assert_true(kit.now_us - begun_us <= (bounds_ms[i] + 2) * MILLI);
            family_run(&kit, 20 * MILLI);
            for (int j = 0; j < JOINTS; j++) {
                grobo_sim_view view;
                assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
                if (view.torque != GROBO_TORQUE_OFF) {
                    fail_msg("%s: joint %d has torque after %d ms", f->name, j, bounds_ms[i]);
                }
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_leaves_says_so_of_joints_that_stand),
        cmocka_unit_test(who_stands_where_it_was_sent_is_believed_at_once),
        cmocka_unit_test(a_short_bound_switches_torque_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
