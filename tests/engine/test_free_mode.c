/* SPDX-License-Identifier: MIT */
/* Free mode under a hand that turns a joint at 30 to 200 deg/s, on board and bus. */
#include <math.h>
#include <stdint.h>

#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define STEP_US 1000
/* A held servo draws this much more under a hand that does not overcome it. */
#define PUSH_MA 300
#define WAY_DEG 60.0
/* Within this time of the first push each of 20 joints is read, and has braked. */
#define GIVES_WAY_S 0.17
/* At this speed of a hand, 80 % of its way in a second at least, however many are taught. */
#define HAND_DPS 60.0
#define HAND_PART 0.8
/* What a joint may move after the hand has left it. */
#define JUMP_DEG 2.0

static grobo_test_rig rig;

/* A hand that never overcomes a servo: it waits while torque is on, and what it waits is lost. */
static void push(int joint, double dps, int64_t time_us)
{
    for (int64_t t_us = 0; t_us < time_us; t_us += STEP_US) {
        bool held = rig_torque(&rig, joint) == GROBO_TORQUE_ON;
        double to_deg = rig_angle_deg(&rig, joint) + dps * STEP_US / 1e6;
        assert_int_equal(grobo_sim_set_load(&rig.sim, joint, held ? PUSH_MA : 0), 0);
        if (!held) {
            int32_t to_mdeg = (int32_t)lround(to_deg * 1000);
            assert_int_equal(grobo_sim_set_angle(&rig.sim, joint, to_mdeg, STEP_US), 0);
        }
        rig_run(&rig, STEP_US);
    }
    assert_int_equal(grobo_sim_set_load(&rig.sim, joint, 0), 0);
}

/* A hand that overcomes the servo, which drives back where torque is on at the end. */
static void force(int joint, double dps, int64_t time_us)
{
    double to_deg = rig_angle_deg(&rig, joint) + dps * (double)time_us / 1e6;
    int32_t to_mdeg = (int32_t)lround(to_deg * 1000);
    assert_int_equal(grobo_sim_set_angle(&rig.sim, joint, to_mdeg, time_us), 0);
    rig_run(&rig, time_us);
}

typedef void (*hand_fn)(int joint, double dps, int64_t time_us);

/* A hand turns a joint, which is expected to go along and to stay there. */
static double turn_once(int joint, hand_fn hand, double dps)
{
    double from_deg = rig_angle_deg(&rig, joint);
    hand(joint, dps, (int64_t)(WAY_DEG / fabs(dps) * 1e6));
    double left_deg = rig_angle_deg(&rig, joint);
    rig_run(&rig, 700000);
    assert_int_equal(rig_torque(&rig, joint), GROBO_TORQUE_ON);
    assert_true(fabs(rig_angle_deg(&rig, joint) - left_deg) <= JUMP_DEG);
    double moved_deg = fabs(rig_angle_deg(&rig, joint) - from_deg);
    assert_true(moved_deg >= WAY_DEG - fabs(dps) * GIVES_WAY_S);
    assert_true(fabs(dps) > HAND_DPS || moved_deg >= HAND_PART * WAY_DEG);
    return moved_deg;
}

/* Turns a joint that has rested for this time, and turns it back: it holds again then. */
static double turn(int joint, grobo_joint_mask taught, hand_fn hand, double dps, int64_t rest_us)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_robot_free(&rig.robot, taught, true), GROBO_OK);
    rig_run(&rig, rest_us);
    double there_deg = turn_once(joint, hand, dps);
    return fmin(there_deg, turn_once(joint, hand, -dps));
}

/* The least of a joint's ways, whenever in the round of readings the hand comes. */
static double least_way(int joint, grobo_joint_mask taught, hand_fn hand, double dps)
{
    double least_deg = WAY_DEG;
    for (int64_t rest_us = 500000; rest_us < 650000; rest_us += 75000) {
        least_deg = fmin(least_deg, turn(joint, taught, hand, dps, rest_us));
    }
    return least_deg;
}

static void expect_ways(int joint, grobo_joint_mask taught, double dps)
{
    double waits_deg = least_way(joint, taught, push, dps);
    double forces_deg = least_way(joint, taught, force, dps);
    print_message("# %s, %s of %d joints taught, %.0f deg/s: %.1f of 60 deg by a hand that waits, "
                  "%.1f by one that forces\n",
                  rig_wiring == GROBO_WIRING_BUS ? "bus" : "board",
                  grobo_i_gr001_model.joints[joint].name, grobo_joints_count(taught), fabs(dps),
                  waits_deg, forces_deg);
}

TEST_WITH(rig_wirings, a_joint_gives_way_to_a_hand_and_stays_where_it_leaves_it)
{
    static const double speeds_dps[] = {30, HAND_DPS, 120, 200};
    static const grobo_joint_mask taught[] = {7u << SHOULDER, GROBO_JOINTS_ALL(20)};
    for (int i = 0; i < 8; i++) {
        double dps = -speeds_dps[i / 2]; /* downwards there is room */
        expect_ways(R_ELBOW, taught[i % 2] | GROBO_JOINT_BIT(R_ELBOW), dps);
        expect_ways(R_KNEE, taught[i % 2] | GROBO_JOINT_BIT(R_KNEE), dps);
    }
}

/* A joint that is on a way of its own when free mode begins is not taken for one that is turned. */
TEST_WITH(rig_wirings, a_way_under_way_is_no_hand)
{
    static const double to_deg = -80;
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target;
    (void)grobo_posture_init(&target, 20);
    target.angle_rad[R_KNEE] = grobo_rad_from_deg(to_deg);
    target.set = GROBO_JOINT_BIT(R_KNEE);
    target.time_us = 2000000;
    assert_true(grobo_robot_send(&rig.robot, &target) >= 0);
    rig_run(&rig, 300000);
    assert_int_equal(grobo_robot_free(&rig.robot, target.set, true), GROBO_OK);
    rig_run(&rig, 2500000);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) - to_deg) < 0.2);
}
