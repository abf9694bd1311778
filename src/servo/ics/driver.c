/* SPDX-License-Identifier: MIT */
/*
 * Robots of Kondo KRS servos. A goal has no time: the servo's speed is set before each, for the way
 * that is to be gone. Each goal is answered with where the servo is, and switches the torque on;
 * whether it has torque stands in the EEPROM. No servo tells its goal: the answer to one shows that
 * it was taken.
 */
#include <math.h>

#include <grobo/core/driver.h>

#include "src/base/bytes.h"
#include "src/model/joint.h"
#include "src/servo/ics/items.h"
#include "src/servo/table/items.h"
#include "src/servo/tables.h"

/* Speeds are 1 to 127, the last of them the servo's own: so they are taken for parts of it. The
 * manual does not say. */
#define SPEED_FULL 127
/* A shaft may stand a little outside of its range. */
enum { OUTSIDE_TICKS = 300, MA_OF_COUNT = 100, CURRENT_BITS = 0x3F };
/* What clients wait after writing the EEPROM. */
#define EEPROM_US 600000

static int32_t wants(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found)
{
    const unsigned others = GROBO_I_ICS_REVERSE | GROBO_I_ICS_ROTATION | GROBO_I_ICS_SLAVE;
    (void)joint;
    (void)servo;
    (void)role; /* the flags alone */
    return found & ~(int32_t)others;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static int finish(const grobo_driver *self, const grobo_ics_packet *packet,
                  grobo_exchange *exchange)
{
    int size = grobo_ics_build(packet, exchange->frame, sizeof exchange->frame);
    return grobo_i_table_finish(self, size, exchange);
}

static int send_position(const grobo_driver *self, int joint, int32_t position,
                         grobo_exchange *exchange)
{
    const grobo_ics_packet packet = {.command = GROBO_ICS_POSITION,
                                     .id = grobo_i_joint(self->model, joint)->motor,
                                     .value = (uint16_t)position};
    return finish(self, &packet, exchange);
}

static int read(const grobo_driver *self, uint8_t id, uint16_t code, grobo_exchange *exchange)
{
    const grobo_ics_packet packet = {.command = GROBO_ICS_READ, .id = id, .item = (uint8_t)code};
    return finish(self, &packet, exchange);
}

static uint16_t speed_of(const grobo_driver *self, const grobo_target *target, int joint)
{
    double part =
        grobo_i_table_speed_dps(self, target, joint) / grobo_i_table_servo(self, joint)->speed_dps;
    return (uint16_t)fmin(fmax(ceil(part * SPEED_FULL), 1), SPEED_FULL);
}

/* Two frames a joint: the second leaves when the first was answered. */
static int posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                   grobo_exchange *exchange)
{
    (void)ctx;
    int j = grobo_i_table_joint_of_part(self, target->posture.set, part / 2);
    if (j < 0) {
        return 0;
    }
    const grobo_joint *joint = grobo_i_joint(self->model, j);
    int32_t ticks =
        grobo_i_table_ticks(joint, grobo_i_table_servo(self, j), target->posture.angle_rad[j]);
    const grobo_ics_packet speed = {.command = GROBO_ICS_WRITE,
                                    .id = joint->motor,
                                    .item = GROBO_ICS_SPEED,
                                    .value = speed_of(self, target, j)};
    ticks = ticks < GROBO_ICS_POSITION_MIN   ? GROBO_ICS_POSITION_MIN
            : ticks > GROBO_ICS_POSITION_MAX ? GROBO_ICS_POSITION_MAX
                                             : ticks;
    int result =
        part % 2 == 0 ? finish(self, &speed, exchange) : send_position(self, j, ticks, exchange);
    return result < 0 ? result : 1;
}

/* The goal where it stands has switched it on already: to read the speed does nothing. */
static int torque(const grobo_driver *self, int joint, bool on, grobo_exchange *exchange)
{
    return on ? read(self, grobo_i_joint(self->model, joint)->motor, GROBO_I_ICS_READ(SPEED),
                     exchange)
              : send_position(self, joint, GROBO_ICS_FREE, exchange);
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Who it is, which way its positions go, how far, and whether it has torque. */
static int take_eeprom(const grobo_i_family *family, const grobo_joint *joint,
                       const grobo_servo_model *servo, const uint8_t *data,
                       grobo_joint_state *state)
{
    const grobo_i_block block = {servo, 0, data, GROBO_I_ICS_EEPROM_BYTES};
    unsigned flags = data[GROBO_I_ICS_AT_FLAGS];
    if (data[0] != GROBO_I_ICS_FIXED || data[GROBO_I_ICS_AT_ID] != joint->motor) {
        return GROBO_ERR_MISMATCH;
    }
    int result = grobo_i_table_setup(family, joint, NULL, &block, state);
    state->torque = (flags & GROBO_I_ICS_FREE) != 0 ? GROBO_TORQUE_OFF : GROBO_TORQUE_ON;
    state->valid |= GROBO_FIELD_TORQUE;
    return result;
}

static int take_position(const grobo_joint *joint, const grobo_servo_model *servo,
                         const uint8_t *data, grobo_joint_state *state)
{
    int32_t ticks = data[0] << 8 | data[1];
    if (ticks < GROBO_ICS_POSITION_MIN - OUTSIDE_TICKS ||
        ticks > GROBO_ICS_POSITION_MAX + OUTSIDE_TICKS) {
        return GROBO_ERR_MISMATCH;
    }
    state->angle_rad = grobo_i_table_angle(joint, servo, ticks);
    state->valid |= GROBO_FIELD_ANGLE;
    return GROBO_OK;
}

/* What a position has done, which the servo has answered. */
static void take_goal(const grobo_joint *joint, const grobo_servo_model *servo, unsigned goal,
                      grobo_joint_state *state)
{
    state->torque = goal == GROBO_ICS_FREE ? GROBO_TORQUE_OFF : GROBO_TORQUE_ON;
    state->valid |= GROBO_FIELD_TORQUE;
    if (goal != GROBO_ICS_FREE) {
        state->goal_rad = grobo_i_table_angle(joint, servo, (int32_t)goal);
        state->valid |= GROBO_FIELD_GOAL;
    }
}

static int parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                 grobo_joint_state *state)
{
    (void)ctx;
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    const uint8_t *data = reply->data;
    if (reply->address >= GROBO_I_ICS_AT_GOAL) {
        take_goal(moved, servo, reply->address - (unsigned)GROBO_I_ICS_AT_GOAL, state);
        return take_position(moved, servo, data, state);
    }
    const grobo_i_item *item =
        grobo_i_item_at(grobo_i_ics_items, reply->address, (unsigned)reply->data_bytes);
    if (item == NULL) {
        return GROBO_ERR_MISMATCH;
    }
    switch (item->read) {
    case GROBO_I_ICS_READ(EEPROM):
        return take_eeprom(self->family, moved, servo, data, state);
    case GROBO_I_ICS_READ(POSITION_ITEM):
        return take_position(moved, servo, data, state);
    case GROBO_I_ICS_READ(CURRENT):
        state->current_ma = (data[0] & CURRENT_BITS) * MA_OF_COUNT;
        state->valid = GROBO_FIELD_CURRENT;
        return GROBO_OK;
    case GROBO_I_ICS_READ(TEMPERATURE):
        state->temperature_c = (int16_t)lround(grobo_i_ics_celsius(data[0]));
        state->valid = GROBO_FIELD_TEMPERATURE;
        return GROBO_OK;
    default:
        return GROBO_OK; /* tells nothing of the joint */
    }
}

/* ---- values, and frames that a user hands in ------------------------------------------------- */

static grobo_write_kind kind_of(uint16_t code, const uint8_t *data)
{
    (void)data;
    return code == GROBO_I_ICS_WRITE(SPEED)     ? GROBO_WRITE_MOTOR
           : code == GROBO_I_ICS_WRITE(STRETCH) ? GROBO_WRITE_HARMLESS
                                                : GROBO_WRITE_SETTING;
}

/* The EEPROM goes back as it was read but for what is changed: its first byte never is. */
static int write_eeprom(const grobo_driver *self, const grobo_register_io *io,
                        grobo_exchange *exchange)
{
    uint8_t nibbles[GROBO_ICS_EEPROM_BYTES];
    if (io->data[0] != GROBO_I_ICS_FIXED) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < GROBO_I_ICS_EEPROM_BYTES; i++) {
        nibbles[2 * i] = io->data[i] >> 4;
        nibbles[2 * i + 1] = io->data[i] & 0x0F;
    }
    const grobo_ics_packet packet = {
        .command = GROBO_ICS_WRITE, .id = io->id, .item = GROBO_ICS_EEPROM, .data = nibbles};
    exchange->settle_us = EEPROM_US;
    return finish(self, &packet, exchange);
}

static int write(const grobo_driver *self, const grobo_register_io *io, uint16_t code,
                 grobo_exchange *exchange)
{
    const grobo_ics_packet packet = {
        .command = GROBO_ICS_WRITE, .id = io->id, .item = (uint8_t)code, .value = io->data[0]};
    return code == GROBO_I_ICS_WRITE(EEPROM) ? write_eeprom(self, io, exchange)
                                             : finish(self, &packet, exchange);
}

/* Of a goal nobody knows how fast the servo would go. */
static int inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                   grobo_target *target, grobo_joint_mask *torqued)
{
    (void)ctx;
    grobo_ics_packet packet;
    if (grobo_ics_parse(NULL, 0, frame, size, &packet) < 0) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (packet.command == GROBO_ICS_READ ||
        (packet.command == GROBO_ICS_WRITE && packet.item == GROBO_ICS_STRETCH)) {
        return GROBO_OK;
    }
    int joint = grobo_model_joint_of_motor(self->model, packet.id);
    if (packet.command != GROBO_ICS_POSITION || joint < 0) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (packet.value == GROBO_ICS_FREE) {
        torqued[GROBO_TORQUE_OFF] |= GROBO_JOINT_BIT(joint);
        return GROBO_OK;
    }
    target->posture.angle_rad[joint] = grobo_i_table_angle(
        grobo_i_joint(self->model, joint), grobo_i_table_servo(self, joint), packet.value);
    target->posture.set |= GROBO_JOINT_BIT(joint);
    target->joint_time_us[joint] = 0;
    return GROBO_OK;
}

/* ---- the table ------------------------------------------------------------------------------- */

static const uint16_t all[] = {GROBO_I_ICS_READ(EEPROM), GROBO_I_ICS_READ(POSITION_ITEM),
                               GROBO_I_ICS_READ(CURRENT), GROBO_I_ICS_READ(TEMPERATURE), 0};
static const uint16_t position[] = {GROBO_I_ICS_READ(POSITION_ITEM), 0};
static const uint16_t goal[] = {GROBO_I_ICS_READ(EEPROM), GROBO_I_ICS_READ(POSITION_ITEM), 0};

static const grobo_i_items items = {.family = {.tables = {&grobo_i_ics_table},
                                               .wants = wants,
                                               .offset_trims = true,
                                               .time_max_ms = 65535},
                                    .items = grobo_i_ics_items,
                                    .senses = {[GROBO_SENSE_FULL] = all,
                                               [GROBO_SENSE_POSITION] = position,
                                               [GROBO_SENSE_GOAL] = goal,
                                               [GROBO_SENSE_ALL] = all},
                                    .check = GROBO_I_ICS_READ(SPEED),
                                    .read = read,
                                    .write = write,
                                    .torque = torque,
                                    .kind = kind_of};

int grobo_ics_driver_init(grobo_driver *driver, const grobo_model *model)
{
    grobo_driver made = GROBO_TABLE(grobo_driver, .goal_energises = true, .tells_no_speed = true,
                                    .posture = posture, .parse = parse, .inspect = inspect);
    int result = grobo_i_items_make(&made, model, &grobo_i_ics_protocol, &items);
    for (int j = 0; result >= 0 && j < model->n_joints; j++) {
        bool tells = grobo_ics_tells_position(grobo_i_table_servo(&made, j));
        result = tells ? result : GROBO_ERR_UNSUPPORTED;
    }
    return grobo_i_table_give(driver, &made, result);
}
