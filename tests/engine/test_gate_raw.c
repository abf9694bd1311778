/* SPDX-License-Identifier: MIT */
/* Raw frames at the gate: what each is refused for, and what is noted of it. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>

#include "src/robot/speed.h"
#include "tests/support/gate_kit.h"
#include "tests/support/test.h"

/* ---- raw frames ------------------------------------------------------------------------------ */

static int raw(const uint8_t *packet, int size, grobo_robot_order *order)
{
    grobo_exchange exchange = {0};
    assert_true(size > 0);
    int n = grobo_frame_wrap(driver.protocol, packet, (size_t)size, exchange.frame,
                             sizeof exchange.frame);
    exchange.frame_bytes = (uint8_t)n;
    int result = grobo_i_gate_raw(&robot, &exchange, order);
    if (result >= 0) {
        take(*order);
        memcpy(robot.frames, exchange.frame, exchange.frame_bytes);
        slot->txn.frame_bytes = exchange.frame_bytes;
    }
    return result;
}

static int raw_goal_of(int joint, double way_deg, int time_ms, grobo_robot_order *order)
{
    uint8_t packet[GROBO_RS30X_PACKET_MAX_BYTES];
    const grobo_rs30x_goal goal = {(uint8_t)(joint + 1),
                                   (int16_t)lround((joint - 20 + way_deg) * 10),
                                   (uint16_t)(time_ms / 10)};
    return raw(packet, grobo_rs30x_write_goal(&goal, packet, sizeof packet), order);
}

static int raw_torque_of(int joint, grobo_torque torque, grobo_robot_order *order)
{
    uint8_t packet[GROBO_RS30X_PACKET_MAX_BYTES];
    return raw(packet,
               grobo_rs30x_write_u8((uint8_t)(joint + 1), GROBO_RS30X_WANT_NOTHING,
                                    GROBO_RS30X_TORQUE, (uint8_t)torque, packet, sizeof packet),
               order);
}

TEST_WITH(rig_wirings, a_raw_goal_is_noted_like_one_of_ours)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order;
        start();
        assert_int_equal(raw_goal_of(j, 5, 2000, &order), GROBO_OK);
        assert_int_equal(order.kind, GROBO_I_ORDER_RAW);
        assert_true(order.joints == GROBO_JOINT_BIT(j) && order.moves && order.single);
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        note_goal(j, 5, 2 * S);
        before[j].last = 0;
        expect_equal(robot.axes[j].trajectory.to_rad, before[j].trajectory.to_rad, "goal");
        before[j].trajectory.to_rad = robot.axes[j].trajectory.to_rad;
        expect_axes();
        assert_true(robot.played_joints == (GROBO_JOINTS_ALL(N) & all_but(j)));
        drop();
    }
}

TEST_WITH(rig_wirings, a_raw_torque_is_noted_like_one_of_ours)
{
    for (int j = 0; j < N; j++) {
        for (int mode = GROBO_TORQUE_OFF; mode <= GROBO_TORQUE_BRAKE; mode++) {
            grobo_robot_order order;
            bool on = mode == GROBO_TORQUE_ON;
            start();
            assert_int_equal(raw_torque_of(j, (grobo_torque)mode, &order), GROBO_OK);
            assert_int_equal(order.kind, GROBO_I_ORDER_RAW);
            assert_true(order.joints == GROBO_JOINT_BIT(j) && order.moves == on);
            assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
            before[j].told_us = NOW;
            before[j].last = 0;
            if (!on) {
                before[j].wants_torque = before[j].torque_known = false;
                before[j].phase = GROBO_I_JOINT_IDLE;
            }
            expect_axes();
            drop();
        }
    }
}

TEST_WITH(rig_wirings, a_raw_frame_that_reads_is_about_no_joint)
{
    uint8_t packet[GROBO_RS30X_PACKET_MAX_BYTES];
    grobo_robot_order order;
    start();
    latch(GROBO_TRIP_ESTOP);
    assert_int_equal(raw(packet, grobo_rs30x_read(2, 42, 2, packet, sizeof packet), &order),
                     GROBO_OK);
    assert_int_equal(order.kind, GROBO_I_ORDER_NONE);
    assert_true(order.joints == 0 && !order.moves);
    drop();
}

/* What was read to hold within two seconds, by then; what comes off is as old as it may be. */
TEST_WITH(rig_wirings, a_raw_torque_comes_on_where_it_was_read_just_now)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order;
        start();
        robot.axes[other_of(j)].torque_us = 0;
        robot.axes[j].torque_us = NOW - 2 * S - 1;
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_ON, &order), GROBO_ERR_STALE);
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_OFF, &order), GROBO_OK);
        drop();
        robot.axes[j].torque_us = NOW - 2 * S;
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_ON, &order), GROBO_OK);
        robot.now_us = NOW + 1;
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_ERR_STALE);
        expect_axes();
        robot.axes[j].torque_us = NOW - 2 * S + 1;
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        drop();
        robot.axes[j].state.torque = GROBO_TORQUE_BRAKE; /* and it does not hold, however new */
        robot.axes[j].torque_us = NOW + 1;
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_ON, &order), GROBO_ERR_STATE);
    }
}

/* 2 % less than the joint needs is taken for late, and no more. */
TEST_WITH(rig_wirings, a_raw_goal_has_the_time_of_its_joint)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order;
        for (int soft = 0; soft < 2; soft++) {
            for (int ms = 100; ms <= 1000; ms += 300) {
                double most_deg = (soft ? 60 : speed_dps(j)) * ms * 1.02 / 1000 + 0.1;
                int way_ddeg = (int)floor(most_deg * 10 - 0.01);
                int beyond_ddeg = (int)floor(most_deg * 10 + 0.01) + 1;
                double side = j < 20 ? 0.1 : -0.1; /* towards the middle */
                if (way_ddeg > 700) {
                    continue;
                }
                start();
                robot.soft = soft;
                robot.soft_us = GROBO_NEVER_US;
                assert_int_equal(raw_goal_of(j, side * beyond_ddeg, ms, &order), GROBO_ERR_SPEED);
                assert_int_equal(robot.fault_joint, j);
                int result = raw_goal_of(j, side * way_ddeg, ms, &order);
                if (result != GROBO_OK) {
                    fail_msg("joint %d: %d00 mdeg in %d ms: %s", j, way_ddeg, ms,
                             grobo_error_name(result));
                }
                drop();
            }
        }
    }
}

TEST_WITH(rig_wirings, a_raw_frame_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order;
        start();
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
        robot.axes[other_of(j)].torque_known = false;
        assert_int_equal(raw_goal_of(j, 0, 1000, &order), GROBO_ERR_STALE);
        assert_int_equal(robot.fault_joint, j);
        robot.fault_joint = -1;
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_ON, &order), GROBO_ERR_STALE);
        assert_int_equal(robot.fault_joint, j);
        assert_int_equal(raw_torque_of(other_of(j), GROBO_TORQUE_ON, &order), GROBO_ERR_STATE);
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_OFF, &order), GROBO_OK);
        drop();
        start();
        robot.free_joints = GROBO_JOINT_BIT(j);
        robot.axes[other_of(j)].phase = GROBO_I_JOINT_EXTERNAL;
        assert_int_equal(raw_goal_of(j, 0, 1000, &order), GROBO_ERR_STATE);
        assert_int_equal(raw_goal_of(other_of(j), 0, 1000, &order), GROBO_ERR_STATE);
        start();
        latch(GROBO_TRIP_VOLTAGE);
        assert_int_equal(raw_goal_of(j, 0, 1000, &order), GROBO_ERR_LATCHED);
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_ON, &order), GROBO_ERR_LATCHED);
        assert_int_equal(raw_torque_of(j, GROBO_TORQUE_BRAKE, &order), GROBO_OK);
        drop();
        start();
        double end_deg = 70 + j - (j - 20);
        assert_int_equal(raw_goal_of(j, end_deg + 0.1, 2000, &order), GROBO_ERR_LIMIT);
        assert_int_equal(robot.fault_joint, j);
        assert_int_equal(raw_goal_of(j, end_deg, 2000, &order), GROBO_OK);
        drop();
    }
}

/* With no time at all: where it is is not too far, and the slow move is over at once. */
TEST_WITH(rig_wirings, a_raw_goal_to_where_its_joint_is_needs_no_time)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order;
        start();
        grobo_i_gate_soften(&robot);
        assert_int_equal(raw_goal_of(j, 0, 0, &order), GROBO_OK);
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        assert_true(robot.soft && robot.soft_us == NOW);
        drop();
        assert_int_equal(raw_goal_of(j, j < 20 ? 9 : -9, 100, &order), GROBO_OK); /* 90 deg/s */
        assert_false(robot.soft);
        drop();
    }
}

/* It is no first move: the next one is as slow as it would have been. */
TEST_WITH(rig_wirings, a_raw_torque_ends_no_slow_move)
{
    grobo_robot_order order;
    start();
    grobo_i_gate_soften(&robot);
    assert_int_equal(raw_torque_of(3, GROBO_TORQUE_OFF, &order), GROBO_OK);
    assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
    assert_true(robot.soft && robot.soft_us == GROBO_NEVER_US);
    drop();
}

TEST_WITH(rig_wirings, a_raw_frame_that_nobody_can_read_is_refused_unless_asked)
{
    for (int accept = 0; accept < 2; accept++) {
        for (int can_read = 0; can_read < 2; can_read++) {
            uint8_t packet[GROBO_RS30X_PACKET_MAX_BYTES];
            grobo_robot_order order;
            start_with(
                &(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .accept_unknown_raw = accept});
            inspected = GROBO_ERR_UNSUPPORTED;
            driver.inspect = can_read ? driver.inspect : NULL;
            int size = grobo_rs30x_read(2, 42, 2, packet, sizeof packet);
            assert_int_equal(raw(packet, size, &order), accept ? GROBO_OK : GROBO_ERR_UNSUPPORTED);
            if (accept) {
                assert_int_equal(order.kind, GROBO_I_ORDER_UNKNOWN);
                assert_true(order.joints == GROBO_JOINTS_ALL(N) && order.moves && order.single);
                assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
                drop();
            }
        }
    }
    for (int at_once = 0; at_once < 2; at_once++) { /* any other error is what it is */
        grobo_robot_order order;
        start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .accept_unknown_raw = true});
        inspected = at_once ? GROBO_ERR_FRAME : GROBO_OK;
        assert_int_equal(raw_goal_of(1, 0, 1000, &order), inspected);
        if (!at_once) {
            inspected = GROBO_ERR_FRAME;
            assert_int_equal(grobo_i_gate_leave(slot), GROBO_ERR_FRAME);
            expect_axes();
            drop();
        }
    }
}
