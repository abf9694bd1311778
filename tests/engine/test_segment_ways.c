/* SPDX-License-Identifier: MIT */
/* Ways, and ways told in segments: where a joint is on them, what the next frame asks for, and what
 * is over. Of each joint all that is known is compared. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/axes_kit.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

/* ---- ways ------------------------------------------------------------------------------------ */

TEST_WITH(rig_wirings, a_way_is_straight_in_time)
{
    static const grobo_robot_trajectory way = {2, 6, NOW, NOW + 4 * S};
    static const grobo_robot_trajectory none = {2, 6, NOW, NOW};
    static const struct {
        int64_t at_us;
        double rad;
    } rows[] = {{NOW - S, 2},     {NOW, 2},         {NOW + 1, 2.000001}, {NOW + S, 3},
                {NOW + 2 * S, 4}, {NOW + 4 * S, 6}, {NOW + 9 * S, 6}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        expect_equal(grobo_i_trajectory_at(&way, rows[i].at_us), rows[i].rad, "place");
        expect_equal(grobo_i_trajectory_at(&none, rows[i].at_us), 6, "place on no way");
    }
}

/* On its way, as far as it was told; or off it, where it was read, or on the way its servo told. */
TEST_WITH(rig_wirings, a_joint_is_where_it_was_sent_or_read)
{
    grobo_robot_axis axis = {.state = {.angle_rad = 10, .goal_rad = 14}, .angle_us = NOW};
    axis.trajectory = (grobo_robot_trajectory){2, 6, NOW, NOW + 4 * S};
    axis.told_to_us = NOW + S;
    axis.own_until_us = NOW + 2 * S;
    expect_equal(grobo_i_axis_commanded(&axis, NOW + 3 * S), 5, "on its way");
    assert_true(grobo_i_axis_until(&axis) == NOW + 4 * S);
    axis.phase = GROBO_I_JOINT_IN_SEGMENTS;
    expect_equal(grobo_i_axis_commanded(&axis, NOW + 3 * S), 3, "as far as it was told");
    expect_equal(grobo_i_axis_commanded(&axis, NOW + S / 2), 2.5, "before");
    axis.phase = GROBO_I_JOINT_STRAY;
    expect_equal(grobo_i_axis_commanded(&axis, NOW + S), 12, "on its own way");
    expect_equal(grobo_i_axis_commanded(&axis, NOW + 3 * S), 14, "at its end");
    assert_true(grobo_i_axis_until(&axis) == NOW + 2 * S);
    axis.own_until_us = NOW + 1;
    expect_equal(grobo_i_axis_commanded(&axis, NOW + S), 14, "on its own way, over by now");
    axis.own_until_us = NOW;
    expect_equal(grobo_i_axis_commanded(&axis, NOW + S), 10, "where it was read");
    expect_equal(grobo_i_axis_target(&axis), 6, "target");
    axis.next_rad = 7;
    axis.next = 1;
    expect_equal(grobo_i_axis_target(&axis), 7, "target that waits");
}

/* It tells the time of its way, which is at 50 degrees and goes at 100 degrees a second: it is
 * there, but where it was read beside it since it was told, and goes on at the speed that it told;
 * or is further from there than it can have come since it was read. */
TEST_WITH(rig_wirings, a_joint_is_on_its_way_but_where_it_is_weak)
{
    static const struct {
        bool tells, off, told; /* since it was read */
        int32_t dps;
        double seen_deg, since_deg; /* where it was read, what it can have come since at its most */
        double deg;                 /* and what it has come at its speed */
    } rows[] = {
        {true, false, false, 50, 30, 0, 30},     {true, false, false, -89, 30, 0, 30},
        {true, false, false, 110, 30, 0, 30},    {false, false, false, 50, 30, 0, 50},
        {true, false, false, 50, 37.9, 0, 37.9}, {true, false, false, 50, 38.1, 0, 50},
        {true, false, false, 50, 30, 5, 30},     {true, false, false, 50, 62.1, 0, 62.1},
        {true, false, false, 50, 61.9, 0, 50},   {true, false, false, 50, 70, 5, 70},
        {true, true, false, 0, 30, 0, 30},       {true, false, true, 50, 30, 5, 35},
        {true, false, true, 50, 30, 8.1, 50},    {true, false, true, 50, 70, 5, 65},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            grobo_robot_axis *axis = &robot.axes[j];
            double since_s = rows[i].since_deg / speed_dps(j);
            axis->trajectory = (grobo_robot_trajectory){0, RAD(100), NOW - S / 2, NOW + S / 2};
            axis->state.angle_rad = axis->seen_rad = RAD(rows[i].seen_deg);
            axis->seen_us = NOW - (int64_t)(since_s * S);
            axis->told_us = rows[i].told ? NOW : NOW - S / 2;
            axis->state.speed_dps = rows[i].dps;
            axis->state.goal_rad = RAD(100);
            axis->state.valid &= (uint16_t)(rows[i].tells ? 0xFFFF : ~GROBO_FIELD_SPEED);
            axis->phase = rows[i].off ? GROBO_I_JOINT_STRAY : GROBO_I_JOINT_SENT;
            axis->own_until_us = 0;
            double on_deg = rows[i].told ? 0 : rows[i].dps * since_s;
            double deg = grobo_i_axis_reached(&robot, j, NOW) / RAD(1);
            if (fabs(deg - rows[i].deg - on_deg) > 0.01) {
                fail_msg("row %zu: at %.2f deg", i, deg);
            }
        }
    }
}

/* It lost the frame that sends it away, and hangs in its goal of before: a halt keeps that, so near
 * and at rest, and where the time of that goal is over. */
TEST_WITH(rig_wirings, a_joint_that_lost_its_frame_hangs_in_its_goal)
{
    static const struct {
        double beyond_deg;
        int32_t dps;
        bool over, hangs;
    } rows[] = {{2, 0, true, true},    {-2, 0, true, true}, {4.9, 0, true, true},
                {5.1, 0, true, false}, {2, 1, true, false}, {2, 0, false, false}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            grobo_robot_axis *axis = &robot.axes[j];
            axis->trajectory =
                (grobo_robot_trajectory){RAD(30), RAD(100), NOW - S / 2, NOW + S / 2};
            axis->state.angle_rad = axis->seen_rad = RAD(30);
            axis->seen_us = axis->angle_us = NOW;
            axis->goal_us = NOW - S;
            axis->state.goal_rad = RAD(30 + rows[i].beyond_deg);
            axis->state.goal_time_us = S;
            axis->state.time_us = rows[i].over ? S : S / 2;
            axis->state.speed_dps = rows[i].dps;
            axis->state.torque = GROBO_TORQUE_ON;
            axis->phase = GROBO_I_JOINT_STRAY;
            axis->own_until_us = 0;
            expect_equal(grobo_i_axis_commanded(axis, NOW) / RAD(1),
                         30 + (rows[i].hangs ? rows[i].beyond_deg : 0), "its set point");
        }
    }
}

/* One that is beside its way may come to the end of the way before it: it is not taken to go on
 * until its halt ends, as one on its way is. */
TEST_WITH(rig_wirings, a_joint_beside_its_way_is_no_further_than_by_now)
{
    static const struct {
        double seen_deg, deg; /* at 50 degrees a second, 100 ms ago; in another 50 ms */
    } rows[] = {{20, 25}, {41, 55}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            grobo_robot_axis *axis = &robot.axes[j];
            axis->trajectory = (grobo_robot_trajectory){0, RAD(100), NOW - S / 2, NOW + S / 2};
            axis->phase = GROBO_I_JOINT_SENT;
            axis->seen_rad = RAD(rows[i].seen_deg);
            axis->seen_us = axis->angle_us = NOW - S / 10;
            axis->told_us = NOW - S / 2;
            axis->state.speed_dps = 50;
            double deg = grobo_i_axis_reached(&robot, j, NOW + S / 20) / RAD(1);
            if (fabs(deg - rows[i].deg) > 0.01) {
                fail_msg("joint %d, row %zu: at %.2f deg", j, i, deg);
            }
        }
    }
}

/* At 1000 deg/s^2: it speeds up to what its way takes unless it had twice the time for that, and
 * brakes before the end. */
TEST_WITH(rig_wirings, a_servo_with_ramps_is_where_these_bring_it)
{
    static const struct {
        int64_t seen_us, rest_us; /* since the begin of its way, which takes a second */
        double seen_deg;
        int16_t dps;
        double deg;
    } rows[] = {
        {150000, 400000, 5, 50, 33.75},   /* at 28.75, and 5 degrees to brake */
        {250000, 400000, 10, 50, 18.75},  /* too weak to be faster: at 17.5, and 1.25 degrees */
        {1000000, 1000001, 99, 100, 100}, /* too fast to end there, and it ends there */
        {1000000, 1000001, 90, 100, 95},  /* it would need 5 degrees */
        {-100000, 400000, 0, 0, 40},      /* it stood until it was sent: at 35 */
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            driver.accel_rad_s2 = RAD(1000);
            grobo_robot_axis *axis = &robot.axes[j];
            const int64_t begin_us = NOW - rows[i].rest_us / 1000 * 1000;
            axis->trajectory = (grobo_robot_trajectory){0, RAD(100), begin_us, begin_us + S};
            axis->state.valid &= (uint16_t)~GROBO_FIELD_TIME;
            axis->seen_rad = RAD(rows[i].seen_deg);
            axis->seen_us = begin_us + rows[i].seen_us;
            axis->seen_dps = rows[i].dps;
            double deg = grobo_i_axis_reached(&robot, j, begin_us + rows[i].rest_us) / RAD(1);
            if (fabs(deg - rows[i].deg) > 0.01) {
                fail_msg("row %zu: at %.2f deg", i, deg);
            }
        }
    }
    driver.accel_rad_s2 = 0;
}

/* At 8000 deg/s^2, read to be at its end at 100 deg/s: it passes the end by 0.6 degrees, and comes
 * back no faster than it was sent, in 30 ms at 100 deg/s and 46 at 20, the least. */
TEST_WITH(rig_wirings, a_servo_with_ramps_comes_back_as_fast_as_it_was_sent)
{
    static const struct {
        int64_t way_us, others_us;
        bool moves;
    } rows[] = {{10 * S, S, true}, {S, 10 * S, false}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            driver.accel_rad_s2 = RAD(8000);
            const int64_t end_us = NOW - 38 * MS;
            for (int k = 0; k < N; k++) {
                grobo_robot_axis *axis = &robot.axes[k];
                int64_t way_us = k == j ? rows[i].way_us : rows[i].others_us;
                axis->trajectory = (grobo_robot_trajectory){0, RAD(100), end_us - way_us, end_us};
                axis->state.valid = (uint16_t)(~GROBO_FIELD_TIME);
                axis->state.torque = GROBO_TORQUE_ON;
                axis->state.angle_rad = axis->seen_rad = RAD(100);
                axis->seen_us = axis->angle_us = end_us;
                axis->told_us = end_us - way_us;
                axis->seen_dps = k == j ? 100 : 0;
                axis->phase = GROBO_I_JOINT_SENT;
                axis->next = 0;
            }
            if (grobo_i_moving(&robot, NOW) != rows[i].moves) {
                fail_msg("joint %d, row %zu", j, i);
            }
        }
    }
    driver.accel_rad_s2 = 0;
}

/* Behind its way it has come what it can at the speed of the way, or at its own where that is
 * larger; how another joint turns is nothing to it. */
TEST_WITH(rig_wirings, a_joint_comes_along_at_its_own_speed)
{
    static const struct {
        int16_t dps, other_dps;
        double deg;
    } rows[] = {{30, 150, 30}, {150, 30, 35}, {-150, 30, 35}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            grobo_robot_axis *axis = &robot.axes[j];
            axis->trajectory = (grobo_robot_trajectory){0, RAD(100), NOW - S / 2, NOW + S / 2};
            for (int k = 0; k < N; k++) {
                robot.axes[k].seen_dps = k == j ? rows[i].dps : rows[i].other_dps;
                robot.axes[k].state.valid |= GROBO_FIELD_SPEED;
                robot.axes[k].state.valid &= (uint16_t)~GROBO_FIELD_TIME;
            }
            axis->seen_rad = RAD(20);
            axis->seen_us = NOW - S / 10;
            double deg = grobo_i_axis_reached(&robot, j, NOW) / RAD(1);
            if (fabs(deg - rows[i].deg) > 0.01) {
                fail_msg("row %zu: at %.2f deg", i, deg);
            }
        }
    }
}

TEST_WITH(rig_wirings, a_joint_that_is_not_limp_moves_to_the_end_of_its_way)
{
    static const struct {
        int64_t way_us, own_us; /* ends, from now */
        bool off, known;
        grobo_torque torque;
        bool moves;
    } rows[] = {
        {1, 0, false, true, GROBO_TORQUE_ON, true},  {0, 0, false, true, GROBO_TORQUE_ON, false},
        {0, 5, false, true, GROBO_TORQUE_ON, false}, {0, 1, true, true, GROBO_TORQUE_ON, true},
        {0, 0, true, true, GROBO_TORQUE_ON, false},  {1, 0, true, true, GROBO_TORQUE_ON, true},
        {1, 1, true, true, GROBO_TORQUE_OFF, false}, {1, 1, true, true, GROBO_TORQUE_BRAKE, false},
        {1, 1, true, false, GROBO_TORQUE_OFF, true},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_robot_axis axis = {.state = {.torque = rows[i].torque},
                                       .trajectory = {0, 1, 0, NOW + rows[i].way_us},
                                       .own_until_us = NOW + rows[i].own_us,
                                       .phase =
                                           rows[i].off ? GROBO_I_JOINT_STRAY : GROBO_I_JOINT_SENT,
                                       .torque_known = rows[i].known};
        if (grobo_i_axis_moves(&axis, NOW) != rows[i].moves) {
            fail_msg("row %zu", i);
        }
        assert_int_equal(grobo_i_axis_is_on(&axis),
                         rows[i].known && rows[i].torque == GROBO_TORQUE_ON);
    }
}

TEST_WITH(rig_wirings, a_joint_rests_where_it_was_read)
{
    for (int j = 0; j < N; j++) {
        for (int own = 0; own < 3; own++) {
            start();
            grobo_robot_axis *axis = &robot.axes[j];
            set_going(j);
            axis->phase = GROBO_I_JOINT_STRAY;
            axis->state.goal_rad += 1;
            axis->own_until_us = axis->angle_us + own; /* 0: it told of no way */
            keep_axes();
            if (own == 2) {
                grobo_i_axis_rest(axis, NOW);
            } else {
                grobo_i_axis_here(axis, NOW);
            }
            before[j].phase = GROBO_I_JOINT_SENT;
            before[j].trajectory =
                own == 1 ? (grobo_robot_trajectory){here_rad(j), here_rad(j) + 1, NOW - 5, NOW - 4}
                         : (grobo_robot_trajectory){here_rad(j), here_rad(j), NOW, NOW};
            expect_axes();
        }
    }
}

TEST_WITH(rig_wirings, joints_are_asked_for_by_their_bits)
{
    for (int j = 0; j < N; j++) {
        int joint = -1;
        start();
        assert_false(grobo_i_moving(&robot, NOW));
        assert_false(grobo_i_externally_moved(&robot, GROBO_JOINTS_ALL(N), &joint));
        assert_int_equal(joint, -1);
        assert_true(grobo_i_all_joints(&robot) == GROBO_JOINTS_ALL(N));
        assert_int_equal(grobo_i_lowest(GROBO_JOINT_BIT(j) | GROBO_JOINT_BIT(N - 1)), j);
        robot.axes[j].phase = GROBO_I_JOINT_EXTERNAL;
        assert_true(grobo_i_externally_moved(&robot, GROBO_JOINT_BIT(j), &joint));
        assert_int_equal(joint, j);
        assert_false(grobo_i_externally_moved(&robot, all_but(j), &joint));
        robot.axes[j].next = 1;
        assert_true(grobo_i_moving(&robot, NOW));
        robot.axes[j].next = 0;
        set_going(j);
        assert_true(grobo_i_moving(&robot, NOW));
        assert_false(grobo_i_moving(&robot, NOW + S));
        robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
        assert_false(grobo_i_moving(&robot, NOW));
        assert_false(grobo_i_all_sensed(&robot, GROBO_JOINTS_ALL(N), &joint));
        assert_int_equal(joint, j);
        assert_true(grobo_i_all_sensed(&robot, all_but(j), &joint));
        assert_true(grobo_i_all_on(&robot, GROBO_JOINTS_ALL(N)));
        make_limp(j);
        assert_false(grobo_i_all_on(&robot, GROBO_JOINT_BIT(j)));
        assert_true(grobo_i_all_on(&robot, all_but(j)));
    }
}

/* ---- what is told in parts ------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_way_is_told_in_parts_where_that_is_wanted)
{
    static const struct {
        grobo_goals goals;
        bool arm, stops;
        int64_t time_us, step_us;
        bool wanted;
    } rows[] = {
        {GROBO_GOALS_DEFAULT, false, false, S, 10000, false},
        {GROBO_GOALS_DEFAULT, true, false, S, 10000, true},
        {GROBO_GOALS_WHOLE, true, false, S, 10000, false},
        {GROBO_GOALS_SEGMENTS, false, false, S, 10000, true},
        {GROBO_GOALS_SEGMENTS, false, true, S, 10000, false},
        {GROBO_GOALS_SEGMENTS, false, false, 380001, 10000, true},
        {GROBO_GOALS_SEGMENTS, false, false, 380000, 10000, false},
        {GROBO_GOALS_SEGMENTS, false, false, 350001, 50000, true}, /* of that many steps */
        {GROBO_GOALS_SEGMENTS, false, false, 350000, 50000, false},
        {GROBO_GOALS_SEGMENTS, false, false, 380001, 380000, true},
        {GROBO_GOALS_SEGMENTS, false, false, 390000, 390000, false},
        {GROBO_GOALS_SEGMENTS, false, false, 390001, 390000, true},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_robot_order order = {.stops = rows[i].stops};
        start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .goals = rows[i].goals});
        driver.arm = rows[i].arm;
        driver.time_step_us = rows[i].step_us;
        bool wanted = grobo_i_goes_in_parts(&robot, &order) &&
                      grobo_i_segments_wanted(&robot, 0, rows[i].time_us);
        if (wanted != rows[i].wanted) {
            fail_msg("row %zu", i);
        }
    }
}

/* The first part of those that go farther than a segment; the others go at once. */
TEST_WITH(rig_wirings, the_first_frame_asks_for_a_segment)
{
    for (int j = 0; j < N; j++) {
        grobo_target whole = {0};
        grobo_target part;
        start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .goals = GROBO_GOALS_SEGMENTS});
        set_going(j); /* it is 10 degrees on, and goes back to where it was */
        assert_int_equal(grobo_posture_init(&whole.posture, N), 0);
        whole.posture.set = bits(j, other_of(j));
        whole.posture.angle_rad[j] = here_rad(j);
        whole.posture.angle_rad[other_of(j)] = 1;
        whole.joint_time_us[j] = whole.joint_time_us[third_of(j)] = 2 * GROBO_SEGMENT_US;
        whole.joint_time_us[other_of(j)] = GROBO_SEGMENT_US;
        memset(&part, 0xA5, sizeof part);
        assert_true(grobo_i_segments_cut(&robot, &(grobo_robot_order){0}, &whole, &part));
        whole.joint_time_us[j] = GROBO_SEGMENT_US;
        expect_equal(part.posture.angle_rad[j], here_rad(j) + RAD(5), "its part");
        whole.posture.angle_rad[j] = part.posture.angle_rad[j];
        assert_memory_equal(&part, &whole, sizeof part);
        grobo_target same = part;
        assert_false(grobo_i_segments_cut(&robot, &(grobo_robot_order){0}, &whole, &part));
        assert_memory_equal(&part, &same, sizeof part);
        expect_equal(robot.axes[j].trajectory.to_rad, here_rad(j) + RAD(20), "nothing is noted");
    }
}

/* It may begin outside its limits, and no part of it lies there; to the limit it is no faster than
 * on all of its way. */
TEST_WITH(rig_wirings, no_part_lies_outside_the_limits)
{
    for (int j = 0; j < N; j++) {
        for (int end = -1; end <= 1; end += 2) {
            grobo_target target = {0};
            start();
            robot.axes[j].trajectory =
                (grobo_robot_trajectory){end * RAD(75 + j), end * RAD(65 + j), NOW, NOW + 2 * S};
            robot.axes[j].phase = GROBO_I_JOINT_IN_SEGMENTS;
            robot.axes[j].told_to_us = NOW + 1;
            grobo_i_segments_aim(&robot, GROBO_JOINTS_ALL(N), &target);
            assert_true(target.posture.set == GROBO_JOINT_BIT(j));
            expect_equal(target.posture.angle_rad[j], end * RAD(70 + j), "its part");
            assert_in_range(target.joint_time_us[j], S, S + 10000);
            robot.now_us += 700000;
            robot.axes[j].told_to_us = NOW + S;
            grobo_i_segments_aim(&robot, GROBO_JOINTS_ALL(N), &target);
            expect_equal(target.posture.angle_rad[j], end * RAD(69.6 + j), "what is inside");
            assert_int_equal(target.joint_time_us[j], GROBO_SEGMENT_US);
        }
    }
}

/* A joint in segments has so much left of a way of 10 degrees, and was told so much of it. */
typedef struct told_way {
    int64_t left_us, told_us, time_us; /* time_us: what the next frame asks for; 0: nothing */
} told_way;

static const told_way told_ways[] = {{S, 1, 380000},      {S, 0, 0},
                                     {S, -1, 0},          {380001, 1, 380000},
                                     {380000, 1, 380000}, {370001, 1, 380000},
                                     {370000, 1, 370000}, {100000, 100000, 100000},
                                     {99999, 99999, 0},   {99999, 99998, 100000},
                                     {5000, 4999, 10000}, {5000, 5000, 0}};
enum { TOLD_WAYS = sizeof told_ways / sizeof told_ways[0] };

static grobo_robot_axis *start_on(int joint, const told_way *row)
{
    grobo_robot_axis *axis = &robot.axes[joint];
    start();
    set_going(third_of(joint)); /* a whole goal */
    axis->trajectory = (grobo_robot_trajectory){0, RAD(10), NOW, NOW + row->left_us};
    axis->told_to_us = NOW + row->told_us;
    axis->phase = GROBO_I_JOINT_IN_SEGMENTS;
    return axis;
}

static void expect_aim(grobo_joint_mask of, int joint, const told_way *row, int64_t time_us)
{
    grobo_target target = {0};
    double part = fmin((double)time_us / (double)row->left_us, 1);
    grobo_i_segments_aim(&robot, of, &target);
    assert_true(target.posture.set == (time_us > 0 ? GROBO_JOINT_BIT(joint) : 0));
    for (int k = 0; k < N; k++) {
        assert_true(target.joint_time_us[k] == (k == joint ? time_us : 0));
        expect_equal(target.posture.angle_rad[k], k == joint ? RAD(10) * part : 0, "part");
    }
}

/* A segment ahead, or what is left, in whole steps. */
TEST_WITH(rig_wirings, the_next_frame_asks_for_more_of_each_way)
{
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < TOLD_WAYS; i++) {
            const told_way *row = &told_ways[i];
            grobo_robot_axis *axis = start_on(j, row);
            expect_aim(GROBO_JOINTS_ALL(N), j, row, row->time_us);
            expect_aim(all_but(j), j, row, 0);
            axis->phase = GROBO_I_JOINT_IDLE;
            expect_aim(GROBO_JOINTS_ALL(N), j, row, 0);
            axis->phase = GROBO_I_JOINT_SENT;
            expect_aim(GROBO_JOINTS_ALL(N), j, row, 0);
        }
    }
}

/* To the end again while there is time for it. */
TEST_WITH(rig_wirings, ways_are_told_on_until_they_end)
{
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3 * TOLD_WAYS; i++) {
            const told_way *row = &told_ways[i / 3];
            grobo_robot_axis *axis = start_on(j, row);
            static const grobo_i_joint_state phases[] = {GROBO_I_JOINT_IN_SEGMENTS,
                                                         GROBO_I_JOINT_SENT, GROBO_I_JOINT_IDLE};
            axis->phase = (uint8_t)phases[i % 3];
            robot.in_segments = true;
            bool is_short = i % 3 == 0 && row->told_us < row->left_us;
            bool again = is_short || (i % 3 == 0 && row->left_us >= 100000);
            assert_int_equal(grobo_i_trajectory_is_short(axis), is_short);
            assert_true(grobo_i_trajectories_renewed(&robot) == (again ? GROBO_JOINT_BIT(j) : 0));
            robot.renewed_us = NOW;
            assert_true(grobo_i_segments_due(&robot) ==
                        (again ? NOW + GROBO_SEGMENT_RENEW_US : GROBO_NEVER_US));
        }
    }
}

/* The frames of all ways leave at once: the first of them sets the time. */
TEST_WITH(rig_wirings, the_first_way_sets_the_time_for_the_others)
{
    for (int j = 0; j < N; j++) {
        start();
        robot.renewed_us = 1;
        set_going(j);
        set_going(other_of(j));
        keep_axes();
        grobo_i_segments_begin(&robot, j);
        assert_true(robot.renewed_us == NOW);
        before[j].phase = GROBO_I_JOINT_IN_SEGMENTS;
        before[j].told_to_us = NOW + GROBO_SEGMENT_US;
        expect_axes();
        robot.renewed_us = 2;
        robot.now_us = NOW + 10;
        grobo_i_segments_begin(&robot, other_of(j));
        assert_true(robot.renewed_us == 2);
        before[other_of(j)].phase = GROBO_I_JOINT_IN_SEGMENTS;
        before[other_of(j)].told_to_us = NOW + 10 + GROBO_SEGMENT_US;
        expect_axes();
    }
}

/* ---- in time --------------------------------------------------------------------------------- */

static void set_going_in_segments(int joint)
{
    set_going(joint);
    robot.axes[joint].phase = GROBO_I_JOINT_IN_SEGMENTS;
    robot.in_segments = true;
    robot.axes[joint].told_to_us = NOW + 200 * MS;
}

static grobo_joint_mask asked_for(void)
{
    for (int i = 0; i < GROBO_ROBOT_SLOTS; i++) {
        if (robot.slots[i].use == GROBO_I_USE_SEGMENT) {
            assert_int_equal(robot.slots[i].txn.priority, GROBO_PRIORITY_MOTION);
            return robot.slots[i].order.joints;
        }
    }
    return 0;
}

/* Every 100 ms on one grid; who comes later than that begins another one. */
TEST_WITH(rig_wirings, more_is_asked_for_on_a_grid)
{
    static const struct {
        int64_t ago_us, renewed_us; /* the grid after it, from now */
        bool asks;
    } rows[] = {{99999, -99999, false}, {100000, 0, true},      {100001, -1, true},
                {150000, -50000, true}, {199999, -99999, true}, {200000, 0, true},
                {200001, 0, true},      {700000, 0, true}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            set_going_in_segments(j);
            set_going_in_segments(other_of(j));
            robot.renewed_us = NOW - rows[i].ago_us;
            int64_t due_us = NOW - rows[i].ago_us + GROBO_SEGMENT_RENEW_US;
            assert_true(grobo_i_segments_deadline(&robot) == due_us);
            grobo_i_segments_step(&robot);
            assert_true(asked_for() == (rows[i].asks ? bits(j, other_of(j)) : 0));
            assert_true(robot.renewed_us == NOW + rows[i].renewed_us);
            if (rows[i].asks) { /* until that has left nothing more is asked for */
                robot.renewed_us = NOW - S;
                grobo_i_segments_step(&robot);
                assert_true(robot.renewed_us == NOW - S);
                assert_true(grobo_i_segments_deadline(&robot) == NOW + 200 * MS);
            }
        }
    }
}

/* Where no joint goes in segments any more, none is looked at. */
TEST_WITH(rig_wirings, where_none_is_told_its_way_nobody_looks)
{
    for (int j = 0; j < N; j++) {
        start();
        set_going_in_segments(j);
        grobo_i_segments_step(&robot);
        assert_true(robot.in_segments);
        robot.axes[j].phase = GROBO_I_JOINT_SENT;
        grobo_i_segments_step(&robot);
        assert_false(robot.in_segments);
        assert_true(grobo_i_segments_deadline(&robot) == GROBO_NEVER_US);
        grobo_i_segments_begin(&robot, j);
        assert_true(robot.in_segments);
    }
}

TEST_WITH(rig_wirings, a_way_that_was_not_told_on_is_looked_at_when_it_is_over)
{
    for (int j = 0; j < N; j++) {
        start();
        assert_true(grobo_i_segments_deadline(&robot) == GROBO_NEVER_US);
        robot.renewed_us = NOW;
        set_going_in_segments(j);
        set_going_in_segments(other_of(j));
        assert_true(grobo_i_segments_deadline(&robot) == NOW + GROBO_SEGMENT_RENEW_US);
        robot.axes[j].told_to_us = NOW + 50 * MS;
        assert_true(grobo_i_segments_deadline(&robot) == NOW + 50 * MS);
        robot.axes[j].told_to_us = NOW + S; /* to its end */
        assert_true(grobo_i_segments_deadline(&robot) == NOW + GROBO_SEGMENT_RENEW_US);
    }
}

/* A joint stands where it was told to go: the host was away, and its move is over. */
TEST_WITH(rig_wirings, a_way_that_was_not_told_on_is_given_up)
{
    static const struct {
        grobo_job_kind kind;
        bool ends;
    } jobs[] = {{GROBO_JOB_NONE, false},  {GROBO_JOB_MOVE, true},   {GROBO_JOB_PLAY, true},
                {GROBO_JOB_SETTLE, true}, {GROBO_JOB_SENSE, false}, {GROBO_JOB_TORQUE, false}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof jobs / sizeof jobs[0]; i++) {
            for (int over = 0; over < 2; over++) {
                start();
                robot.events_n = robot.events_head = 0;
                robot.job->kind = jobs[i].kind;
                robot.job->number = 5;
                bool plays = jobs[i].kind == GROBO_JOB_PLAY;
                robot.sequencer.state = plays ? GROBO_SEQUENCER_PLAYING : GROBO_SEQUENCER_FINISHED;
                set_going_in_segments(j);
                set_going_in_segments(other_of(j));
                robot.axes[j].told_to_us = NOW + !over;
                robot.axes[other_of(j)].told_to_us = NOW + S;
                robot.renewed_us = NOW - 100 * MS; /* what was asked for then has not left */
                keep_axes();
                grobo_i_segments_step(&robot);
                assert_int_equal(robot.counters.stalls, over);
                assert_int_equal(robot.soft, over);
                assert_int_equal(robot.sequencer.state, !plays ? GROBO_SEQUENCER_FINISHED
                                                        : over ? GROBO_SEQUENCER_IDLE
                                                               : GROBO_SEQUENCER_PLAYING);
                assert_true(!over || robot.soft_us == GROBO_NEVER_US);
                assert_int_equal(robot.job->kind,
                                 over && jobs[i].ends ? GROBO_JOB_NONE : jobs[i].kind);
                if (over) {
                    double stands_rad = here_rad(j) + RAD(10);
                    expect_equal(robot.axes[j].trajectory.to_rad, stands_rad, "where it stands");
                    stands_rad = robot.axes[j].trajectory.to_rad;
                    before[j].trajectory.to_rad =
                        stands_rad; /* its servo may be on the ramp there */
                    before[j].trajectory.to_us = NOW;
                    before[j].phase = GROBO_I_JOINT_SENT;
                    const grobo_event *event = &robot.events[robot.events_head];
                    assert_int_equal(event->kind, GROBO_EVENT_TRIP);
                    assert_int_equal(event->u.trip.trip, GROBO_TRIP_HOST_STALL);
                    assert_int_equal(event->u.trip.joint, -1);
                    expect_equal(event->u.trip.value, 280, "ms late");
                    assert_false(event->u.trip.latched);
                    assert_false(robot.trip.latched);
                    bool tells = jobs[i].ends && jobs[i].kind != GROBO_JOB_SETTLE;
                    assert_int_equal(robot.events_n, tells ? 2 : 1);
                    assert_true(!tells || event[1].u.job.result == GROBO_ERR_CANCELED);
                }
                expect_axes();
                /* The other one is still on its way. */
                grobo_joint_mask on = over ? GROBO_JOINT_BIT(other_of(j)) : bits(j, other_of(j));
                assert_true(asked_for() == on);
            }
        }
    }
}
