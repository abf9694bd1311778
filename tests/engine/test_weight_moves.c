/* SPDX-License-Identifier: MIT */
/*
 * Moves of an arm that carries weight: their end is told when the joint rests, not when its way is
 * over; the next one may begin before; and what still swings is no joint that others move.
 */
#include <math.h>
#include <stdlib.h>

#include "tests/support/test.h"
#include "tests/support/weight_kit.h"

enum { LIFT = 1, ELBOW = 2 };

/* After the end of a move its joint goes no further than this. */
#define RESTS_DEG 1.0
/* The end is told so long behind the way at most: 1.5 s, and a reading. */
#define LATEST_MS 1650
/* Where nothing sags, it is told as soon as the goal is read back. */
#define AT_ONCE_MS 80

typedef struct arm {
    const char *name, *robot;
    int gain;
} arm;

static const arm arms[] = {
    {"so101, gain 16", "so101", 16},
    {"so101, gain 32", "so101", 32},
    {"koch", "koch", 0},
    {"openmanipulator-x", "openmanipulator-x", 0},
};

static int end(void)
{
    weight_finish();
    return 0;
}

TESTS_BETWEEN(NULL, end)

/* The first move is a slow one: it is over. */
static void begin(const arm *row)
{
    weight_begin(row->robot, row->gain);
    assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
    assert_int_equal(weight_move(LIFT, 0, 1000), 0);
    assert_int_equal(weight_move(ELBOW, 0, 1000), 0);
    weight_run(WEIGHT_S);
}

TEST_EACH(arm, arms, the_end_of_a_move_is_told_when_it_rests)
{
    static const double to_deg[] = {20, -20, 0, 10, -30, 25};
    begin(row);
    for (int k = 0; k < 12; k++) {
        int joint = k % 2 == 0 ? LIFT : ELBOW;
        int64_t asked_us = weight.now_us;
        int ms = k % 3 == 0 ? 300 : 1000;
        assert_int_equal(weight_move(joint, to_deg[k % 6], ms), 0);
        double at_deg = weight_angle_deg(joint), most_deg = 0;
        double took_ms = (double)(weight.now_us - asked_us) / WEIGHT_MS;
        for (int i = 0; i < 20; i++) {
            weight_run(25 * WEIGHT_MS);
            most_deg = fmax(most_deg, fabs(weight_angle_deg(joint) - at_deg));
        }
        if (most_deg > RESTS_DEG && took_ms < ms + LATEST_MS - 200) {
            fail_msg("%s: joint %d to %.0f deg: it went on by %.2f deg", row->name, joint,
                     to_deg[k % 6], most_deg);
        }
        assert_true(took_ms <= ms + LATEST_MS + 100);
    }
}

/* Another one takes the joint over from it: the first is done, and not superseded. */
TEST_EACH(arm, arms, the_next_move_may_begin_while_it_settles)
{
    begin(row);
    for (int k = 0; k < 6; k++) {
        grobo_posture target = weight_target(LIFT, k % 2 == 0 ? 20 : -20, 400);
        int job = grobo_robot_move(&weight.robot, &target);
        assert_true(job > 0);
        weight_run(470 * WEIGHT_MS);
        target = weight_target(LIFT, k % 2 == 0 ? 15 : -15, 400);
        int next = grobo_robot_move(&weight.robot, &target);
        assert_true(next > 0);
        weight_run(WEIGHT_MS);
        assert_int_equal(weight.ended, job);
        assert_int_equal(weight.result, 0);
        assert_int_equal(weight_wait(next), 0);
    }
}

/* Nor do other commands find it occupied. */
TEST(torque_may_be_asked_for_while_it_settles)
{
    begin(&arms[0]);
    grobo_posture target = weight_target(LIFT, 20, 300);
    int job = grobo_robot_move(&weight.robot, &target);
    assert_true(job > 0);
    weight_run(370 * WEIGHT_MS);
    assert_true(weight.ended != job);
    assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
}

/* A limp arm falls on while the frames that switch it on are under way. A servo that a goal
 * switches on has torque before it is read back, then farther from that goal than one that stood.
 * Another one gets torque where its goal is its angle; where it fell from that, it stays limp. */
TEST_EACH(arm, arms, torque_comes_on_while_the_arm_falls)
{
    for (int fall_ms = 0; fall_ms < 500; fall_ms += 20) {
        begin(row);
        assert_int_equal(weight_torque(GROBO_TORQUE_OFF), 0);
        weight_run(fall_ms * WEIGHT_MS);
        int result = weight_torque(GROBO_TORQUE_ON);
        bool limp = result == GROBO_ERR_MISMATCH && !weight.driver.goal_energises;
        result = result < 0 ? result : weight_move(LIFT, 0, 1000);
        if (result < 0 && !limp) {
            fail_msg("%s: %d ms behind the begin of its fall: %s", row->name, fall_ms,
                     grobo_error_name(result));
        }
    }
}

/* A program that comes while the arm still sags behind the move of the one before. */
TEST_EACH(arm, arms, nobody_else_moves_an_arm_that_settles)
{
    for (int wait_ms = 0; wait_ms < 500; wait_ms += 35) {
        begin(row);
        int joint = wait_ms % 2 == 0 ? LIFT : ELBOW;
        grobo_posture target = weight_target(joint, 20, 400);
        assert_true(grobo_robot_move(&weight.robot, &target) > 0);
        weight_run((480 + wait_ms) * WEIGHT_MS);
        weight_new_engine();
        int result = weight_torque(GROBO_TORQUE_ON);
        result = result < 0 ? result : weight_move(joint, -10, 400);
        if (result < 0) {
            fail_msg("%s: joint %d, %d ms behind its way: %s", row->name, joint, wait_ms + 80,
                     grobo_error_name(result));
        }
    }
}

/* Where nothing is carried nothing waits. */
TEST(without_weight_the_end_is_told_at_once)
{
    begin(&arms[1]);
    for (int k = 0; k < 4; k++) {
        int64_t asked_us = weight.now_us;
        assert_int_equal(weight_move(0, k % 2 == 0 ? 30 : 0, 1000), 0); /* the pan carries none */
        double late_ms = (double)(weight.now_us - asked_us) / WEIGHT_MS - 1000;
        print_message("told %.0f ms behind the way\n", late_ms);
        assert_true(late_ms < AT_ONCE_MS + 300);
    }
}
