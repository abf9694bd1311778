/* SPDX-License-Identifier: MIT */
/* Frames of LewanSoul and Hiwonder servos, both ends. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/lx16a.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tests/support/wire_vectors.h"

enum { MAX = GROBO_LX16A_FRAME_MAX_BYTES };

/* Captured from pylx16a 1.1.1 and lewansoul-lx16a 0.1. */
TEST(frames_are_built_and_taken_apart)
{
    static const struct {
        const char *hex;
        grobo_lx16a_packet packet;
        unsigned accept;
    } rows[] = {
        {"55 55 01 03 1C DF", {1, GROBO_LX16A_POSITION_READ, NULL, 0}, GROBO_ACCEPT_COMMANDS},
        {"55 55 01 05 1C F4 01 E8",
         {1, GROBO_LX16A_POSITION_READ, (const uint8_t *)"\xF4\x01", 2},
         GROBO_ACCEPT_RETURNS},
        {"55 55 FE 03 0B F3", {254, GROBO_LX16A_START, NULL, 0}, GROBO_ACCEPT_COMMANDS},
        {"55 55 01 07 15 00 00 E8 03 F7",
         {1, GROBO_LX16A_LIMITS_READ, (const uint8_t *)"\x00\x00\xE8\x03", 4},
         GROBO_ACCEPT_RETURNS},
        {"55 55 01 04 19 55 8C",
         {1, GROBO_LX16A_HEAT_READ, (const uint8_t *)"\x55", 1},
         GROBO_ACCEPT_RETURNS},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t frame[MAX];
        grobo_lx16a_packet found;
        int n = grobo_lx16a_build(&rows[i].packet, frame, MAX);
        vector_expect(n, frame, rows[i].hex);
        assert_int_equal(grobo_lx16a_measure(frame, (size_t)n, rows[i].accept), n);
        assert_int_equal(grobo_lx16a_parse(frame, (size_t)n, &found), GROBO_OK);
        assert_int_equal(grobo_lx16a_build(&found, frame, MAX), n); /* in its own place */
        vector_expect(n, frame, rows[i].hex);
        for (int k = 1; k < n; k++) {
            assert_int_equal(grobo_lx16a_measure(frame, (size_t)k, rows[i].accept), 0);
            assert_int_equal(grobo_lx16a_build(&rows[i].packet, frame, (size_t)k), GROBO_ERR_SPACE);
        }
    }
    uint8_t frame[MAX];
    grobo_lx16a_packet packet = {.id = 255, .command = GROBO_LX16A_STOP};
    assert_int_equal(grobo_lx16a_build(&packet, frame, MAX), GROBO_ERR_ARG);
    packet = (grobo_lx16a_packet){1, GROBO_LX16A_MOVE, frame, 5};
    assert_int_equal(grobo_lx16a_build(&packet, frame, MAX), GROBO_ERR_CAP);
}

TEST(an_answer_is_of_its_request)
{
    static const struct {
        const char *sent, *bytes;
        int result;
    } rows[] = {
        {"55 55 01 03 1C DF", "55 55 01 05 1C F4 01 E8", 8},
        {"55 55 01 03 1C DF", "55 55 01 03 1C DF", GROBO_ERR_FRAME}, /* its echo */
        {"55 55 01 03 1C DF", "55 55 02 05 1C FA 00 E2", GROBO_ERR_FRAME},
        {"55 55 01 03 1C DF", "55 55 01 05 1B F4 1C CE", GROBO_ERR_FRAME},
        {"55 55 01 03 1C DF", "55 55 01 05 1C F4 01 17", GROBO_ERR_CHECKSUM},
        {"55 55 01 03 1C DF", "55 55 01 05 1C F4", 0},
        {"55 55 FE 03 0E F0", "55 55 03 04 0E 03 E7", 7},
        {"55 55 FE 03 0E F0", "55 55 01 04 0E 03 E9", GROBO_ERR_FRAME}, /* two at once */
        {"55 55 01 03 1C DE", "55", GROBO_ERR_CHECKSUM},                /* nothing of ours */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint8_t sent[MAX], bytes[MAX];
        int sent_n = vector_from_hex(rows[i].sent, sent, sizeof sent);
        int n = vector_from_hex(rows[i].bytes, bytes, sizeof bytes);
        assert_int_equal(grobo_lx16a_answer(sent, (size_t)sent_n, bytes, (size_t)n),
                         rows[i].result);
    }
}

TEST(rubbish_does_no_harm)
{
    static const uint8_t usual[] = {0x55, 0x55, 0x01, 0x03, 0x05, 0x1C, 0xFE, 0x07};
    static const uint8_t sent[] = {0x55, 0x55, 0x01, 0x03, 0x1C, 0xDF};
    uint32_t seed = 5;
    for (int round = 0; round < 50000; round++) {
        uint8_t bytes[16];
        for (size_t i = 0; i < sizeof bytes; i++) {
            uint32_t dice = next_random(&seed);
            bytes[i] = i < 2 ? 0x55 : (dice & 0x700) != 0 ? usual[dice % 8] : (uint8_t)dice;
        }
        size_t n = 1 + next_random(&seed) % sizeof bytes;
        assert_true(grobo_lx16a_measure(bytes, n, GROBO_ACCEPT_COMMANDS) <= (int)n);
        assert_true(grobo_lx16a_answer(sent, sizeof sent, bytes, n) <= (int)n);
    }
}

static int measure(const wire_vector *v, const uint8_t *bytes, size_t n)
{
    if (v->sent.n > 0) {
        return grobo_lx16a_answer(v->sent.bytes, v->sent.n, bytes, n);
    }
    return grobo_lx16a_measure(bytes, n,
                               v->from_servo ? GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS);
}

static void vector_holds(const wire_vector *v)
{
    wire_vector_scan(v, measure);
    if (!v->valid) {
        return;
    }
    uint8_t frame[WIRE_BYTES_MAX];
    grobo_lx16a_packet packet;
    assert_int_equal(grobo_lx16a_parse(v->whole.bytes, v->whole.n, &packet), GROBO_OK);
    assert_int_equal(packet.id, v->id);
    assert_int_equal(packet.command, v->command);
    assert_int_equal(grobo_lx16a_build(&packet, frame, sizeof frame), v->whole.n);
    assert_memory_equal(frame, v->whole.bytes, v->whole.n);
}

TEST(collected_vectors_hold)
{
    wire_vectors_check("lx16a.json", vector_holds, 80);
}
