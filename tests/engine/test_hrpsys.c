/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include <grobo/hrpsys.h>

#include "rig.h"

enum { NECK = 13, R_KNEE = 3 };

static grobo_test_rig rig;
static grobo_hrpsys hrpsys;
static const grobo_robot_config quiet = {.sense_interval_us = GROBO_SENSE_NEVER};

static void start(void)
{
    rig_start(&rig, &quiet, NULL);
    grobo_hrpsys_init(&hrpsys, &rig.robot);
}

static void servo_switches_one_joint(void **state)
{
    (void)state;
    start();
    rig_expect(&rig, grobo_hrpsys_servo(&hrpsys, NECK, true, rig.now_us), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), j == NECK ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
    }
    rig_expect(&rig, grobo_hrpsys_servo(&hrpsys, NECK, false, rig.now_us), GROBO_OK);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
}

static void minus_one_is_not_all(void **state)
{
    (void)state;
    start();
    rig_power(&rig);
    assert_int_equal(grobo_hrpsys_servo(&hrpsys, -1, false, rig.now_us), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_servo(&hrpsys, 20, false, rig.now_us), GROBO_ERR_ARG);
    rig_run(&rig, 100000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
}

static void servo_knows_joints_and_groups_by_name(void **state)
{
    (void)state;
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    start();
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "knees", knees, 2), GROBO_OK);
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "knees", true, rig.now_us), GROBO_OK);
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "NECK_Y", true, rig.now_us), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        bool on = j == 3 || j == 9 || j == NECK;
        assert_int_equal(rig_torque(&rig, j), on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
    }
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "all", false, rig.now_us), GROBO_OK);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_OFF);
    assert_int_equal(grobo_hrpsys_servo_name(&hrpsys, "TAIL", true, rig.now_us),
                     GROBO_ERR_NOTFOUND);
}

static void groups_have_names_of_their_own(void **state)
{
    (void)state;
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    static const char *const tail[] = {"R_KNEE_P", "TAIL"};
    char name[] = "knees";
    char longest[GROBO_NAME_MAX_BYTES + 1];
    start();
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, name, tail, 2), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, name, knees, 2), GROBO_OK);
    assert_string_equal(name, "knees");
    name[0] = 'X'; /* it was copied */
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "knees", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "legs", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "NECK_Y", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "", knees, 2), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "none", knees, 0), GROBO_ERR_ARG);
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, longest, knees, 2), GROBO_ERR_CAP);
    for (int i = 1; i < GROBO_HRPSYS_GROUPS; i++) {
        char next[] = {'g', (char)('a' + i), '\0'};
        assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, next, knees, 2), GROBO_OK);
    }
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "one more", knees, 2), GROBO_ERR_FULL);
}

static void angles_not_read_are_no_numbers(void **state)
{
    (void)state;
    double angles[20];
    start();
    assert_int_equal(grobo_hrpsys_read_joint_angles(&hrpsys, angles, 19, rig.now_us),
                     GROBO_ERR_SPACE);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), 0, rig.now_us), 0);
    assert_int_equal(grobo_hrpsys_read_joint_angles(&hrpsys, angles, 20, rig.now_us), 1);
    assert_true(fabs(grobo_deg_from_rad(angles[R_KNEE]) + 40) < 0.06);
    assert_true(isnan(angles[NECK]));
}

static void commands_go_out_with_one_step(void **state)
{
    (void)state;
    double commands[20];
    start();
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys, rig.now_us), GROBO_ERR_EMPTY);
    for (int j = 0; j < 20; j++) {
        commands[j] = rig.driver->model->joints[j].init_rad;
    }
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, commands, 19), GROBO_ERR_ARG);
    commands[NECK] = 2;
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, commands, 20), GROBO_ERR_LIMIT);
    commands[NECK] = NAN;
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, commands, 20), GROBO_ERR_NAN);
    commands[NECK] = grobo_rad_from_deg(20);
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, commands, 20), GROBO_OK);
    rig_power(&rig);
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 500000), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys, rig.now_us), GROBO_OK);
    rig_run(&rig, 600000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.1);
}

static void emergencies_are_seen(void **state)
{
    (void)state;
    grobo_trip_info reason;
    start();
    rig_power(&rig);
    assert_int_equal(grobo_hrpsys_check_emergency(&hrpsys, &reason), 0);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 70), 0);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0, rig.now_us), GROBO_OK);
    assert_int_equal(grobo_hrpsys_check_emergency(&hrpsys, &reason), 1);
    assert_int_equal(reason.trip, GROBO_TRIP_TEMPERATURE);
    assert_int_equal(reason.joint, NECK);
    assert_int_equal(grobo_hrpsys_check_emergency(&hrpsys, NULL), 1);
}

static void names_become_ids(void **state)
{
    (void)state;
    static const char *const names[] = {"NECK_Y", "R_HIP_Y"};
    static const char *const wrong[] = {"NECK_Y", "TAIL"};
    int ids[2] = {-7, -7};
    start();
    assert_int_equal(grobo_hrpsys_names_to_ids(&hrpsys, wrong, 2, ids), GROBO_ERR_NOTFOUND);
    assert_int_equal(ids[0], -7);
    assert_int_equal(grobo_hrpsys_names_to_ids(&hrpsys, names, 2, ids), 2);
    assert_int_equal(ids[0], NECK);
    assert_int_equal(ids[1], 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(servo_switches_one_joint),
        cmocka_unit_test(minus_one_is_not_all),
        cmocka_unit_test(servo_knows_joints_and_groups_by_name),
        cmocka_unit_test(groups_have_names_of_their_own),
        cmocka_unit_test(angles_not_read_are_no_numbers),
        cmocka_unit_test(commands_go_out_with_one_step),
        cmocka_unit_test(emergencies_are_seen),
        cmocka_unit_test(names_become_ids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
