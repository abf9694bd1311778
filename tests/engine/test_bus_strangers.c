/* SPDX-License-Identifier: MIT */
/*
 * What else may be on the line before a reply comes: the own frame, replies of others and to other
 * questions, a reply within another's data, heads that lie about their length, stumps, noise. Of
 * each family, in one piece and in two, split at every byte. What is read is what was told, or
 * nothing; and the next question is answered.
 */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>
#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/lx16a.h>
#include <grobo/core/rs30x.h>

#include "tests/support/next_random.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, ROOM = 200, OWN_ID = 7, OTHER_ID = 9, VALUE = 0x0BB8, OTHER_VALUE = 0x0664 };

/* What a servo tells. */
typedef struct saying {
    uint8_t id;
    uint16_t value;
    const uint8_t *data; /* instead of the value: as many bytes */
    size_t n;
} saying;

typedef struct family {
    const char *name;
    const grobo_protocol *protocol;
    int (*ask)(uint8_t id, uint8_t *frame);
    int (*tell)(const saying *what, uint8_t *bytes);
    size_t length_at; /* of a reply; 0: none says how long it is */
    bool checked;     /* by a sum; what has none may be made by noise. These come first */
    bool echoes;      /* on its line the own frame may come back */
} family;

static int ask_rs30x(uint8_t id, uint8_t *frame)
{
    return grobo_rs30x_read(id, 42, 2, frame, ROOM);
}

static int ask_board(uint8_t id, uint8_t *frame)
{
    return grobo_frame_read(&grobo_i_board_protocol, id, 42, 2, frame, ROOM);
}

static int tell_rs30x(const saying *what, uint8_t *bytes)
{
    const grobo_rs30x_packet packet = {GROBO_RS30X_RETURN, what->id, 0,          42,
                                       (uint8_t)what->n,   1,        what->data, what->n};
    return grobo_rs30x_build(&packet, bytes, ROOM);
}

static int ask_dxl2(uint8_t id, uint8_t *frame)
{
    const grobo_dxl2_packet packet = {
        .id = id, .instruction = GROBO_DXL2_READ, .address = 132, .length = 2};
    return grobo_dxl2_build(&packet, frame, ROOM);
}

static int tell_dxl2(const saying *what, uint8_t *bytes)
{
    const grobo_dxl2_packet packet = {.id = what->id,
                                      .instruction = GROBO_DXL2_STATUS,
                                      .data = what->data,
                                      .data_bytes = what->n};
    return grobo_dxl2_build(&packet, bytes, ROOM);
}

static int ask_dxl1(uint8_t id, uint8_t *frame)
{
    const grobo_dxl1_packet packet = {
        .id = id, .instruction = GROBO_DXL1_READ, .address = 56, .length = 2};
    return grobo_dxl1_build(&packet, frame, ROOM);
}

static int tell_dxl1(const saying *what, uint8_t *bytes)
{
    const grobo_dxl1_packet packet = {
        .status = true, .id = what->id, .data = what->data, .data_bytes = what->n};
    return grobo_dxl1_build(&packet, bytes, ROOM);
}

static int ask_lx16a(uint8_t id, uint8_t *frame)
{
    const grobo_lx16a_packet packet = {.id = id, .command = GROBO_LX16A_POSITION_READ};
    return grobo_lx16a_build(&packet, frame, ROOM);
}

/* Of another length: another value. */
static int tell_lx16a(const saying *what, uint8_t *bytes)
{
    grobo_lx16a_code code = what->n == 1   ? GROBO_LX16A_TEMPERATURE_READ
                            : what->n == 2 ? GROBO_LX16A_POSITION_READ
                                           : GROBO_LX16A_LIMITS_READ;
    const grobo_lx16a_packet packet = {what->id, (uint8_t)code, what->data,
                                       what->n > 4 ? 4 : what->n};
    return grobo_lx16a_build(&packet, bytes, ROOM);
}

static int ask_ics(uint8_t id, uint8_t *frame)
{
    const grobo_ics_packet packet = {
        .command = GROBO_ICS_READ, .id = id, .item = GROBO_ICS_POSITION_ITEM};
    return grobo_ics_build(&packet, frame, ROOM);
}

static int tell_ics(const saying *what, uint8_t *bytes)
{
    bool position = what->n == 2;
    const grobo_ics_packet packet = {.reply = true,
                                     .command = GROBO_ICS_READ,
                                     .id = what->id,
                                     .item = position ? GROBO_ICS_POSITION_ITEM : 1,
                                     .value = position ? what->value : 0x3F};
    return grobo_ics_build(&packet, bytes, ROOM);
}

static const family families[] = {
    {"RS30x", &grobo_i_rs30x_protocol, ask_rs30x, tell_rs30x, 5, true, true},
    {"board", &grobo_i_board_protocol, ask_board, tell_rs30x, 5, true, false},
    {"DYNAMIXEL 2.0", &grobo_i_dxl2_protocol, ask_dxl2, tell_dxl2, 5, true, true},
    {"DYNAMIXEL 1.0", &grobo_i_dxl1_protocol, ask_dxl1, tell_dxl1, 3, true, true},
    {"Feetech", &grobo_i_feetech_protocol, ask_dxl1, tell_dxl1, 3, true, true},
    {"Hiwonder", &grobo_i_lx16a_protocol, ask_lx16a, tell_lx16a, 3, true, true},
    {"Kondo", &grobo_i_ics_protocol, ask_ics, tell_ics, 0, false, true},
};

enum { FAMILIES = sizeof families / sizeof families[0] };

/* ---- the line -------------------------------------------------------------------------------- */

static struct {
    const family *family;
    grobo_bus bus;
    int64_t now_us;
    bool ended;
    int result;
    int value;
} line;

static void done(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply)
{
    (void)ctx;
    (void)txn;
    bool high_first = line.family->protocol == &grobo_i_ics_protocol;
    line.ended = true;
    line.result = result;
    line.value = -1;
    if (reply != NULL && reply->data_bytes == 2) {
        line.value = reply->data[high_first ? 1 : 0] | reply->data[high_first ? 0 : 1] << 8;
    }
}

static void start_line(const family *f)
{
    const grobo_bus_config config = {.protocol = f->protocol, .baud_bps = 115200};
    memset(&line, 0, sizeof line);
    line.family = f;
    assert_int_equal(grobo_bus_init(&line.bus, &config), GROBO_OK);
}

static void step_to(int64_t at_us)
{
    line.now_us = at_us > line.now_us ? at_us : line.now_us;
    grobo_bus_step(&line.bus, line.now_us);
}

/* Asks once; what comes comes in two pieces when the answer is due. */
static void ask(const uint8_t *bytes, size_t n, size_t split)
{
    uint8_t frame[ROOM], sent[ROOM];
    grobo_txn txn;
    int size = line.family->ask(OWN_ID, frame);
    assert_int_equal(grobo_txn_init(&txn, line.family->protocol, frame, (size_t)size), GROBO_OK);
    txn.retries = 0;
    txn.done = done;
    line.ended = false;
    assert_int_equal(grobo_bus_submit(&line.bus, &txn), GROBO_OK);
    int64_t began_us = line.now_us;
    while (grobo_bus_tx(&line.bus, sent, sizeof sent, line.now_us) == 0) {
        step_to(grobo_bus_deadline(&line.bus, line.now_us));
        assert_true(line.now_us <= began_us + 250 * MS);
    }
    began_us = line.now_us;
    step_to(line.bus.over_us - 200);
    grobo_bus_rx(&line.bus, bytes, split, line.now_us);
    step_to(line.now_us + 200);
    grobo_bus_rx(&line.bus, bytes + split, n - split, line.now_us);
    while (!line.ended) {
        step_to(grobo_bus_deadline(&line.bus, line.now_us));
        assert_true(line.now_us <= began_us + 60 * MS);
    }
}

static int say(uint8_t id, uint16_t value, uint8_t *bytes)
{
    const uint8_t data[] = {(uint8_t)value, (uint8_t)(value >> 8)};
    const saying what = {id, value, data, sizeof data};
    return line.family->tell(&what, bytes);
}

static void told(int value, const char *when, size_t split)
{
    if (line.result != GROBO_OK || line.value != value) {
        fail_msg("%s, %s, split at %u: %s, %d instead of %d", line.family->name, when,
                 (unsigned)split, grobo_error_name(line.result), line.value, value);
    }
}

/* The reply stands behind these bytes. found: it must be read, not only nothing else. */
static void reply_behind(const uint8_t *before, size_t n, bool found, const char *when)
{
    uint8_t bytes[2 * ROOM], next[ROOM];
    assert_true(n <= ROOM);
    memcpy(bytes, before, n);
    size_t all = n + (size_t)say(OWN_ID, VALUE, bytes + n);
    for (size_t split = 0; split <= all; split++) {
        start_line(line.family);
        ask(bytes, all, split);
        if (found || line.result >= 0) {
            told(VALUE, when, split);
        }
        size_t size = (size_t)say(OWN_ID, OTHER_VALUE, next);
        ask(next, size, size);
        told(OTHER_VALUE, "then", split);
    }
}

/* ---- what comes before ----------------------------------------------------------------------- */

TEST(others_are_passed_over)
{
    for (int i = 0; i < FAMILIES; i++) {
        uint8_t bytes[ROOM];
        static const uint8_t many[] = {0x3F, 0x06, 0x00, 0x01};
        start_line(&families[i]);
        reply_behind(bytes, 0, true, "alone");
        reply_behind(bytes, (size_t)say(OTHER_ID, OTHER_VALUE, bytes), true, "behind another's");
        for (size_t n = 1; n <= sizeof many; n += n == 1 ? 3 : 1) {
            const saying what = {OWN_ID, 0, many, n};
            reply_behind(bytes, (size_t)families[i].tell(&what, bytes), true,
                         "behind a reply to something else");
        }
        for (int id = OWN_ID; id <= OTHER_ID && families[i].echoes; id += OTHER_ID - OWN_ID) {
            uint8_t reply[ROOM]; /* as much rubbish as a reply has ends the attempt */
            size_t n = (size_t)families[i].ask((uint8_t)id, bytes);
            bool found = families[i].checked && n < (size_t)say(OWN_ID, VALUE, reply);
            reply_behind(bytes, n, found, "behind a host's question");
        }
    }
}

TEST(the_first_of_two_is_the_reply)
{
    for (int i = 0; i < FAMILIES; i++) {
        uint8_t bytes[ROOM];
        start_line(&families[i]);
        size_t n = (size_t)say(OWN_ID, VALUE, bytes);
        reply_behind(bytes, n, true, "twice");
    }
}

/* A whole reply of this servo, in what another tells. */
TEST(a_reply_within_another_is_none)
{
    for (int i = 0; i < FAMILIES; i++) {
        uint8_t inner[ROOM], bytes[ROOM];
        start_line(&families[i]);
        const saying what = {OTHER_ID, 0, inner, (size_t)say(OWN_ID, OTHER_VALUE, inner)};
        int n = families[i].tell(&what, bytes);
        assert_true(n > 0);
        reply_behind(bytes, (size_t)n, true, "behind one with a reply in it");
    }
}

/* Any length, in the head of a reply of this servo or another that does not go on. */
TEST(a_length_that_lies_makes_no_value)
{
    for (int i = 0; i < FAMILIES; i++) {
        size_t at = families[i].length_at;
        for (int length = 0; at > 0 && length <= UINT8_MAX; length++) {
            uint8_t bytes[ROOM];
            start_line(&families[i]);
            for (uint8_t id = OWN_ID; id <= OTHER_ID; id += OTHER_ID - OWN_ID) {
                (void)say(id, OTHER_VALUE, bytes);
                bytes[at] = (uint8_t)length;
                reply_behind(bytes, at + 1, false, "behind a head");
                bytes[at + 1] = (uint8_t)length; /* the high byte, where there is one */
                reply_behind(bytes, at + 2, false, "behind a longer head");
            }
        }
    }
}

TEST(a_stump_makes_no_value)
{
    for (int i = 0; i < FAMILIES && families[i].checked; i++) {
        uint8_t bytes[ROOM];
        start_line(&families[i]);
        size_t n = (size_t)say(OWN_ID, OTHER_VALUE, bytes);
        for (size_t k = 1; k < n; k++) {
            reply_behind(bytes, k, false, "behind a stump");
            reply_behind(bytes + k, n - k, false, "behind an end");
        }
        for (size_t k = 0; k < n; k++) {
            bytes[k] ^= 0x10;
            reply_behind(bytes, n, false, "behind one with a flipped bit");
            bytes[k] ^= 0x10;
        }
    }
}

TEST(noise_makes_no_value)
{
    uint32_t seed = 11;
    for (int i = 0; i < FAMILIES && families[i].checked; i++) {
        for (int round = 0; round < 300; round++) {
            uint8_t bytes[ROOM], good[ROOM];
            start_line(&families[i]);
            size_t size = (size_t)say(OWN_ID, OTHER_VALUE, good);
            size_t n = 1 + next_random(&seed) % 24;
            for (size_t k = 0; k < n; k++) { /* bytes of a reply, in a wrong order, and others */
                uint32_t dice = next_random(&seed);
                bytes[k] = (dice & 0x300) != 0 ? good[dice % size] : (uint8_t)dice;
            }
            reply_behind(bytes, n, false, "behind noise");
        }
    }
}
