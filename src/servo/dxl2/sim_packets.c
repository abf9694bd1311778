/* SPDX-License-Identifier: MIT */
/* Packets of Protocol 2.0 and what simulated servos answer; what they do to a servo is in sim.c. */
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/protocol.h>
#include <grobo/core/sim.h>

#include "src/base/assert.h"
#include "src/base/bytes.h"
#include "src/servo/dxl2/sim_packets.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/sim/servo/family.h"
#include "src/sim/servo/indirect.h"
#include "src/sim/servo/note.h"
#include "src/sim/servo/power.h"
#include "src/sim/servo/registers.h"
#include "src/sim/servo/servo.h"
#include "src/sim/servo/shaft.h"

/* Data that a status or a part of a fast one has room for. */
enum { MOST_BYTES = GROBO_SIM_TALK_BYTES - 16 };

/* ---- answers ------------------------------------------------------------------------------- */

static uint8_t with_alert(const grobo_sim_servo *servo, uint8_t error)
{
    return (uint8_t)(error | (servo->status != 0 ? GROBO_DXL2_ALERT : 0));
}

static void answer(grobo_sim *sim, int index, grobo_i_dxl_round *round, uint8_t error,
                   const uint8_t *data, size_t n)
{
    uint8_t bytes[GROBO_SIM_TALK_BYTES];
    grobo_dxl2_packet status = {.id = sim->servo[index].plant.id,
                                .instruction = GROBO_DXL2_STATUS,
                                .error = with_alert(&sim->servo[index], error),
                                .data = data,
                                .data_bytes = n};
    int size = grobo_dxl2_build(&status, bytes, sizeof bytes);
    if (size < 0) { /* too much of it is stuffed */
        status.error = with_alert(&sim->servo[index], GROBO_DXL2_BAD_LENGTH);
        status.data_bytes = 0;
        size = grobo_dxl2_build(&status, bytes, sizeof bytes);
    }
    GROBO_ASSERT(size > 0);
    grobo_i_dxl_answer(sim, index, round, bytes, (size_t)size);
}

static uint8_t judge_read(const grobo_sim_servo *servo, int address, int length)
{
    if (length == 0 || length > MOST_BYTES) {
        return GROBO_DXL2_BAD_LENGTH;
    }
    return grobo_i_indirect_readable(servo, address, length) ? GROBO_DXL2_DONE
                                                             : GROBO_DXL2_NO_ACCESS;
}

static void answer_read(grobo_sim *sim, int index, grobo_i_dxl_round *round, int address,
                        int length)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t bytes[GROBO_SIM_TALK_BYTES];
    uint8_t error = judge_read(servo, address, length);
    if (grobo_i_dxl_get(servo, GROBO_ROLE_REPLY_LEVEL) == 0) {
        return;
    }
    grobo_i_dxl2_sim_refresh(sim, index);
    if (error == GROBO_DXL2_DONE) {
        grobo_i_indirect_read(servo, address, length, bytes);
    }
    answer(sim, index, round, error, bytes, error == GROBO_DXL2_DONE ? (size_t)length : 0);
}

/* ---- packets for one ----------------------------------------------------------------------- */

static void ping(grobo_sim *sim, int index, grobo_i_dxl_round *round)
{
    const uint8_t *reg = sim->servo[index].reg;
    const grobo_servo_register *firmware =
        grobo_servo_register_of(sim->servo[index].model, GROBO_ROLE_FIRMWARE);
    const uint8_t data[] = {reg[0], reg[1], reg[firmware->address]};
    answer(sim, index, round, GROBO_DXL2_DONE, data, sizeof data);
}

static uint8_t keep(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    uint8_t error =
        grobo_i_dxl2_sim_judge(servo, packet->address, packet->data, packet->data_bytes);
    if (error == GROBO_DXL2_DONE && packet->data_bytes > sizeof servo->kept) {
        error = GROBO_DXL2_BAD_LENGTH;
    }
    if (error == GROBO_DXL2_DONE) {
        memcpy(servo->kept, packet->data, packet->data_bytes);
        servo->kept_bytes = (uint8_t)packet->data_bytes;
        servo->kept_address = packet->address;
    }
    return error;
}

static uint8_t do_kept(grobo_sim *sim, int index)
{
    grobo_sim_servo *servo = &sim->servo[index];
    size_t n = servo->kept_bytes;
    servo->kept_bytes = 0;
    return n == 0 ? GROBO_DXL2_BAD_INSTRUCTION
                  : grobo_i_dxl2_sim_write(sim, index, servo->kept_address, servo->kept, n);
}

static uint8_t forget_turns(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    static const uint8_t key[] = {0x01, 0x44, 0x58, 0x4C, 0x22};
    if (packet->data_bytes != sizeof key || memcmp(packet->data, key, sizeof key) != 0) {
        return GROBO_DXL2_BAD_RANGE;
    }
    if (grobo_i_sim_moving(&sim->servo[index], sim->now_us)) {
        return GROBO_DXL2_FAILED;
    }
    grobo_i_dxl_one_turn(sim, &sim->servo[index], grobo_i_dxl2_sim_reverses(&sim->servo[index]));
    return GROBO_DXL2_DONE;
}

static uint8_t judge_reset(const grobo_dxl2_packet *packet)
{
    uint8_t what = packet->data_bytes == 1 ? packet->data[0] : 0;
    bool all = what == GROBO_DXL2_RESET_ALL && packet->id != GROBO_DXL2_ID_ALL;
    bool known = all || what == GROBO_DXL2_RESET_BUT_ID || what == GROBO_DXL2_RESET_BUT_ID_BAUD;
    return known ? GROBO_DXL2_DONE : GROBO_DXL2_BAD_RANGE;
}

static void reset(grobo_sim *sim, int index, uint8_t what)
{
    grobo_sim_servo *servo = &sim->servo[index];
    int32_t id = servo->plant.id, rate = grobo_i_dxl_get(servo, GROBO_ROLE_BAUD);
    grobo_i_dxl_factory(servo);
    grobo_i_indirect_factory(servo);
    if (what != GROBO_DXL2_RESET_ALL) {
        grobo_i_dxl_put(servo, GROBO_ROLE_ID, id);
    }
    if (what == GROBO_DXL2_RESET_BUT_ID_BAUD) {
        grobo_i_dxl_put(servo, GROBO_ROLE_BAUD, rate);
    }
    memcpy(servo->flash, servo->reg, sizeof servo->flash);
    grobo_i_sim_reboot(sim, index);
}

static void back_up(grobo_sim *sim, int index, uint8_t what)
{
    if (what == GROBO_I_DXL2_STORE) {
        grobo_i_dxl2_sim_store_backup(&sim->servo[index]);
    } else {
        grobo_i_dxl2_sim_restore_backup(&sim->servo[index]);
        grobo_i_sim_reboot(sim, index);
    }
}

/* Whether an address is before the registers in RAM. */
static bool is_kept(const grobo_sim_servo *servo, int address)
{
    return address < grobo_servo_register_of(servo->model, GROBO_ROLE_TORQUE)->address;
}

static uint8_t carry_out(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    uint8_t code = packet->instruction;
    bool by_second = packet->id != sim->servo[index].plant.id && packet->id != GROBO_DXL2_ID_ALL;
    bool writes = code == GROBO_DXL2_WRITE || code == GROBO_DXL2_REG_WRITE;
    bool kept = code == GROBO_DXL2_FACTORY_RESET || code == GROBO_DXL2_BACKUP ||
                (writes && is_kept(&sim->servo[index], packet->address));
    if (by_second && kept) { /* not by the secondary id */
        grobo_i_sim_note(sim, GROBO_SIM_REFUSED, index, packet->address);
        return GROBO_DXL2_NO_ACCESS;
    }
    if (code == GROBO_DXL2_WRITE) {
        return grobo_i_dxl2_sim_write(sim, index, packet->address, packet->data,
                                      packet->data_bytes);
    }
    if (code == GROBO_DXL2_REG_WRITE) {
        return keep(sim, index, packet);
    }
    if (code == GROBO_DXL2_ACTION) {
        return do_kept(sim, index);
    }
    if (code == GROBO_DXL2_CLEAR) {
        return forget_turns(sim, index, packet);
    }
    if (code == GROBO_DXL2_FACTORY_RESET) { /* when the answer is made, as a restart */
        return judge_reset(packet);
    }
    if (code == GROBO_DXL2_BACKUP) { /* likewise */
        return grobo_i_dxl2_sim_judge_backup(&sim->servo[index], packet);
    }
    return code == GROBO_DXL2_REBOOT ? GROBO_DXL2_DONE : GROBO_DXL2_BAD_INSTRUCTION;
}

static void for_one(grobo_sim *sim, int index, const grobo_dxl2_packet *packet)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl_round round = {0};
    bool named = packet->id == servo->plant.id;
    if (packet->instruction == GROBO_DXL2_READ) {
        if (named) {
            answer_read(sim, index, &round, packet->address, packet->length);
        }
        return;
    }
    uint8_t id = servo->plant.id;
    uint8_t error = carry_out(sim, index, packet);
    if (named && grobo_i_dxl_get(servo, GROBO_ROLE_REPLY_LEVEL) == 2) {
        uint8_t now = servo->plant.id;
        servo->plant.id = id; /* a new one is for what comes next */
        answer(sim, index, &round, error, NULL, 0);
        servo->plant.id = now;
    }
    if (packet->instruction == GROBO_DXL2_REBOOT) {
        grobo_i_sim_reboot(sim, index);
    } else if (packet->instruction == GROBO_DXL2_FACTORY_RESET && error == GROBO_DXL2_DONE) {
        reset(sim, index, packet->data[0]);
    } else if (packet->instruction == GROBO_DXL2_BACKUP && error == GROBO_DXL2_DONE) {
        back_up(sim, index, packet->data[0]);
    }
}

/* ---- packets for several ------------------------------------------------------------------- */

/* What a packet asks of the k-th of its list. */
typedef struct item {
    uint8_t id;
    uint16_t address, length;
    const uint8_t *data;
} item;

static bool is_bulk(const grobo_dxl2_packet *packet)
{
    return packet->instruction == GROBO_DXL2_BULK_READ ||
           packet->instruction == GROBO_DXL2_FAST_BULK_READ ||
           packet->instruction == GROBO_DXL2_BULK_WRITE;
}

static bool is_write(const grobo_dxl2_packet *packet)
{
    return packet->instruction == GROBO_DXL2_SYNC_WRITE ||
           packet->instruction == GROBO_DXL2_BULK_WRITE;
}

/* The item that begins at *at; false where no whole one does. */
static bool next_item(const grobo_dxl2_packet *packet, size_t *at, item *found)
{
    grobo_i_span span = {packet->data, packet->data_bytes};
    const uint8_t *head = grobo_i_span_at(span, *at, is_bulk(packet) ? 5 : 1);
    if (head == NULL) {
        return false;
    }
    *found = (item){head[0], packet->address, packet->length, NULL};
    *at += 1;
    if (is_bulk(packet)) {
        found->address = grobo_i_get_u16(head + 1);
        found->length = grobo_i_get_u16(head + 3);
        *at += 4;
    }
    if (is_write(packet)) {
        found->data = grobo_i_span_at(span, *at, found->length);
        *at += found->length;
        return found->data != NULL;
    }
    return true;
}

static int hearer(grobo_sim *sim, uint8_t id, int before, const grobo_sim_event *raw)
{
    int index = grobo_i_dxl_hearer(sim, &grobo_i_sim_dxl2, id, before, raw);
    if (index >= 0) {
        sim->servo[index].heard_us = sim->now_us;
    }
    return index;
}

static void read_each(grobo_sim *sim, const grobo_dxl2_packet *packet, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    item one;
    for (size_t at = 0; next_item(packet, &at, &one);) {
        const grobo_i_dxl_round begin = round;
        int index = hearer(sim, one.id, -1, raw);
        if (index < 0) {
            grobo_i_dxl_silence(sim, &round, GROBO_DXL2_STATUS_BYTES + (size_t)one.length);
        }
        for (; index >= 0; index = hearer(sim, one.id, index, raw)) {
            grobo_i_dxl_round own = begin;
            answer_read(sim, index, &own, one.address, one.length);
            grobo_i_dxl_beside(&round, &own);
        }
    }
}

/* What one servo adds to a fast status, without its CRC. */
static void fast_part(grobo_sim *sim, int index, const item *one, uint8_t *bytes)
{
    grobo_sim_servo *servo = &sim->servo[index];
    grobo_i_dxl2_sim_refresh(sim, index);
    bytes[0] = with_alert(servo, GROBO_DXL2_DONE);
    bytes[1] = one->id;
    grobo_i_indirect_read(servo, one->address, one->length, bytes + 2);
}

/* Firmware that has no such instruction is silent (issue pollen-robotics/rustypot#122). */
static bool answers_fast(const grobo_sim_servo *servo, const item *one)
{
    uint8_t from = servo->model->fast_firmware;
    return from > 0 && grobo_i_dxl_get(servo, GROBO_ROLE_FIRMWARE) >= from &&
           judge_read(servo, one->address, one->length) == GROBO_DXL2_DONE;
}

/* One status that all of the list make together; whoever is silent ends it. */
static void read_fast(grobo_sim *sim, const grobo_dxl2_packet *packet, const grobo_sim_event *raw)
{
    uint8_t bytes[GROBO_SIM_TALK_BYTES] = {
        0xFF, 0xFF, 0xFD, 0x00, GROBO_DXL2_ID_ALL, 0, 0, GROBO_DXL2_STATUS};
    size_t length = 1, n = 8;
    uint16_t crc = 0;
    int64_t at_ns = -1;
    item one;
    for (size_t at = 0; next_item(packet, &at, &one);) {
        length += 4u + one.length;
    }
    grobo_i_put_u16(bytes + 5, (uint16_t)length);
    for (size_t at = 0; next_item(packet, &at, &one); n = 0) {
        int index = hearer(sim, one.id, -1, raw);
        if (index < 0 || !answers_fast(&sim->servo[index], &one)) {
            return;
        }
        if (at_ns < 0) {
            at_ns = (int64_t)grobo_i_dxl_get(&sim->servo[index], GROBO_ROLE_RETURN_DELAY) * 2000;
        }
        const size_t end = n + 2u + one.length;
        const uint16_t before = crc;
        for (; index >= 0; index = hearer(sim, one.id, index, raw)) {
            fast_part(sim, index, &one, bytes + n);
            crc = grobo_dxl2_crc(before, bytes, end);
            grobo_i_put_u16(bytes + end, crc);
            crc = grobo_dxl2_crc(crc, bytes + end, 2);
            grobo_i_sim_speak(sim, index, bytes, end + 2, at_ns);
        }
        at_ns += (int64_t)(end + 2) * sim->bus_byte_ns;
    }
}

static void write_each(grobo_sim *sim, const grobo_dxl2_packet *packet, const grobo_sim_event *raw)
{
    item one;
    for (size_t at = 0; next_item(packet, &at, &one);) {
        for (int i = -1; (i = hearer(sim, one.id, i, raw)) >= 0;) {
            (void)grobo_i_dxl2_sim_write(sim, i, one.address, one.data, one.length);
        }
    }
}

/* Everyone answers, in the order of ids. */
static void ping_all(grobo_sim *sim, const grobo_sim_event *raw)
{
    grobo_i_dxl_round round = {0};
    for (int id = 0; id <= GROBO_DXL2_ID_MAX; id++) {
        const grobo_i_dxl_round begin = round;
        for (int i = -1; (i = hearer(sim, (uint8_t)id, i, raw)) >= 0;) {
            grobo_i_dxl_round own = begin;
            ping(sim, i, &own);
            grobo_i_dxl_beside(&round, &own);
        }
    }
}

/* ---- packets ------------------------------------------------------------------------------- */

static bool is_for(const grobo_sim_servo *servo, uint8_t id)
{
    const grobo_servo_register *reg = grobo_servo_register_named(servo->model, "secondary_id");
    int second = reg != NULL ? servo->reg[reg->address] : UINT8_MAX; /* above the highest: none */
    return servo->plant.id == id || id == GROBO_DXL2_ID_ALL ||
           (second == id && second <= GROBO_DXL2_ID_MAX);
}

static void spread(grobo_sim *sim, const grobo_dxl2_packet *packet, int result,
                   const grobo_sim_event *raw)
{
    for (int i = 0; i < sim->n_servos; i++) {
        grobo_sim_servo *servo = &sim->servo[i];
        grobo_i_dxl_round round = {0};
        if (servo->family != &grobo_i_sim_dxl2 || !is_for(servo, packet->id) ||
            !grobo_i_sim_hears(sim, i, raw)) {
            continue;
        }
        servo->heard_us = sim->now_us;
        bool named = packet->id == servo->plant.id; /* to its second id it says nothing */
        if (result >= 0 && packet->instruction != GROBO_DXL2_PING) {
            for_one(sim, i, packet);
        } else if (named && result >= 0) {
            ping(sim, i, &round);
        } else if (named) {
            answer(sim, i, &round, GROBO_DXL2_BAD_LENGTH, NULL, 0);
        }
    }
}

static void packet(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw)
{
    (void)self;
    uint8_t data[GROBO_DXL2_FRAME_MAX_BYTES];
    grobo_dxl2_packet parts = {.id = raw->bytes[4], .instruction = raw->bytes[7]};
    int result = grobo_dxl2_parse(raw->bytes, raw->n_bytes, data, sizeof data, &parts);
    uint8_t code = parts.instruction;
    if (code == GROBO_DXL2_SYNC_READ || code == GROBO_DXL2_BULK_READ) {
        read_each(sim, &parts, raw);
    } else if (code == GROBO_DXL2_FAST_SYNC_READ || code == GROBO_DXL2_FAST_BULK_READ) {
        read_fast(sim, &parts, raw);
    } else if (is_write(&parts)) {
        write_each(sim, &parts, raw);
    } else if (parts.id == GROBO_DXL2_ID_ALL && code == GROBO_DXL2_PING) {
        ping_all(sim, raw);
    } else {
        spread(sim, &parts, result, raw);
    }
}

static int measure(const uint8_t *bytes, size_t n, bool good)
{
    int size = grobo_dxl2_measure(bytes, n, GROBO_ACCEPT_COMMANDS);
    return size == GROBO_ERR_CHECKSUM && !good ? 7 + grobo_i_get_u16(bytes + 5) : size;
}

/* ---- the family ---------------------------------------------------------------------------- */

const grobo_sim_family grobo_i_sim_dxl2 = {.tables = {&grobo_i_dxl2_table},
                                           .measure = measure,
                                           .packet = packet,
                                           .factory = grobo_i_dxl2_sim_factory,
                                           .boot = grobo_i_dxl2_sim_restart,
                                           .cut = grobo_i_dxl2_sim_cut,
                                           .goal_mdeg = grobo_i_dxl2_sim_goal_mdeg,
                                           .refresh = grobo_i_dxl2_sim_refresh,
                                           .bps = grobo_i_dxl2_sim_bps,
                                           .next_us = grobo_i_dxl2_sim_next_us,
                                           .act = grobo_i_dxl2_sim_act,
                                           .store = grobo_i_dxl2_sim_store};

const grobo_sim_family *grobo_sim_dxl2(void)
{
    return &grobo_i_sim_dxl2;
}
