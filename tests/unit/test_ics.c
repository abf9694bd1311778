/* SPDX-License-Identifier: MIT */
/* Frames of Kondo KRS servos, both ends. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/ics.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tests/support/wire_vectors.h"

enum { MAX = GROBO_ICS_FRAME_MAX_BYTES };

/* The first five are printed in the maker's manual, the last is ICS 3.6 (arduino-ics). */
static const struct {
    const char *sent, *got;
    grobo_ics_packet command, reply;
} printed[] = {
    {"81 3A 4C",
     "01 3A 4C",
     {false, GROBO_ICS_POSITION, 1, 0, 7500, NULL},
     {true, GROBO_ICS_POSITION, 1, 0, 7500, NULL}},
    {"A1 01",
     "21 01 1E",
     {false, GROBO_ICS_READ, 1, GROBO_ICS_STRETCH, 0, NULL},
     {true, GROBO_ICS_READ, 1, GROBO_ICS_STRETCH, 30, NULL}},
    {"CA 02 64",
     "4A 02 64",
     {false, GROBO_ICS_WRITE, 10, GROBO_ICS_SPEED, 100, NULL},
     {true, GROBO_ICS_WRITE, 10, GROBO_ICS_SPEED, 100, NULL}},
    {"FF 00 00 00",
     "F4",
     {false, GROBO_ICS_ID, 31, 0, 0, NULL},
     {true, GROBO_ICS_ID, 20, 0, 0, NULL}},
    {"F4 01 01 01",
     "F4",
     {false, GROBO_ICS_ID, 20, 1, 0, NULL},
     {true, GROBO_ICS_ID, 20, 1, 0, NULL}},
    {"A1 05",
     "21 05 59 6C",
     {false, GROBO_ICS_READ, 1, GROBO_ICS_POSITION_ITEM, 0, NULL},
     {true, GROBO_ICS_READ, 1, GROBO_ICS_POSITION_ITEM, 11500, NULL}},
};

static void same_packet(const grobo_ics_packet *a, const grobo_ics_packet *b)
{
    assert_int_equal(a->reply, b->reply);
    assert_int_equal(a->command, b->command);
    assert_int_equal(a->id, b->id);
    assert_int_equal(a->item, b->item);
    assert_int_equal(a->value, b->value);
}

TEST(frames_are_built_and_taken_apart)
{
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        uint8_t sent[MAX], got[MAX];
        grobo_ics_packet found;
        int sent_n = grobo_ics_build(&printed[i].command, sent, MAX);
        vector_expect(sent_n, sent, printed[i].sent);
        int n = grobo_ics_build(&printed[i].reply, got, MAX);
        vector_expect(n, got, printed[i].got);
        assert_int_equal(grobo_ics_measure(sent, (size_t)sent_n), sent_n);
        assert_int_equal(grobo_ics_answer(sent, (size_t)sent_n, got, (size_t)n), n);
        assert_int_equal(grobo_ics_parse(NULL, 0, sent, (size_t)sent_n, &found), GROBO_OK);
        same_packet(&found, &printed[i].command);
        assert_int_equal(grobo_ics_parse(sent, (size_t)sent_n, got, (size_t)n, &found), GROBO_OK);
        same_packet(&found, &printed[i].reply);
        for (int k = 0; k < sent_n; k++) {
            assert_int_equal(grobo_ics_measure(sent, (size_t)k), 0);
            assert_int_equal(grobo_ics_build(&printed[i].command, got, (size_t)k), GROBO_ERR_SPACE);
        }
    }
}

TEST(the_eeprom_goes_as_a_whole)
{
    uint8_t nibbles[GROBO_ICS_EEPROM_BYTES] = {5, 10, 3, 12}, frame[MAX], sent[2];
    grobo_ics_packet packet = {.command = GROBO_ICS_WRITE, .id = 5, .data = nibbles}, found;
    assert_int_equal(grobo_ics_build(&packet, frame, MAX), 66);
    assert_int_equal(grobo_ics_parse(NULL, 0, frame, 66, &found), GROBO_OK);
    assert_memory_equal(found.data, nibbles, sizeof nibbles);
    assert_int_equal(grobo_ics_answer(frame, 66, (const uint8_t *)"\x45\x00", 2), 2);
    packet = (grobo_ics_packet){.command = GROBO_ICS_READ, .id = 5};
    assert_int_equal(grobo_ics_build(&packet, sent, sizeof sent), 2);
    packet.reply = true;
    packet.data = nibbles;
    assert_int_equal(grobo_ics_build(&packet, frame, MAX), 66);
    assert_int_equal(grobo_ics_parse(sent, 2, frame, 66, &found), GROBO_OK);
    assert_memory_equal(found.data, nibbles, sizeof nibbles);
    nibbles[3] = 0x80;
    assert_int_equal(grobo_ics_build(&packet, frame, MAX), GROBO_ERR_ARG);
    packet.data = NULL;
    assert_int_equal(grobo_ics_build(&packet, frame, MAX), GROBO_ERR_ARG);
}

TEST(what_is_none_is_refused)
{
    static const grobo_ics_packet bad[] = {
        {.command = GROBO_ICS_POSITION, .id = 32},
        {.command = GROBO_ICS_POSITION, .value = 16384},
        {.command = GROBO_ICS_WRITE, .item = GROBO_ICS_SPEED, .value = 128},
        {.command = GROBO_ICS_WRITE, .item = GROBO_ICS_POSITION_ITEM},
        {.command = GROBO_ICS_READ, .item = 0x7F},
        {.command = GROBO_ICS_ID, .item = 2},
        {.command = 0},
        {.command = 0x81},
    };
    uint8_t frame[MAX];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(grobo_ics_build(&bad[i], frame, MAX), GROBO_ERR_ARG);
    }
    assert_int_equal(grobo_ics_answer((const uint8_t *)"\x81\x3A", 2, frame, 1), GROBO_ERR_ARG);
    /* The old answer is for id 0 alone. */
    assert_int_equal(
        grobo_ics_answer((const uint8_t *)"\x80\x3A\x4C", 3, (const uint8_t *)"\x80\x3A\x4C", 3),
        3);
    assert_int_equal(
        grobo_ics_answer((const uint8_t *)"\x81\x3A\x4C", 3, (const uint8_t *)"\x81\x3A\x4C", 3),
        GROBO_ERR_FRAME);
}

TEST(rubbish_does_no_harm)
{
    uint32_t seed = 9;
    for (int round = 0; round < 50000; round++) {
        uint8_t bytes[80], sent[80];
        for (size_t i = 0; i < sizeof bytes; i++) {
            uint32_t dice = next_random(&seed);
            bytes[i] = (uint8_t)(i == 0 || (dice & 0x3F00) == 0 ? dice : dice % 6);
            sent[i] = (uint8_t)(i == 0 ? dice >> 8 | 0x80 : bytes[i]);
        }
        size_t n = next_random(&seed) % sizeof bytes;
        int size = grobo_ics_measure(bytes, n);
        assert_true(size <= (int)n);
        int sent_n = grobo_ics_measure(sent, sizeof sent);
        if (sent_n > 0) {
            assert_true(grobo_ics_answer(sent, (size_t)sent_n, bytes, n) <= (int)n);
        }
    }
}

static int measure(const wire_vector *v, const uint8_t *bytes, size_t n)
{
    (void)v;
    return grobo_ics_measure(bytes, n);
}

/* Behind the echo of what was sent, wherever that is. */
static void answer_holds(const wire_vector *v)
{
    size_t found = 0;
    for (size_t i = 0; i + v->sent.n <= v->whole.n; i++) {
        if (memcmp(v->whole.bytes + i, v->sent.bytes, v->sent.n) == 0) {
            size_t at = i + v->sent.n;
            int size =
                grobo_ics_answer(v->sent.bytes, v->sent.n, v->whole.bytes + at, v->whole.n - at);
            if (size > 0) {
                assert_int_equal(size, v->frames[0].n);
                assert_memory_equal(v->whole.bytes + at, v->frames[0].bytes, (size_t)size);
                found++;
            }
            break;
        }
    }
    assert_int_equal(found, v->frame_count);
}

/* A command whose answer a collected reply is: the file gives it by its meaning only. */
static int ask_for(const wire_vector *v, uint8_t *sent)
{
    grobo_ics_packet packet = {.command = GROBO_ICS_POSITION, .id = (uint8_t)v->id};
    static const uint8_t nibbles[GROBO_ICS_EEPROM_BYTES];
    if ((v->whole.bytes[0] & 0xE0) == 0xE0) {
        packet = (grobo_ics_packet){.command = GROBO_ICS_ID, .id = (uint8_t)v->id, .item = 1};
    } else if ((v->whole.bytes[0] & 0x60) != 0) {
        packet.command = (v->whole.bytes[0] & 0x60) == 0x20 ? GROBO_ICS_READ : GROBO_ICS_WRITE;
        packet.item = v->whole.bytes[1];
        packet.data = nibbles;
    }
    return grobo_ics_build(&packet, sent, MAX);
}

static void vector_holds(const wire_vector *v)
{
    uint8_t sent[MAX], frame[MAX];
    grobo_ics_packet packet;
    if (strstr(v->name, "general") != NULL) {
        return; /* of devices that are no servos */
    }
    if (!v->from_servo) {
        wire_vector_scan(v, measure);
    } else if (v->sent.n > 0) {
        answer_holds(v);
    }
    if (!v->valid) {
        return;
    }
    int sent_n = v->from_servo ? ask_for(v, sent) : 0;
    assert_int_equal(grobo_ics_parse(v->from_servo ? sent : NULL, (size_t)sent_n, v->whole.bytes,
                                     v->whole.n, &packet),
                     GROBO_OK);
    assert_true(v->id < 0 || packet.id == v->id);
    int n = grobo_ics_build(&packet, frame, sizeof frame);
    bool old = v->whole.bytes[0] == 0x80 && v->from_servo; /* the old answer of id 0 */
    assert_int_equal(n, v->whole.n);
    assert_memory_equal(frame + old, v->whole.bytes + old, v->whole.n - old);
}

TEST(collected_vectors_hold)
{
    wire_vectors_check("ics.json", vector_holds, 80);
}
