/* SPDX-License-Identifier: MIT */
/* What a servo remembers: factory, flash, reboot, loss of power; and how its time goes by. */
#include <string.h>

#include "src/sim/note.h"
#include "src/sim/power.h"
#include "src/sim/registers.h"
#include "src/sim/shaft.h"

/* Not in the manuals at hand: the limit of register TEMPERATURE_LIMIT, the firmware's number. */
#define LIMIT_C 80
#define FIRMWARE 1
/* Assumptions; docs/simulator.md lists them. */
#define BOOT_US 500000
#define SAVE_US 1000000

static void put(uint8_t *registers, uint8_t address, int32_t value)
{
    (void)grobo_rs30x_register_put(grobo_rs30x_register_at(address), value, &registers[address]);
}

/* No.4-29 as they leave the factory (RS301CR/RS302CD manual, memory map). */
static void factory_block(grobo_sim_servo *servo)
{
    const grobo_sim_type *type = grobo_i_sim_type_of(servo);
    memset(&servo->reg[GROBO_RS30X_ID], 0, GROBO_SIM_FLASH_BYTES);
    put(servo->reg, GROBO_RS30X_ID, 1);
    put(servo->reg, GROBO_RS30X_BAUD, GROBO_RS30X_BAUD_CODE_DEFAULT);
    put(servo->reg, GROBO_RS30X_CW_LIMIT, 1500);
    put(servo->reg, GROBO_RS30X_CCW_LIMIT, -1500);
    put(servo->reg, GROBO_RS30X_TEMPERATURE_LIMIT, LIMIT_C);
    put(servo->reg, GROBO_RS30X_CW_MARGIN, 2);
    put(servo->reg, GROBO_RS30X_CCW_MARGIN, 2);
    put(servo->reg, GROBO_RS30X_CW_SLOPE, type->slope);
    put(servo->reg, GROBO_RS30X_CCW_SLOPE, type->slope);
    put(servo->reg, GROBO_RS30X_PUNCH, type->punch);
}

static void to_flash(grobo_sim_servo *servo)
{
    memcpy(servo->flash, &servo->reg[GROBO_RS30X_ID], sizeof servo->flash);
}

void grobo_i_sim_factory(grobo_sim_servo *servo, uint16_t model, uint8_t id, uint32_t baud_bps)
{
    put(servo->reg, GROBO_RS30X_MODEL, model == 0 ? GROBO_RS30X_RS301CR : model);
    put(servo->reg, GROBO_RS30X_FIRMWARE, FIRMWARE);
    factory_block(servo);
    put(servo->reg, GROBO_RS30X_ID, id);
    put(servo->reg, GROBO_RS30X_BAUD, grobo_rs30x_baud_code(baud_bps));
    to_flash(servo);
}

void grobo_i_sim_boot(grobo_sim *sim, int index, int64_t deaf_us)
{
    grobo_sim_servo *servo = &sim->servo[index];
    memcpy(&servo->reg[GROBO_RS30X_ID], servo->flash, sizeof servo->flash);
    servo->baud_bps = grobo_rs30x_baud_bps(servo->reg[GROBO_RS30X_BAUD]);
    memset(&servo->reg[GROBO_RS30X_GOAL], 0, GROBO_REGISTERS - GROBO_RS30X_GOAL);
    put(servo->reg, GROBO_RS30X_MAX_TORQUE, grobo_i_sim_type_of(servo)->max_torque_pct);
    servo->status &= GROBO_RS30X_STATUS_FLASH_ERROR;
    servo->powered = true;
    servo->begun_us = sim->now_us;
    servo->deaf_until_us = sim->now_us + deaf_us;
    grobo_i_sim_note(sim, GROBO_SIM_REBOOT, index, 0);
}

static void limp(grobo_sim *sim, int index)
{
    uint8_t *torque = &sim->servo[index].reg[GROBO_RS30X_TORQUE];
    grobo_torque before = (grobo_torque)*torque;
    *torque = GROBO_TORQUE_OFF;
    grobo_i_sim_torque(sim, index, before);
}

void grobo_i_sim_reboot(grobo_sim *sim, int index)
{
    limp(sim, index);
    grobo_i_sim_boot(sim, index, BOOT_US);
}

void grobo_i_sim_save(grobo_sim *sim, int index, bool reboot_after)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->saved_us = servo->deaf_until_us = sim->now_us + SAVE_US;
    servo->reboots_after_save = reboot_after;
}

void grobo_i_sim_reset(grobo_sim *sim, int index)
{
    factory_block(&sim->servo[index]);
    grobo_i_sim_save(sim, index, false);
}

bool grobo_i_sim_flash_fits(const uint8_t *flash)
{
    uint8_t registers[GROBO_REGISTERS] = {0};
    memcpy(&registers[GROBO_RS30X_ID], flash, GROBO_SIM_FLASH_BYTES);
    for (int a = GROBO_RS30X_ID; a < GROBO_RS30X_ID + GROBO_SIM_FLASH_BYTES; a++) {
        const grobo_rs30x_register *reg = grobo_rs30x_register_at((uint8_t)a);
        int32_t value =
            reg == NULL ? registers[a] : grobo_rs30x_register_get(reg, &registers[reg->address]);
        if (value < (reg == NULL ? 0 : reg->min) || value > (reg == NULL ? 0 : reg->max)) {
            return false;
        }
    }
    return true;
}

void grobo_i_sim_exchange_flash(grobo_sim *sim, int index, const uint8_t *flash)
{
    grobo_sim_servo *servo = &sim->servo[index];
    limp(sim, index);
    memcpy(servo->flash, flash, sizeof servo->flash);
    servo->saved_us = GROBO_NEVER_US;
    if (servo->powered) {
        grobo_i_sim_boot(sim, index, 0);
    }
}

static void saved(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    to_flash(servo);
    servo->status &= (uint8_t)~GROBO_RS30X_STATUS_FLASH_ERROR;
    servo->saved_us = GROBO_NEVER_US;
    grobo_i_sim_note(sim, GROBO_SIM_SAVED, index, 0);
    if (servo->reboots_after_save) {
        grobo_i_sim_reboot(sim, index);
    }
}

void grobo_i_sim_settle(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const int64_t now_us = sim->now_us;
    for (;;) {
        int64_t hand_us = servo->by_hand ? servo->start_us + servo->move_us : GROBO_NEVER_US;
        bool is_saved = servo->saved_us <= hand_us;
        int64_t t_us = is_saved ? servo->saved_us : hand_us;
        if (t_us > now_us) {
            break;
        }
        grobo_i_sim_warm(sim, index, t_us);
        sim->now_us = t_us;
        if (is_saved) {
            saved(sim, index);
        } else {
            grobo_i_sim_halt(sim, index);
            grobo_i_sim_go_on(sim, index);
        }
    }
    grobo_i_sim_warm(sim, index, now_us);
    sim->now_us = now_us;
}

/* ---- supply -------------------------------------------------------------------------------- */

static void power(grobo_sim *sim, int index, bool on)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (on == servo->powered) {
        return;
    }
    grobo_i_sim_settle(sim, index);
    if (on) {
        grobo_i_sim_boot(sim, index, BOOT_US);
        return;
    }
    if (servo->saved_us != GROBO_NEVER_US) {
        servo->status |= GROBO_RS30X_STATUS_FLASH_ERROR;
        servo->saved_us = GROBO_NEVER_US;
    }
    limp(sim, index);
    servo->powered = false;
}

void grobo_i_sim_feed(grobo_sim *sim, int index)
{
    power(sim, index,
          sim->supply_mv >= GROBO_SIM_BROWN_OUT_MV &&
              sim->servo[index].cable != GROBO_SIM_CABLE_OUT);
}

void grobo_i_sim_brown_out(grobo_sim *sim)
{
    for (int i = 0; i < sim->n_servos; i++) {
        bool powered = sim->servo[i].powered;
        power(sim, i, false);
        power(sim, i, powered);
    }
}
