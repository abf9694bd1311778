/* SPDX-License-Identifier: MIT */
/* Frames of DYNAMIXEL Protocol 2.0, both ends. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/protocol.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tests/support/wire_vectors.h"

enum { MAX = GROBO_DXL2_FRAME_MAX_BYTES, BOTH = GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS };

/* Printed in the maker's manual, or made by clients: its SDK (sync read, stuffed writes) and
 * rustypot 1.13.1. */
static const struct {
    const char *hex;
    grobo_dxl2_packet packet;
} printed[] = {
    {"FF FF FD 00 01 03 00 01 19 4E", {.id = 1, .instruction = GROBO_DXL2_PING}},
    {"FF FF FD 00 01 07 00 55 00 06 04 26 65 5D",
     {1, GROBO_DXL2_STATUS, 0, 0, 0, (const uint8_t *)"\x06\x04\x26", 3}},
    {"FF FF FD 00 01 07 00 02 84 00 04 00 1D 15",
     {.id = 1, .instruction = GROBO_DXL2_READ, .address = 132, .length = 4}},
    {"FF FF FD 00 01 03 00 08 2F 4E", {.id = 1, .instruction = GROBO_DXL2_REBOOT}},
    {"FF FF FD 00 01 04 00 06 01 A1 E6",
     {1, GROBO_DXL2_FACTORY_RESET, 0, 0, 0, (const uint8_t *)"\x01", 1}},
    {"FF FF FD 00 01 08 00 10 01 44 58 4C 22 B1 DC",
     {1, GROBO_DXL2_CLEAR, 0, 0, 0, (const uint8_t *)"\x01\x44\x58\x4C\x22", 5}},
    {"FF FF FD 00 FE 0D 00 92 01 90 00 02 00 02 92 00 01 00 1A 05",
     {254, GROBO_DXL2_BULK_READ, 0, 0, 0,
      (const uint8_t *)"\x01\x90\x00\x02\x00\x02\x92\x00\x01\x00", 10}},
    {"FF FF FD 00 FE 0D 00 82 84 00 04 00 01 02 03 04 05 06 B2 9B",
     {254, GROBO_DXL2_SYNC_READ, 0, 132, 4, (const uint8_t *)"\x01\x02\x03\x04\x05\x06", 6}},
    {"FF FF FD 00 FE 13 00 83 40 00 01 00 01 00 02 00 03 00 04 00 05 00 06 00 56 FD",
     {254, GROBO_DXL2_SYNC_WRITE, 0, 64, 1,
      (const uint8_t *)"\x01\x00\x02\x00\x03\x00\x04\x00\x05\x00\x06\x00", 12}},
    {"FF FF FD 00 04 09 00 03 74 00 45 09 00 00 09 AD",
     {4, GROBO_DXL2_WRITE, 0, 116, 0, (const uint8_t *)"\x45\x09\x00\x00", 4}},
    {"FF FF FD 00 03 0C 00 03 7A 02 FF FF FD FD 01 02 03 9A 26",
     {3, GROBO_DXL2_WRITE, 0, 634, 0, (const uint8_t *)"\xFF\xFF\xFD\x01\x02\x03", 6}},
    {"FF FF FD 00 03 0A 00 03 7A 02 09 FF FF FD FD F4 9A",
     {3, GROBO_DXL2_WRITE, 0, 634, 0, (const uint8_t *)"\x09\xFF\xFF\xFD", 4}},
};

static void same_packet(const grobo_dxl2_packet *a, const grobo_dxl2_packet *b)
{
    assert_int_equal(a->id, b->id);
    assert_int_equal(a->instruction, b->instruction);
    assert_int_equal(a->error, b->error);
    assert_int_equal(a->address, b->address);
    assert_int_equal(a->length, b->length);
    assert_int_equal(a->data_bytes, b->data_bytes);
    if (a->data_bytes > 0) {
        assert_memory_equal(a->data, b->data, a->data_bytes);
    }
}

TEST(frames_are_built_and_taken_apart)
{
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        const grobo_dxl2_packet *packet = &printed[i].packet;
        uint8_t frame[MAX], data[MAX];
        grobo_dxl2_packet found;
        int n = grobo_dxl2_build(packet, frame, MAX);
        vector_expect(n, frame, printed[i].hex);
        assert_int_equal(grobo_dxl2_measure(frame, (size_t)n, BOTH), n);
        for (int k = 1; k < n; k++) {
            assert_int_equal(grobo_dxl2_measure(frame, (size_t)k, BOTH), 0);
            assert_int_equal(grobo_dxl2_build(packet, data, (size_t)k), GROBO_ERR_SPACE);
        }
        assert_int_equal(grobo_dxl2_parse(frame, (size_t)n, data, sizeof data, &found), GROBO_OK);
        same_packet(&found, packet);
        /* In its own place, and back. */
        assert_int_equal(grobo_dxl2_parse(frame, (size_t)n, frame + 8, MAX - 8, &found), GROBO_OK);
        same_packet(&found, packet);
        assert_int_equal(grobo_dxl2_build(&found, frame, MAX), n);
        vector_expect(n, frame, printed[i].hex);
    }
}

/* The manual's name for the sum is CRC-16 (IBM), without reflection. */
TEST(the_crc_is_that_of_the_manual)
{
    assert_int_equal(grobo_dxl2_crc(0, (const uint8_t *)"123456789", 9), 0xFEE8);
    uint16_t half = grobo_dxl2_crc(0, (const uint8_t *)"1234", 4);
    assert_int_equal(grobo_dxl2_crc(half, (const uint8_t *)"56789", 5), 0xFEE8);
}

TEST(every_pattern_is_stuffed_and_back)
{
    static const uint8_t letters[] = {0xFF, 0xFD, 0x00};
    uint32_t seed = 1;
    for (int round = 0; round < 20000; round++) {
        uint8_t data[24], frame[64], back[64];
        size_t n = next_random(&seed) % sizeof data;
        for (size_t i = 0; i < n; i++) {
            data[i] = letters[next_random(&seed) % 8 / 3 % sizeof letters];
        }
        grobo_dxl2_packet packet = {
            .id = 1, .instruction = GROBO_DXL2_STATUS, .data = data, .data_bytes = n};
        grobo_dxl2_packet found;
        int size = grobo_dxl2_build(&packet, frame, sizeof frame);
        assert_true(size >= (int)n + GROBO_DXL2_STATUS_BYTES);
        assert_int_equal(grobo_dxl2_measure(frame, (size_t)size, GROBO_ACCEPT_RETURNS), size);
        for (int i = 8; i + 3 < size - 2; i++) {
            assert_false(memcmp(frame + i, "\xFF\xFF\xFD", 3) == 0 && frame[i + 3] != 0xFD);
        }
        assert_int_equal(grobo_dxl2_parse(frame, (size_t)size, back, sizeof back, &found),
                         GROBO_OK);
        same_packet(&found, &packet);
        assert_int_equal(grobo_dxl2_parse(frame, (size_t)size, frame + 8, sizeof frame - 8, &found),
                         GROBO_OK);
        same_packet(&found, &packet);
        assert_int_equal(grobo_dxl2_build(&found, frame, sizeof frame), size);
    }
}

TEST(broken_input_is_refused)
{
    static const struct {
        const char *hex;
        unsigned accept;
        int result;
    } rows[] = {
        {"FF FF FD 00 01 03 00 01 19 4F", BOTH, GROBO_ERR_CHECKSUM},
        {"FF FF FD 00 01 03 00 01 4E 19", BOTH, GROBO_ERR_CHECKSUM},
        {"FF FF FD 01", BOTH, GROBO_ERR_FRAME},
        {"FF FF FD FD", BOTH, GROBO_ERR_FRAME},
        {"FF FF FD 00 FD", BOTH, GROBO_ERR_FRAME},
        {"FF FF FD 00 FF", BOTH, GROBO_ERR_FRAME},
        {"FF FF FD 00 01 00 00", BOTH, GROBO_ERR_FRAME},
        {"FF FF FD 00 01 02 00", BOTH, GROBO_ERR_FRAME},
        {"FF FF FD 00 01 FA 03", BOTH, GROBO_ERR_FRAME}, /* 1025 bytes */
        {"FF FF FD 00 01 F9 03", BOTH, 0},               /* 1024 bytes */
        {"FF FF FD 00 01 03 00 01 19 4E", GROBO_ACCEPT_RETURNS, GROBO_ERR_FRAME},
        {"FF FF FD 00 01 04 00 55 00 A1 0C", GROBO_ACCEPT_COMMANDS, GROBO_ERR_FRAME},
        {"FF FF FD 00 01 03 00 55", BOTH, GROBO_ERR_FRAME}, /* a status without error */
        {"FF FF FD 00 03 08 00 55 00 FF FF FD 01 51 BA", BOTH, GROBO_ERR_FRAME},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t bytes[32];
        int n = vector_from_hex(rows[i].hex, bytes, sizeof bytes);
        assert_int_equal(grobo_dxl2_measure(bytes, (size_t)n, rows[i].accept), rows[i].result);
    }
    uint8_t bytes[MAX + 8], data[MAX];
    grobo_dxl2_packet packet = {.id = 1, .instruction = GROBO_DXL2_WRITE, .address = 116};
    /* Good frames whose parameters do not do. */
    uint8_t few[] = {0x74};
    grobo_dxl2_packet bare = {
        .id = 1, .instruction = GROBO_DXL2_CLEAR, .data = few, .data_bytes = 1};
    int n = grobo_dxl2_build(&bare, bytes, sizeof bytes);
    bytes[7] = GROBO_DXL2_READ;
    uint16_t crc = grobo_dxl2_crc(0, bytes, (size_t)n - 2);
    bytes[n - 2] = (uint8_t)(crc & 0xFF);
    bytes[n - 1] = (uint8_t)(crc >> 8);
    assert_int_equal(grobo_dxl2_parse(bytes, (size_t)n, data, MAX, &packet), GROBO_ERR_SHORT);
    assert_int_equal(packet.address, 116);
    n = grobo_dxl2_build(&packet, bytes, sizeof bytes);
    assert_int_equal(grobo_dxl2_parse(bytes, (size_t)n, data, 1, &packet), GROBO_ERR_SPACE);
    assert_int_equal(grobo_dxl2_parse(bytes, (size_t)n - 1, data, MAX, &packet), GROBO_ERR_FRAME);
    /* What cannot be built. */
    packet.id = 253;
    assert_int_equal(grobo_dxl2_build(&packet, bytes, sizeof bytes), GROBO_ERR_ARG);
    memset(data, 0xFF, sizeof data);
    packet = (grobo_dxl2_packet){
        .id = 1, .instruction = GROBO_DXL2_WRITE, .data = data, .data_bytes = MAX - 12};
    assert_int_equal(grobo_dxl2_build(&packet, bytes, sizeof bytes), MAX);
    data[2] = 0xFD; /* one byte more by stuffing */
    assert_int_equal(grobo_dxl2_build(&packet, bytes, sizeof bytes), GROBO_ERR_CAP);
    packet.data_bytes = MAX - 11;
    assert_int_equal(grobo_dxl2_build(&packet, bytes, sizeof bytes), GROBO_ERR_CAP);
}

/* rustypot 1.13.1, which checks the CRC of each block, took such a frame from six servos. */
#define FAST                                                                                       \
    "FF FF FD 00 FE 19 00 55 00 01 A6 00 00 00 77 88 00 02 1F 08 00 00 86 8E 00 03 00 08 00 00 "   \
    "98 88"

TEST(blocks_of_a_fast_status_have_their_own_crc)
{
    static const uint8_t values[3][4] = {{0xA6}, {0x1F, 0x08}, {0x00, 0x08}};
    uint8_t frame[64], data[64];
    grobo_dxl2_packet block, packet;
    int n = vector_from_hex(FAST, frame, sizeof frame);
    assert_int_equal(grobo_dxl2_measure(frame, (size_t)n, GROBO_ACCEPT_RETURNS), n);
    int at = 8;
    for (int i = 0; i < 3; i++) {
        at = grobo_dxl2_block(frame, (size_t)n, (size_t)at, 4, &block);
        assert_int_equal(at, 8 + 8 * (i + 1));
        assert_int_equal(block.id, i + 1);
        assert_int_equal(block.error, 0);
        assert_int_equal(block.data_bytes, 4);
        assert_memory_equal(block.data, values[i], 4);
    }
    assert_int_equal(grobo_dxl2_block(frame, (size_t)n, (size_t)at, 4, &block), GROBO_ERR_SHORT);
    assert_int_equal(grobo_dxl2_block(frame, (size_t)n, 24, 5, &block), GROBO_ERR_SHORT);
    assert_int_equal(grobo_dxl2_block(frame, (size_t)n, 0, 4, &block), GROBO_ERR_SHORT);
    /* It is built as it is on the wire, without stuffing. */
    assert_int_equal(grobo_dxl2_parse(frame, (size_t)n, data, sizeof data, &packet), GROBO_OK);
    assert_int_equal(packet.id, 254);
    assert_int_equal(packet.data_bytes, 22);
    assert_int_equal(grobo_dxl2_build(&packet, frame, sizeof frame), n);
    frame[10] ^= 1;
    assert_int_equal(grobo_dxl2_block(frame, (size_t)n, 8, 4, &block), GROBO_ERR_CHECKSUM);
}

TEST(rubbish_does_no_harm)
{
    static const uint8_t usual[] = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x55, 0xFE, 0x82};
    uint8_t bytes[64], data[64];
    uint32_t seed = 7;
    for (int round = 0; round < 50000; round++) {
        for (size_t i = 0; i < sizeof bytes; i++) {
            uint32_t dice = next_random(&seed);
            bytes[i] = i < 4 && round % 2 == 0 ? usual[i]
                       : (dice & 0x700) != 0   ? usual[dice % 8]
                                               : (uint8_t)dice;
        }
        if (round % 4 == 0) { /* a good frame but for its parameters */
            bytes[4] = 1;
            bytes[5] = (uint8_t)(3 + next_random(&seed) % 40);
            bytes[6] = 0;
            uint16_t crc = grobo_dxl2_crc(0, bytes, bytes[5] + 5u);
            bytes[bytes[5] + 5] = (uint8_t)(crc & 0xFF);
            bytes[bytes[5] + 6] = (uint8_t)(crc >> 8);
        }
        size_t n = 1 + next_random(&seed) % sizeof bytes;
        int size = grobo_dxl2_measure(bytes, n, BOTH);
        assert_true(size <= (int)n);
        grobo_dxl2_packet packet;
        if (size > 0 &&
            grobo_dxl2_parse(bytes, (size_t)size, data, sizeof data, &packet) == GROBO_OK) {
            assert_true(packet.data >= data && packet.data + packet.data_bytes <= data + size - 10);
        }
    }
}

static int measure(const wire_vector *v, const uint8_t *bytes, size_t n)
{
    return grobo_dxl2_measure(bytes, n,
                              v->from_servo && strcmp(v->name, "echo alone") != 0
                                  ? GROBO_ACCEPT_RETURNS
                                  : GROBO_ACCEPT_COMMANDS);
}

static void vector_holds(const wire_vector *v)
{
    wire_vector_scan(v, measure);
    if (!v->valid) {
        return;
    }
    uint8_t data[WIRE_BYTES_MAX], frame[WIRE_BYTES_MAX];
    grobo_dxl2_packet packet;
    assert_int_equal(grobo_dxl2_parse(v->whole.bytes, v->whole.n, data, sizeof data, &packet),
                     GROBO_OK);
    assert_int_equal(packet.id, v->id);
    assert_int_equal(packet.instruction == GROBO_DXL2_STATUS, v->from_servo);
    assert_true(v->error < 0 || packet.error == v->error);
    assert_true(v->address < 0 || packet.address == v->address);
    assert_true(v->count < 0 || packet.length == v->count);
    if (v->data.n > 0 && packet.id != GROBO_DXL2_ID_ALL) {
        assert_int_equal(packet.data_bytes, v->data.n);
        assert_memory_equal(packet.data, v->data.bytes, v->data.n);
    }
    assert_int_equal(grobo_dxl2_build(&packet, frame, sizeof frame), v->whole.n);
    assert_memory_equal(frame, v->whole.bytes, v->whole.n);
}

TEST(collected_vectors_hold)
{
    wire_vectors_check("dynamixel2.json", vector_holds, 100);
}
