/* SPDX-License-Identifier: MIT */
/* Robots of AX and MX servos with Protocol 1.0. */
#include <string.h>

#include "src/servo/dxl1/driver.h"
#include "src/servo/tables.h"
#include "src/servo/unit.h"

/* MX count turns with both limits there; both 0 make a wheel (emanual mx_angle_limit). */
#define TURNS_LIMITS 4095
/* Of the register drive_mode (emanual mx_drive_mode); its other bit has a second servo follow. */
#define DRIVE_REVERSE 1

static grobo_dxl1_packet to_old(const grobo_dxl2_packet *packet)
{
    return (grobo_dxl1_packet){.id = packet->id,
                               .instruction = packet->instruction,
                               .address = (uint8_t)packet->address,
                               .length = (uint8_t)packet->length,
                               .data = packet->data,
                               .data_bytes = packet->data_bytes};
}

int grobo_i_dxl1_build_as(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap)
{
    const grobo_dxl1_packet old = to_old(packet);
    bool fits = packet->address <= UINT8_MAX && packet->length <= UINT8_MAX;
    return fits ? grobo_dxl1_build(&old, buf, cap) : GROBO_ERR_ARG;
}

int grobo_i_dxl1_parse_as(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                          grobo_dxl2_packet *packet)
{
    grobo_dxl1_packet old;
    int result = grobo_dxl1_parse(frame, n, false, &old);
    (void)data;
    (void)cap;
    if (result >= 0) {
        *packet = (grobo_dxl2_packet){.id = old.id,
                                      .instruction = old.instruction,
                                      .address = old.address,
                                      .length = old.length,
                                      .data = old.data,
                                      .data_bytes = old.data_bytes};
    }
    return result;
}

/* Only MX-106 may be told to turn the other way round, and it and MX-64 to keep a torque. */
static int32_t wants(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found)
{
    (void)joint;
    (void)servo;
    return role == GROBO_ROLE_MODE ? 0 : found & ~DRIVE_REVERSE;
}

/* Both limits 0 make a wheel. The speed of AX is then an output, that of MX a speed; its sense is
 * in bit 10 (emanual ax-12a and mx-64, moving_speed). */
static bool wheel(const grobo_servo_model *servo, grobo_i_wheel *to)
{
    enum { SPEED_MOST = 1023, SPEED_BACK = 1024, TURN_DEG = 360 };
    double unit = grobo_i_register_unit(grobo_servo_register_of(servo, GROBO_ROLE_SPEED));
    *to = (grobo_i_wheel){
        .role = GROBO_ROLE_SPEED,
        .dps = servo->span_deg == TURN_DEG ? unit : (double)servo->speed_dps / SPEED_MOST,
        .most = SPEED_MOST,
        .sign = SPEED_BACK,
        .by_limits = true};
    return true;
}

static bool sync_read(const grobo_servo_model *servo)
{
    (void)servo;
    return false;
}

/* An error of the register shutdown sets the torque limit to 0, until it is written again
 * (emanual torque_limit): torque_limit 0 is no torque. */
static const grobo_i_family family = {
    .tables = {&grobo_i_dxl1_table},
    .build = grobo_i_dxl1_build_as,
    .parse = grobo_i_dxl1_parse_as,
    .wants = wants,
    .wheel = wheel,
    .turns_limits = TURNS_LIMITS,
    .frame_max_bytes = GROBO_DXL1_FRAME_MAX_BYTES,
    .time_max_ms = 65535,
    .overheated = GROBO_DXL1_OVERHEATED,
    .resets = true,
    .sync_read = sync_read,
    .pace = GROBO_I_PACE_SPEED,
};

int grobo_dxl1_driver_init(grobo_driver *driver, const grobo_model *model)
{
    int result = grobo_i_table_driver(driver, model, &grobo_i_dxl1_protocol, &family);
    if (result >= 0) {
        driver->goal_energises = true; /* common in forums; the maker does not say */
    }
    return result;
}
