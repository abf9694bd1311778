/* SPDX-License-Identifier: MIT */
/* Robots of LewanSoul and Hiwonder servos: one frame for one servo, one value a frame. */
#include <math.h>

#include <grobo/core/driver.h>

#include "src/base/bytes.h"
#include "src/model/joint.h"
#include "src/servo/lx16a/items.h"
#include "src/servo/table/items.h"
#include "src/servo/tables.h"

#define MS_US 1000
#define TIME_MAX_MS 30000
/* Saving takes as long as writing the id (lx16a.md: some 10 ms). */
#define SAVE_US 20000
/* A shaft may stand a little outside of its range. */
enum { OUTSIDE_TICKS = 100, HEAT_MAX_C = 120 };

static int32_t wants(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found)
{
    (void)joint;
    (void)servo;
    (void)role; /* the mode alone: no wheel */
    (void)found;
    return 0;
}

/* Motor mode: an output of 1000 at most, signed (Bus Servo Communication Protocol,
 * SERVO_OR_MOTOR_MODE_WRITE). Mode and speed are one frame, and neither is kept: whatever mode the
 * servo is in, the first speed makes a wheel of it. */
static bool wheel(const grobo_servo_model *servo, grobo_i_wheel *to)
{
    enum { OUTPUT_MOST = 1000 };
    *to = (grobo_i_wheel){.role = GROBO_ROLE_GOAL_SPEED,
                          .dps = (double)servo->speed_dps / OUTPUT_MOST,
                          .most = OUTPUT_MOST,
                          .mode = 1};
    return true;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static int finish(const grobo_driver *self, uint8_t id, uint8_t command, const uint8_t *data,
                  size_t n, grobo_exchange *exchange)
{
    const grobo_lx16a_packet packet = {id, command, data, n};
    int size = grobo_lx16a_build(&packet, exchange->frame, sizeof exchange->frame);
    return grobo_i_table_finish(self, size, exchange);
}

static int read(const grobo_driver *self, uint8_t id, uint16_t code, grobo_exchange *exchange)
{
    return finish(self, id, (uint8_t)code, NULL, 0, exchange);
}

static int write(const grobo_driver *self, const grobo_register_io *io, uint16_t code,
                 grobo_exchange *exchange)
{
    return finish(self, io->id, (uint8_t)code, io->data, io->length, exchange);
}

static int posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                   grobo_exchange *exchange)
{
    (void)ctx;
    int j = grobo_i_table_joint_of_part(self, target->posture.set, part);
    if (j < 0) {
        return 0;
    }
    const grobo_joint *joint = grobo_i_joint(self->model, j);
    int64_t ms = (target->joint_time_us[j] + MS_US / 2) / MS_US;
    int32_t ticks =
        grobo_i_table_ticks(joint, grobo_i_table_servo(self, j), target->posture.angle_rad[j]);
    uint8_t data[4];
    grobo_i_put_u16(data, (uint16_t)fmin(fmax(ticks, 0), 1000));
    grobo_i_put_u16(data + 2, (uint16_t)(ms < 1 ? 1 : ms > TIME_MAX_MS ? TIME_MAX_MS : ms));
    int result = finish(self, joint->motor, GROBO_LX16A_MOVE, data, sizeof data, exchange);
    return result < 0 ? result : 1;
}

#if !GROBO_DRIVERS_PLAIN
static int speed(const grobo_driver *self, void *ctx, grobo_joint_mask joints, const double *rad_s,
                 int part, grobo_exchange *exchange)
{
    (void)ctx;
    grobo_i_wheel how;
    int j = grobo_i_table_joint_of_part(self, joints, part);
    if (j < 0 || !grobo_i_table_wheel(self, j, &how)) {
        return j < 0 ? 0 : GROBO_ERR_ARG;
    }
    const grobo_joint *joint = grobo_i_joint(self->model, j);
    uint8_t data[4] = {(uint8_t)how.mode};
    grobo_i_put_u16(data + 2, (uint16_t)grobo_i_wheel_counts(joint, &how, rad_s[j]));
    int result = finish(self, joint->motor, GROBO_LX16A_MODE, data, sizeof data, exchange);
    return result < 0 ? result : 1;
}
#endif

static int torque(const grobo_driver *self, int joint, bool on, grobo_exchange *exchange)
{
    const uint8_t load = on;
    return finish(self, grobo_i_joint(self->model, joint)->motor, GROBO_LX16A_LOAD, &load,
                  sizeof load, exchange);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Two bytes that are swapped pass the sum: what no servo says is not believed. */
static int take_position(const grobo_joint *joint, const grobo_servo_model *servo, int32_t ticks,
                         grobo_joint_state *state)
{
    if (ticks < -OUTSIDE_TICKS || ticks > (int32_t)servo->span_ticks + OUTSIDE_TICKS) {
        return GROBO_ERR_MISMATCH;
    }
    state->angle_rad = grobo_i_table_angle(joint, servo, ticks);
    state->valid |= GROBO_FIELD_ANGLE;
    return GROBO_OK;
}

static int take_goal(const grobo_joint *joint, const grobo_servo_model *servo, const uint8_t *data,
                     grobo_joint_state *state)
{
    int32_t ticks = grobo_i_get_u16(data), ms = grobo_i_get_u16(data + 2);
    if (ticks > (int32_t)servo->span_ticks || ms > TIME_MAX_MS) {
        return GROBO_ERR_MISMATCH;
    }
    state->goal_rad = grobo_i_table_angle(joint, servo, ticks);
    state->goal_time_us = (int64_t)ms * MS_US;
    state->valid |= GROBO_FIELD_GOAL;
    return GROBO_OK;
}

/* The shaft's place of a wheel within one turn: outside of its range a servo tells what it
 * likes. */
static int take_wheel_position(const grobo_joint *joint, const grobo_servo_model *servo,
                               int32_t ticks, grobo_joint_state *state)
{
    const grobo_joint shaft = {.sign = joint->sign};
    state->angle_rad =
        remainder(grobo_i_table_angle(&shaft, servo, ticks), grobo_rad_from_deg(360));
    state->valid |= GROBO_FIELD_ANGLE;
    return GROBO_OK;
}

/* What a wheel was told; in the other mode it was told nothing. */
static int take_mode(const grobo_joint *joint, const grobo_i_wheel *how, const uint8_t *data,
                     grobo_joint_state *state)
{
#if GROBO_DRIVERS_PLAIN
    (void)joint;
    (void)how;
    (void)data;
    (void)state;
#else
    if (data[0] == how->mode) {
        state->goal_rad_s = grobo_i_wheel_rad_s(joint, how, grobo_i_get_i16(data + 2));
        state->valid |= GROBO_FIELD_GOAL;
    }
#endif
    return data[0] <= 1 ? GROBO_OK : GROBO_ERR_MISMATCH;
}

static int parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                 grobo_joint_state *state)
{
    (void)ctx;
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    const grobo_i_item *item =
        grobo_i_item_at(grobo_i_lx16a_items, reply->address, (unsigned)reply->data_bytes);
    const uint8_t *data = reply->data;
    const uint16_t code = item == NULL ? 0 : item->read;
    grobo_i_wheel how;
    bool is_wheel = grobo_i_table_wheel(self, joint, &how);
    if (is_wheel && (code == GROBO_LX16A_MODE_READ || code == GROBO_LX16A_POSITION_READ)) {
        return code == GROBO_LX16A_MODE_READ
                   ? take_mode(moved, &how, data, state)
                   : take_wheel_position(moved, servo, grobo_i_get_i16(data), state);
    }
    switch (code) {
    case GROBO_LX16A_MODE_READ:
    case GROBO_LX16A_LIMITS_READ:
        return grobo_i_table_setup(self->family, moved, is_wheel ? &how : NULL,
                                   &(grobo_i_block){servo, reply->address, data, reply->data_bytes},
                                   state);
    case GROBO_LX16A_POSITION_READ:
        return take_position(moved, servo, grobo_i_get_i16(data), state);
    case GROBO_LX16A_MOVE_READ:
        if (is_wheel) {
            return GROBO_OK; /* it goes to no place */
        }
        return take_goal(moved, servo, data, state);
    case GROBO_LX16A_LOAD_READ:
        state->torque = data[0] == 1 ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF;
        state->valid = GROBO_FIELD_TORQUE;
        return data[0] <= 1 ? GROBO_OK : GROBO_ERR_MISMATCH;
    case GROBO_LX16A_TEMPERATURE_READ:
        state->temperature_c = data[0];
        state->valid = GROBO_FIELD_TEMPERATURE;
        return data[0] <= HEAT_MAX_C ? GROBO_OK : GROBO_ERR_MISMATCH;
    case GROBO_LX16A_VOLTAGE_READ:
        state->voltage_mv = grobo_i_get_u16(data);
        state->valid = GROBO_FIELD_VOLTAGE;
        return GROBO_OK;
    default:
        return GROBO_ERR_MISMATCH;
    }
}

/* ---- values, and frames that a user hands in ------------------------------------------------- */

static grobo_write_kind kind_of(uint16_t code, const uint8_t *data)
{
    switch (code) {
    case GROBO_LX16A_LED:
    case GROBO_LX16A_ALARM:
        return GROBO_WRITE_HARMLESS;
    case GROBO_LX16A_MODE: /* a wheel turns at once */
        return data != NULL && data[0] != 0 ? GROBO_WRITE_MOTOR : GROBO_WRITE_SETTING;
    case GROBO_LX16A_ID:
    case GROBO_LX16A_OFFSET:
    case GROBO_LX16A_LIMITS:
    case GROBO_LX16A_VOLTAGES:
    case GROBO_LX16A_HEAT:
        return GROBO_WRITE_SETTING;
    default:
        return GROBO_WRITE_MOTOR;
    }
}

/* The offset is the one value that is not kept by itself. */
static int command(const grobo_driver *self, void *ctx, int id, grobo_servo_command what,
                   grobo_exchange *exchange)
{
    (void)ctx;
    if (what != GROBO_SERVO_FLASH) {
        return GROBO_ERR_UNSUPPORTED;
    }
    exchange->settle_us = SAVE_US;
    return finish(self, (uint8_t)id, GROBO_LX16A_OFFSET_SAVE, NULL, 0, exchange);
}

/* A goal or a torque for each joint of the id; anything else that moves is not understood: START
 * and STOP are of what was told before. */
static int inspect_joint(const grobo_driver *self, const grobo_lx16a_packet *packet, int joint,
                         grobo_target *target, grobo_joint_mask *torqued)
{
    grobo_joint_state state = {.valid = 0};
    grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    if (packet->command == GROBO_LX16A_LOAD && packet->data_bytes == 1 && packet->data[0] <= 1) {
        torqued[packet->data[0] == 1 ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF] |= bit;
        return GROBO_OK;
    }
    if (grobo_i_joint_is_wheel(self->model, joint) || packet->command != GROBO_LX16A_MOVE ||
        packet->data_bytes != 4 ||
        take_goal(grobo_i_joint(self->model, joint), grobo_i_table_servo(self, joint), packet->data,
                  &state) < 0) {
        return GROBO_ERR_UNSUPPORTED;
    }
    target->posture.angle_rad[joint] = state.goal_rad;
    target->posture.set |= bit;
    target->joint_time_us[joint] = state.goal_time_us;
    return GROBO_OK;
}

static int inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                   grobo_target *target, grobo_joint_mask *torqued)
{
    (void)ctx;
    grobo_lx16a_packet packet;
    int result = GROBO_ERR_UNSUPPORTED;
    if (grobo_lx16a_parse(frame, size, &packet) < 0) {
        return GROBO_ERR_UNSUPPORTED;
    }
    bool reads = packet.data_bytes == 0 && grobo_lx16a_reply_bytes(packet.command) > 0;
    if (reads || kind_of(packet.command, packet.data) == GROBO_WRITE_HARMLESS) {
        return GROBO_OK;
    }
    for (int j = 0; j < self->model->n_joints; j++) {
        if (packet.id == GROBO_LX16A_ID_ALL || packet.id == grobo_i_joint(self->model, j)->motor) {
            result = inspect_joint(self, &packet, j, target, torqued);
            if (result < 0) {
                return result;
            }
        }
    }
    return result;
}

/* ---- the table ------------------------------------------------------------------------------- */

static const uint16_t full[] = {GROBO_LX16A_LOAD_READ, GROBO_LX16A_POSITION_READ,
                                GROBO_LX16A_TEMPERATURE_READ, GROBO_LX16A_VOLTAGE_READ, 0};
static const uint16_t position[] = {GROBO_LX16A_POSITION_READ, 0};
static const uint16_t goal[] = {GROBO_LX16A_LOAD_READ, GROBO_LX16A_POSITION_READ,
                                GROBO_LX16A_MOVE_READ, 0};
static const uint16_t all[] = {GROBO_LX16A_LOAD_READ,    GROBO_LX16A_MODE_READ,
                               GROBO_LX16A_LIMITS_READ,  GROBO_LX16A_POSITION_READ,
                               GROBO_LX16A_VOLTAGE_READ, GROBO_LX16A_TEMPERATURE_READ,
                               GROBO_LX16A_MOVE_READ,    0};
/* What a wheel was told stands with its mode. */
static const uint16_t wheel_goal[] = {GROBO_LX16A_LOAD_READ, GROBO_LX16A_MODE_READ,
                                      GROBO_LX16A_POSITION_READ, 0};

static const grobo_i_items items = {.family = {.tables = {&grobo_i_lx16a_table},
                                               .wants = wants,
                                               .wheel = wheel,
                                               .offset_trims = true,
                                               .time_max_ms = TIME_MAX_MS},
                                    .items = grobo_i_lx16a_items,
                                    .senses = {[GROBO_SENSE_FULL] = full,
                                               [GROBO_SENSE_POSITION] = position,
                                               [GROBO_SENSE_GOAL] = goal,
                                               [GROBO_SENSE_ALL] = all},
                                    .wheel_goal = wheel_goal,
                                    .check = GROBO_LX16A_ID_READ,
                                    .read = read,
                                    .write = write,
                                    .torque = torque,
                                    .kind = kind_of};

int grobo_lx16a_driver_init(grobo_driver *driver, const grobo_model *model)
{
    grobo_driver made =
        GROBO_TABLE(grobo_driver, .goal_energises = true, .tells_no_speed = true,
                    .posture = posture, .parse = parse, .command = command, .inspect = inspect);
#if !GROBO_DRIVERS_PLAIN
    made.speed = speed;
#endif
    int result = grobo_i_items_make(&made, model, &grobo_i_lx16a_protocol, &items);
    return grobo_i_table_give(driver, &made, result);
}
