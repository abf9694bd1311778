/* SPDX-License-Identifier: MIT */
/*
 * Weight with servos of the other families, whose motors nobody has identified: GR001, hung by its
 * waist, and an arm of AX-12A, LX-16A and KRS. What leaves the robot where it is does so, and
 * a stop in motion neither dips nor throws.
 */
#include <math.h>
#include <string.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/weight_kit.h"

enum { PAN, LIFT, ELBOW, ACTIONS = 100 };

/* What an action may do to a joint at rest: so much, or two of its steps. */
#define STAYS_DEG 0.5
/* A joint that moves is not known that well; and one goes on until the halt is heard. */
#define DIPS_DEG 1.5
#define HEARD_S 0.2
#define THROWN_DEG 2.5

typedef struct family {
    const char *name, *family, *servo;
    int baud;
    double kg; /* of each of its four links: a fifth of what the servo can lift, at the second */
} family;

static const family families[] = {
    {"gr001", NULL, NULL, 0, 0},
    {"arm of AX-12A", "dynamixel1", "AX-12A", 1000000, 0.07},
    {"arm of AX-18A", "dynamixel1", "AX-18A", 1000000, 0.08},
    {"arm of RX-28", "dynamixel1", "RX-28", 1000000, 0.12},
    {"arm of MX-28", "dynamixel1", "MX-28", 1000000, 0.11},
    {"arm of MX-64", "dynamixel1", "MX-64", 1000000, 0.2},
    {"arm of MX-106", "dynamixel1", "MX-106", 1000000, 0.3},
    {"arm of MX-64-2", "dynamixel2", "MX-64-2", 1000000, 0.2},
    {"arm of XL330-M288", "dynamixel2", "XL330-M288", 1000000, 0.024},
    {"arm of XL430-W250", "dynamixel2", "XL430-W250", 1000000, 0.065},
    {"arm of XM430-W350", "dynamixel2", "XM430-W350", 1000000, 0.15},
    {"arm of XH540-W270", "dynamixel2", "XH540-W270", 1000000, 0.4},
    {"arm of XL-320", "dynamixel2", "XL-320", 1000000, 0.018},
    {"arm of PM42-010-S260-R", "dynamixel2", "PM42-010-S260-R", 1000000, 0.25},
    {"arm of PH54-200-S500-R", "dynamixel2", "PH54-200-S500-R", 1000000, 1},
    {"arm of H42-20-S300-RA", "dynamixel2", "H42-20-S300-RA", 1000000, 0.25},
    {"arm of M54-40-S250-R", "dynamixel2", "M54-40-S250-R", 1000000, 0.2},
    {"arm of STS3215", "feetech", "STS3215", 1000000, 0.08},
    {"arm of STS3250", "feetech", "STS3250", 1000000, 0.2},
    {"arm of SM40BL", "feetech", "SM40BL", 1000000, 0.15},
    {"arm of HLS3930", "feetech", "HLS3930", 1000000, 0.15},
    {"arm of HLS3606", "feetech", "HLS3606", 1000000, 0.03},
    {"arm of SCS0009", "feetech", "SCS0009", 1000000, 0.01},
    {"arm of SCS225", "feetech", "SCS225", 1000000, 0.07},
    {"arm of LX-16A", "lx16a", "LX-16A", 115200, 0.07},
    {"arm of HTS-35H", "lx16a", "HTS-35H", 115200, 0.15},
    {"arm of KRS-6003R2HV", "ics", "KRS-6003R2HV", 1250000, 0.07},
    {"arm of KRS-3304R2", "ics", "KRS-3304R2", 1250000, 0.06},
    {"arm of RS304MD", "rs30x", "RS304MD", 115200, 0.022},
    {"arm of RS405CB", "rs30x", "RS405CB", 115200, 0.1},
};

static grobo_robot_def *made;

static int end(void)
{
    weight_finish();
    grobo_robot_def_free(made);
    made = NULL;
    return 0;
}

TESTS_BETWEEN(NULL, end)

static int take_text(void *ctx, void *buffer, size_t size)
{
    const char **text = ctx;
    size_t n = strlen(*text);
    n = n < size ? n : size;
    memcpy(buffer, *text, n);
    *text += n;
    return (int)n;
}

/* 0.3 kg along 0.25 m: 0.3 Nm at the lift where it lies. */
static void read_arm(const family *row)
{
    char file[2048];
    const char *text = file;
    static const char *const axes[] = {"[0, 0, 1]", "[0, 1, 0]", "[0, 1, 0]", "[1, 0, 0]"};
    size_t n =
        (size_t)snprintf(file, sizeof file, "name: arm\nfamily: %s\nline: {baud: %d}\njoints:\n",
                         row->family, row->baud);
    for (int j = 0; j < 4; j++) {
        n += (size_t)snprintf(file + n, sizeof file - n,
                              "  - {name: axis_%c, id: %d, servo: %s, limits_deg: [-90, 90]}\n",
                              "abcd"[j], j + 1, row->servo);
    }
    n += (size_t)snprintf(file + n, sizeof file - n, "links:\n  - {name: base, mass_kg: 0.1}\n");
    for (int j = 0; j < 4; j++) {
        n += (size_t)snprintf(
            file + n, sizeof file - n,
            "  - {name: l%d, parent: %s%.0d, joint: axis_%c, axis: %s, mass_kg: %g,\n"
            "     origin_m: [%s, 0, 0], com_m: [0.04, 0, 0],\n"
            "     inertia_kgm2: [2e-5, 4e-5, 4e-5, 0, 0, 0]}\n",
            j + 1, j == 0 ? "base" : "l", j, "abcd"[j], axes[j], row -> kg, j > 1 ? "0.08" : "0");
    }
    assert_true(n < sizeof file);
    grobo_robot_def_free(made);
    made = NULL;
    assert_int_equal(
        grobo_robot_def_read(&(grobo_source){take_text, &text}, "arm", NULL, NULL, &made), 0);
}

static void begin(const family *row)
{
    if (row->family == NULL) {
        weight_begin(row->name, 0);
    } else {
        weight_finish();
        read_arm(row);
        weight_begin_def(made, 0);
    }
    weight_run(WEIGHT_S);
    assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
    weight_run(2 * WEIGHT_S);
}

/* The arm has nothing that trips it, and no move of it fails. */
static void expect_move(const family *row, int joint, double deg, int ms)
{
    int result = weight_move(joint, deg, ms);
    if (result < 0) {
        fail_msg("%s: joint %d to %.1f deg: %s, %s of joint %d", row->name, joint, deg,
                 grobo_error_name(result), grobo_trip_name(weight.tripped), weight.tripped_joint);
    }
}

static double part_deg(int joint, double part)
{
    const grobo_joint *j = &weight.def->model->joints[joint];
    return grobo_deg_from_rad(j->min_rad + part * (j->max_rad - j->min_rad));
}

/* ---- at rest --------------------------------------------------------------------------------- */

static const char *act(uint32_t *seed)
{
    unsigned which = next_random(seed) % (WEIGHT_NOTHINGS + 3);
    switch (which) {
    case WEIGHT_NOTHINGS:
        (void)grobo_robot_stop(&weight.robot, true);
        return "stop";
    case WEIGHT_NOTHINGS + 1:
        weight_wait_if(grobo_robot_cancel(&weight.robot));
        return "cancel";
    case WEIGHT_NOTHINGS + 2:
        weight_wait_if(grobo_robot_exit(&weight.robot, GROBO_EXIT_HOLD));
        weight_new_engine();
        return "exit";
    default:
        return weight_do_nothing(which);
    }
}

TEST_EACH(family, families, nothing_moves_a_robot_at_rest)
{
    double first_deg[GROBO_JOINTS_MAX], drift = 0;
    uint32_t seed = 3;
    begin(row);
    double most = fmax(STAYS_DEG, 2 * grobo_deg_from_rad(weight.driver.angle_step_rad));
    expect_move(row, LIFT, part_deg(LIFT, 0.4), 1500);
    expect_move(row, ELBOW, part_deg(ELBOW, 0.6), 1500);
    weight_run(2 * WEIGHT_S);
    for (int j = 0; j < weight.def->model->n_joints; j++) {
        first_deg[j] = weight_angle_deg(j);
    }
    for (int i = 0; i < ACTIONS; i++) {
        const char *what = act(&seed);
        weight_run((int)(next_random(&seed) % 400) * WEIGHT_MS);
        for (int j = 0; j < weight.def->model->n_joints; j++) {
            double off_deg = weight_angle_deg(j) - first_deg[j];
            drift = fmax(drift, fabs(off_deg));
            if (fabs(off_deg) > most) {
                fail_msg("%s: action %d, %s: joint %d moved by %.2f deg", row->name, i, what, j,
                         off_deg);
            }
        }
    }
    print_message("%s: %d actions, no joint moved by more than %.2f deg\n", row->name, ACTIONS,
                  drift);
}

/* ---- in motion ------------------------------------------------------------------------------- */

TEST_EACH(family, families, a_stop_in_motion_neither_dips_nor_throws)
{
    for (int k = 0; k < 8; k++) {
        int joint = k % 2 == 0 ? LIFT : ELBOW, after_ms = 150 + 90 * k;
        grobo_sim_physics_view view;
        begin(row);
        double from_deg = part_deg(joint, k < 4 ? 0.3 : 0.7), to_deg = part_deg(joint, 0.5);
        expect_move(row, joint, from_deg, 1500);
        weight_run(WEIGHT_S);
        grobo_posture target = weight_target(joint, to_deg, 1200);
        assert_true(grobo_robot_move(&weight.robot, &target) > 0);
        weight_run(after_ms * WEIGHT_MS);
        double at_deg = weight_angle_deg(joint), sign = copysign(1, to_deg - from_deg);
        assert_int_equal(grobo_sim_physics_look(weight.physics, joint, &view), 0);
        double dps =
            fmax(fabs(grobo_deg_from_rad(view.speed_rad_s)), fabs(to_deg - from_deg) / 1.2);
        (void)grobo_robot_stop(&weight.robot, true);
        weight_run(2 * WEIGHT_S);
        double on_deg = sign * (weight_angle_deg(joint) - at_deg);
        if (on_deg < -DIPS_DEG || on_deg > dps * HEARD_S + THROWN_DEG) {
            fail_msg("%s: joint %d after %d ms at %.1f deg and %.0f deg/s: %.2f deg further",
                     row->name, joint, after_ms, at_deg, dps, on_deg);
        }
    }
}
