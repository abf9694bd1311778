/* SPDX-License-Identifier: MIT */
/* What the classic shelf has in the manner of hrpsys: joints and groups by name, emergencies. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/static.h>

#include "src/classic/view.h"
#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static classic_view view;

static void start(void)
{
    rig_start(&rig, &quiet, NULL);
    grobo_classic_view_init(&view, &rig.robot);
}

TEST_WITH(rig_wirings, servo_knows_joints_and_groups_by_name)
{
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    start();
    assert_int_equal(grobo_classic_add_group(&view, "knees", knees, 2), 2);
    rig_expect(&rig, grobo_classic_servo_name(&view, "Knees", true), GROBO_OK);
    rig_expect(&rig, grobo_classic_servo_name(&view, "NECK_Y", true), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        bool on = j == 3 || j == 9 || j == NECK;
        assert_int_equal(rig_torque(&rig, j), on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
    }
    rig_expect(&rig, grobo_classic_servo_name(&view, "all", false), GROBO_OK);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_OFF);
    static const char *const unknown[] = {"TAIL", "", "3", "-1", "alle"};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        assert_int_equal(grobo_classic_servo_name(&view, unknown[i], true), GROBO_ERR_NOTFOUND);
    }
}

TEST_WITH(rig_wirings, all_joints_are_called_all_by_any_model)
{
    static grobo_robot robot;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_joint_mask joints = 0;
    grobo_model model = grobo_i_gr001_model;
    model.n_groups = 0;
    assert_int_equal(grobo_rs30x_driver_init(&driver, &model, &grobo_i_rs30x_protocol), 0);
    assert_int_equal(grobo_robot_init(&robot, &driver, NULL, NULL, 0), 0);
    grobo_classic_view_init(&view, &robot);
    assert_int_equal(grobo_classic_find(&view, "All", &joints), 20);
    assert_true(joints == GROBO_JOINTS_ALL(20));
    assert_int_equal(grobo_classic_find(&view, "right_arm", &joints), GROBO_ERR_NOTFOUND);
}

TEST_WITH(rig_wirings, groups_have_names_of_their_own)
{
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    static const char *const tail[] = {"R_KNEE_P", "TAIL"};
    char name[] = "knees";
    char longest[GROBO_NAME_MAX_BYTES + 1];
    start();
    assert_int_equal(grobo_classic_add_group(&view, name, tail, 2), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_classic_add_group(&view, name, knees, 2), 2);
    grobo_joint_mask found = 0;
    assert_int_equal(grobo_classic_find(&view, "knees", &found), 2);
    assert_true(found == (GROBO_JOINT_BIT(3) | GROBO_JOINT_BIT(9)));
    assert_string_equal(name, "knees"); /* untouched */
    name[0] = 'X';                      /* it was copied */
    assert_int_equal(grobo_classic_add_group(&view, "knees", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_classic_add_group(&view, "legs", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_classic_add_group(&view, "NECK_Y", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_classic_add_group(&view, "", knees, 2), GROBO_ERR_ARG);
    assert_int_equal(grobo_classic_add_group(&view, "none", knees, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_classic_add_group(&view, "12", knees, 2), GROBO_ERR_ARG);
    assert_int_equal(grobo_classic_add_group(&view, "ALL", knees, 2), GROBO_ERR_EXISTS);
    static const char *const more[] = {"knees", "NECK_Y", "r_knee_p"};
    assert_int_equal(grobo_classic_add_group(&view, "more", more, 3), 3);
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_int_equal(grobo_classic_add_group(&view, longest, knees, 2), GROBO_ERR_CAP);
    for (int i = 2; i < VIEW_GROUPS; i++) {
        char next[] = {'g', (char)('a' + i), '\0'};
        assert_int_equal(grobo_classic_add_group(&view, next, knees, 2), 2);
    }
    assert_int_equal(grobo_classic_add_group(&view, "one more", knees, 2), GROBO_ERR_FULL);
}

static int read_angles(double *angles, size_t capacity, int64_t max_age_us)
{
    return grobo_classic_read_angles(&view, max_age_us, angles, capacity);
}

TEST_WITH(rig_wirings, angles_not_read_are_no_numbers)
{
    double angles[20];
    start();
    assert_int_equal(read_angles(angles, 19, GROBO_NEVER_US), GROBO_ERR_SPACE);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), 0), 0);
    rig_run(&rig, 50000);
    assert_int_equal(read_angles(angles, 20, GROBO_NEVER_US), 1);
    assert_true(fabs(grobo_deg_from_rad(angles[R_KNEE]) + 40) < 0.06);
    assert_true(isnan(angles[NECK]));
    assert_int_equal(read_angles(angles, 20, 40000), 0);
    assert_true(isnan(angles[R_KNEE]));
}

/* What the emergency is, after a reading of all joints. */
static const char *emergency(int *joint)
{
    static char reason[VIEW_REASON_MAX_BYTES];
    *joint = -7;
    rig_wait(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0));
    if (grobo_classic_emergency(&view, reason, sizeof reason, joint) == 0) {
        assert_int_equal(*joint, -7);
        return "none";
    }
    return reason;
}

TEST_WITH(rig_wirings, emergencies_are_told)
{
    int joint = 0;
    char small[] = "................................";
    start();
    rig_power(&rig);
    assert_string_equal(emergency(&joint), "none");
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 70.4), 0);
    assert_string_equal(emergency(&joint), "over-temperature: NECK_Y at 70 deg C");
    assert_int_equal(joint, NECK);
    assert_int_equal(grobo_classic_emergency(&view, small, sizeof small, &joint), GROBO_ERR_SPACE);
    assert_int_equal(small[0], '.');

    start();
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 900), 0);
    (void)emergency(&joint);
    rig_run(&rig, 1000000);
    assert_memory_equal(emergency(&joint), "over-current: NECK_Y at ", 24);
    assert_int_equal(joint, NECK);

    start();
    rig_power(&rig);
    grobo_sim_set_supply(&rig.sim, 5500);
    assert_memory_equal(emergency(&joint), "low voltage: ", 13);

    start();
    rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
    assert_string_equal(emergency(&joint), "emergency stop");
    assert_int_equal(joint, -1);
}

TEST_WITH(rig_wirings, lost_replies_in_motion_are_an_emergency)
{
    int joint = 0;
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    rig_start(&rig, &config, NULL);
    grobo_classic_view_init(&view, &rig.robot);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    grobo_posture target = rig_posture(&rig, R_KNEE, -60, 5000);
    rig_wait(&rig, grobo_robot_move(&rig.robot, &target));
    assert_string_equal(emergency(&joint), "lost replies: NECK_Y, 5 in a row");
    assert_int_equal(joint, NECK);
}

TEST_WITH(rig_wirings, names_become_motors)
{
    static const char *const names[] = {"NECK_Y", "r_hip_y"};
    static const char *const wrong[] = {"NECK_Y", "TAIL"};
    static const char *const none[] = {"NECK_Y", NULL};
    int motors[2] = {-7, -7};
    start();
    assert_int_equal(grobo_classic_motors_of(&view, wrong, 2, motors), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_classic_motors_of(&view, none, 2, motors), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_classic_motors_of(&view, NULL, 2, motors), GROBO_ERR_ARG);
    assert_int_equal(grobo_classic_motors_of(&view, names, 2, NULL), GROBO_ERR_ARG);
    assert_int_equal(motors[0], -7);
    assert_int_equal(grobo_classic_motors_of(&view, names, 2, motors), 2);
    assert_int_equal(motors[0], 2);
    assert_int_equal(motors[1], 9);
}
