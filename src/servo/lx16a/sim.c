/* SPDX-License-Identifier: MIT */
/* LewanSoul's and Hiwonder's LX and HTS servos: what their packets do to the values they keep. */
#include <math.h>
#include <string.h>

#include <grobo/core/lx16a.h>
#include <grobo/core/sim.h>

#include "src/base/bytes.h"
#include "src/servo/families.h"
#include "src/servo/lx16a/items.h"
#include "src/servo/tables.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

enum { BPS = 115200, WHEEL_FULL = 1000 };
/* Before a reply. The maker prints none; an assumption. */
#define THINK_NS 300000

static const grobo_i_item *item(uint8_t command)
{
    return grobo_i_item_of(grobo_i_lx16a_items, command);
}

/* ---- positions ------------------------------------------------------------------------------- */

/* The offset moves the position that is read against the shaft. */
static int32_t position_at(const grobo_sim_servo *servo, int32_t angle_mdeg)
{
    enum { TURN_TICKS = 1500 };
    int32_t ticks =
        grobo_i_dxl_ticks(servo, false, angle_mdeg) - grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
    return servo->plant.wheel ? grobo_i_dxl_wrap(ticks, TURN_TICKS) : ticks;
}

static int32_t goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo)
{
    (void)sim;
    int32_t ticks =
        grobo_i_dxl_get(servo, GROBO_ROLE_GOAL) + grobo_i_dxl_get(servo, GROBO_ROLE_OFFSET);
    return (int32_t)lround((ticks - servo->model->middle) * grobo_i_dxl_tick_mdeg(servo));
}

static void goal_is_here(const grobo_sim *sim, grobo_sim_servo *servo)
{
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL,
                    position_at(servo, grobo_i_sim_angle_mdeg(servo, sim->now_us)));
}

/* ---- the shaft's side ------------------------------------------------------------------------ */

static void follow(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_sim_wants *plant = &servo->plant;
    grobo_i_dxl_follow(sim, index);
    plant->time_us = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME) * 1000;
    plant->wheel = grobo_i_dxl_get(servo, GROBO_ROLE_MODE) != 0;
    plant->wheel_mdeg_s = (int32_t)((int64_t)plant->speed_mdeg_s *
                                    grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_SPEED) / WHEEL_FULL);
}

/* The values changed: torque and motion are what they say now. */
static void go(grobo_sim *sim, int index, bool moves)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_torque before = (grobo_torque)servo->plant.torque;
    follow(sim, index);
    if (servo->plant.torque != before) {
        grobo_i_sim_torque(sim, index, before);
    }
    if (moves && servo->plant.torque == GROBO_TORQUE_ON) {
        grobo_i_sim_set_out(sim, index);
    }
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
    grobo_i_dxl_refresh(sim, index, 1, 0);
    grobo_i_dxl_put(servo, GROBO_ROLE_VOLTAGE, grobo_i_dxl_own_mv(sim, servo, sim->supply_mv));
    grobo_i_dxl_put(servo, GROBO_ROLE_POSITION,
                    position_at(servo, grobo_i_sim_angle_mdeg(servo, sim->now_us)));
}

/* Outside of its voltages a servo lets go. */
static int64_t next_us(const grobo_sim *sim, int index)
{
    const grobo_sim_servo *servo = &sim->servo[index];
    bool lets_go =
        servo->powered && servo->plant.torque == GROBO_TORQUE_ON && !grobo_i_dxl_fed(sim, servo, 1);
    return lets_go ? sim->now_us : GROBO_NEVER_US;
}

static void act(grobo_sim *sim, int index)
{
    cut(sim, index, false);
    grobo_i_sim_torque(sim, index, GROBO_TORQUE_ON);
}

/* ---- restart --------------------------------------------------------------------------------- */

static int32_t bps(const grobo_sim *sim, int index)
{
    (void)sim;
    (void)index;
    return BPS;
}

static void restart(grobo_sim *sim, int index)
{
    grobo_i_dxl_boot(sim, index);
    goal_is_here(sim, &sim->servo[index]);
    follow(sim, index);
}

static bool factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps)
{
    if (baud_bps != BPS || id > GROBO_LX16A_ID_MAX) {
        return false;
    }
    grobo_i_dxl_sold(sim, index, id, 0); /* its rate is in no register */
    return true;
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool in_item(const grobo_servo_register *reg, const grobo_i_item *what)
{
    return reg->address >= what->address && reg->address < what->address + what->bytes;
}

/* Values outside of their range become its end; a range that ends before it begins is none. */
static bool take(grobo_sim_servo *servo, const grobo_i_item *what, const uint8_t *data)
{
    const grobo_servo_register *reg;
    bool pair = what->write == GROBO_LX16A_LIMITS || what->write == GROBO_LX16A_VOLTAGES;
    if (pair && grobo_i_get_u16(data) >= grobo_i_get_u16(data + 2)) {
        return false;
    }
    for (size_t i = 0; (reg = grobo_servo_register_row(servo->model, i)) != NULL; i++) {
        if (in_item(reg, what)) {
            grobo_i_dxl_hold(
                servo, reg,
                grobo_servo_register_get(servo->model, reg, data + (reg->address - what->address)));
            if ((reg->flags & GROBO_REGISTER_KEPT) != 0 && what->write != GROBO_LX16A_OFFSET) {
                memcpy(&servo->flash[reg->address], &servo->reg[reg->address], reg->bytes);
            }
        }
    }
    return true;
}

/* A goal is drawn to the limits, and brings the torque by itself; torque without a goal goes to the
 * last one. None is printed: the worst that is possible. */
static void move(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t goal = grobo_i_dxl_within(servo, grobo_i_dxl_get(servo, GROBO_ROLE_GOAL));
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL, goal);
    grobo_i_dxl_put(servo, GROBO_ROLE_TORQUE, 1);
    go(sim, index, true);
    grobo_i_sim_tell(sim,
                     &(grobo_sim_event){.kind = GROBO_SIM_GOAL,
                                        .time_us = sim->now_us,
                                        .servo = index,
                                        .value = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL),
                                        .value2 = grobo_i_dxl_get(servo, GROBO_ROLE_GOAL_TIME)});
}

static void stop(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    goal_is_here(sim, servo);
    grobo_i_dxl_put(servo, GROBO_ROLE_GOAL_TIME, 0);
    go(sim, index, true);
}

/* The values of the item are new. */
static void took_effect(grobo_sim *sim, int index, const grobo_i_item *what)
{
    grobo_sim_servo *servo = &sim->servo[index];
    if (what->write == GROBO_LX16A_MOVE) {
        move(sim, index);
        return;
    }
    servo->kept_bytes = what->write == GROBO_LX16A_WAIT ? what->bytes : servo->kept_bytes;
    go(sim, index, what->write == GROBO_LX16A_MODE && servo->plant.torque == GROBO_TORQUE_ON);
    grobo_i_sim_tell(sim, &(grobo_sim_event){.kind = GROBO_SIM_REGISTER,
                                             .time_us = sim->now_us,
                                             .servo = index,
                                             .value = what->address,
                                             .value2 = servo->reg[what->address]});
}

/* Commands that carry no value. False: there is no such one. */
static bool without_value(grobo_sim *sim, int index, uint8_t command)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_item *next = item(GROBO_LX16A_WAIT), *goal = item(GROBO_LX16A_MOVE);
    switch (command) {
    case GROBO_LX16A_START:
        if (servo->kept_bytes > 0) {
            servo->kept_bytes = 0;
            memcpy(&servo->reg[goal->address], &servo->reg[next->address], goal->bytes);
            move(sim, index);
        }
        return true;
    case GROBO_LX16A_STOP:
        if (servo->plant.torque == GROBO_TORQUE_ON) {
            stop(sim, index);
        }
        return true;
    case GROBO_LX16A_OFFSET_SAVE:
        servo->flash[item(GROBO_LX16A_OFFSET)->address] =
            servo->reg[item(GROBO_LX16A_OFFSET)->address];
        return true;
    default:
        return false;
    }
}

/* Frames of another length, as lx16a 0.0.2 sends them, are refused and noted: what a servo makes of
 * them is not known. A goal is ignored while it is a wheel. */
static void carry_out(grobo_sim *sim, int index, const grobo_lx16a_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_item *what = item(packet->command);
    bool wheel = servo->plant.wheel && packet->command == GROBO_LX16A_MOVE;
    if (packet->data_bytes == 0 && without_value(sim, index, packet->command)) {
        return;
    }
    if (what == NULL || what->write != packet->command || wheel ||
        packet->data_bytes != what->bytes || !take(servo, what, packet->data)) {
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, packet->command);
        return;
    }
    took_effect(sim, index, what);
}

/* ---- packets --------------------------------------------------------------------------------- */

static void answer(grobo_sim *sim, int index, const grobo_lx16a_packet *asked)
{
    uint8_t bytes[GROBO_LX16A_FRAME_MAX_BYTES];
    const grobo_sim_servo *servo = &sim->servo[index];
    const grobo_i_item *what = item(asked->command);
    refresh(sim, index);
    const grobo_lx16a_packet reply = {servo->plant.id, asked->command, &servo->reg[what->address],
                                      what->bytes};
    int size = grobo_lx16a_build(&reply, bytes, sizeof bytes);
    grobo_i_sim_speak(sim, index, bytes, (size_t)size, THINK_NS);
}

/* All hear what is for all; of what they read only the id is answered then, at once. */
static void packet(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_lx16a_packet found;
    (void)grobo_lx16a_parse(raw->bytes, raw->n_bytes, &found);
    bool all = found.id == GROBO_LX16A_ID_ALL;
    bool reads = found.data_bytes == 0 && grobo_lx16a_reply_bytes(found.command) > 0;
    int id = all ? GROBO_I_DXL_ALL : found.id;
    for (int i = -1; (i = grobo_i_dxl_hearer(sim, self, id, i, raw)) >= 0;) {
        if (!reads) {
            carry_out(sim, i, &found);
        } else if (!all || found.command == GROBO_LX16A_ID_READ) {
            answer(sim, i, &found);
        }
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    int size = grobo_lx16a_measure(bytes, n, GROBO_ACCEPT_COMMANDS);
    return size == GROBO_ERR_CHECKSUM && !good ? bytes[3] + 3 : size;
}

/* ---- inspection ------------------------------------------------------------------------------ */

static int store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n)
{
    grobo_sim_servo *servo = &sim->servo[index];
    const grobo_servo_register *reg = grobo_servo_register_at(servo->model, (uint16_t)address);
    const grobo_i_item *what = grobo_i_lx16a_items;
    while (!in_item(reg, what)) {
        what++;
    }
    uint8_t data[4];
    memcpy(data, &servo->reg[what->address], what->bytes);
    memcpy(data + (address - what->address), bytes, n);
    if (!take(servo, what, data)) {
        return GROBO_ERR_LIMIT;
    }
    took_effect(sim, index, what);
    return GROBO_OK;
}

const grobo_sim_family grobo_i_sim_lx16a = {.usual_bps = BPS,
                                            .tables = {&grobo_i_lx16a_table},
                                            .measure = measure,
                                            .packet = packet,
                                            .factory = factory,
                                            .boot = restart,
                                            .cut = cut,
                                            .goal_mdeg = goal_mdeg,
                                            .refresh = refresh,
                                            .bps = bps,
                                            .next_us = next_us,
                                            .act = act,
                                            .store = store};

const grobo_sim_family *grobo_sim_lx16a(void)
{
    return &grobo_i_sim_lx16a;
}
