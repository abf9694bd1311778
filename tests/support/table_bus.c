/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/base/instant.h"
#include "tests/support/table_bus.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { BIT_NS = 1000, BITS = 10 };

static bool is_new(const table_bus *bus)
{
    return bus->driver.protocol == &grobo_i_dxl2_protocol;
}

static const grobo_servo_model *model_of(uint16_t number)
{
    static const grobo_servo_table *const tables[] = {&grobo_i_dxl2_table, &grobo_i_dxl1_table,
                                                      &grobo_i_sts_table, &grobo_i_scs_table};
    const grobo_servo_model *found = NULL;
    for (size_t i = 0; found == NULL && i < sizeof tables / sizeof tables[0]; i++) {
        found = grobo_servo_model_numbered(tables[i], number);
    }
    return found;
}

/* ---- registers ------------------------------------------------------------------------------- */

static int32_t get(const table_servo *s, grobo_register_role role)
{
    const grobo_servo_register *reg = grobo_servo_register_of(s->servo, role);
    return reg == NULL ? 0 : grobo_servo_register_get(s->servo, reg, s->memory + reg->address);
}

static void put(table_servo *s, grobo_register_role role, int32_t value)
{
    const grobo_servo_register *reg = grobo_servo_register_of(s->servo, role);
    if (reg != NULL) {
        assert_true(grobo_servo_register_put(s->servo, reg, value, s->memory + reg->address) > 0);
    }
}

int32_t table_get(const table_bus *bus, int joint, grobo_register_role role)
{
    return get(&bus->servo[joint], role);
}

void table_put(table_bus *bus, int joint, grobo_register_role role, int32_t value)
{
    put(&bus->servo[joint], role, value);
}

/* ---- motion ---------------------------------------------------------------------------------- */

static double place(const table_servo *s, int64_t now_us)
{
    if (now_us >= s->to_us) {
        return s->to_ticks;
    }
    double part = (double)(now_us - s->from_us) / (double)(s->to_us - s->from_us);
    return s->from_ticks + (s->to_ticks - s->from_ticks) * part;
}

static void refresh(table_servo *s, uint8_t error, int64_t now_us)
{
    bool moves = now_us < s->to_us && fabs(s->to_ticks - s->from_ticks) > 3;
    put(s, GROBO_ROLE_POSITION, (int32_t)lround(place(s, now_us)));
    put(s, GROBO_ROLE_PRESENT_SPEED, moves ? 200 : 0);
    if (s->servo->table != &grobo_i_dxl2_table) {
        put(s, GROBO_ROLE_ERROR, error); /* there it is a number of its own */
    }
}

static double ticks_per_s(const table_servo *s, int32_t speed)
{
    bool sts = s->servo->table == &grobo_i_sts_table || s->servo->table == &grobo_i_scs_table;
    double deg_s = speed * (sts ? (double)s->servo->span_deg / s->servo->span_ticks
                            : s->servo->span_ticks == 1024 ? 0.666
                                                           : 0.684);
    return deg_s * s->servo->span_ticks / s->servo->span_deg;
}

static void start_move(table_bus *bus, table_servo *s)
{
    double most = s->servo->speed_dps * (double)s->servo->span_ticks / s->servo->span_deg;
    double way = get(s, GROBO_ROLE_GOAL) - place(s, bus->now_us);
    double time_s = 0;
    int32_t speed = get(s, GROBO_ROLE_SPEED);
    int32_t ms = get(s, GROBO_ROLE_GOAL_TIME);
    if (is_new(bus)) {
        time_s = speed / 1e3;
    } else if (grobo_servo_register_of(s->servo, GROBO_ROLE_GOAL_TIME) != NULL && speed == 0) {
        time_s = ms / 1e3;
    } else if (speed != 0) {
        time_s = fabs(way) / ticks_per_s(s, speed);
    }
    s->jumps += fabs(way) > 3 && fabs(way) > time_s * most * 1.05;
    time_s = fmax(time_s, fabs(way) / most);
    s->from_ticks = place(s, bus->now_us);
    s->to_ticks = get(s, GROBO_ROLE_TORQUE) == 1 ? get(s, GROBO_ROLE_GOAL) : s->from_ticks;
    s->from_us = bus->now_us;
    s->to_us = bus->now_us + (int64_t)(time_s * 1e6);
}

static void rest(table_bus *bus, table_servo *s)
{
    s->from_ticks = s->to_ticks = place(s, bus->now_us);
    s->from_us = s->to_us = bus->now_us;
}

static void write_bytes(table_bus *bus, table_servo *s, uint16_t address, const uint8_t *data,
                        size_t n)
{
    int32_t torque = get(s, GROBO_ROLE_TORQUE);
    const grobo_servo_register *goal = grobo_servo_register_of(s->servo, GROBO_ROLE_GOAL);
    assert_true(address + n <= TABLE_MEMORY);
    if (s->frozen == 0 || address != s->frozen) {
        memcpy(s->memory + address, data, n);
    }
    if (address <= goal->address && address + n > goal->address) {
        start_move(bus, s);
    } else if (torque != get(s, GROBO_ROLE_TORQUE)) {
        rest(bus, s);
        if (torque != 1) {
            start_move(bus, s); /* to the old goal, at once */
        }
    }
}

/* ---- frames ---------------------------------------------------------------------------------- */

static void answer(table_bus *bus, int64_t *at_us, table_servo *s, uint16_t address, size_t n)
{
    uint8_t b[256];
    int size;
    refresh(s, bus->error, bus->now_us);
    if (is_new(bus)) {
        size = grobo_dxl2_build(&(grobo_dxl2_packet){.id = (uint8_t)get(s, GROBO_ROLE_ID),
                                                     .instruction = GROBO_DXL2_STATUS,
                                                     .error = bus->error,
                                                     .data = s->memory + address,
                                                     .data_bytes = n},
                                b, sizeof b);
    } else {
        size = grobo_dxl1_build(&(grobo_dxl1_packet){.status = true,
                                                     .id = (uint8_t)get(s, GROBO_ROLE_ID),
                                                     .error = bus->error,
                                                     .data = s->memory + address,
                                                     .data_bytes = n},
                                b, sizeof b);
    }
    assert_true(size > 0 && bus->n_replies < 16);
    *at_us += size * BITS * BIT_NS / 1000;
    if (!s->silent) {
        bus->reply[bus->n_replies].at_us = *at_us;
        bus->reply[bus->n_replies].n = (size_t)size;
        memcpy(bus->reply[bus->n_replies++].bytes, b, (size_t)size);
    }
}

static table_servo *find(table_bus *bus, uint8_t id)
{
    for (int i = 0; i < bus->n; i++) {
        if (get(&bus->servo[i], GROBO_ROLE_ID) == id) {
            return &bus->servo[i];
        }
    }
    return NULL;
}

static void obey(table_bus *bus, const grobo_dxl2_packet *p, int64_t at_us)
{
    table_servo *s = find(bus, p->id);
    if (p->instruction == GROBO_DXL2_READ && s != NULL) {
        answer(bus, &at_us, s, p->address, p->length);
    } else if (p->instruction == GROBO_DXL2_WRITE && s != NULL) {
        write_bytes(bus, s, p->address, p->data, p->data_bytes);
        answer(bus, &at_us, s, 0, 0);
    } else if (p->instruction == GROBO_DXL2_SYNC_READ) {
        for (size_t i = 0; i < p->data_bytes; i++) {
            s = find(bus, p->data[i]);
            if (s != NULL) {
                answer(bus, &at_us, s, p->address, p->length);
            }
        }
    } else if (p->instruction == GROBO_DXL2_SYNC_WRITE) {
        for (size_t at = 0; at + 1 + p->length <= p->data_bytes; at += 1u + p->length) {
            s = find(bus, p->data[at]);
            if (s != NULL) {
                write_bytes(bus, s, p->address, p->data + at + 1, p->length);
            }
        }
    }
}

static bool open_frame(const table_bus *bus, const uint8_t *b, size_t n, uint8_t *room,
                       grobo_dxl2_packet *p)
{
    grobo_dxl1_packet old;
    if (is_new(bus)) {
        return grobo_dxl2_parse(b, n, room, GROBO_FRAME_MAX_BYTES, p) == GROBO_OK;
    }
    if (grobo_dxl1_parse(b, n, false, &old) < 0) {
        return false;
    }
    *p = (grobo_dxl2_packet){.id = old.id,
                             .instruction = old.instruction,
                             .address = old.address,
                             .length = old.length,
                             .data = old.data,
                             .data_bytes = old.data_bytes};
    return true;
}

static void hear(table_bus *bus, const uint8_t *b, size_t n)
{
    uint8_t room[GROBO_FRAME_MAX_BYTES];
    grobo_dxl2_packet p;
    assert_true(open_frame(bus, b, n, room, &p));
    assert_true(bus->n_frames < TABLE_FRAMES && n <= sizeof bus->frame[0].bytes);
    table_frame *frame = &bus->frame[bus->n_frames++];
    frame->at_us = bus->now_us;
    frame->size = (uint16_t)n;
    memcpy(frame->bytes, b, n);
    obey(bus, &p, bus->now_us + (int64_t)n * BITS * BIT_NS / 1000);
}

size_t table_count(const table_bus *bus, uint8_t instruction)
{
    size_t n = 0;
    for (size_t i = 0; i < bus->n_frames; i++) {
        n += bus->frame[i].bytes[is_new(bus) ? 7 : 4] == instruction;
    }
    return n;
}

/* ---- time ------------------------------------------------------------------------------------ */

static void on_event(void *ctx, const grobo_event *event)
{
    table_bus *bus = ctx;
    if (event->kind != GROBO_EVENT_JOINT && event->kind != GROBO_EVENT_ROUND) {
        assert_true(bus->n_events < TABLE_EVENTS);
        bus->event[bus->n_events++] = *event;
    }
}

void table_start(table_bus *bus, const grobo_robot_config *config)
{
    grobo_robot_config used = *config;
    const grobo_model *model = bus->driver.model;
    used.bus.baud_bps = 1000000;
    bus->n = model->n_joints;
    bus->now_us = 1000000;
    for (int j = 0; j < bus->n; j++) {
        table_servo *s = &bus->servo[j];
        const grobo_servo_register *reg;
        s->servo = model_of(model->joints[j].servo_model);
        assert_non_null(s->servo);
        for (size_t i = 0; (reg = grobo_servo_register_row(s->servo, i)) != NULL; i++) {
            if (reg->factory != 0 && reg->address + reg->bytes <= TABLE_MEMORY) {
                (void)grobo_servo_register_put(s->servo, reg, reg->factory,
                                               s->memory + reg->address);
            }
        }
        put(s, GROBO_ROLE_MODEL, s->servo->number);
        put(s, GROBO_ROLE_ID, model->joints[j].motor);
        put(s, GROBO_ROLE_TEMPERATURE, 30);
        put(s, GROBO_ROLE_VOLTAGE, s->servo->voltage_mv / 100);
        put(s, GROBO_ROLE_TORQUE_LIMIT, 1000);
        s->from_ticks = s->to_ticks = s->servo->middle;
        if (is_new(bus)) {
            put(s, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME);
        }
    }
    assert_int_equal(grobo_robot_init(&bus->robot, &bus->driver, NULL, &used, bus->now_us),
                     GROBO_OK);
    grobo_robot_on_event(&bus->robot, on_event, bus);
    grobo_robot_link_up(&bus->robot, bus->now_us);
}

static void deliver(table_bus *bus)
{
    while (bus->n_replies > 0 && bus->reply[0].at_us <= bus->now_us) {
        uint8_t b[256];
        size_t n = bus->reply[0].n;
        memcpy(b, bus->reply[0].bytes, n);
        bus->n_replies--;
        memmove(bus->reply, bus->reply + 1, (size_t)bus->n_replies * sizeof bus->reply[0]);
        grobo_robot_rx(&bus->robot, b, n, bus->now_us);
    }
}

void table_run(table_bus *bus, int64_t us)
{
    int64_t until_us = bus->now_us + us;
    for (int spins = 0; bus->now_us <= until_us; spins++) {
        uint8_t b[GROBO_FRAME_MAX_BYTES];
        assert_true(spins < 1000000);
        deliver(bus);
        grobo_robot_step(&bus->robot, bus->now_us);
        int n = grobo_robot_tx(&bus->robot, b, sizeof b, bus->now_us);
        assert_true(n >= 0);
        if (n > 0) {
            hear(bus, b, (size_t)n);
        }
        int64_t next_us = grobo_robot_deadline(&bus->robot, bus->now_us);
        if (bus->n_replies > 0) {
            next_us = grobo_i_sooner(next_us, bus->reply[0].at_us);
        }
        if (next_us > until_us) {
            bus->now_us = until_us;
            return;
        }
        bus->now_us = grobo_i_later(bus->now_us, next_us);
    }
}

int table_wait(table_bus *bus, int number)
{
    assert_true(number > 0);
    for (int64_t end_us = bus->now_us + 60000000; bus->now_us < end_us;) {
        for (size_t i = 0; i < bus->n_events; i++) {
            const grobo_event *event = &bus->event[i];
            if (event->kind == GROBO_EVENT_JOB && event->u.job.number == number) {
                return event->u.job.result;
            }
        }
        table_run(bus, 1000);
    }
    fail_msg("job %d does not end", number);
    return GROBO_ERR_TIMEOUT;
}

/* ---- joints ---------------------------------------------------------------------------------- */

static double ticks_per_rad(const table_servo *s)
{
    return s->servo->span_ticks / (s->servo->span_deg * 0.017453292519943295);
}

double table_angle_deg(const table_bus *bus, int joint)
{
    const table_servo *s = &bus->servo[joint];
    double servo_rad = (place(s, bus->now_us) - s->servo->middle) / ticks_per_rad(s);
    return grobo_deg_from_rad(grobo_joint_from_servo(&bus->driver.model->joints[joint], servo_rad));
}

void table_turn(table_bus *bus, int joint, double angle_deg)
{
    table_servo *s = &bus->servo[joint];
    const grobo_joint *moved = &bus->driver.model->joints[joint];
    assert_int_not_equal(get(s, GROBO_ROLE_TORQUE), 1);
    s->from_ticks = s->to_ticks =
        s->servo->middle +
        grobo_joint_to_servo(moved, grobo_rad_from_deg(angle_deg)) * ticks_per_rad(s);
}
