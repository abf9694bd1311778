/* SPDX-License-Identifier: MIT */
/* Robots of DYNAMIXEL servos with Protocol 2.0: X, MX, P, PRO and XL-320. */
#include "src/servo/dxl2/series.h"
#include "src/servo/table/family.h"
#include "src/servo/tables.h"
#include "src/servo/unit.h"

/* Bits of the drive mode that say what a goal means: its sense, that it comes with a time, and that
 * it switches torque on, which would wake limp joints. */
#define DRIVE_BITS (GROBO_DXL2_DRIVE_REVERSE | GROBO_DXL2_DRIVE_TIME | GROBO_DXL2_DRIVE_WAKES)

/* Longer than the time between two readings of a joint that moves: GROBO_WATCH_US / 2 at most. */
#define WATCHDOG_US 500000

/* Goals are within one turn in mode 3 and 5 and count turns in mode 4; 5 bounds the current, as a
 * gripper needs it. Without the bit of time a duration would be taken for a velocity
 * (emanual drive_mode, opmode_six_2). P have no mode 5: their current is bounded in each. */
static int32_t wants(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found)
{
    bool grips = joint->torque_limit_pct > 0 && grobo_i_dxl2_series_of(servo) == GROBO_I_DXL2_X &&
                 grobo_servo_register_of(servo, GROBO_ROLE_GOAL_CURRENT) != NULL;
    if (role == GROBO_ROLE_DIRECTION) {
        return (found & ~(int32_t)DRIVE_BITS) | (int32_t)GROBO_DXL2_DRIVE_TIME;
    }
    return grips || found == GROBO_DXL2_MODE_GRIP ? GROBO_DXL2_MODE_GRIP
           : joint->turns                         ? GROBO_DXL2_MODE_EXTENDED
                                                  : GROBO_DXL2_MODE_POSITION;
}

/* Velocity control: a speed of its own, of PRO where that of a goal is (emanual, goal_velocity). */
static bool wheel(const grobo_servo_model *servo, grobo_i_wheel *to)
{
    bool pro = grobo_i_dxl2_series_of(servo) == GROBO_I_DXL2_PRO;
    grobo_register_role role = pro ? GROBO_ROLE_SPEED : GROBO_ROLE_GOAL_SPEED;
    const grobo_servo_register *reg = grobo_servo_register_of(servo, role);
    if (reg == NULL) {
        return false;
    }
    *to = (grobo_i_wheel){.role = role,
                          .dps = grobo_i_register_unit(reg),
                          .most = reg->max,
                          .mode = GROBO_DXL2_MODE_VELOCITY,
                          .any = (int32_t)GROBO_DXL2_DRIVE_TIME};
    return true;
}

static bool sync_read(const grobo_servo_model *servo)
{
    (void)servo;
    return true;
}

/* Each has its error, its id, its data and a CRC; of the last one the CRC is the packet's. */
static bool fast_part(const grobo_packet *reply, int n, int k, grobo_packet *part)
{
    enum { HEAD_BYTES = 2, CRC_BYTES = 2 };
    size_t bytes = reply->data_bytes + CRC_BYTES, each = bytes / (size_t)n;
    if (each * (size_t)n != bytes || each <= HEAD_BYTES + CRC_BYTES) {
        return false;
    }
    const uint8_t *at = reply->data + (size_t)k * each;
    *part = *reply;
    part->flags = at[0];
    part->refused = (at[0] & ~(unsigned)GROBO_DXL2_ALERT) != GROBO_DXL2_DONE;
    part->id = at[1];
    part->data = at + HEAD_BYTES;
    part->data_bytes = each - HEAD_BYTES - CRC_BYTES;
    return true;
}

/* Wheel or joint (emanual xl320). */
static int32_t xl320_wants(const grobo_joint *joint, const grobo_servo_model *servo,
                           grobo_register_role role, int32_t found)
{
    (void)joint;
    (void)servo;
    return role == GROBO_ROLE_MODE ? GROBO_DXL2_MODE_XL320_JOINT : found;
}

/* An output, its sense in bit 10 (emanual xl320, goal_velocity). */
static bool xl320_wheel(const grobo_servo_model *servo, grobo_i_wheel *to)
{
    enum { OUTPUT_MOST = 1023, OUTPUT_BACK = 1024 };
    *to = (grobo_i_wheel){.role = GROBO_ROLE_SPEED,
                          .dps = (double)servo->speed_dps / OUTPUT_MOST,
                          .most = OUTPUT_MOST,
                          .sign = OUTPUT_BACK,
                          .mode = GROBO_DXL2_MODE_XL320_WHEEL};
    return true;
}

static const grobo_i_family xl320, pro, family;

static const grobo_i_family *of(const grobo_servo_model *servo)
{
    grobo_i_dxl2_series series = grobo_i_dxl2_series_of(servo);
    return series == GROBO_I_DXL2_XL320 ? &xl320 : series == GROBO_I_DXL2_PRO ? &pro : &family;
}

/*
 * A profile of this duration, without ramps, is a straight way in time. A set bit of the register
 * shutdown that occurs cuts the torque until a reboot (emanual shutdown).
 */
static const grobo_i_family family = {
    .of = of,
    .numbers_errors = true,
    .tables = {&grobo_i_dxl2_table},
    .build = grobo_dxl2_build,
    .parse = grobo_dxl2_parse,
    .wants = wants,
    .wheel = wheel,
    .limits_mode = GROBO_DXL2_MODE_POSITION,
    .watchdog_us = 20000,
    .frame_max_bytes = GROBO_DXL2_FRAME_MAX_BYTES,
    .time_max_ms = 32737,
    .overheated = GROBO_DXL2_OVERHEATED,
    .cuts = 0xFF,
    .reset = {GROBO_DXL2_RESET_ALL},
    .reset_bytes = 1,
    .resets = true,
    .reboots = true,
    .sync_read = sync_read,
    .fast_part = fast_part,
    .pace = GROBO_I_PACE_PROFILE,
};

/* What of it the table asks of each servo: a goal has a speed, errors have bits of their own. */
static const grobo_i_family xl320 = {
    .numbers_errors = true,
    .wants = xl320_wants,
    .wheel = xl320_wheel,
    .limits_mode = GROBO_DXL2_MODE_XL320_JOINT,
    .overheated = GROBO_DXL2_XL320_OVERHEATED,
    .cuts = 0xFF,
    .fast_part = fast_part,
    .pace = GROBO_I_PACE_SPEED,
};

/* As P, but that a goal has a speed (emanual pro, goal_velocity). */
static const grobo_i_family pro = {
    .numbers_errors = true,
    .wants = wants,
    .wheel = wheel,
    .limits_mode = GROBO_DXL2_MODE_POSITION,
    .overheated = GROBO_DXL2_OVERHEATED,
    .cuts = 0xFF,
    .fast_part = fast_part,
    .pace = GROBO_I_PACE_SPEED,
};

int grobo_dxl2_driver_init(grobo_driver *driver, const grobo_model *model)
{
    int result = grobo_i_table_driver(driver, model, &grobo_i_dxl2_protocol, &family);
    if (result >= 0 && driver->watchdog != NULL) {
        driver->watchdog_us = WATCHDOG_US;
    }
    return result;
}
