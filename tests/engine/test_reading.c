/* SPDX-License-Identifier: MIT */
/* What a reading tells of where a joint is. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/rs30x.h>

#include "src/robot/axis.h"
#include "src/robot/reading.h"
#include "src/robot/state.h"
#include "tests/support/many_joints.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

static grobo_test_rig rig;

static grobo_robot_axis *neck(void)
{
    return &rig.robot.axes[NECK];
}

/* The neck has answered with these registers, from `address` on. */
static void read_neck(uint8_t address, const uint8_t *data, uint8_t n)
{
    const grobo_robot_slot slot = {
        .robot = &rig.robot, .joint = NECK, .asked_us = rig.robot.now_us, .reads = true};
    const grobo_packet reply = {.kind = GROBO_PACKET_RETURN,
                                .id = NECK_ID,
                                .address = address,
                                .data = data,
                                .data_bytes = n};
    grobo_joint_state got;
    assert_int_equal(grobo_i_reading_take(&slot, GROBO_OK, &reply, &got), GROBO_OK);
}

/* No.36-53: with torque, at this angle and speed. */
static void read_state(double deg, int speed_dps)
{
    int ddeg = (int)(deg * 10);
    uint8_t data[GROBO_STATE_BYTES] = {1};
    data[6] = (uint8_t)(ddeg & 0xFF);
    data[7] = (uint8_t)(ddeg >> 8 & 0xFF);
    data[10] = (uint8_t)(speed_dps & 0xFF);
    data[11] = (uint8_t)(speed_dps >> 8 & 0xFF);
    data[17] = 3; /* 7.68 V */
    read_neck(GROBO_STATE_ADDRESS, data, sizeof data);
}

/* The neck was sent from 0 to 40 degrees in 4 s, half of which are over. */
static void on_the_way(void)
{
    rig_start(&rig, &quiet, NULL);
    int64_t now_us = rig.robot.now_us;
    neck()->trajectory = (grobo_robot_trajectory){0, RAD(40), now_us - 2000000, now_us + 2000000};
    neck()->phase = GROBO_I_JOINT_SENT;
}

TEST(a_joint_that_stands_beside_its_way_is_off_it)
{
    on_the_way();
    read_state(20, 0);
    assert_false(grobo_i_is_stray(neck()));
    read_state(5, 0);
    assert_true(grobo_i_is_stray(neck()));
}

TEST(a_joint_that_moves_beside_its_way_is_late_and_on_it)
{
    on_the_way();
    read_state(5, 30);
    assert_false(grobo_i_is_stray(neck()));
}

/* Ahead of its way, or before its begin: 200 ms after the frame left it is on another one. */
TEST(a_joint_that_moves_where_its_way_is_not_is_off_it)
{
    static const struct {
        double deg;
        int64_t told_us; /* so long ago */
        bool off;
    } rows[] = {{32.1, 200001, true}, {31.9, 200001, false}, {32.1, 200000, false},
                {-0.1, 200001, true}, {0.1, 200001, false},  {-0.1, 200000, false},
                {-40, 20000, false}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        on_the_way();
        neck()->told_us = rig.robot.now_us - rows[i].told_us;
        read_state(rows[i].deg, 30);
        if (grobo_i_is_stray(neck()) != rows[i].off) {
            fail_msg("row %zu", i);
        }
    }
}

TEST(a_joint_that_was_sent_nowhere_is_off_no_way)
{
    on_the_way();
    neck()->phase = GROBO_I_JOINT_IDLE;
    read_state(5, 0);
    assert_false(grobo_i_is_stray(neck()));
}

TEST(off_its_way_a_joint_is_on_its_own_or_where_it_was_read)
{
    on_the_way();
    read_state(5, 0);
    int64_t now_us = rig.robot.now_us;
    assert_true(grobo_i_is_stray(neck()));
    neck()->state.goal_rad = RAD(15);
    neck()->own_until_us = now_us;
    assert_float_equal(grobo_i_axis_commanded(neck(), now_us + 500000), RAD(5), 1e-3);
    neck()->own_until_us = now_us + 1000000;
    assert_float_equal(grobo_i_axis_commanded(neck(), now_us + 500000), RAD(10), 1e-3);
    assert_float_equal(grobo_i_axis_commanded(neck(), now_us + 1500000), RAD(15), 1e-3);
}

TEST(an_angle_alone_tells_nothing_of_how_a_joint_moves)
{
    static const uint8_t angle[] = {50, 0};
    on_the_way();
    neck()->phase = GROBO_I_JOINT_IDLE;
    read_state(5, 30); /* moves, nobody knows where to */
    assert_true(grobo_i_is_external(neck()));
    read_neck(GROBO_RS30X_POSITION, angle, sizeof angle);
    assert_true(grobo_i_is_external(neck()));
    read_state(5, 0);
    assert_false(grobo_i_is_external(neck()));
}

static int parse_nonsense(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                          grobo_joint_state *got)
{
    (void)self;
    (void)ctx;
    (void)joint;
    (void)reply;
    got->angle_rad = NAN;
    got->valid = GROBO_FIELD_ANGLE;
    return GROBO_OK;
}

TEST(a_driver_that_makes_no_number_of_a_reply_has_read_nothing)
{
    on_the_way();
    read_state(20, 0);
    grobo_driver odd = *rig.driver;
    odd.parse = parse_nonsense;
    rig.robot.driver = &odd;
    const grobo_robot_slot slot = {.robot = &rig.robot, .joint = NECK, .reads = true};
    const grobo_packet reply = {.kind = GROBO_PACKET_RETURN, .id = NECK_ID};
    grobo_joint_state got;
    assert_int_equal(grobo_i_reading_take(&slot, GROBO_OK, &reply, &got), GROBO_ERR_MISMATCH);
    assert_float_equal(neck()->state.angle_rad, RAD(20), 1e-3);
    assert_int_equal(neck()->lost, 1);
    rig.robot.driver = rig.driver;
}

/* ---- any reading of any joint ---------------------------------------------------------------- */

enum { N = GROBO_JOINTS_MAX };
static const int64_t NOW = 50000000;

static grobo_driver made = GROBO_TABLE_INIT(grobo_driver);
static grobo_robot robot;
static grobo_robot_axis before[N];
static grobo_joint_state given; /* what the driver makes of any reply */
static int given_of, given_result;
#define ALL_FIELDS 0xFF

static int parse_given(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                       grobo_joint_state *got)
{
    static const grobo_joint_state nothing;
    assert_ptr_equal(self, &made);
    assert_ptr_equal(ctx, &given);
    assert_int_equal(joint, given_of);
    assert_int_equal(reply->kind, GROBO_PACKET_RETURN);
    assert_memory_equal(got, &nothing, sizeof nothing); /* a driver sets what it found */
    *got = given;
    return given_result;
}

/* As many joints as there may be, none like another; all were read and sent somewhere. */
static void start_with(const grobo_robot_config *config)
{
    made = *many_unlike_joints(rig_wiring, N);
    made.parse = parse_given;
    assert_int_equal(grobo_robot_init(&robot, &made, &given, config, NOW), GROBO_OK);
    for (int j = 0; j < N; j++) {
        grobo_robot_axis *axis = &robot.axes[j];
        axis->state = (grobo_joint_state){.angle_rad = RAD(10),
                                          .goal_rad = RAD(10),
                                          .goal_time_us = 11,
                                          .time_us = 12,
                                          .speed_dps = 13,
                                          .current_ma = 14,
                                          .voltage_mv = 15,
                                          .temperature_c = 16,
                                          .torque = GROBO_TORQUE_BRAKE,
                                          .overheated = true,
                                          .flags = 17};
        axis->trajectory = (grobo_robot_trajectory){RAD(10), RAD(10), NOW - 20, NOW - 10};
        axis->goal_us = axis->angle_us = axis->full_us = NOW - 5;
        axis->own_until_us = NOW - 3;
        axis->told_us = NOW - 7;
        axis->status = GROBO_ERR_TIMEOUT;
        axis->lost = 3;
        axis->phase = GROBO_I_JOINT_SENT;
    }
    given = (grobo_joint_state){.angle_rad = RAD(10),
                                .goal_rad = RAD(10),
                                .goal_time_us = 21,
                                .time_us = 22,
                                .current_ma = 24,
                                .voltage_mv = 25,
                                .temperature_c = 26,
                                .valid = ALL_FIELDS,
                                .torque = GROBO_TORQUE_ON,
                                .flags = 27};
    given_result = 7;
}

static int take_asked(int joint, int64_t asked_us)
{
    static const grobo_packet reply = {.kind = GROBO_PACKET_RETURN};
    const grobo_robot_slot slot = {
        .robot = &robot, .joint = (uint8_t)joint, .asked_us = asked_us, .reads = true};
    grobo_joint_state got;
    given_of = joint;
    memcpy(before, robot.axes, sizeof before);
    return grobo_i_reading_take(&slot, GROBO_OK, &reply, &got);
}

/* What was given is taken, asked for now; and no other joint is touched. */
static grobo_robot_axis *take(int joint)
{
    assert_int_equal(take_asked(joint, NOW), GROBO_OK);
    for (int j = 0; j < N; j++) {
        assert_true(j == joint || memcmp(&before[j], &robot.axes[j], sizeof before[j]) == 0);
    }
    return &robot.axes[joint];
}

static void expect(const char *what, double is, double be)
{
    if (is != be) {
        fail_msg("%s is %.9g, not %.9g", what, is, be);
    }
}

static void expect_near(const char *what, double is, double be)
{
    if (!(fabs(is - be) < 1e-12)) {
        fail_msg("%s is %.9g, not %.9g", what, is, be);
    }
}

TEST(what_a_reading_lacks_stays_as_it_was)
{
    for (int j = 0; j < N; j++) {
        for (unsigned valid = 0; valid <= ALL_FIELDS; valid++) {
            start_with(NULL);
            given.valid = (uint16_t)valid;
            given.angle_rad = RAD(10.01);
            given.goal_rad = RAD(10.02);
            robot.axes[j].state.valid = GROBO_FIELD_VOLTAGE | GROBO_FIELD_GOAL;
            robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
            const grobo_robot_axis *axis = take(j);
            const grobo_joint_state *is = &axis->state;
            const grobo_joint_state *was = &before[j].state;
#define EXPECT(bit, field)                                                                         \
    expect(#field, (double)is->field, (double)((valid & (bit)) != 0 ? given.field : was->field))
            EXPECT(GROBO_FIELD_ANGLE, angle_rad);
            EXPECT(GROBO_FIELD_GOAL, goal_rad);
            EXPECT(GROBO_FIELD_GOAL, goal_time_us);
            EXPECT(GROBO_FIELD_TIME, time_us);
            EXPECT(GROBO_FIELD_SPEED, speed_dps);
            EXPECT(GROBO_FIELD_CURRENT, current_ma);
            EXPECT(GROBO_FIELD_TEMPERATURE, temperature_c);
            EXPECT(GROBO_FIELD_VOLTAGE, voltage_mv);
            EXPECT(GROBO_FIELD_TORQUE, torque);
#undef EXPECT
            assert_int_equal(is->valid, valid | was->valid);
            assert_false(is->overheated); /* what each reply says */
            assert_int_equal(is->flags, 27);
            assert_int_equal(axis->status, GROBO_OK);
            assert_int_equal(axis->lost, 0);
            bool angle = (valid & GROBO_FIELD_ANGLE) != 0;
            bool goal = (valid & GROBO_FIELD_GOAL) != 0;
            assert_true(axis->angle_us == (angle ? NOW : NOW - 5));
            assert_true(axis->goal_us == (goal ? NOW : NOW - 5));
            assert_true(axis->full_us == ((valid & GROBO_FIELD_TEMPERATURE) != 0 ? NOW : NOW - 5));
            assert_int_equal(grobo_i_is_sensed(axis), angle);
            assert_int_equal(axis->torque_known, (valid & GROBO_FIELD_TORQUE) != 0);
        }
    }
}

/* Asked for before a frame left, it may be of before that frame: it restores nothing. */
TEST(a_reading_from_before_a_frame_tells_nothing_of_after_it)
{
    for (int j = 0; j < N; j++) {
        for (int late = 0; late < 2; late++) {
            start_with(NULL);
            given.speed_dps = 20;
            given.angle_rad = RAD(40);
            robot.axes[j].phase = GROBO_I_JOINT_UNKNOWN;
            assert_int_equal(take_asked(j, NOW - 7 - late), GROBO_OK);
            const grobo_robot_axis *axis = &robot.axes[j];
            assert_int_equal(grobo_i_is_sensed(axis), !late);
            assert_int_equal(axis->torque_known, !late);
            assert_true(axis->goal_us == (late ? NOW - 5 : NOW));
            assert_true(late == (memcmp(&axis->trajectory, &before[j].trajectory,
                                        sizeof axis->trajectory) == 0));
            assert_int_equal(axis->own_until_us != NOW - 3, !late);
            expect("angle", axis->state.angle_rad, RAD(40));
            assert_true(axis->angle_us == NOW);
        }
    }
}

/* What was read a while ago of how it turns goes for as long as it may go on, unless it was told to
 * go elsewhere since. */
TEST(an_angle_alone_hides_no_turning)
{
    static const struct {
        int64_t later_us;
        bool told, hides;
    } rows[] = {{1, false, false}, {199999, false, false}, {200000, false, true}, {9, true, true}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const int64_t then_us = NOW + rows[i].later_us;
            start_with(NULL);
            given.speed_dps = -30;
            (void)take(j);
            robot.now_us = then_us;
            robot.axes[j].told_us = rows[i].told ? NOW + 1 : NOW;
            given.valid = GROBO_FIELD_ANGLE;
            given.angle_rad = RAD(12);
            assert_int_equal(take_asked(j, then_us), GROBO_OK);
            const grobo_robot_axis *axis = &robot.axes[j];
            assert_int_equal(axis->seen_dps, rows[i].hides ? GROBO_I_NO_SPEED : -30);
            assert_true(axis->seen_us == (rows[i].hides ? then_us : NOW));
            expect("seen", axis->seen_rad, RAD(rows[i].hides ? 12 : 10));
        }
    }
}

/* Of servos that tell no speed: the angle before is of before the frame that sent it elsewhere. */
TEST(two_ways_have_no_speed)
{
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 4; i++) {
            bool tells = i % 2 != 0, since = i / 2 != 0;
            start_with(NULL);
            made.tells_no_speed = !tells;
            given.speed_dps = 25;
            robot.axes[j].told_us = since ? NOW - 4 : NOW - 5; /* the angle is of NOW - 5 */
            assert_int_equal(take(j)->seen_dps, tells || !since ? 25 : GROBO_I_NO_SPEED);
        }
    }
}

/* Another host's way, which the servo tells: its time, or what it cannot do faster. */
TEST(where_a_servo_goes_is_taken_from_what_it_tells)
{
    static const struct {
        grobo_torque torque;
        int speed_dps;
        int64_t goal_time_us, time_us;
        double way_deg; /* 0: no time is needed for it */
        bool moves;
    } rows[] = {
        {GROBO_TORQUE_ON, 8, 5000000, 2000000, 30, true},
        {GROBO_TORQUE_ON, -8, 5000000, 2000000, -30, true},
        {GROBO_TORQUE_ON, 1, 5000000, 2000000, 30, true}, /* it creeps */
        {GROBO_TORQUE_ON, -7, 5000000, 4999999, 0, true},
        {GROBO_TORQUE_ON, 7, 5000000, 5000000, 30, false},
        {GROBO_TORQUE_ON, 7, 5000000, 6000000, 30, false},
        {GROBO_TORQUE_ON, 0, 5000000, 2000000, 30, false},
        {GROBO_TORQUE_OFF, 100, 5000000, 2000000, 30, false},
        {GROBO_TORQUE_BRAKE, 100, 5000000, 2000000, 30, false},
        {GROBO_TORQUE_ON, 8, 0, 2000000, 30, true},
        {GROBO_TORQUE_ON, 8, 0, 2000000, -20, true},
        {GROBO_TORQUE_ON, 8, 2000000, 1950000, 30, true},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start_with(NULL);
            given.torque = rows[i].torque;
            given.speed_dps = rows[i].speed_dps;
            given.goal_time_us = rows[i].goal_time_us;
            given.time_us = rows[i].time_us;
            given.goal_rad = given.angle_rad + RAD(rows[i].way_deg);
            int64_t left_us = rows[i].goal_time_us - rows[i].time_us;
            double least_us = fabs(rows[i].way_deg) / (100 + 5 * j) * 1e6;
            int64_t be_us = rows[i].moves ? (int64_t)fmax((double)left_us, least_us) : 0;
            const grobo_robot_axis *axis = take(j);
            if (axis->own_until_us - NOW != be_us &&
                (be_us == left_us || llabs(axis->own_until_us - NOW - be_us) > 1)) {
                fail_msg("joint %d, row %zu: %lld us left, not %lld", j, i,
                         (long long)(axis->own_until_us - NOW), (long long)be_us);
            }
            assert_false(grobo_i_is_external(axis));
        }
    }
}

/* One that moves though it was sent nowhere, and does not tell where to. */
TEST(a_joint_is_externally_moved_that_goes_nobody_knows_where)
{
    enum { PACE = GROBO_FIELD_SPEED | GROBO_FIELD_TORQUE, ANGLE = GROBO_FIELD_ANGLE };
    static const struct {
        unsigned valid;
        int speed_dps;
        grobo_torque torque;
        bool sent, external;
    } rows[] = {
        {ANGLE | PACE, 8, GROBO_TORQUE_ON, false, true},
        {ANGLE | PACE, -8, GROBO_TORQUE_ON, false, true},
        {ANGLE | PACE, 7, GROBO_TORQUE_ON, false, false},
        {ANGLE | PACE, -7, GROBO_TORQUE_ON, false, false},
        {ANGLE | PACE, 30, GROBO_TORQUE_BRAKE, false, false},
        {ANGLE | PACE, 30, GROBO_TORQUE_OFF, false, false},
        {ANGLE | PACE, 30, GROBO_TORQUE_ON, true, false},
        {ANGLE | PACE | GROBO_FIELD_GOAL, 30, GROBO_TORQUE_ON, false, true},
        {ANGLE | PACE | GROBO_FIELD_TIME, 30, GROBO_TORQUE_ON, false, true},
        {ALL_FIELDS, 30, GROBO_TORQUE_ON, false, false}, /* it tells where to */
        {ALL_FIELDS & ~ANGLE, 30, GROBO_TORQUE_ON, false, false},
        {ANGLE | GROBO_FIELD_SPEED, 30, GROBO_TORQUE_ON, false, false},
        {ANGLE | GROBO_FIELD_TORQUE, 30, GROBO_TORQUE_ON, false, false},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start_with(NULL);
            given.valid = (uint16_t)rows[i].valid;
            given.speed_dps = rows[i].speed_dps;
            given.torque = rows[i].torque;
            given.goal_rad += RAD(5);
            robot.axes[j].phase = rows[i].sent ? GROBO_I_JOINT_SENT : GROBO_I_JOINT_IDLE;
            if (grobo_i_is_external(take(j)) != rows[i].external) {
                fail_msg("joint %d, row %zu", j, i);
            }
            if (rows[i].external && (rows[i].valid & PACE) == PACE) {
                given.valid = ANGLE | GROBO_FIELD_TORQUE; /* without its speed it stays so */
                assert_true(grobo_i_is_external(take(j)));
            }
        }
    }
}

/* Sent nowhere, a joint is where it was read, or on the way that its servo told of. */
TEST(a_joint_sent_nowhere_is_where_it_was_read)
{
    for (int j = 0; j < N; j++) {
        for (int moves = 0; moves < 2; moves++) {
            start_with(NULL);
            given.speed_dps = moves * 20;
            given.goal_time_us = 5000000;
            given.time_us = 2000000;
            given.angle_rad = RAD(20);
            given.goal_rad = RAD(30);
            robot.axes[j].phase = GROBO_I_JOINT_IDLE;
            const grobo_robot_axis *axis = take(j);
            expect("from", axis->trajectory.from_rad, RAD(20));
            expect("to", axis->trajectory.to_rad, moves ? RAD(30) : RAD(20));
            assert_true(axis->trajectory.from_us == NOW);
            assert_true(axis->trajectory.to_us == NOW + (moves ? 3000000 : 0));
            robot.axes[j].phase = GROBO_I_JOINT_SENT; /* sent somewhere, it is on its way */
            given.angle_rad = RAD(22);
            expect("to", take(j)->trajectory.to_rad, moves ? RAD(30) : RAD(20));
        }
    }
}

/* On a way from 0 to 60 degrees in 6 s, half of which are over; asked for a second ago. */
static grobo_robot_axis *on_a_way(int joint)
{
    start_with(NULL);
    grobo_robot_axis *axis = &robot.axes[joint];
    axis->trajectory = (grobo_robot_trajectory){0, RAD(60), NOW - 3000000, NOW + 3000000};
    axis->told_us = NOW - 3000000;
    given.goal_rad = axis->state.goal_rad = RAD(60);
    given.goal_time_us = given.time_us = 0;
    given.valid = ALL_FIELDS & ~GROBO_FIELD_GOAL;
    return axis;
}

/* On its trajectory, sent nowhere, in segments, off it. */
static const grobo_i_joint_state hows[] = {GROBO_I_JOINT_SENT, GROBO_I_JOINT_IDLE,
                                           GROBO_I_JOINT_IN_SEGMENTS, GROBO_I_JOINT_STRAY};

/* 12 degrees from where it was when it was asked, and from where it is by now. */
TEST(a_joint_that_stands_is_off_its_way_by_twelve_degrees)
{
    static const struct {
        double deg;
        int speed_dps;
        bool off;
    } rows[] = {{20 - 11.99, 0, false}, {20 - 12.01, 0, true},  {20 - 12.01, 7, true},
                {20 - 12.01, -7, true}, {20 - 12.01, 8, false}, {20 - 12.01, -8, false},
                {30 + 11.99, 0, false}, {30 + 12.01, 0, true},  {25, 0, false}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            for (int how = 0; how < 4; how++) {
                grobo_robot_axis *axis = on_a_way(j);
                given.angle_rad = RAD(rows[i].deg);
                given.speed_dps = rows[i].speed_dps;
                axis->phase = (uint8_t)hows[how == 3 && rows[i].off ? 0 : how];
                assert_int_equal(take_asked(j, NOW - 1000000), GROBO_OK);
                assert_int_equal(grobo_i_is_stray(axis), rows[i].off && (how == 0 || how == 3));
            }
        }
    }
}

/* One that should turn by 40 deg/s, and stands, has not begun: two degrees tell it. */
TEST(a_joint_that_stands_on_a_fast_way_has_not_begun_it)
{
    static const struct {
        double deg, way_deg;
        int64_t told_ago_us;
        int speed_dps;
        bool off;
    } rows[] = {{20 - 2.01, 40, 500000, 7, true},  {20 - 1.99, 40, 500000, 0, false},
                {20 - 2.01, 40, 500000, 8, false}, {20 - 2.01, 40, 100000, 0, false},
                {20 - 2.01, 40, 100001, 0, true},  {15 - 2.01, 29, 500000, 0, false},
                {20 + 2.01, 40, 500000, 0, true}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            grobo_robot_axis *axis = on_a_way(j);
            double way_rad = RAD(rows[i].way_deg);
            axis->trajectory = (grobo_robot_trajectory){0, way_rad, NOW - 500000, NOW + 500000};
            axis->told_us = NOW - rows[i].told_ago_us;
            given.goal_rad = axis->state.goal_rad = way_rad;
            given.angle_rad = RAD(rows[i].deg);
            given.speed_dps = rows[i].speed_dps;
            (void)take(j);
            if (grobo_i_is_stray(axis) != rows[i].off) {
                fail_msg("joint %d, row %zu", j, i);
            }
        }
    }
}

/* Without its speed a reading tells nothing of that. */
TEST(without_its_speed_a_joint_stays_on_its_way_or_off_it)
{
    for (int j = 0; j < N; j++) {
        for (int off = 0; off < 2; off++) {
            grobo_robot_axis *axis = on_a_way(j);
            given.valid = GROBO_FIELD_ANGLE;
            given.angle_rad = off ? RAD(30) : 0;
            axis->phase = off ? GROBO_I_JOINT_STRAY : GROBO_I_JOINT_SENT;
            (void)take(j);
            assert_int_equal(grobo_i_is_stray(axis), off);
        }
    }
}

/* Its goal is another one: it has told so since the frame, or before and did not move since. */
TEST(a_joint_whose_goal_is_another_is_off_its_way)
{
    static const struct {
        double goal_deg;
        bool tells;
        int64_t told_ago_us; /* its goal, before; GROBO_NEVER_US: never */
        int speed_dps;
        bool off;
    } rows[] = {
        {60.059, true, GROBO_NEVER_US, 30, false}, {60.061, true, GROBO_NEVER_US, 30, true},
        {59.941, true, GROBO_NEVER_US, 30, false}, {59.939, true, GROBO_NEVER_US, 30, true},
        {59.939, false, GROBO_NEVER_US, 0, false}, {59.939, false, 2999999, 0, true},
        {59.939, false, 3000000, 0, false}, /* when the frame left: of before it */
        {59.939, false, 1000000, 7, true},         {59.939, false, 1000000, -7, true},
        {59.939, false, 1000000, 8, false}, /* it may have taken the frame since */
        {59.941, false, 1000000, 0, false},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            for (int how = 0; how < 3; how++) { /* in one, nowhere, in segments */
                grobo_robot_axis *axis = on_a_way(j);
                given.angle_rad = RAD(30);
                given.speed_dps = rows[i].speed_dps;
                given.valid = rows[i].tells ? ALL_FIELDS : ALL_FIELDS & ~GROBO_FIELD_GOAL;
                given.goal_rad = axis->state.goal_rad = RAD(rows[i].goal_deg);
                axis->goal_us = rows[i].told_ago_us == GROBO_NEVER_US ? GROBO_NEVER_US
                                                                      : NOW - rows[i].told_ago_us;
                axis->phase = (uint8_t)hows[how];
                (void)take(j);
                if (grobo_i_is_stray(axis) != (rows[i].off && how == 0)) {
                    fail_msg("joint %d, row %zu", j, i);
                }
            }
        }
    }
}

/* Exactly so far is not farther. */
TEST(what_is_at_the_bound_is_on_the_way)
{
    for (int j = 0; j < N; j++) {
        grobo_robot_axis *axis = on_a_way(j);
        axis->trajectory = (grobo_robot_trajectory){0, 0, NOW, NOW};
        given.angle_rad = 12 * 0.017453292519943295;
        axis->state.goal_rad = 0.06 * 0.017453292519943295;
        (void)take(j);
        assert_false(grobo_i_is_stray(axis));
    }
}

/* Its goal is where it is, and it moves all the same. */
TEST(a_joint_that_leaves_its_goal_is_externally_moved)
{
    for (int j = 0; j < N; j++) {
        start_with(NULL);
        given.speed_dps = 30;
        given.goal_time_us = given.time_us;
        robot.axes[j].phase = GROBO_I_JOINT_IDLE;
        assert_true(grobo_i_is_external(take(j)));
        given.goal_time_us++; /* or the servo has time left for it */
        assert_false(grobo_i_is_external(take(j)));
    }
}

/* It moves, but on the way that its servo told of before the frame. */
TEST(a_joint_on_the_way_told_of_before_is_off_the_new_one)
{
    for (int j = 0; j < N; j++) {
        for (int over = 0; over < 2; over++) {
            grobo_robot_axis *axis = on_a_way(j);
            axis->state.goal_rad = RAD(50);
            axis->goal_us = NOW - 1000000;
            axis->own_until_us = NOW + !over;
            given.angle_rad = RAD(30);
            given.speed_dps = 30;
            (void)take(j);
            assert_int_equal(grobo_i_is_stray(axis), !over);
        }
    }
}

/* What a servo reads as its angle is not quite the angle of some joints. */
TEST(a_reading_is_corrected_where_that_is_wanted)
{
    for (int j = 0; j < N; j++) {
        for (int wanted = 0; wanted < 2; wanted++) {
            const grobo_readback add[] = {{.joint = (uint8_t)j, .add_rad = RAD(2)},
                                          {.joint = (uint8_t)((j + 1) % N), .add_rad = RAD(9)},
                                          {.joint = (uint8_t)j, .add_rad = RAD(-0.5)},
                                          {.joint = (uint8_t)j, .add_rad = RAD(5)}};
            start_with(
                &(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .readback_correction = wanted});
            made.readback = add;
            made.n_readback = 3; /* the fourth is none of its own */
            double by_rad = wanted ? RAD(2) + RAD(-0.5) : 0;
            given.valid = j % 2 == 0 ? ALL_FIELDS : GROBO_FIELD_ANGLE;
            const grobo_robot_axis *axis = take(j);
            expect_near("angle", axis->state.angle_rad, RAD(10) + by_rad);
            expect_near("hold", grobo_i_hold_rad(&robot, j), RAD(10));
            given.valid = ALL_FIELDS & ~GROBO_FIELD_ANGLE;
            expect_near("angle", take(j)->state.angle_rad, RAD(10) + by_rad);
        }
    }
}

TEST(a_joint_is_held_at_its_limit_from_three_degrees_beyond)
{
    for (int j = 0; j < N; j++) {
        for (int end = -1; end <= 1; end += 2) {
            start_with(NULL);
            robot.axes[j].state.angle_rad = end * RAD(70 + j - 0.01);
            expect_near("hold", grobo_i_hold_rad(&robot, j), end * RAD(70 + j - 0.01));
            robot.axes[j].state.angle_rad = end * RAD(70 + j + 2.99);
            expect_near("hold", grobo_i_hold_rad(&robot, j), end * RAD(70 + j));
            robot.axes[j].state.angle_rad = end * RAD(70 + j + 3.01);
            assert_true(isnan(grobo_i_hold_rad(&robot, j)));
            const grobo_joint *limits = &made.model->joints[j];
            robot.axes[j].state.angle_rad = end > 0 ? limits->max_rad + grobo_rad_from_deg(3)
                                                    : limits->min_rad - grobo_rad_from_deg(3);
            assert_true(!isnan(grobo_i_hold_rad(&robot, j)));
        }
    }
}

/* ---- no reading ------------------------------------------------------------------------------ */

TEST(what_did_not_come_is_told_of_its_joint_alone)
{
    static const struct {
        int result;
        bool lost;
    } rows[] = {{GROBO_ERR_TIMEOUT, true},   {GROBO_ERR_SHORT, true},
                {GROBO_ERR_CHECKSUM, true},  {GROBO_ERR_MISMATCH, true},
                {GROBO_ERR_CANCELED, false}, {GROBO_ERR_UNPLUGGED, false},
                {GROBO_ERR_STALE, false},    {GROBO_ERR_NACK, false}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const grobo_packet reply = {.kind = GROBO_PACKET_RETURN};
            const grobo_robot_slot slot = {.robot = &robot, .joint = (uint8_t)j, .reads = true};
            grobo_joint_state got;
            for (int parsed = 0; parsed < 2; parsed++) { /* the line has it, or the driver */
                start_with(NULL);
                given_of = j;
                given_result = rows[i].result;
                memcpy(before, robot.axes, sizeof before);
                assert_int_equal(grobo_i_reading_take(&slot, parsed ? GROBO_OK : rows[i].result,
                                                      parsed ? &reply : NULL, &got),
                                 rows[i].result);
                before[j].status = rows[i].result;
                before[j].lost = rows[i].lost ? 4 : 3;
                assert_memory_equal(before, robot.axes, sizeof before);
            }
            assert_int_equal(grobo_i_is_loss(rows[i].result), rows[i].lost);
        }
        grobo_joint_state got;
        const grobo_robot_slot slot = {.robot = &robot, .joint = (uint8_t)j, .reads = true};
        assert_int_equal(grobo_i_reading_take(&slot, GROBO_OK, NULL, &got), GROBO_ERR_MISMATCH);
    }
    assert_false(grobo_i_is_loss(GROBO_OK));
}

TEST(what_is_no_number_is_no_reading)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        start_with(NULL);
        given.angle_rad = odd[i];
        assert_int_equal(take_asked(0, NOW), GROBO_ERR_MISMATCH);
        given.valid = ALL_FIELDS & ~GROBO_FIELD_ANGLE; /* it is not read */
        assert_int_equal(take_asked(0, NOW), GROBO_OK);
        start_with(NULL);
        given.goal_rad = odd[i];
        assert_int_equal(take_asked(0, NOW), GROBO_ERR_MISMATCH);
        given.valid = ALL_FIELDS & ~GROBO_FIELD_GOAL;
        assert_int_equal(take_asked(0, NOW), GROBO_OK);
    }
    start_with(NULL);
    given.angle_rad = given.goal_rad = DBL_MAX; /* which is one */
    assert_int_equal(take_asked(0, NOW), GROBO_OK);
}
