/* SPDX-License-Identifier: MIT */
/* What is noted of which joint when a frame leaves. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/robot/speed.h"
#include "tests/support/gate_kit.h"
#include "tests/support/test.h"

/* ---- what is noted --------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_goal_is_noted_of_its_joints_alone)
{
    for (int j = 0; j < N; j++) {
        for (int played = 0; played < 2; played++) {
            start();
            const grobo_joint_mask both = bits(j, other_of(j));
            const grobo_robot_order order = {
                .joints = both, .number = NUMBER, .kind = GROBO_I_ORDER_GOAL, .each = true};
            robot.played_joints = played ? GROBO_JOINT_BIT(third_of(j)) : GROBO_JOINTS_ALL(N);
            robot.axes[j].phase = GROBO_I_JOINT_STRAY; /* it stands where it was read */
            robot.axes[j].trajectory.to_rad += RAD(30);
            await(j, 5, 2 * S);
            await(other_of(j), 5, 2 * S);
            await(third_of(j), 5, 2 * S); /* its frame is another one */
            take(order);
            slot->due_us = played ? NOW : GROBO_NEVER_US;
            assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
            expect_goals(both, 5, 2 * S);
            note_goal(j, 5, 2 * S);
            note_goal(other_of(j), 5, 2 * S);
            expect_axes();
            assert_true(robot.played_joints == (played ? both | GROBO_JOINT_BIT(third_of(j))
                                                       : GROBO_JOINTS_ALL(N) & ~both));
            drop();
        }
    }
}

/* The others that it was asked for are told nothing: what was asked of them before goes on. */
TEST_WITH(rig_wirings, a_halt_is_noted_of_what_moves)
{
    for (int j = 0; j < N; j++) {
        start();
        set_going(j);
        take((grobo_robot_order){.joints = GROBO_JOINTS_ALL(N),
                                 .asked_us = NOW - 10 * MS,
                                 .kind = GROBO_I_ORDER_HALT,
                                 .each = true,
                                 .stops = true});
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        /* 50 ms after it was asked for: 10.4 degrees on the way. */
        note_goal(j, 0, 100 * MS);
        before[j].trajectory.from_rad = here_rad(j) + RAD(10);
        before[j].trajectory.to_rad = robot.axes[j].trajectory.to_rad;
        before[j].last = 0;
        expect_equal(robot.axes[j].trajectory.to_rad, here_rad(j) + RAD(10.4), "where it stops");
        expect_equal(robot.axes[j].trajectory.from_rad, here_rad(j) + RAD(10), "from where");
        before[j].trajectory.from_rad = robot.axes[j].trajectory.from_rad;
        expect_axes();
        expect_goals(GROBO_JOINT_BIT(j), 10.4, 100 * MS);
        assert_true(robot.played_joints == (GROBO_JOINTS_ALL(N) & all_but(j)));
        drop();
    }
}

static int (*true_posture)(const grobo_driver *self, void *ctx, const grobo_target *target,
                           int part, grobo_exchange *exchange);
static double from_rad[GROBO_JOINTS_MAX]; /* of the last frame */

static int catch_posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                         grobo_exchange *exchange)
{
    memcpy(from_rad, target->from_rad, sizeof from_rad);
    return true_posture(self, ctx, target, part, exchange);
}

/* Where the way to a halt at 10.4 degrees begins, of a joint read there. */
static void expect_begin(int j, double read_deg, double begin_deg)
{
    start();
    set_going(j);
    robot.axes[j].state.angle_rad = here_rad(j) + RAD(read_deg);
    true_posture = driver.posture;
    driver.posture = catch_posture;
    int r = leave((grobo_robot_order){.joints = GROBO_JOINTS_ALL(N),
                                      .asked_us = NOW - 10 * MS,
                                      .kind = GROBO_I_ORDER_HALT,
                                      .each = true,
                                      .stops = true});
    driver.posture = true_posture;
    assert_int_equal(r, GROBO_OK);
    expect_equal(from_rad[j], here_rad(j) + RAD(begin_deg), "from where");
    drop();
}

/* For servos that make a speed of it: one that is behind has further to go in the same time. */
TEST_WITH(rig_wirings, a_halt_counts_its_way_from_where_a_joint_was_read)
{
    for (int j = 0; j < N; j++) {
        expect_begin(j, 6, 6);
    }
}

/* 20 degrees a second in its 100 ms: a joint beside where it was read would creep there. */
TEST_WITH(rig_wirings, a_halt_is_no_creeping_to_where_it_ends)
{
    for (int j = 0; j < N; j++) {
        expect_begin(j, 10, 8.4);
    }
}

TEST_WITH(rig_wirings, a_hold_is_noted_of_its_joints_alone)
{
    for (int j = 0; j < N; j++) {
        start();
        make_limp(j);
        make_limp(other_of(j));
        set_going(j);
        robot.axes[j].phase = GROBO_I_JOINT_IN_SEGMENTS;
        robot.axes[other_of(j)].phase = GROBO_I_JOINT_STRAY;
        assert_int_equal(leave((grobo_robot_order){.joints = bits(j, other_of(j)),
                                                   .kind = GROBO_I_ORDER_HOLD,
                                                   .each = true}),
                         GROBO_OK);
        expect_goals(bits(j, other_of(j)), 0, driver.time_step_us);
        for (int i = 0; i < 2; i++) {
            int k = i == 0 ? j : other_of(j);
            before[k].trajectory = (grobo_robot_trajectory){here_rad(k), here_rad(k), NOW, NOW};
            before[k].own_until_us = 0;
            before[k].phase = GROBO_I_JOINT_IDLE;
            before[k].told_us = NOW;
            before[k].last = 0;
        }
        expect_axes();
        assert_true(robot.played_joints == GROBO_JOINTS_ALL(N));
        drop();
    }
}

TEST_WITH(rig_wirings, torque_is_noted_of_its_joints_alone)
{
    for (int j = 0; j < N; j++) {
        for (int mode = GROBO_TORQUE_OFF; mode <= GROBO_TORQUE_BRAKE; mode++) {
            for (int limp = 0; limp < 2; limp++) {
                bool on = mode == GROBO_TORQUE_ON;
                start();
                if (limp) {
                    make_limp(j);
                }
                assert_int_equal(leave((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                                           .asked_us = NOW,
                                                           .kind = GROBO_I_ORDER_TORQUE,
                                                           .torque = (uint8_t)mode}),
                                 GROBO_OK);
                expect_torque(j, (grobo_torque)mode);
                before[j].told_us = NOW;
                before[j].last = 0;
                before[j].torque_known = on && !limp;
                if (!on) {
                    before[j].wants_torque = false;
                    before[j].phase = GROBO_I_JOINT_IDLE;
                }
                expect_axes();
                assert_int_equal(robot.soft, on && limp); /* a hand may have moved it */
                assert_true(!robot.soft || robot.soft_us == GROBO_NEVER_US);
                drop();
            }
        }
    }
}

/* What nobody can read, a setting, a restart: what is known of the joint is no longer true. */
TEST_WITH(rig_wirings, what_leaves_joints_unknown_is_noted_of_them_alone)
{
    static const grobo_i_order_kind kinds[] = {GROBO_I_ORDER_UNKNOWN, GROBO_I_ORDER_SETTING,
                                               GROBO_I_ORDER_COMMAND};
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            start();
            if (kinds[i] == GROBO_I_ORDER_SETTING) {
                robot.axes[j].state.torque = GROBO_TORQUE_OFF;
                robot.axes[other_of(j)].state.torque = GROBO_TORQUE_OFF;
            }
            assert_int_equal(leave((grobo_robot_order){.joints = bits(j, other_of(j)),
                                                       .kind = (uint8_t)kinds[i]}),
                             GROBO_OK);
            for (int k = 0; k < N; k++) {
                if (k == j || k == other_of(j)) {
                    before[k].phase = GROBO_I_JOINT_UNKNOWN;
                    before[k].wants_torque = before[k].torque_known =
                        kinds[i] == GROBO_I_ORDER_UNKNOWN;
                    before[k].own_until_us = 0;
                    before[k].told_us = NOW;
                    before[k].last = 0;
                }
            }
            expect_axes();
            assert_true(robot.soft && robot.soft_us == GROBO_NEVER_US);
            drop();
        }
    }
}

/* Nor does it make known what was not: wanted or not, known or not. */
TEST_WITH(rig_wirings, what_is_unknown_already_stays_so)
{
    start();
    for (int j = 0; j < N; j++) {
        robot.axes[j].wants_torque = j % 2 != 0;
        robot.axes[j].torque_known = j % 3 != 0;
    }
    assert_int_equal(
        leave((grobo_robot_order){.joints = GROBO_JOINTS_ALL(N), .kind = GROBO_I_ORDER_UNKNOWN}),
        GROBO_OK);
    for (int j = 0; j < N; j++) {
        assert_int_equal(robot.axes[j].wants_torque, j % 2 != 0);
        assert_int_equal(robot.axes[j].torque_known, j % 3 != 0);
    }
    drop();
}

TEST_WITH(rig_wirings, what_does_nothing_to_a_joint_notes_nothing)
{
    start();
    assert_int_equal(leave((grobo_robot_order){.kind = GROBO_I_ORDER_NONE}), GROBO_OK);
    expect_axes();
    assert_false(robot.soft);
    assert_true(robot.played_joints == GROBO_JOINTS_ALL(N));
    drop();
}

/* Only how far along its way the joint was told. */
TEST_WITH(rig_wirings, a_segment_is_noted_of_its_joints_alone)
{
    for (int j = 0; j < N; j++) {
        start();
        for (int k = 0; k < N; k++) {
            set_going(k);
            robot.axes[k].phase = GROBO_I_JOINT_IN_SEGMENTS;
            robot.axes[k].told_to_us = NOW + 50 * MS;
        }
        assert_int_equal(leave((grobo_robot_order){.joints = bits(j, other_of(j)),
                                                   .kind = GROBO_I_ORDER_SEGMENT,
                                                   .each = true}),
                         GROBO_OK);
        expect_goals(bits(j, other_of(j)), 13.8, GROBO_SEGMENT_US); /* 10, and 3.8 ahead */
        before[j].told_to_us = before[other_of(j)].told_to_us = NOW + GROBO_SEGMENT_US;
        expect_axes();
        drop();
    }
}

/* Of a longer way its frame asks for a part, and it is told more of it in time. */
TEST_WITH(rig_wirings, a_goal_in_segments_is_noted_of_its_joints_alone)
{
    for (int j = 0; j < N; j++) {
        for (int whole = 0; whole < 2; whole++) {
            const int64_t time_us = whole ? GROBO_SEGMENT_US : GROBO_SEGMENT_US * 2;
            start_with(
                &(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .goals = GROBO_GOALS_SEGMENTS});
            robot.renewed_us = NOW - 1;
            await(j, 10, time_us);
            await(other_of(j), 5, GROBO_SEGMENT_US);
            await(third_of(j), 5, 2 * S); /* in another frame */
            assert_int_equal(leave((grobo_robot_order){.joints = bits(j, other_of(j)),
                                                       .number = NUMBER,
                                                       .kind = GROBO_I_ORDER_GOAL,
                                                       .each = true}),
                             GROBO_OK);
            doubled_goal = whole ? j : -1;
            expect_goals(bits(j, other_of(j)), 5, GROBO_SEGMENT_US);
            doubled_goal = -1;
            note_goal(j, 10, time_us);
            note_goal(other_of(j), 5, GROBO_SEGMENT_US);
            before[j].phase = whole ? GROBO_I_JOINT_SENT : GROBO_I_JOINT_IN_SEGMENTS;
            before[j].told_to_us = whole ? NOW - 7 : NOW + GROBO_SEGMENT_US;
            expect_axes();
            assert_true(robot.renewed_us == (whole ? NOW - 1 : NOW));
            drop();
        }
    }
}

/* ---- the slow first move --------------------------------------------------------------------- */

/* Of a caller's own stream the first is slow until it is there; of played frames the first. */
TEST_WITH(rig_wirings, the_slow_move_is_over_when_its_first_target_is_reached)
{
    for (int j = 0; j < N; j++) {
        for (int how = 0; how < 3; how++) { /* of a stream, of a job, played */
            start();
            grobo_i_gate_soften(&robot);
            await(j, 5, 300 * MS);
            await(other_of(j), 5, 200 * MS);
            take((grobo_robot_order){.joints = bits(j, other_of(j)),
                                     .number = NUMBER,
                                     .kind = GROBO_I_ORDER_GOAL,
                                     .each = true,
                                     .single = how == 0});
            slot->due_us = how == 2 ? NOW : GROBO_NEVER_US;
            assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
            assert_int_equal(robot.soft, how != 2);
            assert_true(robot.soft_us == (how == 0 ? NOW + 300 * MS : GROBO_NEVER_US));
            drop();
            if (how == 0) { /* a second one does not make it longer, and may be 10 ms early */
                robot.now_us = NOW + 290 * MS - 1;
                grobo_i_gate_single(&robot);
                assert_true(robot.soft);
                await(j, 5, 300 * MS);
                assert_int_equal(leave((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                                           .number = NUMBER,
                                                           .kind = GROBO_I_ORDER_GOAL,
                                                           .single = true}),
                                 GROBO_OK);
                drop();
                assert_true(robot.soft_us == NOW + 300 * MS);
                robot.now_us = NOW + 290 * MS;
                grobo_i_gate_single(&robot);
                assert_false(robot.soft);
            }
        }
    }
}
