/* SPDX-License-Identifier: MIT */
/*
 * Simulated servos of other families, and clients that send anything: any instruction to anybody,
 * any registers, lengths and lists that lie, packets cut off and broken. What servos say is packets
 * of their family, unless two talk at once; and what can only be read stays.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/lx16a.h>
#include <grobo/core/protocol.h>

#include "tests/support/chain_kit.h"
#include "tests/support/next_random.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { SERVOS = 3, ROUNDS = 1000, ROOM = 300, DATA_MOST = 24 };

/* Each servo of a list that is not there has the time of what it is asked for. */
enum { LONGEST_US = 100000000 };

static const grobo_servo_table *const tables[] = {&grobo_i_dxl2_table,  &grobo_i_dxl1_table,
                                                  &grobo_i_sts_table,   &grobo_i_scs_table,
                                                  &grobo_i_lx16a_table, &grobo_i_ics_table};

static chain_kit chain;
static uint32_t seed;

static uint32_t any(uint32_t n)
{
    return next_random(&seed) % n;
}

static uint8_t any_byte(void)
{
    static const uint8_t ends[] = {0, 1, 2, 4, 127, 128, 253, 254, 255};
    return (uint8_t)(any(2) == 0 ? ends[any(sizeof ends)] : any(256));
}

/* A register of the servo, mostly. */
static const grobo_servo_register *any_register(void)
{
    const grobo_servo_register *reg = NULL;
    while (reg == NULL) {
        reg = grobo_servo_register_row(chain.servos[0], any(80));
    }
    return reg;
}

static int any_instruction(uint8_t *frame)
{
    static const uint8_t codes[] = {1, 2, 3, 3, 4, 5, 6, 8, 10, 11, 16, 0x82, 0x83, 0x92, 0x93};
    const grobo_servo_register *reg = any_register();
    uint8_t data[DATA_MOST];
    size_t n = any(3) > 0 ? reg->bytes : any(DATA_MOST);
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = any(3) > 0 ? (uint8_t)(1 + any(SERVOS)) : any_byte();
    }
    const grobo_dxl2_packet packet = {
        .id = (uint8_t)(any(3) > 0 ? 1 + any(SERVOS) : GROBO_DXL2_ID_ALL),
        .instruction = any(8) > 0 ? codes[any(sizeof codes)] : any_byte(),
        .address = (uint16_t)(any(4) > 0 ? reg->address : next_random(&seed)),
        .length = (uint16_t)(any(2) > 0 ? reg->bytes : any_byte() << any(9)),
        .data = data,
        .data_bytes = n};
    const grobo_dxl1_packet other = {.id = packet.id,
                                     .instruction = packet.instruction,
                                     .address = (uint8_t)packet.address,
                                     .length = (uint8_t)packet.length,
                                     .data = data,
                                     .data_bytes = n};
    const grobo_lx16a_packet small = {packet.id, (uint8_t)any(40), data, any(5)};
    uint8_t nibbles[GROBO_ICS_EEPROM_BYTES] = {5, 10};
    for (size_t i = 2; i < sizeof nibbles; i++) {
        nibbles[i] = (uint8_t)any(16);
    }
    const grobo_ics_packet bare = {.command = (uint8_t)(GROBO_ICS_POSITION + 0x20 * any(4)),
                                   .id = (uint8_t)(1 + any(SERVOS)),
                                   .item = (uint8_t)any(7),
                                   .value = (uint16_t)any(any(2) > 0 ? 0x4000 : 0x80),
                                   .data = nibbles};
    const grobo_servo_table *table = chain.servos[0]->table;
    return table == &grobo_i_dxl2_table    ? grobo_dxl2_build(&packet, frame, ROOM)
           : table == &grobo_i_lx16a_table ? grobo_lx16a_build(&small, frame, ROOM)
           : table == &grobo_i_ics_table   ? grobo_ics_build(&bare, frame, ROOM)
                                           : grobo_dxl1_build(&other, frame, ROOM);
}

static int size_of_reply(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes, size_t n)
{
    const grobo_servo_table *table = chain.servos[0]->table;
    return table == &grobo_i_dxl2_table    ? grobo_dxl2_measure(bytes, n, GROBO_ACCEPT_RETURNS)
           : table == &grobo_i_lx16a_table ? grobo_lx16a_measure(bytes, n, GROBO_ACCEPT_RETURNS)
           : table == &grobo_i_ics_table   ? grobo_ics_answer(sent, sent_bytes, bytes, n)
                                           : grobo_dxl1_measure(bytes, n, GROBO_ACCEPT_RETURNS);
}

static void ask(const uint8_t *frame, size_t n)
{
    char hex[2 * ROOM + 1];
    for (size_t i = 0; i < n; i++) {
        (void)snprintf(hex + 2 * i, sizeof hex - 2 * i, "%02X", frame[i]);
    }
    simkit_ask(&chain.kit, hex, LONGEST_US);
}

static void what_is_said_is_whole(const uint8_t *sent, size_t n)
{
    const simkit *kit = &chain.kit;
    for (size_t at = 0; at < kit->n_got;) {
        int size = size_of_reply(sent, n, kit->got + at, kit->n_got - at);
        if (size <= 0) {
            fail_msg("%s says what is no packet: %d", chain.servos[0]->name, size);
        }
        at += (size_t)size;
    }
}

static void a_client_that_sends_anything(const grobo_servo_model *model)
{
    static const grobo_register_role fixed[] = {GROBO_ROLE_MODEL, GROBO_ROLE_FIRMWARE};
    const bool slow = model->table == &grobo_i_lx16a_table || model->table == &grobo_i_ics_table;
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .baud_bps = slow ? 115200 : 1000000,
                                     .no_stops = any(2) > 0};
    int32_t before[2] = {0}, parts = 0;
    chain_start(&chain, model, SERVOS, &config);
    for (int i = 0; i < 2 && grobo_servo_register_of(model, fixed[i]) != NULL; i++) {
        before[parts++] = chain_register(&chain, 0, fixed[i]);
    }
    for (int round = 0; round < ROUNDS; round++) {
        uint8_t frame[ROOM];
        int n = any_instruction(frame);
        uint32_t collisions = chain.kit.sim.stats.collisions;
        if (n <= 0) {
            continue;
        }
        bool broken = any(16) == 0;
        frame[any((uint32_t)n)] ^= (uint8_t)(broken ? 1u << any(8) : 0);
        ask(frame, any(30) > 0 ? (size_t)n : 1 + any((uint32_t)n));
        if (!broken && chain.kit.sim.stats.collisions == collisions) {
            what_is_said_is_whole(frame, (size_t)n);
        }
        for (int i = 0; i < parts; i++) {
            assert_int_equal(chain_register(&chain, 0, fixed[i]), before[i]);
        }
        if (any(500) == 0) { /* else most have another rate soon, or answer nothing */
            chain_start(&chain, model, SERVOS, &config);
        }
    }
}

TEST(no_client_breaks_a_servo)
{
    seed = 5;
    for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
        for (size_t m = 0; m < tables[t]->model_count; m++) {
            a_client_that_sends_anything(&tables[t]->models[m]);
        }
    }
}
