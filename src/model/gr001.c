/* SPDX-License-Identifier: MIT */
#include <grobo/model.h>

#define PI 3.14159265358979323846
#define RAD(angle_deg) ((angle_deg)*PI / 180.0)

/*
 * Servos. The robot has 11 RS301CR "in legs and waist" and 9 RS302CD "in the upper body", yet the
 * legs alone have 12 joints and the upper body 8: two leg joints must carry an RS302CD. We take
 * the hip yaws (motors 9, 15) for them: free mode lets them draw 100 mA before it brakes, between
 * the arms' 50 and the 150 and more of the other leg joints and of motor 1 (CHEST_P, the waist).
 * Then 10 leg joints and the waist are the 11. Should it be wrong, the speed given here is the
 * slower one, which is the safe side.
 *
 * Speeds are those of the data sheets at 7.4 V without load, as protocol 4 gives them.
 */
#define RS301_MODEL 0x3010
#define RS301_SPEED RAD(60.0 / 0.11)
#define RS302_MODEL 0x3020
#define RS302_SPEED RAD(60.0 / 0.16)

#define JOINT(name_, motor_, min_deg, max_deg, init_deg, servo, free_ma, mirror_, sign_)           \
    {                                                                                              \
        .name = (name_), .min_rad = RAD(min_deg), .max_rad = RAD(max_deg),                         \
        .max_speed_rad_s = servo##_SPEED, .init_rad = RAD(init_deg), .servo_model = servo##_MODEL, \
        .free_current_ma = (free_ma), .motor = (motor_), .mirror = (mirror_),                      \
        .mirror_sign = (sign_)                                                                     \
    }

/*
 * In joint order. The current is the one above which free mode brakes (protocol 5). The mirror
 * swaps left and right and negates; CHEST_P bends forward in the mirror too.
 */
static const grobo_joint gr001_joints[] = {
    /*    name  motor  min  max  init  servo  free mA  mirror, sign */
    JOINT("R_HIP_Y", 9, -150, 30, 0, RS302, 100, 6, -1),
    JOINT("R_HIP_R", 11, -90, 90, 0, RS301, 170, 7, -1),
    JOINT("R_HIP_P", 10, -40, 120, 20, RS301, 180, 8, -1),
    JOINT("R_KNEE_P", 12, -130, 0, -40, RS301, 200, 9, -1),
    JOINT("R_ANKLE_P", 13, -95, 60, -20, RS301, 150, 10, -1),
    JOINT("R_ANKLE_R", 14, -45, 90, 0, RS301, 160, 11, -1),
    JOINT("L_HIP_Y", 15, -30, 150, 0, RS302, 100, 0, -1),
    JOINT("L_HIP_R", 17, -90, 90, 0, RS301, 170, 1, -1),
    JOINT("L_HIP_P", 16, -120, 40, -20, RS301, 180, 2, -1),
    JOINT("L_KNEE_P", 18, 0, 130, 40, RS301, 200, 3, -1),
    JOINT("L_ANKLE_P", 19, -60, 95, 20, RS301, 150, 4, -1),
    JOINT("L_ANKLE_R", 20, -90, 45, 0, RS301, 160, 5, -1),
    JOINT("CHEST_P", 1, -95, 0, 0, RS301, 150, 12, 1),
    JOINT("NECK_Y", 2, -50, 50, 0, RS302, 50, 13, -1),
    JOINT("R_SHOULDER_P", 3, -150, 150, 20, RS302, 50, 17, -1),
    JOINT("R_SHOULDER_R", 4, -150, 40, 0, RS302, 50, 18, -1),
    JOINT("R_ELBOW_P", 5, -130, 50, -20, RS302, 50, 19, -1),
    JOINT("L_SHOULDER_P", 6, -150, 150, -20, RS302, 50, 14, -1),
    JOINT("L_SHOULDER_R", 7, -40, 150, 0, RS302, 50, 15, -1),
    JOINT("L_ELBOW_P", 8, -50, 130, 20, RS302, 50, 16, -1),
};

/* Joints first..last. */
#define SPAN(first, last) (GROBO_JOINTS_ALL((last) + 1) & ~GROBO_JOINTS_ALL(first))

/* The torque groups of the reference library, c = 0..7 (protocol 5, setServo). */
static const grobo_group gr001_groups[] = {
    {"all", SPAN(0, 19)},       {"body", SPAN(12, 13)}, {"right_arm", SPAN(14, 16)},
    {"left_arm", SPAN(17, 19)}, {"arms", SPAN(14, 19)}, {"right_leg", SPAN(0, 5)},
    {"left_leg", SPAN(6, 11)},  {"legs", SPAN(0, 11)},
};

const grobo_model grobo_gr001_model = {
    .name = "GR001",
    .joints = gr001_joints,
    .groups = gr001_groups,
    .n_joints = sizeof gr001_joints / sizeof gr001_joints[0],
    .n_groups = sizeof gr001_groups / sizeof gr001_groups[0],
    .limit_slack_deg = 1, /* recordings leave limits by fractions of a degree: CHEST_P by 0.6 */
};
