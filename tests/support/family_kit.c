/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/lx16a.h>
#include <grobo/core/sim.h>
#include <grobo/robot_file.h>

#include "src/base/instant.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MS = 1000, S = 1000000 };

static const family families[] = {
    {"dxl2", &grobo_i_dxl2_table, "XM430-W350", grobo_dxl2_driver_init, 0.5, 1000000, false},
    {"sts", &grobo_i_sts_table, "STS3215", grobo_feetech_driver_init, 0.5, 1000000, false},
    {"scs", &grobo_i_scs_table, "SCS0009", grobo_feetech_driver_init, 1, 1000000, false},
    {"dxl1", &grobo_i_dxl1_table, "AX-12A", grobo_dxl1_driver_init, 1, 1000000, false},
    {"lx16a", &grobo_i_lx16a_table, "LX-16A", grobo_lx16a_driver_init, 0.5, 115200, true},
    {"ics", &grobo_i_ics_table, "KRS-3301", grobo_ics_driver_init, 0.5, 115200, true},
};

const family *family_next(const family *before)
{
    const family *next = before == NULL ? families : before + 1;
    return next < families + sizeof families / sizeof families[0] ? next : NULL;
}

const family *family_named(const char *name)
{
    const family *f = family_next(NULL);
    while (f != NULL && strcmp(f->name, name) != 0) {
        f = family_next(f);
    }
    return f;
}

static void on_event(void *ctx, const grobo_event *event)
{
    family_kit *kit = ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        kit->done[kit->n_done++ % FAMILY_EVENTS] = event->u.job;
    } else if (event->kind == GROBO_EVENT_TRIP) {
        kit->trips[kit->n_trips++ % FAMILY_EVENTS] = event->u.trip.trip;
    } else if (event->kind == GROBO_EVENT_HALTED) {
        kit->halted = event->u.halted;
        kit->n_halted++;
    }
}

/* A sum of 8 bits passes one broken packet in 256, and every packet that lost a byte 0xFF where the
 * first 0xFF of the next one fills it up: no servo can know. */
static bool was_sent(const family_kit *kit, const grobo_sim_event *packet)
{
    for (int i = 0; i < FAMILY_SENT; i++) {
        if (kit->sent_bytes[i] == packet->n_bytes &&
            memcmp(kit->sent[i], packet->bytes, packet->n_bytes) == 0) {
            return true;
        }
    }
    return false;
}

static void note_sent(family_kit *kit, const uint8_t *bytes, size_t n)
{
    memcpy(kit->sent[kit->n_sent % FAMILY_SENT], bytes, n);
    kit->sent_bytes[kit->n_sent++ % FAMILY_SENT] = n;
}

static void on_sim(void *ctx, const grobo_sim_event *event)
{
    family_kit *kit = ctx;
    if (event->kind == GROBO_SIM_PACKET) {
        kit->made_up = !was_sent(kit, event);
    }
    if (kit->on_sim != NULL) {
        kit->on_sim(kit, event);
    }
}

void family_set_up(family_kit *kit, int servo, grobo_register_role role, int32_t value)
{
    const grobo_servo_register *reg = grobo_servo_register_of(kit->servos[servo], role);
    assert_non_null(reg);
    assert_int_equal(grobo_sim_set_register(&kit->sim, servo, reg->address, value), GROBO_OK);
}

static void make_joints(family_kit *kit)
{
    static const char *const names[FAMILY_JOINTS] = {"A", "B", "C", "D"};
    const family *f = kit->family;
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        kit->servos[j] = grobo_servo_model_named(f->table, f->servo);
        assert_non_null(kit->servos[j]);
        kit->joints[j] = (grobo_joint){.name = names[j],
                                       .min_rad = RAD(-90),
                                       .max_rad = RAD(90),
                                       .max_speed_rad_s = RAD(0.8 * kit->servos[j]->speed_dps),
                                       .servo_model = kit->servos[j]->number,
                                       .motor = (uint8_t)(j + 1),
                                       .mirror = (uint8_t)j,
                                       .mirror_sign = 1,
                                       .sign = j == 1 ? -1 : 1};
    }
    kit->model = (grobo_model)GROBO_TABLE(
        grobo_model, .name = f->servo, GROBO_MODEL_JOINTS(kit->joints), .n_joints = FAMILY_JOINTS);
}

void family_start_as(family_kit *kit, const family *f, const grobo_robot_config *config,
                     const grobo_sim_config *sim, void (*change)(family_kit *kit))
{
    grobo_robot_config used = *config;
    grobo_sim_config with =
        sim != NULL ? *sim : (grobo_sim_config){GROBO_SIM_CONFIG_INIT, .seed = 7};
    memset(kit, 0, sizeof *kit);
    kit->family = f;
    kit->now_us = S;
    used.bus.baud_bps = f->baud_bps;
    used.bus.echo = f->echo;
    make_joints(kit);
    if (change != NULL) {
        change(kit);
    }
    with.model = &kit->model;
    with.physics = kit->physics;
    with.wiring = GROBO_WIRING_BUS;
    with.servos = kit->servos;
    with.families = grobo_i_sim_families;
    with.baud_bps = f->baud_bps;
    with.echo = f->echo;
    with.supply_mv = kit->servos[0]->voltage_mv;
    with.hook = on_sim;
    with.hook_ctx = kit;
    assert_int_equal(grobo_sim_init(&kit->sim, &with, kit->now_us), GROBO_OK);
    bool profiled = grobo_servo_register_of(kit->servos[0], GROBO_ROLE_DIRECTION) != NULL;
    for (int j = 0; j < FAMILY_JOINTS && profiled && f->table == &grobo_i_dxl2_table; j++) {
        if (!kit->joints[j].wheel) { /* one as it is sold turns */
            family_set_up(kit, j, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME);
        }
    }
    kit->driver.size = sizeof kit->driver;
    assert_int_equal(f->init(&kit->driver, &kit->model), GROBO_OK);
    assert_int_equal(grobo_robot_init(&kit->robot, &kit->driver, NULL, &used, kit->now_us),
                     GROBO_OK);
    family_listen(kit);
}

void family_start(family_kit *kit, const family *f, const grobo_robot_config *config,
                  const grobo_sim_config *sim)
{
    family_start_as(kit, f, config, sim, NULL);
}

void family_listen(family_kit *kit)
{
    kit->n_done = 0; /* numbers of jobs begin anew */
    grobo_robot_on_event(&kit->robot, on_event, kit);
    grobo_robot_link_up(&kit->robot, kit->now_us);
}

double family_angle_deg(family_kit *kit, int joint)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&kit->sim, joint, &view), GROBO_OK);
    return view.angle_mdeg / 1000.0 * (kit->joints[joint].sign < 0 ? -1 : 1);
}

static void look(family_kit *kit)
{
    if (kit->on_look != NULL) {
        kit->on_look(kit);
        return;
    }
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit->sim, j, &view), GROBO_OK);
        kit->most_dps = fmax(kit->most_dps, view.speed_dps);
    }
}

void family_run(family_kit *kit, int64_t us)
{
    int64_t until_us = kit->now_us + us;
    for (int spins = 0; kit->now_us <= until_us; spins++) {
        uint8_t b[GROBO_FRAME_MAX_BYTES];
        size_t n;
        assert_true(spins < 4000000);
        grobo_sim_step(&kit->sim, kit->now_us);
        while ((n = grobo_sim_tx(&kit->sim, b, sizeof b, kit->now_us)) > 0) {
            grobo_robot_rx(&kit->robot, b, n, kit->now_us);
        }
        grobo_robot_step(&kit->robot, kit->now_us);
        int size = grobo_robot_tx(&kit->robot, b, sizeof b, kit->now_us);
        assert_true(size >= 0);
        if (size > 0 && kit->lose > 0) {
            kit->lose--;
        } else if (size > 0) {
            note_sent(kit, b, (size_t)size);
            assert_int_equal(grobo_sim_rx(&kit->sim, b, (size_t)size, kit->now_us), size);
        }
        look(kit);
        int64_t next_us = grobo_i_sooner(grobo_robot_deadline(&kit->robot, kit->now_us),
                                         grobo_sim_deadline(&kit->sim));
        if (next_us > until_us) {
            kit->now_us = until_us;
            return;
        }
        kit->now_us = grobo_i_later(kit->now_us, next_us);
    }
}

int family_wait(family_kit *kit, int number)
{
    if (number <= 0) {
        fail_msg("%s: refused: %s, trip %d", kit->family->name, grobo_error_name(number),
                 kit->n_trips > 0 ? (int)kit->trips[0] : 0);
    }
    for (int64_t end_us = kit->now_us + 60 * (int64_t)S; kit->now_us < end_us;
         family_run(kit, MS)) {
        for (unsigned i = 0; i < kit->n_done && i < FAMILY_EVENTS; i++) {
            if (kit->done[i].number == number) {
                return kit->done[i].result;
            }
        }
    }
    fail_msg("job %d does not end", number);
    return GROBO_ERR_TIMEOUT;
}

grobo_posture family_posture(const family_kit *kit, double deg, int time_ms)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, kit->model.n_joints), 0);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        p.angle_rad[j] = RAD(deg - 10 * j);
    }
    p.set = GROBO_JOINTS_ALL(FAMILY_JOINTS);
    p.time_us = time_ms * (int64_t)MS;
    return p;
}

int family_move(family_kit *kit, double deg, int time_ms)
{
    grobo_posture p = family_posture(kit, deg, time_ms);
    return family_wait(kit, grobo_robot_move(&kit->robot, &p));
}

void family_at(family_kit *kit, double deg)
{
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        double is_deg = family_angle_deg(kit, j);
        if (fabs(is_deg - (deg - 10 * j)) > kit->family->near_deg) {
            fail_msg("%s: joint %d is at %f, not %f", kit->family->servo, j, is_deg, deg - 10 * j);
        }
    }
}
