/* SPDX-License-Identifier: MIT */
/* What a reading tells of where a joint is. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <grobo/rs30x.h>

#include "src/robot/robot.h"
#include "tests/support/rig.h"

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
    neck()->way = (grobo_robot_way){0, RAD(40), now_us - 2000000, now_us + 2000000};
    neck()->has_target = true;
}

static void a_joint_that_stands_beside_its_way_is_off_it(void **state)
{
    (void)state;
    on_the_way();
    read_state(20, 0);
    assert_false(neck()->off_way);
    read_state(5, 0);
    assert_true(neck()->off_way);
}

static void a_joint_that_moves_beside_its_way_is_late_and_on_it(void **state)
{
    (void)state;
    on_the_way();
    read_state(5, 30);
    assert_false(neck()->off_way);
}

static void a_joint_that_was_sent_nowhere_is_off_no_way(void **state)
{
    (void)state;
    on_the_way();
    neck()->has_target = false;
    read_state(5, 0);
    assert_false(neck()->off_way);
}

static void off_its_way_a_joint_is_on_its_own_or_where_it_was_read(void **state)
{
    (void)state;
    on_the_way();
    read_state(5, 0);
    int64_t now_us = rig.robot.now_us;
    assert_true(neck()->off_way);
    neck()->state.goal_rad = RAD(15);
    neck()->own_until_us = now_us;
    assert_float_equal(grobo_i_axis_commanded(neck(), now_us + 500000), RAD(5), 1e-3);
    neck()->own_until_us = now_us + 1000000;
    assert_float_equal(grobo_i_axis_commanded(neck(), now_us + 500000), RAD(10), 1e-3);
    assert_float_equal(grobo_i_axis_commanded(neck(), now_us + 1500000), RAD(15), 1e-3);
}

static void an_angle_alone_tells_nothing_of_how_a_joint_moves(void **state)
{
    (void)state;
    static const uint8_t angle[] = {50, 0};
    on_the_way();
    neck()->has_target = false;
    read_state(5, 30); /* moves, nobody knows where to */
    assert_true(neck()->adrift);
    read_neck(GROBO_RS30X_POSITION, angle, sizeof angle);
    assert_true(neck()->adrift);
    read_state(5, 0);
    assert_false(neck()->adrift);
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

static void a_driver_that_makes_no_number_of_a_reply_has_read_nothing(void **state)
{
    (void)state;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_joint_that_stands_beside_its_way_is_off_it),
        cmocka_unit_test(a_joint_that_moves_beside_its_way_is_late_and_on_it),
        cmocka_unit_test(a_joint_that_was_sent_nowhere_is_off_no_way),
        cmocka_unit_test(off_its_way_a_joint_is_on_its_own_or_where_it_was_read),
        cmocka_unit_test(a_driver_that_makes_no_number_of_a_reply_has_read_nothing),
        cmocka_unit_test(an_angle_alone_tells_nothing_of_how_a_joint_moves),
    };
    return cmocka_run_group_tests_name("reading", tests, NULL, NULL);
}
