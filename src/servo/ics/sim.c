/* SPDX-License-Identifier: MIT */
/* Kondo's KRS servos: what the commands of ICS 3.5 and 3.6 do to the values they keep. */
#include <math.h>
#include <string.h>

#include <grobo/core/ics.h>
#include <grobo/core/sim.h>

#include "src/servo/families.h"
#include "src/servo/ics/items.h"
#include "src/servo/tables.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

enum { EEPROM = GROBO_I_ICS_EEPROM_BYTES, SPEED_FULL = 127, CURRENT_FULL = 63, MA_OF_COUNT = 100 };
/* Before a reply. The maker prints none; an assumption. */
#define THINK_NS 300000
/* A servo hears nothing while it writes its EEPROM. Clients wait 500 ms and more. */
#define BUSY_US 400000
/* A servo that is hot has less power until it is cooler: it does not let go. */
#define NEVER_CUTS_C 1000
/* A position on the wire has 14 bits. */
enum { WIRE_MAX = 16383 };

static int32_t rate_of(int32_t code)
{
    return code == 10 ? 115200 : code == 1 ? 625000 : code == 0 ? 1250000 : GROBO_ERR_ARG;
}

/* ---- positions ------------------------------------------------------------------------------- */

static unsigned flags_of(const grobo_sim_servo *servo)
{
    return servo->reg[GROBO_I_ICS_AT_FLAGS];
}

static int32_t reversed(const grobo_sim_servo *servo, int32_t position)
{
    bool reverse = (flags_of(servo) & GROBO_I_ICS_REVERSE) != 0;
    return reverse ? 2 * servo->model->middle - position : position;
}

static int32_t position_at(const grobo_sim_servo *servo, int32_t angle_mdeg)
{
    return reversed(servo, grobo_i_dxl_ticks(servo, false, angle_mdeg)) -
           grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
}

/* It knows where it stands, also where no register tells it (ICS 3.5). */
static void put_position(grobo_sim_servo *servo, int32_t position)
{
    int32_t held = position < 0 ? 0 : position > WIRE_MAX ? WIRE_MAX : position;
    servo->reg[GROBO_I_ICS_AT_POSITION] = (uint8_t)(held >> 8);
    servo->reg[GROBO_I_ICS_AT_POSITION + 1] = (uint8_t)held;
}

static uint16_t position_of(const grobo_sim_servo *servo)
{
    const uint8_t *at = &servo->reg[GROBO_I_ICS_AT_POSITION];
    return (uint16_t)(at[0] << 8 | at[1]);
}

static int32_t goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    (void)sim;
    int32_t position =
        grobo_i_dxl_get(servo, GROBO_ROLE_GOAL) + grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
    return (int32_t)lround((reversed(servo, position) - servo->model->middle) *
                           grobo_i_dxl_tick_mdeg(servo));
}

/* ---- the shaft's side ------------------------------------------------------------------------ */

static void follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_sim_wants *plant = &servo->plant;
    grobo_i_dxl_follow(sim, index);
    plant->cap_mdeg_s = (int32_t)((int64_t)plant->speed_mdeg_s *
                                  grobo_i_dxl_get(servo, GROBO_ROLE_SPEED) / SPEED_FULL);
    plant->most_ma =
        plant->stall_ma * grobo_i_dxl_get(servo, GROBO_ROLE_TORQUE_LIMIT) / CURRENT_FULL;
    plant->limit_c = NEVER_CUTS_C;
}

/* The torque is what the value says now. */
static void go(grobo_sim *sim, int index)
{
    grobo_torque before = (grobo_torque)sim->servo[index].plant.torque;
    follow(sim, index);
    grobo_i_sim_torque(sim, index, before);
}

static void cut(grobo_sim *sim, int index, bool hot)
{
    (void)hot;
    grobo_i_dxl_put(&sim->servo[index], GROBO_ROLE_TORQUE, 0);
    follow(sim, index);
}

static void refresh(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_sim_settle(sim, index);
    bool limp = servo->plant.torque != GROBO_TORQUE_ON;
    unsigned flags = flags_of(servo) & ~(unsigned)GROBO_I_ICS_FREE;
    servo->reg[GROBO_I_ICS_AT_FLAGS] = (uint8_t)(flags | (limp ? GROBO_I_ICS_FREE : 0));
    grobo_i_dxl_put(servo, GROBO_ROLE_TEMPERATURE, grobo_i_ics_raw_heat(servo->temperature_c));
    grobo_i_dxl_put(servo, GROBO_ROLE_CURRENT,
                    lround(grobo_i_dxl_current_ma(sim, index) / MA_OF_COUNT));
    put_position(servo, position_at(servo, grobo_i_sim_angle_mdeg(servo, sim->now_us)));
}

/* ---- restart --------------------------------------------------------------------------------- */

static int32_t bps(const grobo_sim *sim, int index)
{
    return rate_of(grobo_i_dxl_get(&sim->servo[index], GROBO_ROLE_BAUD));
}

static void put(grobo_sim_servo *servo, const char *name, int32_t value)
{
    grobo_i_dxl_hold(servo, grobo_i_dxl_row(servo, name), value);
}

/* What is set now begins as the EEPROM has it. */
static void restart(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_boot(sim, index);
    memcpy(servo->reg, servo->flash, EEPROM); /* reserved bytes too */
    put(servo, "stretch_now", servo->reg[1] / 2);
    put(servo, "speed_now", servo->reg[2]);
    put(servo, "temperature_limit_now", servo->reg[14]);
    put(servo, "current_limit_now", servo->reg[15]);
    follow(sim, index);
}

static bool factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    static const uint8_t codes[] = {10, 1, 0};
    for (size_t i = 0; i < sizeof codes; i++) {
        if ((uint32_t)rate_of(codes[i]) == baud_bps && id <= GROBO_ICS_ID_MAX) {
            grobo_i_dxl_sold(sim, index, id, codes[i]);
            return true;
        }
    }
    return false;
}

/* ---- commands -------------------------------------------------------------------------------- */

static void answer(grobo_sim *sim, int index, grobo_ics_packet reply)
{
    uint8_t bytes[GROBO_ICS_FRAME_MAX_BYTES];
    const grobo_sim_servo *servo = &sim->servo[index];
    reply.reply = true;
    int size = grobo_ics_build(&reply, bytes, sizeof bytes);
    if (size <= 0 || (flags_of(servo) & GROBO_I_ICS_SLAVE) != 0) {
        return; /* a slave takes commands and is silent */
    }
    if (reply.command == GROBO_ICS_POSITION && reply.id == 0 && bps(sim, index) == 115200) {
        bytes[0] = GROBO_ICS_POSITION; /* as ICS 2.0 did */
    }
    grobo_i_sim_speak(sim, index, bytes, (size_t)size, THINK_NS);
}

/* The answer is where it was before. 0 lets go; what is outside of the limits is drawn to them. */
static void position(grobo_sim *sim, int index, const grobo_ics_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    refresh(sim, index);
    grobo_ics_packet reply = *packet;
    reply.value = position_of(servo);
    answer(sim, index, reply);
    bool on = packet->value != GROBO_ICS_FREE;
    if (on) {
        grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, grobo_i_dxl_within(servo, packet->value));
    }
    bool was_on = servo->plant.torque == GROBO_TORQUE_ON;
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, on);
    go(sim, index);
    if (on && was_on) {
        grobo_i_sim_set_out(sim, index);
    }
    if (on) {
        grobo_i_dxl_tell(sim, index, grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL),
                         grobo_i_dxl_get(servo, GROBO_ROLE_GOAL));
    }
}

static const grobo_i_item *item_of(const grobo_ics_packet *packet)
{
    return grobo_i_item_of(grobo_i_ics_items, GROBO_I_ICS_CODE(packet->command, packet->item));
}

static void read_eeprom(grobo_sim *sim, int index, const grobo_ics_packet *packet)
{
    uint8_t nibbles[GROBO_ICS_EEPROM_BYTES];
    const grobo_sim_servo *servo = &sim->servo[index];
    grobo_ics_packet reply = *packet;
    for (size_t i = 0; i < EEPROM; i++) {
        nibbles[2 * i] = servo->reg[i] >> 4;
        nibbles[2 * i + 1] = servo->reg[i] & 0x0F;
    }
    reply.data = nibbles;
    answer(sim, index, reply);
}

static void read(grobo_sim *sim, int index, const grobo_ics_packet *packet)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_item *item = item_of(packet);
    bool lacks = packet->item == GROBO_ICS_POSITION_ITEM && !grobo_ics_tells_position(servo->model);
    if (item == NULL || lacks) {
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, packet->item);
        return;
    }
    refresh(sim, index);
    if (packet->item == GROBO_ICS_EEPROM) {
        read_eeprom(sim, index, packet);
        return;
    }
    grobo_ics_packet reply = *packet;
    const uint8_t *at = &servo->reg[item->address];
    reply.value = (uint16_t)(item->bytes == 2 ? at[0] << 8 | at[1] : at[0]);
    answer(sim, index, reply);
}

static void write_eeprom(grobo_sim *sim, int index, const uint8_t *nibbles)
{
    grobo_sim_servo *servo = &sim->servo[index];
    for (size_t i = 0; i < EEPROM; i++) {
        servo->reg[i] = (uint8_t)(nibbles[2 * i] << 4 | (nibbles[2 * i + 1] & 0x0F));
    }
    memcpy(servo->flash, servo->reg, EEPROM);
    servo->deaf_until_us = sim->now_us + BUSY_US;
    go(sim, index);
}

static void write(grobo_sim *sim, int index, const grobo_ics_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_item *item = item_of(packet);
    if (packet->item == GROBO_ICS_EEPROM) {
        if (packet->data[0] << 4 != (GROBO_I_ICS_FIXED & 0xF0)) {
            grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, packet->item);
            return;
        }
        answer(sim, index, *packet); /* with the old id */
        write_eeprom(sim, index, packet->data);
        return;
    }
    const grobo_servo_register *reg = grobo_servo_register_at(servo->model, item->address);
    grobo_i_dxl_hold(servo, reg, packet->value);
    answer(sim, index, *packet);
    go(sim, index);
    grobo_i_dxl_tell(sim, index, reg, packet->value);
}

/* All servos take it: it is for a line with one. */
static void identity(grobo_sim *sim, int index, const grobo_ics_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_ics_packet reply = *packet;
    if (packet->item != 0) {
        grobo_i_dxl_put(servo, GROBO_ROLE_ID, packet->id);
        servo->flash[GROBO_I_ICS_AT_ID] = servo->reg[GROBO_I_ICS_AT_ID];
        follow(sim, index);
    }
    reply.id = servo->plant.id;
    answer(sim, index, reply);
    servo->deaf_until_us = sim->now_us + BUSY_US;
}

static void carry_out(grobo_sim *sim, int index, const grobo_ics_packet *packet)
{
    switch ((grobo_ics_command)packet->command) {
    case GROBO_ICS_POSITION:
        position(sim, index, packet);
        break;
    case GROBO_ICS_READ:
        read(sim, index, packet);
        break;
    case GROBO_ICS_WRITE:
        write(sim, index, packet);
        break;
    case GROBO_ICS_ID:
        identity(sim, index, packet);
        break;
    }
}

static void packet(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_ics_packet found;
    (void)grobo_ics_parse(NULL, 0, raw->bytes, raw->n_bytes, &found);
    int id = found.command == GROBO_ICS_ID ? GROBO_I_DXL_ALL : found.id;
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, self, id, i, raw)) >= 0;) {
        carry_out(sim, i, &found);
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    (void)good;
    return grobo_ics_measure(bytes, n);
}

/* ---- inspection ------------------------------------------------------------------------------ */

static int store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    memcpy(&servo->reg[address], bytes, n);
    if (address < EEPROM) {
        memcpy(&servo->flash[address], bytes, n);
    }
    go(sim, index);
    return GROBO_OK;
}

const grobo_sim_family grobo_i_sim_ics = {.usual_bps = 115200,
                                          .parity = true,
                                          .tables = {&grobo_i_ics_table},
                                          .measure = measure,
                                          .packet = packet,
                                          .factory = factory,
                                          .boot = restart,
                                          .cut = cut,
                                          .goal_mdeg = goal_mdeg,
                                          .refresh = refresh,
                                          .bps = bps,
                                          .store = store};

const grobo_sim_family *grobo_sim_ics(void)
{
    return &grobo_i_sim_ics;
}
