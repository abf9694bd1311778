/* SPDX-License-Identifier: MIT */
/* The driver functions of robots made of RS30x servos, on any line. */
#include <string.h>

#include <grobo/core/driver.h>

#include "src/base/bytes.h"
#include "src/model/joint.h"
#include "src/servo/rs30x/driver.h"

/* A long packet of n servos has 8 + (1 + data) n bytes (protocol 3). */
static int servos_per_frame(const grobo_driver *self, int data_bytes)
{
    const grobo_relay *relay = self->protocol->relay;
    int packet = relay != NULL ? (int)relay->packet_max_bytes : GROBO_RS30X_PACKET_MAX_BYTES;
    return (packet - GROBO_RS30X_OVERHEAD_BYTES) / (1 + data_bytes);
}

/* Takes the size a builder returned into the exchange and works out the reply. */
static int finish(const grobo_driver *self, int size, grobo_exchange *exchange)
{
    if (size < 0) {
        return size;
    }
    exchange->frame_bytes = (uint16_t)size;
    int reply = self->protocol->reply_to(exchange->frame, (size_t)size, &exchange->reply);
    return reply < 0 ? reply : GROBO_OK;
}

static int finish_part(const grobo_driver *self, int size, grobo_exchange *exchange)
{
    int result = finish(self, size, exchange);
    return result < 0 ? result : 1;
}

/* The joints of part `part` in motor order, `capacity` a part; returns how many. */
static int joints_of_part(const grobo_model *model, grobo_joint_mask joints, int part, int capacity,
                          uint8_t *list)
{
    uint8_t joint_of[GROBO_SERVO_ID_MAX + 1]; /* by motor, the joint + 1; 0: none */
    int highest = 0, skip = part * capacity, n = 0;
    if (skip > 0 && grobo_joints_count(joints) <= skip) {
        return 0;
    }
    for (int j = 0; j < model->n_joints; j++) {
        int motor = grobo_i_joint(model, j)->motor;
        highest = motor > highest ? motor : highest;
    }
    memset(joint_of, 0, (size_t)highest + 1);
    for (int j = 0; j < model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0) {
            joint_of[grobo_i_joint(model, j)->motor] = (uint8_t)(j + 1);
        }
    }
    for (int motor = 0; motor <= highest && n < capacity; motor++) {
        if (joint_of[motor] != 0 && skip-- <= 0) {
            list[n++] = (uint8_t)(joint_of[motor] - 1);
        }
    }
    return n;
}

int grobo_i_rs30x_check(const grobo_driver *self, void *ctx, int part, grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_relay *relay = self->protocol->relay;
    if (relay != NULL) {
        return part > 0 ? 0
                        : finish_part(self, relay->check(exchange->frame, sizeof exchange->frame),
                                      exchange);
    }
    if (part >= self->model->n_joints) {
        return 0;
    }
    int size = grobo_frame_read(self->protocol, grobo_i_joint(self->model, part)->motor,
                                GROBO_RS30X_MODEL, 2, exchange->frame, sizeof exchange->frame);
    return finish_part(self, size, exchange);
}

/* In the wire's unit. */
static uint16_t steps_of(const grobo_driver *self, int64_t time_us)
{
    int64_t steps = (time_us + self->time_step_us / 2) / self->time_step_us;
    int64_t most = self->time_max_us / self->time_step_us;
    return (uint16_t)(steps > most ? most : steps);
}

static void fill_goal(const grobo_driver *self, const grobo_target *target, int joint,
                      grobo_rs30x_goal *goal)
{
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    goal->id = moved->motor;
    goal->pos_ddeg =
        grobo_ddeg_from_rad(grobo_joint_to_servo(moved, target->posture.angle_rad[joint]));
}

int grobo_i_rs30x_posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                          grobo_exchange *exchange)
{
    (void)ctx;
    uint8_t list[GROBO_JOINTS_MAX];
    grobo_rs30x_goal goals[GROBO_JOINTS_MAX];
    int n = joints_of_part(self->model, target->posture.set, part, servos_per_frame(self, 4), list);
    if (n == 0) {
        return 0;
    }
    for (int i = 0; i < n; i++) {
        fill_goal(self, target, list[i], &goals[i]);
        bool same = i > 0 && target->joint_time_us[list[i]] == target->joint_time_us[list[i - 1]];
        goals[i].time_cs =
            same ? goals[i - 1].time_cs : steps_of(self, target->joint_time_us[list[i]]);
    }
    uint8_t *buf = exchange->frame;
    int size =
        n == 1 ? grobo_frame_goal(self->protocol, goals, buf, sizeof exchange->frame)
               : grobo_frame_goals(self->protocol, goals, (size_t)n, buf, sizeof exchange->frame);
    return finish_part(self, size, exchange);
}

int grobo_i_rs30x_torque(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                         grobo_torque mode, int part, grobo_exchange *exchange)
{
    (void)ctx;
    uint8_t list[GROBO_JOINTS_MAX];
    grobo_rs30x_byte torques[GROBO_JOINTS_MAX];
    int n = joints_of_part(self->model, joints, part, servos_per_frame(self, 1), list);
    if (n == 0) {
        return 0;
    }
    for (int i = 0; i < n; i++) {
        torques[i].id = grobo_i_joint(self->model, list[i])->motor;
        torques[i].value = (uint8_t)mode;
    }
    uint8_t *buf = exchange->frame;
    int size =
        n == 1
            ? grobo_frame_torque(self->protocol, torques[0].id, mode, buf, sizeof exchange->frame)
            : grobo_frame_torques(self->protocol, torques, (size_t)n, buf, sizeof exchange->frame);
    return finish_part(self, size, exchange);
}

/* Registers that each kind of sensing reads. */
static const struct {
    uint8_t address, length;
} blocks[] = {
    [GROBO_SENSE_FULL] = {GROBO_STATE_ADDRESS, GROBO_STATE_BYTES},
    [GROBO_SENSE_POSITION] = {GROBO_RS30X_POSITION, 2},
    [GROBO_SENSE_GOAL] = {GROBO_RS30X_GOAL, GROBO_RS30X_SPEED + 2 - GROBO_RS30X_GOAL},
    [GROBO_SENSE_ALL] = {GROBO_RS30X_GOAL, GROBO_RS30X_VOLTAGE + 2 - GROBO_RS30X_GOAL},
};

int grobo_i_rs30x_sense(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                        grobo_exchange *exchange)
{
    (void)ctx;
    uint8_t id = grobo_i_joint(self->model, joint)->motor;
    uint8_t address = blocks[kind].address;
    uint8_t length = blocks[kind].length;
    const grobo_relay *relay = self->protocol->relay;
    uint8_t *buf = exchange->frame;
    int size = grobo_rs30x_read(id, address, length, buf, sizeof exchange->frame);
    if (size > 0 && relay != NULL) {
        size = relay->wrap(buf, (size_t)size, buf, sizeof exchange->frame);
    }
    if (size < 0) {
        return size;
    }
    exchange->frame_bytes = (uint16_t)size;
    /* What reply_to() would find in the frame, in 300 instructions. */
    exchange->reply = (grobo_reply){.kind = GROBO_REPLY_RETURN,
                                    .count = 1,
                                    .id = id,
                                    .tag = address,
                                    .address = address,
                                    .length = length,
                                    .bytes = (uint32_t)length + GROBO_RS30X_OVERHEAD_BYTES};
    return GROBO_OK;
}

/* The bits of both lists, side by side. */
static const struct {
    uint8_t has;
    uint16_t field;
} fields[] = {
    {GROBO_RS30X_HAS_POSITION, GROBO_FIELD_ANGLE},
    {GROBO_RS30X_HAS_TIME, GROBO_FIELD_TIME},
    {GROBO_RS30X_HAS_SPEED, GROBO_FIELD_SPEED},
    {GROBO_RS30X_HAS_CURRENT, GROBO_FIELD_CURRENT},
    {GROBO_RS30X_HAS_TEMPERATURE, GROBO_FIELD_TEMPERATURE},
    {GROBO_RS30X_HAS_VOLTAGE, GROBO_FIELD_VOLTAGE},
    {GROBO_RS30X_HAS_TORQUE, GROBO_FIELD_TORQUE},
};

/* The sum is an exclusive or: two bytes broken alike, or a lost one made up for, go through it.
 * What no servo says is not believed all the same. */
static bool plausible(const grobo_rs30x_state *s)
{
    return s->pos_ddeg >= -1800 && s->pos_ddeg <= 1800 && s->temperature_c >= -40 &&
           s->temperature_c <= 150 && s->voltage_mv <= 20000 && s->current_ma <= 10000 &&
           s->torque <= GROBO_TORQUE_BRAKE;
}

int grobo_i_rs30x_parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                        grobo_joint_state *state)
{
    (void)ctx;
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    grobo_rs30x_state got;
    int found =
        grobo_rs30x_state_decode((uint8_t)reply->address, reply->data, reply->data_bytes, &got);
    if (found <= 0 || !plausible(&got)) {
        return GROBO_ERR_MISMATCH;
    }
    state->angle_rad = grobo_joint_from_servo(moved, grobo_rad_from_ddeg(got.pos_ddeg));
    state->time_us = (int64_t)got.time_cs * GROBO_PLAY_TIME_UNIT_US;
    state->speed_dps = got.speed_dps;
    state->current_ma = got.current_ma;
    state->temperature_c = got.temperature_c;
    state->voltage_mv = (int32_t)got.voltage_mv;
    state->torque = (grobo_torque)got.torque;
    state->flags = reply->flags;
    state->overheated = (reply->flags & GROBO_RS30X_STATUS_OVERHEATED) != 0;
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if ((got.has & fields[i].has) != 0) {
            state->valid = (uint16_t)(state->valid | fields[i].field);
        }
    }
    if (reply->address == GROBO_RS30X_GOAL && reply->data_bytes >= 4) {
        int goal_ddeg = grobo_i_get_i16(reply->data);
        state->goal_rad = grobo_joint_from_servo(moved, grobo_rad_from_ddeg(goal_ddeg));
        state->goal_time_us = (int64_t)grobo_i_get_u16(reply->data + 2) * GROBO_PLAY_TIME_UNIT_US;
        state->valid |= GROBO_FIELD_GOAL;
    }
    return GROBO_OK;
}

static bool touches(const grobo_register_io *io, int address, int bytes)
{
    return io->address < address + bytes && io->address + io->length > address;
}

grobo_write_kind grobo_i_rs30x_write_kind(const grobo_driver *self, const grobo_register_io *io)
{
    (void)self;
    if (touches(io, GROBO_RS30X_GOAL, 4) || touches(io, GROBO_RS30X_TORQUE, 1)) {
        return GROBO_WRITE_MOTOR;
    }
    return touches(io, GROBO_RS30X_ID, 2) || touches(io, GROBO_RS30X_CW_LIMIT, 4)
               ? GROBO_WRITE_SETTING
               : GROBO_WRITE_HARMLESS;
}

int grobo_i_rs30x_registers(const grobo_driver *self, void *ctx, const grobo_register_io *io,
                            grobo_exchange *exchange)
{
    (void)ctx;
    uint8_t *buf = exchange->frame;
    size_t cap = sizeof exchange->frame;
    if (io->address + io->length > GROBO_REGISTERS) {
        return GROBO_ERR_ARG;
    }
    const uint8_t address = (uint8_t)io->address;
    const uint8_t length = (uint8_t)io->length;
    if (io->data == NULL) {
        int size = grobo_frame_read(self->protocol, io->id, address, length, buf, cap);
        return finish(self, size, exchange);
    }
    grobo_rs30x_packet packet = {
        .kind = GROBO_RS30X_SHORT,
        .id = io->id,
        .flags = GROBO_RS30X_WANT_ACK,
        .address = address,
        .length = length,
        .count = 1,
        .data = io->data,
        .data_bytes = io->length,
    };
    int size = grobo_rs30x_build(&packet, buf, cap);
    if (size > 0) {
        size = grobo_frame_wrap(self->protocol, buf, (size_t)size, buf, cap);
    }
    return finish(self, size, exchange);
}

/* Protocol 3: a flash write takes a second or more, a reboot two. */
#define FLASH_US 1200000
#define REBOOT_US 2000000

int grobo_i_rs30x_command(const grobo_driver *self, void *ctx, int id, grobo_servo_command command,
                          grobo_exchange *exchange)
{
    (void)ctx;
    uint8_t *buf = exchange->frame;
    size_t cap = sizeof exchange->frame;
    int size = GROBO_ERR_ARG;
    switch (command) {
    case GROBO_SERVO_FLASH:
        size = grobo_rs30x_control((uint8_t)id, GROBO_RS30X_FLASH, buf, cap);
        exchange->settle_us = FLASH_US;
        break;
    case GROBO_SERVO_REBOOT:
        size = grobo_rs30x_control((uint8_t)id, GROBO_RS30X_REBOOT, buf, cap);
        exchange->settle_us = REBOOT_US;
        break;
    case GROBO_SERVO_FACTORY_RESET:
        size = grobo_rs30x_factory_reset((uint8_t)id, GROBO_RS30X_RESET_WITH_DATA, buf, cap);
        exchange->settle_us = FLASH_US;
        break;
    }
    if (size > 0) {
        size = grobo_frame_wrap(self->protocol, buf, (size_t)size, buf, cap);
    }
    return finish(self, size, exchange);
}

int grobo_i_rs30x_stored(const grobo_driver *self, void *ctx, grobo_stored_kind kind, int number,
                         grobo_exchange *exchange)
{
    (void)ctx;
    uint8_t *buf = exchange->frame;
    size_t cap = sizeof exchange->frame;
    if (number < 0 || number > UINT8_MAX) {
        return GROBO_ERR_ARG;
    }
    int size =
        self->protocol->relay->stored(kind == GROBO_STORED_SCENARIO, (uint8_t)number, buf, cap);
    return finish(self, size, exchange);
}

/* ---- reading what a raw frame asks for ------------------------------------------------------ */

/* Flags by which a servo does something with itself. */
#define ACTS (GROBO_RS30X_FLASH | GROBO_RS30X_REBOOT | GROBO_RS30X_FACTORY)

/* One servo's share of a write: its data from `address` on. */
typedef struct share {
    uint8_t id, address, bytes;
    const uint8_t *data;
} share;

static const uint8_t *at_register(const share *s, int address, int bytes)
{
    bool inside = address >= s->address && address + bytes <= s->address + s->bytes;
    return inside ? s->data + (address - s->address) : NULL;
}

static bool overlaps(const share *s, int first, int last)
{
    return s->bytes > 0 && s->address <= last && s->address + s->bytes > first;
}

static int inspect_joint(const grobo_driver *self, const share *s, int joint, grobo_target *target,
                         grobo_joint_mask *torqued)
{
    grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    const uint8_t *goal = at_register(s, GROBO_RS30X_GOAL, 2);
    const uint8_t *time = at_register(s, GROBO_RS30X_GOAL_TIME, 2);
    const uint8_t *torque = at_register(s, GROBO_RS30X_TORQUE, 1);
    if (overlaps(s, GROBO_RS30X_GOAL, GROBO_RS30X_GOAL + 1) != (goal != NULL) ||
        overlaps(s, GROBO_RS30X_GOAL_TIME, GROBO_RS30X_GOAL_TIME + 1) != (time != NULL)) {
        return GROBO_ERR_UNSUPPORTED; /* half of a value */
    }
    if ((torque != NULL && *torque > GROBO_TORQUE_BRAKE) ||
        (goal != NULL && (target->posture.set & bit) != 0)) {
        return GROBO_ERR_UNSUPPORTED; /* a torque that there is not, or two goals */
    }
    if (goal != NULL) {
        int ddeg = grobo_i_get_i16(goal);
        int64_t units = time == NULL ? 0 : grobo_i_get_u16(time);
        target->posture.angle_rad[joint] =
            grobo_joint_from_servo(grobo_i_joint(self->model, joint), grobo_rad_from_ddeg(ddeg));
        target->posture.set |= bit;
        target->joint_time_us[joint] = units * self->time_step_us;
    }
    if (torque != NULL) {
        torqued[*torque] |= bit;
    }
    return GROBO_OK;
}

static int inspect_share(const grobo_driver *self, const share *s, grobo_target *target,
                         grobo_joint_mask *torqued)
{
    bool motor = overlaps(s, GROBO_RS30X_GOAL, GROBO_RS30X_GOAL_TIME + 1) ||
                 overlaps(s, GROBO_RS30X_TORQUE, GROBO_RS30X_TORQUE);
    bool known = s->id == GROBO_RS30X_ID_ALL || grobo_model_joint_of_motor(self->model, s->id) >= 0;
    /* Id, direction, speed, limits: afterwards a goal means something else. */
    if (overlaps(s, GROBO_RS30X_ID, GROBO_RS30X_CCW_LIMIT + 1) || (motor && !known)) {
        return GROBO_ERR_UNSUPPORTED;
    }
    for (int j = 0; j < self->model->n_joints; j++) {
        if (s->id == GROBO_RS30X_ID_ALL || s->id == grobo_i_joint(self->model, j)->motor) {
            int result = inspect_joint(self, s, j, target, torqued);
            if (result < 0) {
                return result;
            }
        }
    }
    return GROBO_OK;
}

static int inspect_packet(const grobo_driver *self, const grobo_rs30x_packet *packet,
                          grobo_target *target, grobo_joint_mask *torqued)
{
    if ((packet->flags & ACTS) != 0) {
        return GROBO_ERR_UNSUPPORTED; /* grobo_robot_command() does it */
    }
    if (packet->kind == GROBO_RS30X_SHORT) {
        share s = {packet->id, packet->address, (uint8_t)packet->data_bytes, packet->data};
        return inspect_share(self, &s, target, torqued);
    }
    for (size_t i = 0; i < packet->count; i++) {
        const uint8_t *entry = packet->data + i * packet->length;
        share s = {entry[0], packet->address, (uint8_t)(packet->length - 1), entry + 1};
        int result = inspect_share(self, &s, target, torqued);
        if (result < 0) {
            return result;
        }
    }
    return GROBO_OK;
}

int grobo_i_rs30x_inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                          grobo_target *target, grobo_joint_mask *torqued)
{
    (void)ctx;
    const uint8_t *bytes = frame;
    size_t n = size;
    if (self->protocol->relay != NULL) {
        int inside = self->protocol->relay->unwrap(frame, size, &bytes);
        if (inside <= 0) {
            return inside;
        }
        n = (size_t)inside;
    }
    grobo_rs30x_parser parser;
    grobo_rs30x_packet packet;
    grobo_rs30x_parser_init(&parser, GROBO_ACCEPT_COMMANDS);
    if (grobo_rs30x_parser_feed(&parser, bytes, n) != n ||
        grobo_rs30x_parser_next(&parser, &packet) != 1 || parser.framer.stats.frame_bytes != n) {
        return GROBO_ERR_UNSUPPORTED;
    }
    return inspect_packet(self, &packet, target, torqued);
}

/* ---- the table ------------------------------------------------------------------------------- */

int grobo_rs30x_driver_init(grobo_driver *driver, const grobo_model *model,
                            const grobo_protocol *protocol)
{
    if (driver == NULL || model == NULL || protocol == NULL || grobo_model_check(model) < 0) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (grobo_i_joint(model, j)->torque_limit_pct > 0 || grobo_i_joint(model, j)->calibrated ||
            grobo_i_joint_is_wheel(model, j)) {
            return GROBO_ERR_ARG; /* a reading does not show it, and they have no mode for speeds */
        }
    }
    grobo_driver made =
        GROBO_TABLE(grobo_driver, .name = model->name, .model = model, .protocol = protocol,
                    .on_exit = GROBO_EXIT_HOLD,
                    .limits = {.temperature_c = 70,
                               .lost_replies = 5,
                               .approach_rad_s = grobo_rad_from_deg(GROBO_PLAY_APPROACH_DEG_S)},
                    GROBO_I_RS30X_FUNCTIONS);
    if (protocol->relay != NULL) {
        made.stored = grobo_i_rs30x_stored;
    }
    return grobo_driver_copy(driver, &made);
}
