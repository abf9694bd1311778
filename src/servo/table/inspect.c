/* SPDX-License-Identifier: MIT */
/* What writing registers would do, and what a raw frame of a user asks for. */
#include <math.h>
#include <string.h>

#include "src/model/joint.h"
#include "src/servo/table/family.h"
#include "src/servo/unit.h"

/* ---- kinds of writes ------------------------------------------------------------------------- */

static grobo_write_kind kind_of_register(const grobo_servo_register *reg)
{
    /* A register that no table knows may be another one's place, as an indirect one is. */
    if (reg == NULL) {
        return GROBO_WRITE_MOTOR;
    }
    switch ((grobo_register_role)reg->role) {
    case GROBO_ROLE_TORQUE:
    case GROBO_ROLE_GOAL:
    case GROBO_ROLE_GOAL_TIME:
    case GROBO_ROLE_SPEED:
    case GROBO_ROLE_ACCELERATION:
    case GROBO_ROLE_GOAL_SPEED:
    case GROBO_ROLE_GOAL_CURRENT:
    case GROBO_ROLE_GOAL_PWM:
        return GROBO_WRITE_MOTOR;
    case GROBO_ROLE_MODE: /* of some series it does not survive power-off */
    case GROBO_ROLE_REPLY_LEVEL:
    case GROBO_ROLE_WATCHDOG:
    case GROBO_ROLE_TORQUE_LIMIT: /* a gripper would pinch harder */
        return GROBO_WRITE_SETTING;
    case GROBO_ROLE_NONE:
    case GROBO_ROLE_MODEL:
    case GROBO_ROLE_FIRMWARE:
    case GROBO_ROLE_ID:
    case GROBO_ROLE_BAUD:
    case GROBO_ROLE_RETURN_DELAY:
    case GROBO_ROLE_LOCK:
    case GROBO_ROLE_DIRECTION:
    case GROBO_ROLE_OFFSET:
    case GROBO_ROLE_MIN_POSITION:
    case GROBO_ROLE_MAX_POSITION:
    case GROBO_ROLE_TEMPERATURE_LIMIT:
    case GROBO_ROLE_MIN_VOLTAGE:
    case GROBO_ROLE_MAX_VOLTAGE:
    case GROBO_ROLE_MAX_TORQUE:
    case GROBO_ROLE_CURRENT_LIMIT:
    case GROBO_ROLE_SPEED_LIMIT:
    case GROBO_ROLE_SHUTDOWN:
    case GROBO_ROLE_ERROR:
    case GROBO_ROLE_REGISTERED:
    case GROBO_ROLE_MOVING:
    case GROBO_ROLE_POSITION:
    case GROBO_ROLE_PRESENT_SPEED:
    case GROBO_ROLE_LOAD:
    case GROBO_ROLE_CURRENT:
    case GROBO_ROLE_VOLTAGE:
    case GROBO_ROLE_TEMPERATURE:
        break;
    }
    return (reg->flags & GROBO_REGISTER_KEPT) != 0 ? GROBO_WRITE_SETTING : GROBO_WRITE_HARMLESS;
}

static grobo_write_kind kind_of_run(const grobo_servo_model *servo, int address, int bytes)
{
    grobo_write_kind worst = GROBO_WRITE_HARMLESS;
    for (int at = address; at < address + bytes; at++) {
        grobo_write_kind kind = kind_of_register(grobo_servo_register_at(servo, (uint16_t)at));
        worst = kind > worst ? kind : worst;
    }
    return worst;
}

/* Of a servo that is no joint's: as the first joint's. */
grobo_write_kind grobo_i_table_write_kind(const grobo_driver *self, const grobo_register_io *io)
{
    int joint = grobo_model_joint_of_motor(self->model, io->id);
    return kind_of_run(grobo_i_table_servo(self, joint < 0 ? 0 : joint), io->address, io->length);
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* One servo's share of a write. */
typedef struct share {
    uint16_t address;
    const uint8_t *data;
    size_t n;
} share;

static bool value_of(const grobo_servo_model *servo, const share *s, grobo_register_role role,
                     int32_t *value)
{
    return grobo_i_table_value(servo, role, s->address, s->data, s->n, value);
}

/* In which time the servo would go there; 0: as fast as it can. */
static int64_t time_of(const grobo_driver *self, int joint, const share *s, double from_rad,
                       double to_rad)
{
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    int32_t speed = 0, ms = 0;
    if (value_of(servo, s, GROBO_ROLE_GOAL_TIME, &ms)) {
        (void)value_of(servo, s, GROBO_ROLE_SPEED, &speed);
        return speed == 0 ? (int64_t)ms * 1000 : 0;
    }
    if (!value_of(servo, s, GROBO_ROLE_SPEED, &speed) || speed <= 0) {
        return 0;
    }
    if (grobo_i_table_family(self, servo)->pace == GROBO_I_PACE_PROFILE) {
        return (int64_t)speed * 1000;
    }
    double dps = speed * grobo_i_register_unit(grobo_servo_register_of(servo, GROBO_ROLE_SPEED));
    double way_rad = grobo_joint_to_servo(moved, to_rad) - grobo_joint_to_servo(moved, from_rad);
    return (int64_t)(grobo_deg_from_rad(fabs(way_rad)) / dps * 1e6);
}

/* Whether a frame may write all of this: no setting hides behind a goal, nor a register that no
 * table knows, nor the limit of a gripper's torque. */
static bool may_write(const grobo_driver *self, int index, const share *s)
{
    int32_t counts;
    const grobo_joint *joint = grobo_i_joint(self->model, index);
    const grobo_servo_model *servo = grobo_i_table_servo(self, index);
    bool wheel = grobo_i_joint_is_wheel(self->model, index); /* it goes to no place */
    const grobo_servo_register *limit =
        joint->torque_limit_pct > 0 ? grobo_i_table_limit(joint, servo, &counts) : NULL;
    for (int at = s->address; at < s->address + (int)s->n; at++) {
        const grobo_servo_register *reg = grobo_servo_register_at(servo, (uint16_t)at);
        if (reg == NULL || reg == limit || kind_of_register(reg) == GROBO_WRITE_SETTING ||
            (wheel && reg->role == GROBO_ROLE_GOAL)) {
            return false;
        }
    }
    return true;
}

/* Only what goes with a goal may be written with one; each value whole. */
static int inspect_joint(const grobo_driver *self, const share *s, int joint, grobo_target *target,
                         grobo_joint_mask *torqued)
{
    const grobo_i_family *family = self->family;
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    int32_t torque = 0, goal = 0;
    bool has_torque = value_of(servo, s, GROBO_ROLE_TORQUE, &torque);
    bool has_goal = value_of(servo, s, GROBO_ROLE_GOAL, &goal);
    grobo_write_kind kind = kind_of_run(servo, s->address, (int)s->n);
    if (!may_write(self, joint, s) || (kind == GROBO_WRITE_MOTOR && !has_torque && !has_goal)) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (has_torque) {
        bool known = torque == 1 || torque == family->off || torque == family->brake;
        if (!known || has_goal) {
            return GROBO_ERR_UNSUPPORTED;
        }
        torqued[torque == 1             ? GROBO_TORQUE_ON
                : torque == family->off ? GROBO_TORQUE_OFF
                                        : GROBO_TORQUE_BRAKE] |= bit;
    }
    if (has_goal) {
        double to_rad = grobo_i_table_angle(grobo_i_joint(self->model, joint), servo, goal);
        if ((target->posture.set & bit) != 0) {
            return GROBO_ERR_UNSUPPORTED; /* two goals */
        }
        target->posture.angle_rad[joint] = to_rad;
        target->posture.set |= bit;
        target->joint_time_us[joint] = time_of(self, joint, s, target->from_rad[joint], to_rad);
    }
    return GROBO_OK;
}

static int inspect_share(const grobo_driver *self, const share *s, uint8_t id, grobo_target *target,
                         grobo_joint_mask *torqued)
{
    bool found = false;
    for (int j = 0; j < self->model->n_joints; j++) {
        if (id == GROBO_DXL2_ID_ALL || id == grobo_i_joint(self->model, j)->motor) {
            int result = inspect_joint(self, s, j, target, torqued);
            if (result < 0) {
                return result;
            }
            found = true;
        }
    }
    grobo_write_kind kind = kind_of_run(grobo_i_table_servo(self, 0), s->address, (int)s->n);
    return found || kind == GROBO_WRITE_HARMLESS ? GROBO_OK : GROBO_ERR_UNSUPPORTED;
}

static int inspect_packet(const grobo_driver *self, const grobo_dxl2_packet *packet,
                          grobo_target *target, grobo_joint_mask *torqued)
{
    share s = {packet->address, packet->data, packet->data_bytes};
    static const uint8_t reads[] = {GROBO_DXL2_PING,      GROBO_DXL2_READ,
                                    GROBO_DXL2_SYNC_READ, GROBO_DXL2_FAST_SYNC_READ,
                                    GROBO_DXL2_BULK_READ, GROBO_DXL2_FAST_BULK_READ};
    if (memchr(reads, packet->instruction, sizeof reads) != NULL) {
        return GROBO_OK;
    }
    if (packet->instruction == GROBO_DXL2_WRITE) {
        return inspect_share(self, &s, packet->id, target, torqued);
    }
    if (packet->instruction != GROBO_DXL2_SYNC_WRITE) {
        return GROBO_ERR_UNSUPPORTED; /* done later, or it changes what a goal means */
    }
    const size_t each = (size_t)packet->length + 1;
    int result = packet->data_bytes % each == 0 ? GROBO_OK : GROBO_ERR_UNSUPPORTED;
    for (size_t at = 0; at < packet->data_bytes && result >= 0; at += each) {
        s.data = packet->data + at + 1;
        s.n = packet->length;
        result = inspect_share(self, &s, packet->data[at], target, torqued);
    }
    return result;
}

int grobo_i_table_inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                          grobo_target *target, grobo_joint_mask *torqued)
{
    (void)ctx;
    const grobo_i_family *family = self->family;
    uint8_t data[GROBO_FRAME_MAX_BYTES];
    grobo_dxl2_packet packet;
    if (size > sizeof data || family->parse(frame, size, data, sizeof data, &packet) < 0) {
        return GROBO_ERR_UNSUPPORTED;
    }
    return inspect_packet(self, &packet, target, torqued);
}
