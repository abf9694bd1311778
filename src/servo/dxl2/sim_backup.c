/* SPDX-License-Identifier: MIT */
/*
 * Control table backup of simulated DYNAMIXEL (emanual, protocol2, Control Table Backup): a copy of
 * the EEPROM and of some registers in RAM. An instruction brings the EEPROM back; a restart brings
 * the registers in RAM back where the register startup says so (emanual, startup_configuration).
 */
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/registers.h>

#include "src/servo/dxl2/sim_packets.h"
#include "src/sim/servo/indirect.h"
#include "src/sim/servo/registers.h"

/* Bits of the register startup. */
enum { STARTUP_TORQUE = 1, STARTUP_RAM = 2 };

/* The same firmware has it as has fast sync read (both pages of the emanual). */
static bool has_backup(const grobo_sim_servo *servo)
{
    uint8_t from = servo->model->fast_firmware;
    return from > 0 && grobo_i_dxl_get(servo, GROBO_ROLE_FIRMWARE) >= from &&
           grobo_i_dxl_end(servo) <= GROBO_SIM_BACKUP_BYTES;
}

uint8_t grobo_i_dxl2_sim_judge_backup(const grobo_sim_servo *servo, const grobo_dxl2_packet *packet)
{
    static const uint8_t key[] = {0x43, 0x54, 0x52, 0x4C};
    if (!has_backup(servo)) {
        return GROBO_DXL2_BAD_INSTRUCTION;
    }
    if (packet->data_bytes != 1 + sizeof key || packet->data[0] < GROBO_I_DXL2_STORE ||
        packet->data[0] > GROBO_I_DXL2_RESTORE || memcmp(packet->data + 1, key, sizeof key) != 0) {
        return GROBO_DXL2_BAD_RANGE;
    }
    bool nothing = packet->data[0] == GROBO_I_DXL2_RESTORE && !servo->backed_up;
    return nothing || grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE) != 0 ? GROBO_DXL2_FAILED
                                                                     : GROBO_DXL2_DONE;
}

static void say_ready(grobo_sim_servo *servo)
{
    const grobo_servo_register *ready = grobo_servo_register_named(servo->model, "backup_ready");
    if (ready != NULL) {
        grobo_i_dxl_hold(servo, ready, servo->backed_up);
    }
}

void grobo_i_dxl2_sim_store_backup(grobo_sim_servo *servo)
{
    memcpy(servo->backup, servo->reg, sizeof servo->backup);
    memcpy(servo->backup_indirect, servo->indirect, sizeof servo->backup_indirect);
    servo->backed_up = true;
    say_ready(servo);
}

static void bring_back(grobo_sim_servo *servo, const grobo_servo_register *reg)
{
    memcpy(&servo->reg[reg->address], &servo->backup[reg->address], reg->bytes);
}

void grobo_i_dxl2_sim_restore_backup(grobo_sim_servo *servo)
{
    const grobo_servo_register *reg;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if ((reg->flags & GROBO_REGISTER_KEPT) != 0) {
            bring_back(servo, reg);
        }
    }
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
    if (grobo_i_indirect_kept(servo)) {
        memcpy(servo->indirect, servo->backup_indirect, sizeof servo->indirect);
    }
}

void grobo_i_dxl2_sim_start_up(grobo_sim_servo *servo)
{
    static const char *const in_ram[] = {
        "velocity_i",    "velocity_p",    "position_d",           "position_i",      "position_p",
        "feedforward_2", "feedforward_1", "profile_acceleration", "profile_velocity"};
    const grobo_servo_register *startup = grobo_servo_register_named(servo->model, "startup");
    int bits = startup != NULL ? servo->reg[startup->address] : 0;
    say_ready(servo);
    if ((bits & STARTUP_RAM) != 0 && servo->backed_up) {
        for (size_t i = 0; i < sizeof in_ram / sizeof *in_ram; i++) {
            const grobo_servo_register *reg = grobo_servo_register_named(servo->model, in_ram[i]);
            if (reg != NULL) {
                bring_back(servo, reg);
            }
        }
        memcpy(servo->indirect, servo->backup_indirect, sizeof servo->indirect);
    }
    if ((bits & STARTUP_TORQUE) != 0) {
        grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 1);
    }
}
