/* SPDX-License-Identifier: MIT */
/* A servo at its line, whatever its family: whether it hears, and how it speaks. */
#include "src/sim/servo/family.h"
#include "src/sim/servo/fault.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"
#include "src/sim/servo/talk.h"
#include "src/sim/servo/world.h"

/* Resistance of battery and wires: the supply sags by it. An assumption. */
#define SUPPLY_MOHM 100

bool grobo_i_sim_deaf(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    return !servo->powered || servo->cable != GROBO_SIM_CABLE_IN ||
           sim->now_us < servo->deaf_until_us;
}

int32_t grobo_i_sim_bps(const grobo_sim *sim, int index)
{
    return sim->servo[index].family->bps(sim, index);
}

/* A servo that does something else for a while misses what it is told. */
static void note_missed(grobo_sim *sim, int index, const grobo_sim_event *raw)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    if (sim->now_us < servo->deaf_until_us && servo->powered &&
        servo->cable == GROBO_SIM_CABLE_IN) {
        grobo_sim_event missed = *raw;
        missed.kind = GROBO_SIM_MISSED;
        missed.servo = index;
        missed.value =
            servo->saved_us != GROBO_NEVER_US ? GROBO_SIM_BUSY_FLASH : GROBO_SIM_BUSY_REBOOT;
        grobo_i_sim_tell(sim, &missed);
    }
}

bool grobo_i_sim_hears(grobo_sim *sim, int index, const grobo_sim_event *raw)
{
    grobo_i_sim_settle(sim, index);
    grobo_i_world_touch(&sim->servo[index]);
    note_missed(sim, index, raw);
    int32_t bps = grobo_i_sim_bps(sim, index);
    return !grobo_i_sim_deaf(sim, index) && bps > 0 && (uint32_t)bps == sim->bus_bps &&
           !grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_SILENT, index);
}

int32_t grobo_i_sim_supply_mv(const grobo_sim *sim)
{
    int64_t total_ma = 0;
    if (sim->config.physics != NULL) {
        return (int32_t)sim->config.physics->bus_mv;
    }
    for (int i = 0; i < sim->n_servos; i++) {
        total_ma += grobo_i_sim_current_ma(&sim->servo[i], sim->now_us);
    }
    int64_t mv = (int64_t)sim->supply_mv - total_ma * SUPPLY_MOHM / 1000;
    return mv > 0 ? (int32_t)mv : 0;
}

/* The servos' own replies go straight to the bus; on its way to the host a reply may suffer. */
void grobo_i_sim_speak(grobo_sim *sim, int index, uint8_t *bytes, size_t n, int64_t after_ns)
{
    int64_t start_ns = sim->now_ns + after_ns;
    if (grobo_i_sim_strikes(sim, GROBO_SIM_FAULT_DUPLICATE_ID, index)) {
        for (size_t i = n > 1 ? 2 : 0; i < n; i++) {
            bytes[i] &= (uint8_t)grobo_i_sim_random(sim, GROBO_SIM_FAULT_DUPLICATE_ID, 256);
        }
    }
    if (sim->config.wiring == GROBO_WIRING_BOARD) {
        grobo_i_sim_talk(sim, bytes, n, start_ns);
        return;
    }
    const grobo_sim_event reply = {.kind = GROBO_SIM_REPLY,
                                   .time_us = grobo_i_sim_us(start_ns),
                                   .servo = index,
                                   .bytes = bytes,
                                   .n_bytes = n};
    grobo_i_sim_reply(sim, &reply, start_ns, grobo_i_sim_talk);
}
