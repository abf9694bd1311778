/* SPDX-License-Identifier: MIT */
/*
 * A goal's frame that leaves as it was asked for, or is built anew: its bytes are the same. When a
 * halt that is owed leaves.
 */
#include <stdint.h>
#include <string.h>

#include "src/base/assert.h"
#include "src/robot/speed.h"
#include "tests/support/axes_kit.h"
#include "tests/support/next_random.h"
#include "tests/support/test.h"

/* Each frame that stands is built once more, to be held against it. */
static const bool held_against = GROBO_ASSERT_WALKS;

static int built; /* frames, by the driver */
static grobo_driver whole = GROBO_TABLE_INIT(grobo_driver);

static int count_posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                         grobo_exchange *exchange)
{
    built += part == 0;
    return whole.posture(self, ctx, target, part, exchange);
}

/* Asks all joints to go two degrees on, in a second; joint 5 waits in one frame with others. */
static void ask(bool timed, bool rests)
{
    const grobo_i_motion how = {.priority = GROBO_PRIORITY_MOTION,
                                .due_us = GROBO_NEVER_US,
                                .each = true,
                                .as_is = true,
                                .rests = rests};
    grobo_posture target;
    start();
    whole = driver;
    driver.posture = count_posture;
    driver.timed_posture = timed ? count_posture : whole.timed_posture;
    assert_int_equal(grobo_posture_init(&target, N), 0);
    for (int j = 0; j < N; j++) {
        assert_int_equal(grobo_posture_set_rad(&target, j, here_rad(j) + RAD(2)), 0);
    }
    target.time_us = S;
    assert_int_equal(grobo_i_gate_send(&robot, &target, &how), GROBO_OK);
    built = 0;
}

static grobo_robot_slot *frame_of(int joint)
{
    for (int i = 0; i < robot.slots_end; i++) {
        if ((robot.slots[i].order.joints & GROBO_JOINT_BIT(joint)) != 0) {
            return &robot.slots[i];
        }
    }
    fail_msg("joint %d is in no frame", joint);
    return NULL;
}

/* ---- what happens meanwhile ---- */

static void nothing(void)
{
}

static void it_waited(void)
{
    robot.now_us += 7000;
}

static void a_joint_was_behind(void)
{
    robot.axes[5].trajectory =
        (grobo_robot_trajectory){here_rad(5), here_rad(5) - RAD(140), NOW - S, NOW - 9};
}

static void a_joint_was_a_little_behind(void)
{
    robot.axes[5].trajectory =
        (grobo_robot_trajectory){here_rad(5), here_rad(5) - RAD(1), NOW - S, NOW - 9};
}

static void a_joint_got_another_target(void)
{
    robot.axes[5].next++;
}

static void a_joint_got_another_that_left(void)
{
    robot.axes[5].next = 0;
    robot.axes[5].last++;
}

static void its_servo_told_of_a_limit(void)
{
    robot.axes[5].state.valid |= GROBO_FIELD_RANGE;
    robot.axes[5].state.low_rad = here_rad(5) - 1;
    robot.axes[5].state.high_rad = here_rad(5) + RAD(1.5);
}

static void all_got_slower(void)
{
    robot.config.speed_limit_pct = 1;
}

static void a_first_move_is_slow(void)
{
    robot.soft = true;
    robot.config.approach_dps = 1;
}

static void goals_go_in_segments(void)
{
    robot.config.goals = GROBO_GOALS_SEGMENTS;
}

static void a_joint_is_free(void)
{
    robot.free_joints = GROBO_JOINT_BIT(5);
}

static void it_stopped(void)
{
    latch(GROBO_TRIP_LOST_REPLIES);
}

static const struct {
    void (*happens)(void);
    bool anew; /* its frame is built anew */
    int result;
} rows[] = {
    {nothing, false, GROBO_OK},
    {it_waited, false, GROBO_OK},
    {a_joint_was_behind, true, GROBO_OK},
    {a_joint_was_a_little_behind, false, GROBO_OK},
    {a_joint_got_another_target, true, GROBO_OK},
    {a_joint_got_another_that_left, true, GROBO_OK},
    {its_servo_told_of_a_limit, true, GROBO_OK},
    {all_got_slower, true, GROBO_OK},
    {a_first_move_is_slow, true, GROBO_OK},
    {goals_go_in_segments, true, GROBO_OK},
    {a_joint_is_free, false, GROBO_ERR_STATE},
    {it_stopped, false, GROBO_ERR_LATCHED},
};

/* ---- tests ---- */

TEST_WITH(rig_wirings, a_frame_that_stands_is_the_one_that_is_built_anew)
{
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t bytes[GROBO_FRAME_MAX_BYTES];
        ask(false, false);
        rows[i].happens();
        grobo_robot_slot *slot = frame_of(5);
        assert_int_equal(grobo_i_gate_leave(slot), rows[i].result);
        assert_int_equal(built, rows[i].result == GROBO_OK);
        size_t size = slot->txn.frame_bytes;
        memcpy(bytes, slot->txn.frame, size);

        ask(true, false);
        rows[i].happens();
        slot = frame_of(5);
        assert_int_equal(grobo_i_gate_leave(slot), rows[i].result);
        assert_int_equal(built, rows[i].anew || (held_against && rows[i].result == GROBO_OK));
        assert_int_equal(slot->txn.frame_bytes, size);
        assert_memory_equal(slot->txn.frame, bytes, size);
    }
}

/* What was built anew once does not stand, though nothing is different again. */
TEST_WITH(rig_wirings, an_attempt_after_one_that_was_built_anew_is_built_anew)
{
    ask(true, false);
    grobo_robot_slot *slot = frame_of(5);
    robot.config.speed_limit_pct = 1;
    assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
    assert_int_equal(built, 1);
    robot.config.speed_limit_pct = 100;
    assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
    assert_int_equal(built, 2);
}

/* It comes to rest where it is by then. */
TEST_WITH(rig_wirings, what_rests_is_built_anew)
{
    ask(true, true);
    assert_int_equal(grobo_i_gate_leave(frame_of(5)), GROBO_OK);
    assert_int_equal(built, 1);
}

/* As fast as that takes, by a division of doubles: what integers find sure is no other time. */
TEST_WITH(rig_wirings, the_time_is_the_one_that_doubles_find)
{
    uint32_t seed = 5;
    int stretched = 0;
    start();
    for (int i = 0; i < 20000; i++) {
        int j = i % N;
        double part = (double)next_random(&seed) / 0xFFFFFF;
        double speed_rad_s = driver.model->joints[j].max_speed_rad_s;
        double from_rad = here_rad(j) + RAD(40) * ((double)next_random(&seed) / 0xFFFFFF - 0.5);
        int64_t asked_us = (int64_t)(1 + next_random(&seed) % 60) * 10000;
        robot.config.speed_limit_pct = 1 + (int)(next_random(&seed) % 100);
        speed_rad_s *= robot.config.speed_limit_pct / 100.0;
        /* On the way that may be gone in that time, or close to it. */
        double most_rad = speed_rad_s * (double)asked_us * 1e-6;
        double way_rad = i % 3 == 0 ? most_rad * (1 + (part - 0.5) * 1e-5) : most_rad * 2 * part;
        grobo_robot_order order = {.joints = GROBO_JOINT_BIT(j), .kind = GROBO_I_ORDER_GOAL};
        grobo_target target = {.posture = {.n_joints = (uint8_t)N}};
        robot.axes[j].trajectory = (grobo_robot_trajectory){from_rad, from_rad, NOW - 20, NOW - 10};
        target.posture.set = order.joints;
        target.posture.angle_rad[j] = from_rad + (i % 2 == 0 ? way_rad : -way_rad);
        target.joint_time_us[j] = asked_us;
        double needed_us = (way_rad - driver.angle_step_rad) / speed_rad_s * 1e6;
        assert_int_equal(grobo_i_gate_time(&robot, &order, &target), GROBO_OK);
        assert_true((double)target.joint_time_us[j] >= needed_us * (1 - 1e-9));
        assert_true(target.joint_time_us[j] == asked_us ||
                    (double)target.joint_time_us[j] < needed_us + 10001);
        stretched += target.joint_time_us[j] > asked_us;
    }
    assert_in_range(stretched, 2000, 18000);
}

/* A joint of an arm that was told something after it was read: its halt waits for a reading, which
 * has come since, or for as long as a servo takes to restart. */
TEST_WITH(rig_wirings, a_halt_that_is_owed_leaves_once_its_joint_was_read_since)
{
    for (int j = 0; j < N; j++) {
        start();
        driver.arm = true;
        grobo_robot_axis *axis = &robot.axes[j];
        axis->angle_us = NOW - S;
        axis->told_us = NOW - S / 2;
        robot.halts_owed = GROBO_JOINT_BIT(j);
        robot.halt_us = axis->angle_us;
        assert_true(grobo_i_gate_halt_at(&robot) == NOW);
        robot.halt_us = axis->angle_us + 1;
        assert_true(grobo_i_gate_halt_at(&robot) == robot.halt_us + 3 * GROBO_I_RESTART_US);
    }
}
