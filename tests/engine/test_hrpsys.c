/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/hrpsys.h>
#include <grobo/core/static.h>

#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static grobo_hrpsys hrpsys;

static void start(void)
{
    rig_start(&rig, &quiet, NULL);
    grobo_hrpsys_init(&hrpsys, &rig.robot);
}

TEST_WITH(rig_wirings, servo_switches_one_joint)
{
    start();
    rig_expect(&rig, grobo_hrpsys_servo(&hrpsys, NECK, true), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), j == NECK ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
    }
    rig_expect(&rig, grobo_hrpsys_servo(&hrpsys, NECK, false), GROBO_OK);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
}

TEST_WITH(rig_wirings, minus_one_is_not_all)
{
    start();
    rig_power(&rig);
    assert_int_equal(grobo_hrpsys_servo(&hrpsys, -1, false), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_servo(&hrpsys, 20, false), GROBO_ERR_ARG);
    rig_run(&rig, 100000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
}

TEST_WITH(rig_wirings, servo_knows_joints_and_groups_by_name)
{
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    start();
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "knees", knees, 2), 2);
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "Knees", true), GROBO_OK);
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "NECK_Y", true), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        bool on = j == 3 || j == 9 || j == NECK;
        assert_int_equal(rig_torque(&rig, j), on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
    }
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "all", false), GROBO_OK);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_OFF);
    static const char *const unknown[] = {"TAIL", "", "3", "-1", "alle"};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        assert_int_equal(grobo_hrpsys_servo_name(&hrpsys, unknown[i], true), GROBO_ERR_NOTFOUND);
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
    grobo_hrpsys_init(&hrpsys, &robot);
    assert_int_equal(grobo_hrpsys_find(&hrpsys, "All", &joints), 20);
    assert_true(joints == GROBO_JOINTS_ALL(20));
    assert_int_equal(grobo_hrpsys_find(&hrpsys, "right_arm", &joints), GROBO_ERR_NOTFOUND);
}

TEST_WITH(rig_wirings, groups_have_names_of_their_own)
{
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    static const char *const tail[] = {"R_KNEE_P", "TAIL"};
    char name[] = "knees";
    char longest[GROBO_NAME_MAX_BYTES + 1];
    start();
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, name, tail, 2), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, name, knees, 2), 2);
    grobo_joint_mask found = 0;
    assert_int_equal(grobo_hrpsys_find(&hrpsys, "knees", &found), 2);
    assert_true(found == (GROBO_JOINT_BIT(3) | GROBO_JOINT_BIT(9)));
    assert_string_equal(name, "knees"); /* untouched */
    name[0] = 'X';                      /* it was copied */
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "knees", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "legs", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "NECK_Y", knees, 2), GROBO_ERR_EXISTS);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "", knees, 2), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "none", knees, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "12", knees, 2), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "ALL", knees, 2), GROBO_ERR_EXISTS);
    static const char *const more[] = {"knees", "NECK_Y", "r_knee_p"};
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "more", more, 3), 3);
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, longest, knees, 2), GROBO_ERR_CAP);
    for (int i = 2; i < GROBO_HRPSYS_GROUPS; i++) {
        char next[] = {'g', (char)('a' + i), '\0'};
        assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, next, knees, 2), 2);
    }
    assert_int_equal(grobo_hrpsys_add_joint_group(&hrpsys, "one more", knees, 2), GROBO_ERR_FULL);
}

static int read_angles(double *angles, size_t capacity, int64_t max_age_us)
{
    return grobo_hrpsys_read_joint_angles(&hrpsys, max_age_us, angles, capacity);
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

static int write_pose(double neck_deg)
{
    double commands[20];
    for (int j = 0; j < 20; j++) {
        commands[j] = rig.driver->model->joints[j].init_rad;
    }
    commands[NECK] = grobo_rad_from_deg(neck_deg);
    return grobo_hrpsys_write_joint_commands(&hrpsys, commands, 20);
}

TEST_WITH(rig_wirings, commands_go_out_with_one_step)
{
    const double commands[20] = {0};
    start();
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_EMPTY);
    rig_power(&rig);
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, commands, 19), GROBO_ERR_ARG);
    assert_int_equal(write_pose(NAN), GROBO_ERR_NAN);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_EMPTY);
    assert_int_equal(write_pose(115), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_LIMIT);
    assert_int_equal(write_pose(20), GROBO_OK);
    assert_int_equal(write_pose(NAN), GROBO_ERR_NAN); /* and the one before stays */
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 500000), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_OK);
    rig_run(&rig, 600000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.1);

    /* Each joint gets its own. */
    double each[20];
    for (int j = 0; j < 20; j++) {
        const grobo_joint *joint = &rig.driver->model->joints[j];
        each[j] = 0.9 * joint->init_rad + 0.1 * (j % 2 == 0 ? joint->min_rad : joint->max_rad);
    }
    assert_int_equal(grobo_hrpsys_write_joint_commands(&hrpsys, each, 20), GROBO_OK);
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 1000000), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_OK);
    rig_run(&rig, 1500000);
    for (int j = 0; j < 20; j++) {
        assert_true(fabs(rig_angle_deg(&rig, j) - grobo_deg_from_rad(each[j])) < 0.1);
    }
}

TEST_WITH(rig_wirings, a_loop_of_steps_is_followed)
{
    double angles[20];
    start();
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "all", true), GROBO_OK);
    assert_int_equal(grobo_hrpsys_set_period_us(&hrpsys, 20000), GROBO_OK);
    for (int i = 0; i < 150; i++) {
        assert_int_equal(write_pose(30 * sin(i * 0.04)), GROBO_OK);
        assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_OK);
        rig_run(&rig, 20000);
        if (i > 50) { /* the first step is slow */
            assert_true(fabs(rig_angle_deg(&rig, NECK) - 30 * sin(i * 0.04)) < 3);
        }
    }
    rig_run(&rig, 200000);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
    assert_int_equal(read_angles(angles, 20, GROBO_NEVER_US), 20);
    assert_true(fabs(grobo_deg_from_rad(angles[NECK]) - 30 * sin(149 * 0.04)) < 0.1);
}

TEST_WITH(rig_wirings, joints_without_torque_are_left_out)
{
    start();
    assert_int_equal(write_pose(20), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_STATE);
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "right_arm", true), GROBO_OK);
    assert_int_equal(write_pose(20), GROBO_OK);
    rig_forget(&rig);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_OK);
    rig_run(&rig, 200000);
    assert_int_equal(rig.n_sent, 1);
    const uint8_t *packet;
    assert_int_equal(rig_packet(&rig.sent[0], &packet), 8 + 3 * 5);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.1);
}

TEST_WITH(rig_wirings, switching_forgets_what_was_written)
{
    start();
    assert_int_equal(write_pose(20), GROBO_OK);
    rig_expect(&rig, grobo_hrpsys_servo(&hrpsys, NECK, true), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_STATE);
    rig_expect(&rig, grobo_hrpsys_servo_name(&hrpsys, "all", true), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_EMPTY);
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.1);
}

/* What the emergency is, after a reading of all joints. */
static const char *emergency(int *joint)
{
    static char reason[GROBO_HRPSYS_REASON_MAX_BYTES];
    *joint = -7;
    rig_wait(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0));
    if (grobo_hrpsys_check_emergency(&hrpsys, reason, sizeof reason, joint) == 0) {
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
    assert_int_equal(grobo_hrpsys_check_emergency(&hrpsys, small, sizeof small, &joint),
                     GROBO_ERR_SPACE);
    assert_int_equal(small[0], '.');
    assert_int_equal(write_pose(5), GROBO_OK);
    assert_int_equal(grobo_hrpsys_one_step(&hrpsys), GROBO_ERR_LATCHED);

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
    grobo_hrpsys_init(&hrpsys, &rig.robot);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    grobo_posture target = rig_posture(&rig, R_KNEE, -60, 5000);
    rig_wait(&rig, grobo_robot_move(&rig.robot, &target));
    assert_string_equal(emergency(&joint), "lost replies: NECK_Y, 5 in a row");
    assert_int_equal(joint, NECK);
}

TEST_WITH(rig_wirings, names_become_ids)
{
    static const char *const names[] = {"NECK_Y", "R_HIP_Y"};
    static const char *const wrong[] = {"NECK_Y", "TAIL"};
    int ids[2] = {-7, -7};
    start();
    assert_int_equal(grobo_hrpsys_names_to_ids(&hrpsys, wrong, 2, ids), GROBO_ERR_NOTFOUND);
    assert_int_equal(ids[0], -7);
    assert_int_equal(grobo_hrpsys_names_to_ids(&hrpsys, names, 2, ids), 2);
    assert_int_equal(ids[0], NECK);
    assert_int_equal(ids[1], 0);
    assert_int_equal(grobo_hrpsys_names_to_motors(&hrpsys, wrong, 2, ids), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_hrpsys_names_to_motors(&hrpsys, names, 2, ids), 2);
    assert_int_equal(ids[0], 2);
    assert_int_equal(ids[1], 9);
}
