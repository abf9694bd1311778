/* SPDX-License-Identifier: MIT */
/* Servos that answer a reading with one packet together are read so, where each of them does. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/dxl2.h>

#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, OLD = 45, ENOUGH = 46 };

static const family xl330 = {
    "dxl2", &grobo_i_dxl2_table, "XL330-M288", grobo_dxl2_driver_init, 0.5, 1000000, false};
static const grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 10 * MS};

static family_kit kit;
static unsigned fast, plain;
static bool pretends; /* the third has a new firmware but for a fast reading */

/* A register that nobody writes: the servo is another one then. */
static void set_firmware(family_kit *of, int servo, uint8_t firmware)
{
    of->sim.servo[servo].reg[6] = firmware;
}

static void count(family_kit *of, const grobo_sim_event *event)
{
    if (event->kind != GROBO_SIM_PACKET || event->n_bytes < 8) {
        return;
    }
    bool is_fast = event->bytes[7] == GROBO_DXL2_FAST_SYNC_READ;
    fast += is_fast;
    plain += event->bytes[7] == GROBO_DXL2_SYNC_READ;
    if (pretends) {
        set_firmware(of, 2, is_fast ? OLD : ENOUGH);
    }
}

static void begin(const family *f)
{
    fast = plain = 0;
    pretends = false;
    family_start(&kit, f, &busy, NULL);
    kit.on_sim = count;
}

static void begin_with(uint8_t firmware_of_third)
{
    begin(&xl330);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        set_firmware(&kit, j, j == 2 ? firmware_of_third : ENOUGH);
    }
    grobo_robot_link_down(&kit.robot, kit.now_us); /* what it has read so far is forgotten */
    grobo_robot_link_up(&kit.robot, kit.now_us);
    fast = plain = 0;
}

static void run(int64_t us)
{
    fast = plain = 0;
    family_run(&kit, us);
}

/* Each joint is where it is said to be, and was read a moment ago. */
static void assert_read(void)
{
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        grobo_joint_info got;
        assert_int_equal(grobo_robot_joint(&kit.robot, j, &got), GROBO_OK);
        assert_true(got.full_age_us < 50 * MS);
        assert_int_equal(got.status, GROBO_OK);
        assert_true(grobo_deg_from_rad(got.state.angle_rad) - family_angle_deg(&kit, j) < 0.2);
        assert_true(grobo_deg_from_rad(got.state.angle_rad) - family_angle_deg(&kit, j) > -0.2);
    }
    assert_int_equal(kit.n_trips, 0);
}

TEST(all_that_answer_so_are_read_fast)
{
    begin_with(ENOUGH);
    run(S);
    assert_in_range(plain, 1, 2); /* the first reading asks what they are */
    assert_in_range(fast, 95, 101);
    assert_read();
    assert_int_equal(family_move(&kit, 40, 500), GROBO_OK);
    family_at(&kit, 40);
    assert_read();
}

TEST(one_old_servo_among_them_is_enough)
{
    begin_with(OLD);
    run(S);
    assert_int_equal(fast, 0);
    assert_in_range(plain, 95, 101);
    assert_read();
}

/* The firmware from which the maker says that a model answers so, 0: never (ROBOTIS e-manual,
 * Protocol 2.0, Fast Sync Read: X430 and X540 from 45 but for 2X, X330 from 46, P from 12; no MX,
 * PRO nor XL-320). */
static uint8_t first_of(const char *name)
{
    if (strncmp(name, "PH", 2) == 0 || strncmp(name, "PM", 2) == 0) {
        return 12;
    }
    if (strncmp(name, "2X", 2) == 0 || name[0] != 'X' || strcmp(name, "XL-320") == 0) {
        return 0;
    }
    return strncmp(name + 2, "330", 3) == 0 ? 46 : 45;
}

/* Every model at the versions around that, and at the newest. */
TEST(each_model_is_asked_so_from_its_firmware_on)
{
    int models = 0;
    for (int i = 0; i < grobo_i_dxl2_table.model_count; i++) {
        const grobo_servo_model *model = &grobo_i_dxl2_table.models[i];
        const family f = {
            "dxl2", &grobo_i_dxl2_table, model->name, grobo_dxl2_driver_init, 0.5, 1000000, false};
        if ((model->flags & GROBO_MODEL_NO_JOINT) != 0) {
            continue; /* nothing is known of it */
        }
        uint8_t first = first_of(model->name);
        const uint8_t versions[] = {(uint8_t)(first > 0 ? first - 1 : 44), first, 255};
        assert_int_equal(model->fast_firmware, first);
        models++;
        for (size_t v = 0; v < sizeof versions; v++) {
            begin(&f);
            for (int j = 0; j < FAMILY_JOINTS; j++) {
                set_firmware(&kit, j, versions[v]);
            }
            grobo_robot_link_down(&kit.robot, kit.now_us);
            grobo_robot_link_up(&kit.robot, kit.now_us);
            run(120 * MS);
            bool expected = first > 0 && versions[v] >= first;
            assert_true(expected ? fast > 8 && plain <= 2 : fast == 0 && plain > 8);
            if (first > 0 || strncmp(model->name, "MX", 2) == 0 || model->name[0] == '2') {
                assert_read();
            }
        }
    }
    assert_true(models >= 35);
}

/* Where an old one takes the place of a new one while the line stays up, one reading is lost. */
TEST(a_servo_replaced_in_operation_is_read_on)
{
    begin_with(ENOUGH);
    family_run(&kit, S);
    set_firmware(&kit, 2, OLD);
    run(S);
    assert_int_equal(fast, 1);
    assert_in_range(plain, 90, 101);
    assert_read();
    set_firmware(&kit, 2, ENOUGH);
    grobo_robot_link_down(&kit.robot, kit.now_us);
    grobo_robot_link_up(&kit.robot, kit.now_us);
    run(S);
    assert_true(fast > 90);
    assert_read();
}

/* A disturbance changes nothing for long: all are asked what they are, and read fast again. */
TEST(a_lost_reading_is_no_end)
{
    begin_with(ENOUGH);
    family_run(&kit, S);
    for (int i = 0; i < 10; i++) {
        assert_int_equal(grobo_sim_set_cable(&kit.sim, 1, GROBO_SIM_CABLE_MUTE), 0);
        family_run(&kit, 5 * MS);
        assert_int_equal(grobo_sim_set_cable(&kit.sim, 1, GROBO_SIM_CABLE_IN), 0);
        run(500 * MS);
        assert_true(fast > 40);
        assert_in_range(plain, 0, 5);
    }
    assert_read();
}

/* One that says so and does not answer is asked so three times. */
TEST(who_only_says_so_is_not_asked_for_ever)
{
    begin_with(ENOUGH);
    pretends = true;
    run(2 * (int64_t)S);
    assert_int_equal(fast, 3);
    assert_in_range(plain, 180, 201);
    assert_read();
}
