/* SPDX-License-Identifier: MIT */
/* The servos' own dead-man: they stop when their host is gone, and go on when one is back. */
#include <math.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tests/support/family_kit.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000 };

static family_kit kit;
/* Whole goals: without a dead-man a servo would go all the way. */
static const grobo_robot_config whole = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS,
                                         .goals = GROBO_GOALS_WHOLE};

static void start(void)
{
    family_start(&kit, family_named("dxl2"), &whole, NULL);
}

static int32_t watchdog(int servo)
{
    const grobo_servo_register *reg =
        grobo_servo_register_of(kit.servos[servo], GROBO_ROLE_WATCHDOG);
    int32_t value = 0;
    assert_int_equal(grobo_sim_get_register(&kit.sim, servo, reg->address, &value), GROBO_OK);
    return value;
}

/* Nobody pumps the engine any more: its program is dead. */
static void die(int64_t us)
{
    uint8_t b[GROBO_FRAME_MAX_BYTES];
    kit.now_us += us;
    grobo_sim_step(&kit.sim, kit.now_us);
    while (grobo_sim_tx(&kit.sim, b, sizeof b, kit.now_us) > 0) {
    }
}

static void move_and_die(void)
{
    start();
    assert_int_equal(family_move(&kit, 40, 1000), GROBO_OK);
    grobo_posture p = family_posture(&kit, -50, 5000);
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, 1000 * MS);
    assert_int_equal(watchdog(0), 25);
    double then_deg = family_angle_deg(&kit, 0);
    die(4 * (int64_t)S);
    double way_deg = then_deg - family_angle_deg(&kit, 0);
    assert_true(way_deg > 1 && way_deg < 90.0 * 600 / 5000);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_ON);
        assert_false(view.moving);
        assert_int_equal(watchdog(j), -1);
    }
}

TEST(servos_stop_when_their_program_dies)
{
    move_and_die();
}

TEST(another_program_goes_on)
{
    move_and_die();
    grobo_robot_config config = whole;
    config.bus.baud_bps = 1000000;
    assert_int_equal(grobo_robot_init(&kit.robot, &kit.driver, NULL, &config, kit.now_us),
                     GROBO_OK);
    grobo_robot_link_up(&kit.robot, kit.now_us);
    grobo_posture p = family_posture(&kit, 20, 1000);
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, 4 * S);
    family_at(&kit, 20);
    assert_int_equal(watchdog(0), 25);
}

/* A host that stalls for longer than that goes on with its next motion. */
TEST(a_host_that_stalls_goes_on)
{
    move_and_die();
    family_run(&kit, S);
    assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
    family_at(&kit, 10);
    assert_int_equal(watchdog(0), 25);
}

TEST(who_leaves_takes_it_back)
{
    static const grobo_exit_policy policies[] = {GROBO_EXIT_HOLD, GROBO_EXIT_OFF, GROBO_EXIT_SIT};
    for (size_t i = 0; i < sizeof policies / sizeof policies[0]; i++) {
        start();
        assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
        assert_int_equal(family_wait(&kit, grobo_robot_exit(&kit.robot, policies[i])), GROBO_OK);
        die(2 * S);
        for (int j = 0; j < FAMILY_JOINTS; j++) {
            assert_int_equal(watchdog(j), 0);
        }
    }
}

TEST(it_does_not_go_off_by_itself)
{
    start();
    assert_int_equal(family_move(&kit, 10, 1000), GROBO_OK);
    family_run(&kit, 10 * S);
    assert_int_equal(watchdog(0), 25);
    kit.driver.watchdog_us = 0; /* an option */
    assert_int_equal(grobo_sim_set_register(&kit.sim, 0, 98, 0), GROBO_OK);
    assert_int_equal(family_move(&kit, 20, 1000), GROBO_OK);
    assert_int_equal(watchdog(0), 0);
}

/* A program that reads nothing is not stopped on a whole way, one that reads slowly has more time,
 * as far as the servo can count. */
TEST(readings_are_what_renews_it)
{
    static const struct {
        int64_t interval_us;
        int32_t count;
    } rows[] = {{GROBO_SENSE_NEVER, 0}, {100 * MS, 25}, {600 * MS, 60}, {3 * (int64_t)S, 0}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_robot_config config = whole;
        config.sense_interval_us = rows[i].interval_us;
        family_start(&kit, family_named("dxl2"), &config, NULL);
        assert_int_equal(family_move(&kit, 30, 2000), GROBO_OK);
        assert_int_equal(watchdog(3), rows[i].count);
        assert_int_equal(family_move(&kit, -30, 4000), GROBO_OK);
        family_at(&kit, -30);
    }
}
