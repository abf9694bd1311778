/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/unit.h>
#include <grobo/posture.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

static const grobo_model *const gr001 = &grobo_i_gr001_model;

/* GR001 as its sheet gives it, in joint order; typed anew, so that one table checks the other. */
static const struct {
    const char *name;
    int motor, min_deg, max_deg, init_deg;
} sheet[] = {
    {"R_HIP_Y", 9, -150, 30, 0},        {"R_HIP_R", 11, -90, 90, 0},
    {"R_HIP_P", 10, -40, 120, 20},      {"R_KNEE_P", 12, -130, 0, -40},
    {"R_ANKLE_P", 13, -95, 60, -20},    {"R_ANKLE_R", 14, -45, 90, 0},
    {"L_HIP_Y", 15, -30, 150, 0},       {"L_HIP_R", 17, -90, 90, 0},
    {"L_HIP_P", 16, -120, 40, -20},     {"L_KNEE_P", 18, 0, 130, 40},
    {"L_ANKLE_P", 19, -60, 95, 20},     {"L_ANKLE_R", 20, -90, 45, 0},
    {"CHEST_P", 1, -95, 0, 0},          {"NECK_Y", 2, -50, 50, 0},
    {"R_SHOULDER_P", 3, -150, 150, 20}, {"R_SHOULDER_R", 4, -150, 40, 0},
    {"R_ELBOW_P", 5, -130, 50, -20},    {"L_SHOULDER_P", 6, -150, 150, -20},
    {"L_SHOULDER_R", 7, -40, 150, 0},   {"L_ELBOW_P", 8, -50, 130, 20},
};

/* By motor 1..20: the initial posture (0.1 degree) and the free mode currents (mA). */
static const int init_ddeg[] = {0, 0,    200,  0, -200, -200, 0, 200, 0,   200,
                                0, -400, -200, 0, 0,    -200, 0, 400, 200, 0};
static const int free_ma[] = {150, 50,  50,  50,  50,  50,  50,  50,  100, 180,
                              170, 200, 150, 160, 100, 180, 170, 200, 150, 160};

static int joint_of(int motor)
{
    return grobo_model_joint_of_motor(gr001, motor);
}

TEST(gr001_is_as_its_sheet_says)
{
    assert_int_equal(grobo_model_check(gr001), 0);
    assert_string_equal(gr001->name, "GR001");
    assert_int_equal(gr001->n_joints, 20);
    for (int j = 0; j < 20; j++) {
        const grobo_joint *joint = &gr001->joints[j];
        assert_string_equal(joint->name, sheet[j].name);
        assert_int_equal(joint->motor, sheet[j].motor);
        assert_true(joint->min_rad == grobo_rad_from_deg(sheet[j].min_deg));
        assert_true(joint->max_rad == grobo_rad_from_deg(sheet[j].max_deg));
        assert_true(joint->init_rad == grobo_rad_from_deg(sheet[j].init_deg));
    }
}

/* Motion files of GR001 may leave a limit by one degree, judged on the wire's grid. */
TEST(slack_goes_to_the_limit)
{
    const double max_rad = gr001->joints[12].max_rad, min_rad = gr001->joints[12].min_rad;
    const double within_deg[] = {0.06, 0.3, 1, 1.04}, left_deg[] = {-20, 0, 0.04, 1.06, 30};
    grobo_model model = *gr001;

    for (size_t i = 0; i < sizeof within_deg / sizeof within_deg[0]; i++) {
        const double by_rad = grobo_rad_from_deg(within_deg[i]);

        assert_true(grobo_model_take_slack(gr001, 12, max_rad + by_rad) == max_rad);
        assert_true(grobo_model_take_slack(gr001, 12, min_rad - by_rad) == min_rad);
    }
    for (size_t i = 0; i < sizeof left_deg / sizeof left_deg[0]; i++) {
        const double by_rad = grobo_rad_from_deg(left_deg[i]);

        assert_true(grobo_model_take_slack(gr001, 12, max_rad + by_rad) == max_rad + by_rad);
        assert_true(grobo_model_take_slack(gr001, 12, min_rad - by_rad) == min_rad - by_rad);
    }
    assert_true(isnan(grobo_model_take_slack(gr001, 12, NAN)));
    model.limit_slack_deg = 0;
    assert_int_equal(grobo_model_check(&model), 0);
    assert_true(grobo_model_take_slack(&model, 12, max_rad + 0.01) == max_rad + 0.01);
    model.limit_slack_deg = -1;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    model.limit_slack_deg = 5.1;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    model.limit_slack_deg = NAN;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
}

TEST(the_standard_pose_is_the_initial_posture_of_the_wire)
{
    for (int motor = 1; motor <= 20; motor++) {
        const grobo_joint *joint = &gr001->joints[joint_of(motor)];
        assert_int_equal(grobo_ddeg_from_rad(joint->init_rad), init_ddeg[motor - 1]);
        assert_int_equal(joint->free_current_ma, free_ma[motor - 1]);
    }
    grobo_posture pose;
    grobo_posture_init_pose(&pose, gr001);
    assert_true(pose.set == GROBO_JOINTS_ALL(20));
    assert_int_equal(pose.time_us, GROBO_POSTURE_TIME_US);
    assert_int_equal(grobo_posture_check(&pose, gr001, NULL), 0);
}

TEST(servos_are_eleven_of_one_kind_and_nine_of_the_other)
{
    int rs301 = 0;
    for (int j = 0; j < 20; j++) {
        const grobo_joint *joint = &gr001->joints[j];
        double deg_s = grobo_deg_from_rad(joint->max_speed_rad_s);
        bool is_301 = joint->servo_model == 0x3010;
        assert_true(is_301 || joint->servo_model == 0x3020);
        assert_true(fabs(deg_s - (is_301 ? 60.0 / 0.11 : 60.0 / 0.16)) < 1e-9);
        rs301 += is_301;
    }
    assert_int_equal(rs301, 11);
}

TEST(the_mirror_fits_names_limits_and_pose)
{
    for (int j = 0; j < 20; j++) {
        const grobo_joint *joint = &gr001->joints[j];
        const grobo_joint *other = &gr001->joints[joint->mirror];
        if (joint->mirror != j) {
            assert_string_equal(joint->name + 1, other->name + 1);
            assert_int_not_equal(joint->name[0], other->name[0]);
            assert_int_equal(joint->mirror_sign, -1);
            assert_true(joint->min_rad == -other->max_rad);
        }
        assert_true(joint->init_rad == joint->mirror_sign * other->init_rad);
        assert_int_equal(joint->free_current_ma, other->free_current_ma);
        assert_int_equal(joint->servo_model, other->servo_model);
    }
    assert_int_equal(gr001->joints[12].mirror_sign, 1);
    assert_int_equal(gr001->joints[13].mirror_sign, -1);
}

TEST(motors_and_joints_lead_to_each_other)
{
    /* In joint order; hip roll and pitch swap (the reference's table of joints). */
    static const int motors[20] = {9,  11, 10, 12, 13, 14, 15, 17, 16, 18,
                                   19, 20, 1,  2,  3,  4,  5,  6,  7,  8};
    for (int j = 0; j < 20; j++) {
        assert_int_equal(grobo_model_motor_of_joint(gr001, j), motors[j]);
        assert_int_equal(joint_of(motors[j]), j);
    }
    assert_int_equal(joint_of(0), GROBO_ERR_NOTFOUND);
    assert_int_equal(joint_of(21), GROBO_ERR_NOTFOUND);
    assert_int_equal(joint_of(-1), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_model_motor_of_joint(gr001, 20), GROBO_ERR_ARG);
    assert_int_equal(grobo_model_motor_of_joint(gr001, -1), GROBO_ERR_ARG);
}

static int find(const char *name)
{
    return grobo_model_find_joint(gr001, name, strlen(name));
}

TEST(joints_are_found_by_name_motor_and_id)
{
    static const struct {
        const char *name;
        int joint;
    } rows[] = {
        {"R_KNEE_P", 3}, {"r_knee_p", 3},   {"R_Knee_p", 3}, {"m12", 3},  {"M12", 3},
        {"m1", 12},      {"j3", 3},         {"J0", 0},       {"j19", 19}, {"m012", 3},
        {"R_KNEE", -1},  {"R_KNEE_PP", -1}, {"m0", -1},      {"m21", -1}, {"m", -1},
        {"j20", -1},     {"j-1", -1},       {"", -1},        {"12", -1},  {"x12", -1},
        {"m12 ", -1},    {"m99999999", -1}, {"j 3", -1},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        int expected = rows[i].joint < 0 ? GROBO_ERR_NOTFOUND : rows[i].joint;
        assert_int_equal(find(rows[i].name), expected);
    }
    assert_int_equal(grobo_model_find_joint(gr001, "NECK_Y=30", 6), 13);
}

TEST(groups_are_those_of_the_reference_library)
{
    static const struct {
        const char *name;
        int first, last, first2, last2; /* motors */
    } rows[] = {
        {"all", 1, 20, 0, -1},       {"body", 1, 2, 0, -1},   {"right_arm", 3, 5, 0, -1},
        {"left_arm", 6, 8, 0, -1},   {"arms", 3, 5, 6, 8},    {"right_leg", 9, 14, 0, -1},
        {"left_leg", 15, 20, 0, -1}, {"legs", 9, 14, 15, 20},
    };
    assert_int_equal(gr001->n_groups, 8);
    for (size_t g = 0; g < 8; g++) {
        grobo_joint_mask expected = 0, by_name = 0, by_number = 0;
        char number[] = {(char)('0' + g), '\0'};
        int n = 0;
        for (int m = 1; m <= 20; m++) {
            if ((m >= rows[g].first && m <= rows[g].last) ||
                (m >= rows[g].first2 && m <= rows[g].last2)) {
                expected |= GROBO_JOINT_BIT(joint_of(m));
                n++;
            }
        }
        assert_int_equal(
            grobo_model_find_joints(gr001, rows[g].name, strlen(rows[g].name), &by_name), n);
        assert_int_equal(grobo_model_find_joints(gr001, number, 1, &by_number), n);
        assert_true(by_name == expected);
        assert_true(by_number == expected);
    }
}

TEST(sets_are_found_by_joint_too)
{
    grobo_joint_mask joints = 5;
    assert_int_equal(grobo_model_find_joints(gr001, "m2", 2, &joints), 1);
    assert_true(joints == GROBO_JOINT_BIT(13));
    assert_int_equal(grobo_model_find_joints(gr001, "LEGS", 4, &joints), 12);
    joints = 5;
    assert_int_equal(grobo_model_find_joints(gr001, "8", 1, &joints), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_model_find_joints(gr001, "tail", 4, &joints), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_model_find_joints(gr001, "", 0, &joints), GROBO_ERR_NOTFOUND);
    assert_true(joints == 5);
}

TEST(joints_of_a_set_are_counted)
{
    assert_int_equal(grobo_joints_count(0), 0);
    assert_int_equal(grobo_joints_count(GROBO_JOINT_BIT(0) | GROBO_JOINT_BIT(GROBO_JOINTS_MAX - 1)),
                     2);
    assert_int_equal(grobo_joints_count(GROBO_JOINTS_ALL(GROBO_JOINTS_MAX)), GROBO_JOINTS_MAX);
}

/* One fault at a time in a table that is good otherwise. */
static grobo_joint arm[2];
static grobo_group arm_groups[2];
static grobo_model two = GROBO_TABLE_INIT(grobo_model);

static void make_two(void)
{
    arm[0] = (grobo_joint){.name = "LEFT",
                           .min_rad = -1,
                           .max_rad = 1,
                           .max_speed_rad_s = 5,
                           .motor = 1,
                           .mirror = 1,
                           .mirror_sign = -1};
    arm[1] = (grobo_joint){.name = "RIGHT",
                           .min_rad = -1,
                           .max_rad = 1,
                           .max_speed_rad_s = 5,
                           .motor = 2,
                           .mirror = 0,
                           .mirror_sign = -1};
    arm_groups[0] = (grobo_group){"both", 3};
    arm_groups[1] = (grobo_group){"one", 1};
    two = (grobo_model)GROBO_TABLE(grobo_model, "TWO", arm, sizeof(grobo_joint), arm_groups, 2, 2,
                                   0, NULL);
}

#define assert_refused(fault)                                                                      \
    do {                                                                                           \
        make_two();                                                                                \
        assert_int_equal(grobo_model_check(&two), 0);                                              \
        fault;                                                                                     \
        assert_int_equal(grobo_model_check(&two), GROBO_ERR_ARG);                                  \
    } while (0)

TEST(a_faulty_joint_is_refused)
{
    assert_refused(arm[0].name = NULL);
    assert_refused(arm[0].name = "");
    assert_refused(arm[0].name = "right");
    assert_refused(arm[0].motor = GROBO_SERVO_ID_MAX + 1);
    assert_refused(arm[0].motor = 2);
    assert_refused(arm[1].min_rad = (double)NAN);
    assert_refused(arm[1].max_rad = (double)INFINITY);
    assert_refused(arm[1].min_rad = 0.5);
    assert_refused(arm[1].init_rad = 1.5);
    assert_refused(arm[1].init_rad = (double)NAN);
    assert_refused(arm[1].max_speed_rad_s = 0);
    assert_refused(arm[1].max_speed_rad_s = (double)INFINITY);
    assert_refused(arm[1].zero_rad = (double)NAN);
    assert_refused(arm[1].gear = -1);
    assert_refused(arm[1].mirror = 1);
    assert_refused(arm[1].mirror = 2);
    assert_refused(arm[1].mirror_sign = 0);
    assert_refused(arm[1].mirror_sign = 1);
}

static void follow(void)
{
    arm[1].follows = 0;
    arm[1].ratio = -0.5;
    arm[1].min_rad = -0.5;
    arm[1].max_rad = 0.5;
}

TEST(a_joint_follows_one_that_follows_none)
{
    make_two();
    follow();
    assert_int_equal(grobo_model_check(&two), 0);
    assert_refused((follow(), arm[1].ratio = 0.5 * (double)NAN));
    assert_refused((follow(), arm[1].ratio = -0.6));
    assert_refused((follow(), arm[1].max_rad = 0.4));
    assert_refused((follow(), arm[1].init_rad = 0.1));
    assert_refused((follow(), arm[1].follows = 1));
    assert_refused((follow(), arm[1].follows = 2));
    assert_refused((follow(), arm[1].apart_rad = -0.1));
    assert_refused((follow(), arm[1].apart_rad = (double)INFINITY));
    assert_refused((follow(), arm[0].follows = 1, arm[0].ratio = -2));
    assert_refused(arm[1].apart_rad = 0.1);
}

/* Turned round, geared down by 2, and 0.5 away where the joint is at 0. */
/* A rack of 90 mm a turn, and a gripper that is open at -20 degrees. */
TEST(a_joint_may_be_given_in_its_own_unit)
{
    grobo_joint joints[3];
    grobo_model model = *gr001;
    for (int j = 0; j < 3; j++) {
        joints[j] = gr001->joints[j];
        joints[j].mirror = (uint8_t)j;
        joints[j].min_rad = grobo_rad_from_deg(-20);
        joints[j].max_rad = grobo_rad_from_deg(60);
    }
    joints[1].unit = GROBO_UNIT_MM;
    joints[1].unit_rad = grobo_rad_from_deg(360) / 90;
    joints[2].unit = GROBO_UNIT_PCT;
    joints[2].unit_zero_rad = grobo_rad_from_deg(60);
    joints[2].unit_rad = grobo_rad_from_deg(-80) / 100;
    model.joints = joints;
    model.n_joints = 3;
    model.n_groups = 0;
    assert_int_equal(grobo_model_check(&model), 0);
    static const double at_deg[] = {60, 30, -20},
                        value[][3] = {{60, 30, -20}, {15, 7.5, -5}, {0, 37.5, 100}};
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) {
            double rad = grobo_rad_from_deg(at_deg[k]);
            assert_true(fabs(grobo_model_value(&model, j, rad) - value[j][k]) < 1e-9);
            assert_true(fabs(grobo_model_angle(&model, j, value[j][k]) - rad) < 1e-12);
        }
        /* A limit is not exceeded by the last bits. */
        assert_true(grobo_model_angle(&model, j, value[j][0]) <= joints[j].max_rad);
        assert_true(grobo_model_angle(&model, j, value[j][2]) >= joints[j].min_rad);
    }
    assert_true(fabs(grobo_model_change(&model, 0, grobo_rad_from_deg(8)) - 8) < 1e-9);
    assert_true(fabs(grobo_model_change(&model, 1, grobo_rad_from_deg(8)) - 2) < 1e-9);
    assert_true(fabs(grobo_model_change(&model, 2, grobo_rad_from_deg(8)) + 10) < 1e-9);
    assert_string_equal(grobo_unit_name(grobo_model_unit(&model, 0)), "deg");
    assert_string_equal(grobo_unit_name(grobo_model_unit(&model, 1)), "mm");
    assert_string_equal(grobo_unit_name(grobo_model_unit(&model, 2)), "%");
    assert_true(isnan(grobo_model_value(&model, 3, 0)) && isnan(grobo_model_angle(&model, -1, 0)));
    /* Of a program whose joints had no unit yet all are degrees. */
    grobo_model yesterday = model;
    yesterday.joint_size = offsetof(grobo_joint, unit);
    assert_int_equal(grobo_model_unit(&yesterday, 0), GROBO_UNIT_DEG);
}

TEST(a_unit_needs_its_scale)
{
    static const grobo_joint faults[] = {
        {.unit = GROBO_UNIT_MM},
        {.unit = GROBO_UNIT_PCT},
        {.unit = GROBO_UNIT_PCT + 1, .unit_rad = 1},
        {.unit_rad = 1},
        {.unit_zero_rad = 1},
        {.unit = GROBO_UNIT_MM, .unit_rad = INFINITY},
        {.unit = GROBO_UNIT_MM, .unit_rad = 1, .unit_zero_rad = NAN}};
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        grobo_joint joint = gr001->joints[0];
        grobo_model model = *gr001;
        model.joints = &joint;
        model.n_joints = 1;
        model.n_groups = 0;
        joint.mirror = 0;
        assert_int_equal(grobo_model_check(&model), 0);
        joint.unit = faults[i].unit;
        joint.unit_rad = faults[i].unit_rad;
        joint.unit_zero_rad = faults[i].unit_zero_rad;
        assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    }
}

TEST(a_servo_may_be_mounted_any_way)
{
    make_two();
    assert_true(grobo_joint_to_servo(&arm[0], 0.25) == 0.25);
    assert_true(grobo_joint_from_servo(&arm[0], 0.25) == 0.25);
    arm[0].sign = -1;
    arm[0].gear = 2;
    arm[0].zero_rad = 0.5;
    assert_true(grobo_joint_to_servo(&arm[0], 0.25) == 0);
    assert_true(grobo_joint_from_servo(&arm[0], 1.5) == -0.5);
    arm[0].sign = 0; /* as in a table that says nothing of it */
    arm[0].gear = 0;
    assert_true(grobo_joint_to_servo(&arm[0], 0.25) == 0.75);
}

TEST(a_faulty_table_is_refused)
{
    assert_int_equal(grobo_model_check(NULL), GROBO_ERR_ARG);
    assert_refused(two.name = NULL);
    assert_refused(two.joints = NULL);
    assert_refused(two.groups = NULL);
    assert_refused(two.n_joints = 0);
    assert_refused(two.n_joints = GROBO_JOINTS_MAX + 1);
    assert_refused(arm_groups[1].name = "BOTH");
    assert_refused(arm_groups[1].name = NULL);
    assert_refused(arm_groups[1].joints = 4);
}
