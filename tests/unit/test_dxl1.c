/* SPDX-License-Identifier: MIT */
/* Frames of DYNAMIXEL Protocol 1.0 and of Feetech, both ends. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/feetech.h>
#include <grobo/core/protocol.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tests/support/wire_vectors.h"

enum { MAX = GROBO_DXL1_FRAME_MAX_BYTES, BOTH = GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS };

#define BYTES(text) (const uint8_t *)(text), sizeof(text) - 1

/* Printed in ROBOTIS' manual of Protocol 1.0 (the first eight), or captured from clients of Feetech
 * servos: feetech-servo-sdk 1.0.0, ftservo-python-sdk 2.0.1. */
static const struct {
    const char *hex;
    grobo_dxl1_packet packet;
} printed[] = {
    {"FF FF 01 02 01 FB", {.id = 1, .instruction = GROBO_DXL1_PING}},
    {"FF FF 01 02 00 FC", {.status = true, .id = 1}},
    {"FF FF 01 02 24 D8", {.status = true, .id = 1, .error = 0x24}},
    {"FF FF 01 04 02 2B 01 CC",
     {.id = 1, .instruction = GROBO_DXL1_READ, .address = 43, .length = 1}},
    {"FF FF 01 03 00 20 DB", {true, 1, 0, 0, 0, 0, BYTES("\x20")}},
    {"FF FF 01 05 03 0C 64 AA DC", {false, 1, GROBO_DXL1_WRITE, 0, 12, 0, BYTES("\x64\xAA")}},
    {"FF FF 00 02 06 F7", {.id = 0, .instruction = GROBO_DXL1_FACTORY_RESET}},
    {"FF FF FE 09 92 00 02 01 1E 02 02 24 1D",
     {false, 254, GROBO_DXL1_BULK_READ, 0, 0, 0, BYTES("\x00\x02\x01\x1E\x02\x02\x24")}},
    {"FF FF FE 0A 82 38 02 01 02 03 04 05 06 26",
     {false, 254, GROBO_DXL1_SYNC_READ, 0, 56, 2, BYTES("\x01\x02\x03\x04\x05\x06")}},
    {"FF FF 02 05 04 2A 02 BC 0C", {false, 2, GROBO_DXL1_REG_WRITE, 0, 42, 0, BYTES("\x02\xBC")}},
    {"FF FF FE 02 05 FA", {.id = 254, .instruction = GROBO_DXL1_ACTION}},
    {"FF FF FE 0D 83 2A 02 01 01 9D 02 01 FF 03 02 60 3F",
     {false, 254, GROBO_DXL1_SYNC_WRITE, 0, 42, 2, BYTES("\x01\x01\x9D\x02\x01\xFF\x03\x02\x60")}},
    {"FF FF 04 02 08 F1", {.id = 4, .instruction = GROBO_DXL1_REBOOT}},
};

static void same_packet(const grobo_dxl1_packet *a, const grobo_dxl1_packet *b)
{
    assert_int_equal(a->status, b->status);
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
        const grobo_dxl1_packet *packet = &printed[i].packet;
        uint8_t frame[MAX];
        grobo_dxl1_packet found;
        int n = grobo_dxl1_build(packet, frame, MAX);
        vector_expect(n, frame, printed[i].hex);
        assert_int_equal(grobo_dxl1_measure(frame, (size_t)n, BOTH), n);
        assert_int_equal(grobo_dxl1_parse(frame, (size_t)n, packet->status, &found), GROBO_OK);
        same_packet(&found, packet);
        assert_int_equal(grobo_dxl1_build(&found, frame, MAX), n); /* in its own place */
        vector_expect(n, frame, printed[i].hex);
        for (int k = 1; k < n; k++) {
            assert_int_equal(grobo_dxl1_measure(frame, (size_t)k, BOTH), 0);
            assert_int_equal(grobo_dxl1_build(packet, frame, (size_t)k), GROBO_ERR_SPACE);
            assert_int_equal(grobo_dxl1_parse(frame, (size_t)k, packet->status, &found),
                             GROBO_ERR_FRAME);
        }
    }
}

TEST(broken_input_is_refused)
{
    static const struct {
        const char *hex;
        unsigned accept;
        int result;
    } rows[] = {
        {"FF FF 01 02 01 FC", BOTH, GROBO_ERR_CHECKSUM},
        {"FF FE", BOTH, GROBO_ERR_FRAME},
        {"FF FF FF", BOTH, GROBO_ERR_FRAME},
        {"FF FF FE", GROBO_ACCEPT_RETURNS, GROBO_ERR_FRAME},
        {"FF FF FE", BOTH, 0},
        {"FF FF 01 00", BOTH, GROBO_ERR_FRAME},
        {"FF FF 01 01", BOTH, GROBO_ERR_FRAME},
        {"FF FF 01 FF", BOTH, 0},
    };
    uint8_t bytes[MAX + 1];
    grobo_dxl1_packet packet = {.id = 7};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        int n = vector_from_hex(rows[i].hex, bytes, sizeof bytes);
        assert_int_equal(grobo_dxl1_measure(bytes, (size_t)n, rows[i].accept), rows[i].result);
    }
    /* A read that does not say how much. */
    int n = vector_from_hex("FF FF 01 03 02 2B CE", bytes, sizeof bytes);
    assert_int_equal(grobo_dxl1_parse(bytes, (size_t)n, false, &packet), GROBO_ERR_SHORT);
    assert_int_equal(packet.id, 7);
    /* What cannot be built. */
    packet = (grobo_dxl1_packet){.status = true, .id = 254};
    assert_int_equal(grobo_dxl1_build(&packet, bytes, sizeof bytes), GROBO_ERR_ARG);
    packet = (grobo_dxl1_packet){.id = 255, .instruction = GROBO_DXL1_PING};
    assert_int_equal(grobo_dxl1_build(&packet, bytes, sizeof bytes), GROBO_ERR_ARG);
    static const uint8_t many[300];
    packet = (grobo_dxl1_packet){
        .id = 1, .instruction = GROBO_DXL1_WRITE, .data = many, .data_bytes = 252};
    assert_int_equal(grobo_dxl1_build(&packet, bytes, sizeof bytes), MAX);
    packet.data_bytes = 253;
    assert_int_equal(grobo_dxl1_build(&packet, bytes, sizeof bytes), GROBO_ERR_CAP);
}

TEST(a_status_answers_only_what_it_fits)
{
    static const char read2[] = "FF FF 01 04 02 24 02 D2";
    static const char sync[] = "FF FF FE 07 82 38 04 01 02 04 35";
    static const char bulk[] = "FF FF FE 0C 92 00 08 04 24 02 05 24 02 06 44 BC";
    static const struct {
        const char *sent, *bytes;
        int result;
    } rows[] = {
        {read2, "FF FF 01 04 00 00 02 F8", 8},
        {read2, "FF FF 01 04 20 00 02 D8", 8}, /* with an error */
        {read2, "FF FF 01 02 08 F4", 6},       /* an error without data */
        {read2, "FF FF 01 02 00 FC", GROBO_ERR_FRAME},
        {read2, "FF FF 01 03 00 00 FB", GROBO_ERR_FRAME},
        {read2, "FF FF 02 04 00 00 02 F7", GROBO_ERR_FRAME},
        {read2, "FF FF 01 04 02 24 02 D2", GROBO_ERR_FRAME}, /* its echo */
        {read2, "FF FF 01 04 02 24", 0},
        {read2, "FF FF 01 06", GROBO_ERR_FRAME},
        {read2, "FF FF 01 04 00 00 02 F9", GROBO_ERR_CHECKSUM},
        {"FF FF 01 02 01 FB", "FF FF 01 02 00 FC", 6},
        {"FF FF 01 02 01 FB", "FF FF 01 02 01 FB", GROBO_ERR_FRAME},
        {"FF FF FE 02 01 FE", "FF FF 07 02 00 F6", 6}, /* a ping to all */
        {"FF FF 01 05 03 0C 64 AA DC", "FF FF 01 02 00 FC", 6},
        {"FF FF FE 04 03 28 00 D2", "FF FF 01 02 00 FC", GROBO_ERR_FRAME},
        {sync, "FF FF 02 06 00 EA 03 00 00 0A", 10},
        {sync, "FF FF 03", GROBO_ERR_FRAME},
        {sync, "FF FF 02 04", GROBO_ERR_FRAME},
        {bulk, "FF FF 05 04 00 00 08 EE", 8},
        {bulk, "FF FF 04 04", GROBO_ERR_FRAME}, /* 8 bytes were asked for */
        {bulk, "FF FF 01", GROBO_ERR_FRAME},
        {"FF FF 01 02 01 FC", "FF", GROBO_ERR_CHECKSUM}, /* nothing of ours */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t sent[32], bytes[32];
        int sent_n = vector_from_hex(rows[i].sent, sent, sizeof sent);
        int n = vector_from_hex(rows[i].bytes, bytes, sizeof bytes);
        assert_int_equal(grobo_dxl1_answer(sent, (size_t)sent_n, bytes, (size_t)n), rows[i].result);
    }
}

TEST(rubbish_does_no_harm)
{
    static const uint8_t sent[] = {0xFF, 0xFF, 0xFE, 0x07, 0x82, 0x38,
                                   0x04, 0x01, 0x02, 0x04, 0x35};
    static const uint8_t usual[] = {0xFF, 0xFF, 0x01, 0x02, 0x04, 0xFE, 0x82, 0x92};
    uint8_t bytes[64];
    uint32_t seed = 3;
    for (int round = 0; round < 50000; round++) {
        for (size_t i = 0; i < sizeof bytes; i++) {
            uint32_t dice = next_random(&seed);
            bytes[i] = i < 2 ? 0xFF : (dice & 0x700) != 0 ? usual[dice % 8] : (uint8_t)dice;
        }
        if (round % 2 == 0) { /* a good frame but for its parameters */
            bytes[2] = 1;
            bytes[3] = (uint8_t)(2 + next_random(&seed) % 40);
            unsigned sum = 0;
            for (unsigned i = 2; i < bytes[3] + 3u; i++) {
                sum += bytes[i];
            }
            bytes[bytes[3] + 3] = (uint8_t)~sum;
        }
        size_t n = 1 + next_random(&seed) % sizeof bytes;
        grobo_dxl1_packet packet;
        int size = grobo_dxl1_measure(bytes, n, BOTH);
        assert_true(size <= (int)n && grobo_dxl1_answer(sent, sizeof sent, bytes, n) <= (int)n);
        if (size > 0 && grobo_dxl1_parse(bytes, (size_t)size, round % 3 == 0, &packet) >= 0) {
            assert_true(packet.data > bytes && packet.data + packet.data_bytes < bytes + size);
            assert_true(grobo_dxl1_answer(bytes, (size_t)size, sent, sizeof sent) < 0);
        }
    }
}

static int measure(const wire_vector *v, const uint8_t *bytes, size_t n)
{
    if (v->sent.n > 0) {
        return grobo_dxl1_answer(v->sent.bytes, v->sent.n, bytes, n);
    }
    return grobo_dxl1_measure(bytes, n,
                              v->from_servo ? GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS);
}

static void vector_holds(const wire_vector *v)
{
    wire_vector_scan(v, measure);
    if (!v->valid) {
        return;
    }
    uint8_t frame[WIRE_BYTES_MAX];
    grobo_dxl1_packet packet;
    assert_int_equal(grobo_dxl1_parse(v->whole.bytes, v->whole.n, v->from_servo, &packet),
                     GROBO_OK);
    assert_int_equal(packet.id, v->id);
    assert_true(v->error < 0 || packet.error == v->error);
    assert_true(v->address < 0 || packet.address == v->address);
    assert_true(v->count < 0 || packet.length == v->count);
    if (v->data.n > 0) {
        assert_int_equal(packet.data_bytes, v->data.n);
        assert_memory_equal(packet.data, v->data.bytes, v->data.n);
    }
    assert_int_equal(grobo_dxl1_build(&packet, frame, sizeof frame), v->whole.n);
    assert_memory_equal(frame, v->whole.bytes, v->whole.n);
}

TEST(collected_vectors_of_dynamixel_hold)
{
    wire_vectors_check("dynamixel1.json", vector_holds, 80);
}

TEST(collected_vectors_of_feetech_hold)
{
    wire_vectors_check("feetech.json", vector_holds, 80);
}
