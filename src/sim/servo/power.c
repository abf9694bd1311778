/* SPDX-License-Identifier: MIT */
/* What befalls a servo: flash write, reboot, loss of power; and how its time goes by. */
#include <string.h>

#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/shaft.h"

/* Assumptions; docs/simulator.md lists them. */
#define BOOT_US 500000
#define SAVE_US 1000000

void grobo_i_sim_boot(grobo_sim *sim, int index, int64_t deaf_us)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->family->boot(sim, index);
    servo->powered = true;
    servo->begun_us = sim->now_us;
    servo->deaf_until_us = sim->now_us + deaf_us;
    grobo_i_sim_note(sim, GROBO_SIM_REBOOT, index, 0);
}

static void limp(grobo_sim *sim, int index)
{
    grobo_torque before = (grobo_torque)sim->servo[index].plant.torque;
    sim->servo[index].family->cut(sim, index, false);
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

void grobo_i_sim_exchange_flash(grobo_sim *sim, int index, const uint8_t *flash)
{
    grobo_sim_servo *servo = &sim->servo[index];
    limp(sim, index);
    memcpy(servo->flash, flash, GROBO_SIM_FLASH_BYTES);
    servo->saved_us = GROBO_NEVER_US;
    if (servo->powered) {
        grobo_i_sim_boot(sim, index, 0);
    }
}

static void saved(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    servo->family->saved(sim, index, true);
    servo->saved_us = GROBO_NEVER_US;
    grobo_i_sim_note(sim, GROBO_SIM_SAVED, index, 0);
    if (servo->reboots_after_save) {
        grobo_i_sim_reboot(sim, index);
    }
}

/* The first thing that a servo does by itself, and when. */
typedef enum self_act { SAVED, HAND_ENDS, OWN } self_act;

static self_act next_act(const grobo_sim *sim, int index, int64_t *at_us)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    int64_t hand_us = servo->by_hand ? servo->start_us + servo->move_us : GROBO_NEVER_US;
    int64_t own_us =
        servo->family->next_us != NULL ? servo->family->next_us(sim, index) : GROBO_NEVER_US;
    own_us = own_us < servo->settled_us ? servo->settled_us : own_us;
    *at_us = servo->saved_us <= hand_us ? servo->saved_us : hand_us;
    self_act act = servo->saved_us <= hand_us ? SAVED : HAND_ENDS;
    if (own_us < *at_us) {
        *at_us = own_us;
        act = OWN;
    }
    return act;
}

void grobo_i_sim_settle(grobo_sim *sim, int index)
{
    const int64_t now_us = sim->now_us;
    for (;;) {
        int64_t t_us = now_us;
        self_act act = next_act(sim, index, &t_us);
        if (t_us > now_us) {
            break;
        }
        grobo_i_sim_warm(sim, index, t_us);
        sim->now_us = t_us;
        if (act == SAVED) {
            saved(sim, index);
        } else if (act == HAND_ENDS) {
            grobo_i_sim_halt(sim, index);
            grobo_i_sim_go_on(sim, index);
        } else {
            sim->servo[index].family->act(sim, index);
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
        servo->family->saved(sim, index, false);
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
