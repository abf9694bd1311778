/* SPDX-License-Identifier: MIT */
/* Every model of every table that can be a joint, on simulated servos of its own: its torque is
 * switched on, it moves where it is sent, and is read whole. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/sim.h>
#include <grobo/robot_file.h>

#include "src/servo/families.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000 };

static family_kit kit;
static const grobo_robot_config idle = {GROBO_ROBOT_CONFIG_INIT,
                                        .sense_interval_us = GROBO_NEVER_US};

static int rs30x_init(grobo_driver *driver, const grobo_model *model)
{
    return grobo_i_family_rs30x.init[GROBO_WIRING_BUS](driver, model);
}

static const family rs30x = {"rs30x", &grobo_i_rs30x_table, "RS301CR", rs30x_init, 0.5, 115200,
                             false};

/* The line reckons with a reply as late as the servo sends it, as it leaves the factory; Feetech's
 * that have no delay are not waited for. */
static void waits_for_replies(const grobo_servo_model *servo)
{
    const grobo_servo_register *delay = grobo_servo_register_of(servo, GROBO_ROLE_RETURN_DELAY);
    uint32_t bus_us = kit.robot.bus.config.return_delay_us;
    if (delay != NULL) {
        double own_us = delay->factory * strtod(delay->unit, NULL);
        assert_true(bus_us >= own_us);
        assert_true(strcmp(kit.driver.protocol->name, "Feetech") != 0 || bus_us <= own_us);
    }
}

/* A move of ten degrees for each joint, then the state of each. */
static void moves_and_tells(const family *row)
{
    const grobo_servo_model *servo = grobo_servo_model_named(row->table, row->servo);
    family_start(&kit, row, &idle, NULL);
    waits_for_replies(servo);
    int ran = grobo_robot_torque(&kit.robot, GROBO_JOINTS_ALL(FAMILY_JOINTS), GROBO_TORQUE_ON);
    assert_true(ran > 0);
    assert_int_equal(family_wait(&kit, ran), GROBO_OK);
    assert_int_equal(family_move(&kit, 30, 2000), GROBO_OK);
    family_run(&kit, S / 2);
    family_at(&kit, 30);
    ran = grobo_robot_sense(&kit.robot, GROBO_JOINTS_ALL(FAMILY_JOINTS), GROBO_SENSE_FULL);
    assert_int_equal(family_wait(&kit, ran), GROBO_OK);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&kit.robot, j, &info), GROBO_OK);
        const grobo_joint_state state = info.state;
        assert_true((state.valid & GROBO_FIELD_ANGLE) != 0);
        assert_true(fabs(grobo_deg_from_rad(state.angle_rad) - (30 - 10 * j)) < 2);
        if (grobo_servo_register_of(servo, GROBO_ROLE_VOLTAGE) != NULL &&
            (state.valid & GROBO_FIELD_VOLTAGE) != 0) {
            assert_true(abs(state.voltage_mv - servo->voltage_mv) < 500);
        }
    }
}

TEST(each_model_moves_and_tells_its_state)
{
    int models = 0, refused = 0;
    for (const family *f = family_next(NULL); f != NULL; f = f == &rs30x ? NULL
                                                             : family_next(f) != NULL
                                                                 ? family_next(f)
                                                                 : &rs30x) {
        for (int m = 0; m < f->table->model_count; m++) {
            const grobo_servo_model *servo = &f->table->models[m];
            family row = *f;
            row.servo = servo->name;
            row.near_deg = 1;
            if ((servo->flags & GROBO_MODEL_NO_JOINT) != 0) {
                refused++;
                continue;
            }
            printf("%s\n", servo->name);
            moves_and_tells(&row);
            models++;
        }
    }
    printf("%d models moved, %d cannot be joints\n", models, refused);
    assert_true(models >= 60);
}

static void last_is_sm(family_kit *own)
{
    const int last = FAMILY_JOINTS - 1;
    own->servos[last] = grobo_servo_model_named(&grobo_i_sts_table, "SM8512BL");
    assert_non_null(own->servos[last]);
    own->joints[last].servo_model = own->servos[last]->number;
}

/* One servo that waits makes the wait of its line. */
TEST(the_slowest_servo_is_waited_for)
{
    const family *sts = family_named("sts");
    assert_non_null(sts);
    family_start_as(&kit, sts, &idle, NULL, last_is_sm);
    assert_int_equal(kit.robot.bus.config.return_delay_us, 500);
    family_start(&kit, sts, &idle, NULL);
    assert_int_equal(kit.robot.bus.config.return_delay_us, 0);
}
