/* SPDX-License-Identifier: MIT */
/* The gate, one kind of order after the other: what each is refused for, and which time it gets. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/robot/speed.h"
#include "tests/support/gate_kit.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

/* ---- what is refused ------------------------------------------------------------------------- */

static int judge(grobo_robot_order order)
{
    return grobo_i_gate_judge(&robot, &order, NULL);
}

TEST_WITH(rig_wirings, a_goal_is_judged_as_it_leaves)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order = {
            .joints = bits(j, other_of(j)), .number = NUMBER, .kind = GROBO_I_ORDER_GOAL};
        start();
        assert_int_equal(judge(order), GROBO_ERR_SUPERSEDED); /* none waits */
        await(j, 1, S);
        assert_int_equal(judge(order), GROBO_OK);
        robot.axes[other_of(j)].phase =
            GROBO_I_JOINT_UNKNOWN; /* another one's is not needed any more */
        assert_int_equal(judge(order), GROBO_OK);
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
        robot.fault_joint = -1;
        assert_int_equal(leave(order), GROBO_ERR_STALE);
        assert_int_equal(robot.fault_joint, j);
        expect_axes();
        drop();
        robot.axes[j].phase = GROBO_I_JOINT_SENT;
        robot.free_joints = GROBO_JOINT_BIT(other_of(j));
        assert_int_equal(judge(order), GROBO_OK);
        robot.free_joints = GROBO_JOINT_BIT(j);
        assert_int_equal(judge(order), GROBO_ERR_STATE);
        assert_int_equal(robot.fault_joint, -1);
        robot.free_joints = 0;
        robot.axes[other_of(j)].phase = GROBO_I_JOINT_EXTERNAL;
        assert_int_equal(judge(order), GROBO_OK);
        robot.axes[j].phase = GROBO_I_JOINT_EXTERNAL;
        assert_int_equal(judge(order), GROBO_ERR_STATE);
        assert_int_equal(robot.fault_joint, j);
        robot.axes[j].phase = GROBO_I_JOINT_SENT;
        latch(GROBO_TRIP_LOST_REPLIES);
        assert_int_equal(judge(order), GROBO_ERR_LATCHED);
        order.stops = true;
        assert_int_equal(judge(order), GROBO_OK);
        latch(GROBO_TRIP_ESTOP);
        assert_int_equal(judge(order), GROBO_ERR_LATCHED);
    }
}

/* Of servos that a goal switches on: those that are known to hold, and were heard lately. */
TEST_WITH(rig_wirings, a_goal_that_would_wake_a_servo_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order goal = {
            .joints = GROBO_JOINT_BIT(j), .number = NUMBER, .kind = GROBO_I_ORDER_GOAL};
        for (int wakes = 0; wakes < 2; wakes++) {
            start();
            driver.goal_energises = wakes;
            robot.axes[j].heard_us = NOW - GROBO_I_RESTART_US;
            await(j, 1, S);
            assert_int_equal(judge(goal), GROBO_OK);
            make_limp(other_of(j));
            assert_int_equal(judge(goal), GROBO_OK);
            make_limp(j);
            assert_int_equal(judge(goal), wakes ? GROBO_ERR_STATE : GROBO_OK);
            robot.axes[j].heard_us--;
            assert_int_equal(judge(goal), wakes ? GROBO_ERR_EMPTY : GROBO_OK);
        }
    }
    driver.goal_energises = false;
}

/* Torque that comes on and waits is not for a joint that is to be without; else it is. */
TEST_WITH(rig_wirings, torque_off_and_brake_take_back_torque_on_that_waits)
{
    static const grobo_torque modes[] = {GROBO_TORQUE_OFF, GROBO_TORQUE_ON, GROBO_TORQUE_BRAKE};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
            const grobo_joint_mask joint = GROBO_JOINT_BIT(j);
            start();
            make_limp(j);
            assert_int_equal(grobo_i_gate_torque(&robot, joint, GROBO_TORQUE_ON, GROBO_I_WHOLE),
                             GROBO_OK);
            const grobo_txn *first = &robot.slots[0].txn;
            assert_true(grobo_txn_is_pending(first));
            assert_int_equal(grobo_i_gate_torque(&robot, joint, modes[i], GROBO_I_WHOLE), GROBO_OK);
            bool on = modes[i] == GROBO_TORQUE_ON;
            assert_int_equal(grobo_bus_pending(&robot.bus), on ? 2 : 1);
            assert_true(grobo_i_slots_wait(&robot, joint, GROBO_I_ORDER_TORQUE, modes[i]));
            assert_int_equal(
                grobo_i_slots_wait(&robot, joint, GROBO_I_ORDER_TORQUE, GROBO_TORQUE_ON), on);
        }
    }
}

/* What has left goes again, or its next part, until another one waits or has left. */
TEST_WITH(rig_wirings, a_goal_goes_again_until_another_takes_its_place)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order order = {
            .joints = GROBO_JOINT_BIT(j), .number = NUMBER, .kind = GROBO_I_ORDER_GOAL};
        start();
        await(j, 5, 2 * S);
        robot.axes[j].next = 0;
        robot.axes[j].last = NUMBER;
        assert_int_equal(leave(order), GROBO_OK);
        expect_goals(order.joints, 5, 2 * S);
        drop();
        robot.axes[j].next = NUMBER + 1;
        assert_int_equal(judge(order), GROBO_ERR_SUPERSEDED);
        robot.axes[j].next = 0;
        robot.axes[j].last = NUMBER + 1;
        assert_int_equal(judge(order), GROBO_ERR_SUPERSEDED);
    }
}

TEST_WITH(rig_wirings, a_halt_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order order = {.joints = GROBO_JOINT_BIT(j),
                                         .asked_us = NOW,
                                         .kind = GROBO_I_ORDER_HALT,
                                         .each = true};
        start();
        set_going(other_of(j));
        assert_int_equal(judge(order), GROBO_ERR_EMPTY);
        set_going(j);
        assert_int_equal(judge(order), GROBO_OK);
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
        assert_int_equal(judge(order), GROBO_ERR_EMPTY);
        robot.axes[j].phase = GROBO_I_JOINT_SENT;
        make_limp(j);
        assert_int_equal(judge(order), GROBO_ERR_EMPTY);
        robot.axes[j].torque_known = false; /* it may have torque all the same */
        assert_int_equal(judge(order), GROBO_OK);
        latch(GROBO_TRIP_CURRENT);
        assert_int_equal(judge(order), GROBO_OK);
        latch(GROBO_TRIP_ESTOP);
        assert_int_equal(judge(order), GROBO_ERR_LATCHED);
        robot.holds_at_stop = true;
        assert_int_equal(judge(order), GROBO_OK);
    }
}

/* 50 ms after it was asked for, or 25 ms from now; drawn to the limits; half the speed. */
TEST_WITH(rig_wirings, a_halt_stops_ahead_of_where_joints_are)
{
    static const struct {
        int ago_ms;
        double way_deg;
    } rows[] = {{0, 10.5}, {1, 10.49}, {24, 10.26}, {25, 10.25}, {26, 10.25}, {500, 10.25}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            set_going(j);
            assert_int_equal(leave((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                                       .asked_us = NOW - rows[i].ago_ms * MS,
                                                       .kind = GROBO_I_ORDER_HALT,
                                                       .each = true,
                                                       .stops = true}),
                             GROBO_OK);
            expect_equal(robot.axes[j].trajectory.to_rad, here_rad(j) + RAD(rows[i].way_deg),
                         "its rest");
            assert_true(robot.axes[j].trajectory.to_us == NOW + 100 * MS);
            drop();
        }
    }
}

TEST_WITH(rig_wirings, a_hold_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order order = {
            .joints = GROBO_JOINT_BIT(j), .kind = GROBO_I_ORDER_HOLD, .each = true};
        start();
        make_limp(other_of(j));
        assert_int_equal(judge(order), GROBO_ERR_STATE); /* it has torque */
        make_limp(j);
        assert_int_equal(judge(order), GROBO_OK);
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
        assert_int_equal(judge(order), GROBO_ERR_STATE);
        robot.axes[j].phase = GROBO_I_JOINT_SENT;
        for (int end = -1; end <= 1; end += 2) { /* 3 degrees outside at most */
            robot.axes[j].state.angle_rad = end * RAD(70 + j + 3.01);
            assert_int_equal(judge(order), GROBO_ERR_STATE);
            robot.axes[j].state.angle_rad = end * RAD(70 + j + 2.99);
            robot.axes[j].state.torque = GROBO_TORQUE_OFF;
            assert_int_equal(leave(order), GROBO_OK);
            /* at 60 deg/s, in steps of 10 ms */
            expect_goals(order.joints, end * (70 + j) - (j - 20), 5 * driver.time_step_us);
            drop();
        }
        latch(GROBO_TRIP_LIMIT);
        assert_int_equal(judge(order), GROBO_ERR_LATCHED);
    }
}

TEST_WITH(rig_wirings, torque_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_order order = {.joints = GROBO_JOINT_BIT(j),
                                   .asked_us = NOW,
                                   .kind = GROBO_I_ORDER_TORQUE,
                                   .torque = GROBO_TORQUE_ON};
        start();
        make_limp(j);
        robot.axes[other_of(j)].phase = GROBO_I_JOINT_IDLE;
        assert_int_equal(judge(order), GROBO_OK);
        order.asked_us = NOW - 2 * S;
        assert_int_equal(judge(order), GROBO_OK);
        order.asked_us = NOW - 2 * S - 1; /* waited for too long */
        assert_int_equal(judge(order), GROBO_ERR_STATE);
        order.asked_us = NOW;
        robot.axes[j].phase = GROBO_I_JOINT_IDLE;
        assert_int_equal(judge(order), GROBO_ERR_STATE);
        robot.axes[j].phase = GROBO_I_JOINT_READY;
        for (int end = -1; end <= 1; end += 2) { /* 2 degrees from its goal at most */
            robot.axes[j].state.goal_rad = here_rad(j) + end * RAD(2.01);
            assert_false(grobo_i_goal_holds(&robot, j));
            assert_int_equal(judge(order), GROBO_ERR_STATE);
            robot.axes[j].state.goal_rad = here_rad(j) + end * RAD(1.99);
            assert_true(grobo_i_goal_holds(&robot, j));
            assert_int_equal(judge(order), GROBO_OK);
        }
        robot.axes[j].state.angle_rad = 0;
        robot.axes[j].state.goal_rad = grobo_rad_from_deg(2);
        assert_true(grobo_i_goal_holds(&robot, j));
        latch(GROBO_TRIP_LIMIT);
        assert_int_equal(judge(order), GROBO_ERR_LATCHED);
        order.torque = GROBO_TORQUE_BRAKE;
        assert_int_equal(judge(order), GROBO_OK);
        order.torque = GROBO_TORQUE_OFF;
        robot.axes[j].phase = GROBO_I_JOINT_IDLE;
        assert_int_equal(judge(order), GROBO_OK);
    }
}

/* A frame for two joints of which one is not held switches the other alone. */
TEST_WITH(rig_wirings, torque_comes_on_for_those_that_are_held)
{
    for (int j = 0; j < N; j++) {
        start();
        make_limp(j);
        make_limp(other_of(j));
        robot.axes[other_of(j)].phase = GROBO_I_JOINT_IDLE;
        assert_int_equal(leave((grobo_robot_order){.joints = bits(j, other_of(j)),
                                                   .asked_us = NOW,
                                                   .kind = GROBO_I_ORDER_TORQUE,
                                                   .torque = GROBO_TORQUE_ON}),
                         GROBO_OK);
        expect_torque(j, GROBO_TORQUE_ON);
        drop();
    }
}

TEST_WITH(rig_wirings, a_segment_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order order = {
            .joints = GROBO_JOINT_BIT(j), .kind = GROBO_I_ORDER_SEGMENT, .each = true};
        start();
        set_going(j);
        set_going(other_of(j));
        robot.axes[other_of(j)].phase = GROBO_I_JOINT_IN_SEGMENTS;
        robot.axes[other_of(j)].told_to_us = NOW + 1;
        assert_int_equal(judge(order), GROBO_ERR_EMPTY);
        robot.axes[j].phase = GROBO_I_JOINT_IN_SEGMENTS;
        robot.axes[j].told_to_us = NOW;
        assert_int_equal(judge(order), GROBO_ERR_EMPTY); /* it stands */
        robot.axes[j].told_to_us = NOW + 1;
        assert_int_equal(judge(order), GROBO_OK);
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN; /* what is forgotten is told no more */
        assert_int_equal(judge(order), GROBO_ERR_EMPTY);
        robot.axes[j].phase = GROBO_I_JOINT_IN_SEGMENTS;
        robot.free_joints = GROBO_JOINT_BIT(j);
        assert_int_equal(judge(order), GROBO_ERR_STATE);
        robot.free_joints = 0;
        latch(GROBO_TRIP_CURRENT);
        assert_int_equal(judge(order), GROBO_ERR_LATCHED);
    }
}

TEST_WITH(rig_wirings, a_setting_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order order = {.joints = GROBO_JOINT_BIT(j),
                                         .kind = GROBO_I_ORDER_SETTING};
        start();
        make_limp(j);
        assert_int_equal(judge(order), GROBO_OK);
        for (int has = GROBO_TORQUE_OFF; has <= GROBO_TORQUE_BRAKE; has++) {
            robot.axes[j].state.torque = (grobo_torque)has;
            assert_int_equal(judge(order), has == GROBO_TORQUE_ON ? GROBO_ERR_STATE : GROBO_OK);
        }
        robot.axes[j].torque_known = false;
        assert_int_equal(judge(order), GROBO_ERR_STALE);
        take(order); /* its first attempt is why: a second may leave */
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_ERR_STALE);
        slot->txn.sent_us = NOW - 5;
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        slot->txn.sent_us = robot.axes[j].told_us = 0; /* where the clock may begin */
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        drop();
    }
}

TEST_WITH(rig_wirings, what_needs_silence_is_refused_while_something_moves)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order command = {.joints = GROBO_JOINT_BIT(other_of(j)),
                                           .kind = GROBO_I_ORDER_COMMAND};
        const grobo_robot_order unknown = {.joints = GROBO_JOINTS_ALL(N),
                                           .kind = GROBO_I_ORDER_UNKNOWN};
        start();
        assert_int_equal(judge(command), GROBO_OK);
        assert_int_equal(judge(unknown), GROBO_OK);
        set_going(j);
        assert_int_equal(judge(command), GROBO_ERR_STATE);
        assert_int_equal(judge(unknown), GROBO_ERR_STATE);
        start();
        await(j, 0, S);
        assert_int_equal(judge(command), GROBO_ERR_STATE);
        assert_int_equal(judge(unknown), GROBO_ERR_STATE);
        start();
        latch(GROBO_TRIP_ESTOP);
        assert_int_equal(judge(command), GROBO_OK);
        assert_int_equal(judge(unknown), GROBO_ERR_LATCHED);
    }
}

/* Another frame has told one of its joints something since the first attempt. */
TEST_WITH(rig_wirings, a_second_attempt_is_passed_by_what_left_since)
{
    for (int j = 0; j < N; j++) {
        start();
        take((grobo_robot_order){.joints = bits(j, other_of(j)),
                                 .kind = GROBO_I_ORDER_TORQUE,
                                 .torque = GROBO_TORQUE_OFF});
        slot->txn.sent_us = NOW - 7; /* all were told something then */
        robot.axes[third_of(j)].told_us = NOW;
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        for (int i = 0; i < 2; i++) {
            robot.axes[j].told_us = robot.axes[other_of(j)].told_us = NOW - 7;
            robot.axes[i == 0 ? j : other_of(j)].told_us = NOW - 6;
            keep_axes();
            assert_int_equal(grobo_i_gate_leave(slot), GROBO_ERR_SUPERSEDED);
            expect_axes();
        }
        slot->txn.sent_us = -1; /* a first attempt is passed by nothing */
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
        slot->txn.sent_us = 0; /* the clock may begin there */
        assert_int_equal(grobo_i_gate_leave(slot), GROBO_ERR_SUPERSEDED);
        drop();
    }
}

/* The driver has no such part, and so nothing leaves. */
TEST_WITH(rig_wirings, a_frame_that_there_is_not_does_not_leave)
{
    for (int torque = 0; torque < 2; torque++) {
        start();
        await(4, 1, S);
        assert_int_equal(leave((grobo_robot_order){
                             .joints = GROBO_JOINT_BIT(4),
                             .number = NUMBER,
                             .kind = (uint8_t)(torque ? GROBO_I_ORDER_TORQUE : GROBO_I_ORDER_GOAL),
                             .part = 1}),
                         GROBO_ERR_EMPTY);
        expect_axes();
        drop();
    }
}

/* What does not fit the first frame is in the second; in one frame is asked for or refused. */
TEST_WITH(rig_wirings, each_part_has_joints_of_its_own)
{
    grobo_robot_order order = {.joints = GROBO_JOINTS_ALL(N), .number = 1};
    for (int torque = 0; torque < 2; torque++) {
        int next = 0;
        start();
        for (int j = 0; j < N; j++) {
            await(j, 0, S);
            robot.axes[j].next = 1;
        }
        order.kind = torque ? GROBO_I_ORDER_TORQUE : GROBO_I_ORDER_GOAL;
        order.part = 0;
        grobo_exchange exchange;
        int result = grobo_i_gate_build(&robot, &order, &exchange);
        for (; leave(order) == GROBO_OK; order.part++) {
            rig_frame frame = {.size = (uint8_t)slot->txn.frame_bytes};
            memcpy(frame.bytes, slot->txn.frame, frame.size);
            const uint8_t *packet;
            assert_true(rig_packet(&frame, &packet) > 8);
            for (int i = 0; i < packet[6]; i++) {
                assert_int_equal(packet[7 + i * packet[5]], ++next);
            }
            drop();
            if (order.part > 0) {
                order.number = 1;
                assert_int_equal(grobo_i_gate_build(&robot, &order, &exchange), 1);
                assert_memory_equal(exchange.frame, frame.bytes, frame.size);
            }
        }
        drop();
        assert_int_equal(next, N);
        assert_int_equal(result, order.part > 1 ? GROBO_ERR_CAP : 1);
        assert_int_equal(grobo_i_gate_build(&robot, &order, &exchange), 0);
        assert_true(torque == 1 || robot.axes[0].next == 0);
    }
}

static int parts; /* that the driver needs, whatever for */
static grobo_driver whole = GROBO_TABLE_INIT(grobo_driver);

static int posture_in_parts(const grobo_driver *self, void *ctx, const grobo_target *target,
                            int part, grobo_exchange *exchange)
{
    int result = whole.posture(self, ctx, target, 0, exchange);
    return part < parts ? result : parts < 0 ? GROBO_ERR_SPACE : 0;
}

/* Several joints go into one frame, or are asked for in smaller frames; one may need more. */
TEST_WITH(rig_wirings, several_joints_go_in_one_frame)
{
    static const struct {
        int joints, parts, part, result;
    } rows[] = {{1, 1, 0, 1},
                {1, 2, 0, 1},
                {1, 2, 1, 1},
                {1, 2, 2, 0},
                {1, 0, 0, 0},
                {2, 1, 0, 1},
                {2, 2, 0, GROBO_ERR_CAP},
                {2, 3, 0, GROBO_ERR_CAP},
                {2, 2, 1, 1},
                {2, 2, 2, 0},
                {2, 0, 0, 0},
                {2, -1, 0, GROBO_ERR_SPACE},
                {1, -1, 0, GROBO_ERR_SPACE}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_robot_order order = {.joints = rows[i].joints == 1 ? 1 : 3,
                                   .number = NUMBER,
                                   .kind = GROBO_I_ORDER_GOAL,
                                   .part = (uint8_t)rows[i].part};
        grobo_exchange exchange;
        start();
        whole = driver;
        driver.posture = posture_in_parts;
        parts = rows[i].parts;
        assert_int_equal(grobo_i_gate_build(&robot, &order, &exchange), GROBO_ERR_SUPERSEDED);
        await(0, 1, S);
        await(1, 1, S);
        assert_int_equal(grobo_i_gate_build(&robot, &order, &exchange), rows[i].result);
    }
}

TEST_WITH(rig_wirings, only_the_target_of_that_number_waits_no_more)
{
    for (int j = 0; j < N; j++) {
        start();
        await(j, 1, S);
        await(other_of(j), 1, S);
        robot.axes[third_of(j)].next = NUMBER + 1;
        keep_axes();
        grobo_i_gate_unwait(&robot, &(grobo_robot_order){.joints = GROBO_JOINTS_ALL(N)});
        grobo_i_gate_unwait(&robot, &(grobo_robot_order){.joints = GROBO_JOINTS_ALL(N) &
                                                                   ~GROBO_JOINT_BIT(j) &
                                                                   all_but(other_of(j)),
                                                         .number = NUMBER});
        expect_axes();
        grobo_i_gate_unwait(&robot,
                            &(grobo_robot_order){.joints = bits(j, third_of(j)), .number = NUMBER});
        before[j].next = 0;
        expect_axes();
    }
}

/* ---- time ------------------------------------------------------------------------------------ */

static int64_t steps_up(double time_us)
{
    return (int64_t)ceil(time_us / 10000 - 1e-9) * 10000;
}

TEST_WITH(rig_wirings, times_are_what_speeds_make_them)
{
    static const struct {
        int pct;
        double approach_dps;
        bool soft;
    } rows[] = {{100, 60, false}, {10, 60, false}, {99, 60, false}, {1, 60, false},
                {100, 60, true},  {100, 7, true},  {10, 60, true},  {10, 500, true}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = rows[i].pct,
                                           .approach_dps = rows[i].approach_dps};
        for (int j = 0; j < N; j++) {
            grobo_robot_order order = {.each = true, .soft = rows[i].soft};
            grobo_target target = {0};
            start_with(&config);
            double way_deg = j < 20 ? 50.037 : -50.037;
            double limit_dps = speed_dps(j) * rows[i].pct / 100;
            double dps = rows[i].soft ? fmin(rows[i].approach_dps, limit_dps) : limit_dps;
            int64_t be_us = steps_up((50.037 - 0.1) / dps * 1e6);
            assert_int_equal(grobo_posture_init(&target.posture, N), 0);
            target.posture.set = bits(j, other_of(j));
            target.posture.angle_rad[j] = here_rad(j) + RAD(way_deg);
            target.posture.angle_rad[other_of(j)] = here_rad(other_of(j));
            for (int each = 1; each >= 0; each--) {
                order.each = each;
                assert_int_equal(grobo_i_gate_time(&robot, &order, &target), GROBO_OK);
                for (int k = 0; k < N; k++) {
                    int64_t needs_us = k == j ? be_us : k == other_of(j) ? 10000 : 0;
                    int64_t gets_us = each ? needs_us : be_us;
                    if (target.joint_time_us[k] != gets_us) {
                        fail_msg("joint %d of %d: %lld us, not %lld", k, j,
                                 (long long)target.joint_time_us[k], (long long)gets_us);
                    }
                }
            }
            assert_int_equal(robot.counters.stretched, 1);
            target.joint_time_us[j] -= 10000; /* any of it counts, and all of it once */
            assert_int_equal(grobo_i_gate_time(&robot, &order, &target), GROBO_OK);
            assert_int_equal(robot.counters.stretched, 2);
        }
    }
}

/* What is long enough stays, each joint by itself; a unit less is stretched by it. */
TEST_WITH(rig_wirings, a_goal_keeps_a_time_that_is_long_enough)
{
    static const int pcts[] = {100, 50, 1};
    for (int i = 0; i < 3 * N; i++) {
        const int j = i / 3, pct = pcts[i % 3];
        const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = pct};
        const grobo_robot_order order = {.kind = GROBO_I_ORDER_GOAL, .each = true};
        const int64_t be_us = steps_up((50.037 - 0.1) / (speed_dps(j) * pct / 100) * 1e6);
        for (int64_t more_us = -10000; more_us <= 10000; more_us += 10000) {
            grobo_target target = {0};
            start_with(&config);
            robot.soft = false;
            assert_int_equal(grobo_posture_init(&target.posture, N), 0);
            target.posture.set = bits(j, other_of(j));
            target.posture.angle_rad[j] = here_rad(j) + RAD(j < 20 ? 50.037 : -50.037);
            target.posture.angle_rad[other_of(j)] = here_rad(other_of(j));
            target.joint_time_us[j] = be_us + more_us;
            target.joint_time_us[other_of(j)] = 100 * (int64_t)S;
            assert_int_equal(grobo_i_gate_time(&robot, &order, &target), GROBO_OK);
            assert_true(target.joint_time_us[j] == be_us + (more_us < 0 ? 0 : more_us));
            assert_true(target.joint_time_us[other_of(j)] == 100 * (int64_t)S);
            assert_int_equal(robot.counters.stretched, more_us < 0);
        }
    }
}

/* A time off the wire's grid would be rounded down there, and one past its end cut. */
TEST_WITH(rig_wirings, a_time_that_the_wire_does_not_have_is_no_long_enough_one)
{
    grobo_target target = {0};
    start();
    robot.soft = false;
    const grobo_driver kept = driver;
    assert_int_equal(grobo_posture_init(&target.posture, N), 0);
    target.posture.set = 1;
    driver.time_step_us = 30000;
    target.posture.angle_rad[0] = here_rad(0) + RAD(speed_dps(0) * 0.095);
    target.joint_time_us[0] = 100000;
    const grobo_robot_order halt = {.kind = GROBO_I_ORDER_HALT, .each = true};
    assert_int_equal(grobo_i_gate_time(&robot, &halt, &target), GROBO_OK);
    assert_int_equal(target.joint_time_us[0], 120000);
    driver.time_step_us = 10000;
    driver.time_max_us = 105000; /* ten units, and half of one */
    target.posture.angle_rad[0] = here_rad(0) + RAD(speed_dps(0) * 0.104 + 0.1);
    target.joint_time_us[0] = 110000;
    const grobo_robot_order goal = {.kind = GROBO_I_ORDER_GOAL, .each = true};
    assert_int_equal(grobo_i_gate_time(&robot, &goal, &target), GROBO_ERR_SPEED);
    driver = kept;
}

/* Of an odd number of joints, too, and of none beyond them. */
TEST_WITH(rig_wirings, all_joints_of_a_move_get_its_time)
{
    for (int n = N - 1; n <= N; n++) {
        grobo_target target = {0};
        make_robot(n, NULL);
        assert_int_equal(grobo_posture_init(&target.posture, n), 0);
        target.posture.set = 2;
        target.posture.angle_rad[1] = RAD(50);
        assert_int_equal(grobo_i_gate_time(&robot, &(grobo_robot_order){0}, &target), GROBO_OK);
        for (int j = 0; j < N; j++) {
            assert_int_equal(target.joint_time_us[j], j < n ? 840000 : 0); /* 49.9 at 60 deg/s */
        }
    }
}

/* From where the joint is on its way by now, whatever the target asks for. */
TEST_WITH(rig_wirings, a_goal_that_leaves_late_gets_the_time_from_there)
{
    for (int j = 0; j < N; j++) {
        for (int soft = 0; soft < 2; soft++) {
            start();
            set_going(j);
            await(j, -30, 10 * MS);
            take((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                     .number = NUMBER,
                                     .kind = GROBO_I_ORDER_GOAL,
                                     .soft = soft,
                                     .each = true});
            assert_int_equal(grobo_i_gate_leave(slot), GROBO_OK);
            int64_t be_us = steps_up((40 - 0.1) / (soft ? 60 : speed_dps(j)) * 1e6);
            if (robot.axes[j].trajectory.to_us != NOW + be_us) {
                fail_msg("joint %d: %lld us, not %lld", j,
                         (long long)(robot.axes[j].trajectory.to_us - NOW), (long long)be_us);
            }
            drop();
        }
    }
}

/* The wire has no more than so many steps. */
TEST_WITH(rig_wirings, a_time_longer_than_the_wire_has_is_refused)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order order = {.each = true, .soft = true};
        const double most_deg = 0.5 * (double)GROBO_PLAY_TIME_MAX_US / 1e6 + 0.1;
        for (int beyond = 0; beyond < 2; beyond++) {
            grobo_target target = {0};
            start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .approach_dps = 0.5});
            robot.axes[j].trajectory.to_rad = RAD(-40);
            assert_int_equal(grobo_posture_init(&target.posture, N), 0);
            target.posture.set = bits(j, other_of(j));
            target.posture.angle_rad[j] = RAD(-40 + most_deg + (beyond ? 0.001 : -0.001));
            target.posture.angle_rad[other_of(j)] = here_rad(other_of(j));
            robot.fault_joint = -1;
            assert_int_equal(grobo_i_gate_time(&robot, &order, &target),
                             beyond ? GROBO_ERR_SPEED : GROBO_OK);
            assert_int_equal(robot.fault_joint, beyond ? j : -1);
            assert_true(beyond || target.joint_time_us[j] == GROBO_PLAY_TIME_MAX_US);
        }
    }
}

/* A slow first move takes no less than a halt where the joint still moves. */
TEST_WITH(rig_wirings, one_that_moves_is_not_caught_up_softly)
{
    for (int j = 0; j < N; j++) {
        for (int soft = 0; soft < 2; soft++) {
            for (int moves = 0; moves < 2; moves++) {
                const grobo_robot_order order = {.each = true, .soft = soft};
                grobo_target target = {0};
                start();
                robot.axes[j].trajectory.to_us = NOW + moves;
                assert_int_equal(grobo_posture_init(&target.posture, N), 0);
                target.posture.set = GROBO_JOINT_BIT(j);
                target.posture.angle_rad[j] = here_rad(j);
                assert_int_equal(grobo_i_gate_time(&robot, &order, &target), GROBO_OK);
                assert_int_equal(target.joint_time_us[j], soft && moves ? 100000 : 10000);
                target.joint_time_us[j] = 150000; /* one that is long enough stays */
                assert_int_equal(grobo_i_gate_time(&robot, &order, &target), GROBO_OK);
                assert_int_equal(target.joint_time_us[j], 150000);
            }
        }
    }
}

TEST_WITH(rig_wirings, a_target_of_no_joint_takes_no_time)
{
    grobo_target target = {0};
    start();
    assert_int_equal(grobo_i_gate_time(&robot, &(grobo_robot_order){0}, &target), GROBO_OK);
    for (int j = 0; j < N; j++) {
        assert_int_equal(target.joint_time_us[j], 0);
    }
    assert_int_equal(robot.counters.stretched, 0);
}

/* The end of a motion: at most half of the way that the joint would go in its time, from where it
 * is, and no faster than it may; and not behind it. */
TEST_WITH(rig_wirings, a_motion_rests_near_where_joints_are)
{
    for (int j = 0; j < N; j++) {
        for (int side = -1; side <= 1; side += 2) {
            for (int how = 0; how < 8; how++) {
                bool far = how % 2 != 0;
                bool soft = how / 2 == 1 || how / 2 == 2; /* the robot, or the order */
                double most_deg = (soft ? 60 : 80) * 0.04 / 2;
                double way_deg = side * (most_deg + (far ? 1 : -0.5));
                start();
                robot.soft = how / 2 == 1;
                robot.axes[j].trajectory = (grobo_robot_trajectory){
                    here_rad(j), here_rad(j) + RAD(20), NOW - S / 8, NOW + S / 8}; /* 80 deg/s */
                await(j, 10 + way_deg, 40 * MS);
                assert_int_equal(leave((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                                           .number = NUMBER,
                                                           .kind = GROBO_I_ORDER_GOAL,
                                                           .each = true,
                                                           .soft = how / 2 == 2,
                                                           .rests = true}),
                                 GROBO_OK);
                double on_deg = side < 0 ? 0 : far ? most_deg : way_deg;
                expect_equal(robot.axes[j].trajectory.to_rad, here_rad(j) + RAD(10 + on_deg),
                             "its rest");
                drop();
            }
        }
    }
}

/* A joint may have sagged outside its limits: it rests, or stops, at them. */
TEST_WITH(rig_wirings, nothing_rests_outside_the_limits)
{
    for (int j = 0; j < N; j++) {
        for (int halts = 0; halts < 2; halts++) {
            start();
            robot.axes[j].trajectory =
                (grobo_robot_trajectory){RAD(72 + j), RAD(78 + j), NOW - S, NOW + S};
            robot.axes[j].seen_rad = RAD(75 + j);
            robot.axes[j].next = NUMBER;
            robot.axes[j].next_rad = RAD(70 + j);
            robot.axes[j].next_time_us = 10 * MS;
            assert_int_equal(
                leave((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                          .number = NUMBER,
                                          .asked_us = NOW,
                                          .kind = halts ? GROBO_I_ORDER_HALT : GROBO_I_ORDER_GOAL,
                                          .each = true,
                                          .rests = true}),
                GROBO_OK);
            expect_equal(robot.axes[j].trajectory.to_rad, RAD(70 + j), "its rest");
            drop();
        }
    }
}

/* By a raw frame or a halt: the joint stops where it is 50 ms later, wherever the clip is. */
TEST_WITH(rig_wirings, a_motion_rests_where_others_have_joints_stand)
{
    for (int j = 0; j < N; j++) {
        start();
        set_going(j);
        await(j, 30, 40 * MS);
        robot.axes[j].last = 0;
        assert_int_equal(leave((grobo_robot_order){.joints = GROBO_JOINT_BIT(j),
                                                   .number = NUMBER,
                                                   .kind = GROBO_I_ORDER_GOAL,
                                                   .each = true,
                                                   .rests = true}),
                         GROBO_OK);
        expect_equal(robot.axes[j].trajectory.to_rad, here_rad(j) + RAD(10.5), "its rest");
        drop();
    }
}

/* ---- what may be asked ----------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_target_is_checked_for_numbers_and_limits)
{
    for (int j = 0; j < N; j++) {
        for (int clamp = 0; clamp < 2; clamp++) {
            grobo_posture target;
            start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT,
                                             .limit_policy =
                                                 clamp ? GROBO_LIMIT_CLAMP : GROBO_LIMIT_REFUSE});
            assert_int_equal(grobo_posture_init(&target, N), 0);
            target.set = bits(j, other_of(j));
            target.angle_rad[j] = RAD(70 + j);
            robot.fault_joint = 99;
            robot.fault_deg = 99;
            assert_int_equal(grobo_i_gate_target(&robot, &target), GROBO_OK);
            assert_int_equal(robot.fault_joint, -1);
            expect_equal(robot.fault_deg, 0, "no fault");
            assert_int_equal(robot.counters.clamped, 0);
            target.angle_rad[j] = -RAD(71 + j);
            assert_int_equal(grobo_i_gate_target(&robot, &target),
                             clamp ? GROBO_OK : GROBO_ERR_LIMIT);
            expect_equal(target.angle_rad[j], -RAD(clamp ? 70 + j : 71 + j), "target");
            assert_int_equal(robot.counters.clamped, clamp);
            if (!clamp) {
                assert_int_equal(robot.fault_joint, j);
                expect_equal(robot.fault_deg, -71 - j, "fault");
            }
            target.angle_rad[j] = NAN;
            target.angle_rad[other_of(j)] = RAD(200);
            robot.fault_joint = 99;
            robot.fault_deg = 99;
            int result = grobo_i_gate_target(&robot, &target);
            bool first = j < other_of(j); /* one behind a limit is found when that is drawn in */
            assert_int_equal(result, first || clamp ? GROBO_ERR_NAN : GROBO_ERR_LIMIT);
            assert_int_equal(robot.fault_joint, first ? j : clamp ? -1 : other_of(j));
            if (first) {
                assert_true(isnan(robot.fault_deg));
            } else {
                expect_equal(robot.fault_deg, clamp ? 0 : 200, "fault");
            }
            assert_int_equal(robot.counters.clamped, clamp);
        }
    }
}

TEST_WITH(rig_wirings, joints_are_ready_that_were_read_and_hold)
{
    for (int j = 0; j < N; j++) {
        start();
        assert_true(grobo_i_gate_ready(&robot, GROBO_JOINTS_ALL(N)));
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN; /* it is known to hold */
        assert_false(grobo_i_gate_ready(&robot, GROBO_JOINTS_ALL(N)));
        assert_true(grobo_i_gate_ready(&robot, all_but(j)));
        robot.axes[j].phase = GROBO_I_JOINT_SENT;
        robot.axes[j].torque_known = false;
        assert_false(grobo_i_gate_ready(&robot, GROBO_JOINTS_ALL(N)));
        robot.axes[j].torque_known = true;
        make_limp(j);
        assert_false(grobo_i_gate_ready(&robot, GROBO_JOINTS_ALL(N)));
        assert_true(grobo_i_gate_ready(&robot, all_but(j)));
    }
}

/* One that has no part in a frame now may have one by the time it leaves. */
TEST_WITH(rig_wirings, what_waits_has_room_for_all_its_joints)
{
    for (int j = 0; j < N; j++) {
        grobo_exchange is, be;
        grobo_target target = {0};
        grobo_robot_order order = {.joints = bits(j, other_of(j)) | GROBO_JOINT_BIT(third_of(j)),
                                   .asked_us = NOW,
                                   .kind = GROBO_I_ORDER_HALT,
                                   .each = true,
                                   .stops = true};
        start();
        set_going(j);
        assert_int_equal(grobo_posture_init(&target.posture, N), 0);
        target.posture.set = order.joints;
        target.posture.angle_rad[j] = here_rad(j) + RAD(10.5);
        target.joint_time_us[j] = 100 * MS;
        target.joint_time_us[other_of(j)] = target.joint_time_us[third_of(j)] = 10000;
        assert_int_equal(driver.posture(&driver, robot.driver_ctx, &target, 0, &be), 1);
        assert_int_equal(grobo_i_gate_build(&robot, &order, &is), 1);
        assert_int_equal(is.frame_bytes, be.frame_bytes);
        assert_memory_equal(is.frame, be.frame, be.frame_bytes);

        make_limp(j);
        robot.axes[j].phase = GROBO_I_JOINT_IDLE;
        order.kind = GROBO_I_ORDER_TORQUE;
        order.torque = GROBO_TORQUE_ON;
        assert_int_equal(
            driver.torque(&driver, robot.driver_ctx, order.joints, GROBO_TORQUE_ON, 0, &be), 1);
        assert_int_equal(grobo_i_gate_build(&robot, &order, &is), 1);
        assert_int_equal(is.frame_bytes, be.frame_bytes);
        assert_memory_equal(is.frame, be.frame, be.frame_bytes);
    }
}
