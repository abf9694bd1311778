/* SPDX-License-Identifier: MIT */
/* LewanSoul and Hiwonder: no registers, but what a command carries is told like them. */
#include <stdio.h>
#include <string.h>

#include <grobo/core/lx16a.h>

#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/words/common.h"

/* A command, the one that reads the same, and its fields in a row of what they carry. */
typedef struct order {
    uint8_t write, read;
    const char *action; /* of the write; NULL: "write" */
    uint8_t bytes;
} order;

static const order orders[] = {
    {GROBO_LX16A_MOVE, GROBO_LX16A_MOVE_READ, NULL, 4},
    {GROBO_LX16A_WAIT, GROBO_LX16A_WAIT_READ, "write at start", 4},
    {GROBO_LX16A_START, 0, "start", 0},
    {GROBO_LX16A_STOP, 0, "stop", 0},
    {GROBO_LX16A_ID, GROBO_LX16A_ID_READ, NULL, 1},
    {GROBO_LX16A_OFFSET, GROBO_LX16A_OFFSET_READ, NULL, 1},
    {GROBO_LX16A_OFFSET_SAVE, 0, "save offset", 0},
    {GROBO_LX16A_LIMITS, GROBO_LX16A_LIMITS_READ, NULL, 4},
    {GROBO_LX16A_VOLTAGES, GROBO_LX16A_VOLTAGES_READ, NULL, 4},
    {GROBO_LX16A_HEAT, GROBO_LX16A_HEAT_READ, NULL, 1},
    {0, GROBO_LX16A_TEMPERATURE_READ, NULL, 1},
    {0, GROBO_LX16A_VOLTAGE_READ, NULL, 2},
    {0, GROBO_LX16A_POSITION_READ, NULL, 2},
    {GROBO_LX16A_MODE, GROBO_LX16A_MODE_READ, NULL, 4},
    {GROBO_LX16A_LOAD, GROBO_LX16A_LOAD_READ, NULL, 1},
    {GROBO_LX16A_LED, GROBO_LX16A_LED_READ, NULL, 1},
    {GROBO_LX16A_ALARM, GROBO_LX16A_ALARM_READ, NULL, 1},
};

/* Fields have the address 8 * the order's place, and on. */
#define FIELD(name_, order_, at, bytes_, sign_, role_, unit_, min_, max_)                          \
    {                                                                                              \
        .name = (name_), .unit = (unit_), .min = (min_), .max = (max_),                            \
        .address = 8 * (order_) + (at), .bytes = (bytes_), .sign = (sign_),                        \
        .role = GROBO_ROLE_##role_, .flags = GROBO_REGISTER_W                                      \
    }

static const grobo_servo_register fields[] = {
    FIELD("position", 0, 0, 2, 0, GOAL, "0.24 deg", 0, 1000),
    FIELD("time", 0, 2, 2, 0, GOAL_TIME, "1 ms", 0, 30000),
    FIELD("position", 1, 0, 2, 0, GOAL, "0.24 deg", 0, 1000),
    FIELD("time", 1, 2, 2, 0, GOAL_TIME, "1 ms", 0, 30000),
    FIELD("id", 4, 0, 1, 0, ID, "", 0, 253),
    FIELD("offset", 5, 0, 1, 1, OFFSET, "0.24 deg", -125, 125),
    FIELD("min_position", 7, 0, 2, 0, MIN_POSITION, "0.24 deg", 0, 1000),
    FIELD("max_position", 7, 2, 2, 0, MAX_POSITION, "0.24 deg", 0, 1000),
    FIELD("min_voltage", 8, 0, 2, 0, MIN_VOLTAGE, "1 mV", 4500, 12000),
    FIELD("max_voltage", 8, 2, 2, 0, MAX_VOLTAGE, "1 mV", 4500, 12000),
    FIELD("temperature_limit", 9, 0, 1, 0, TEMPERATURE_LIMIT, "deg C", 50, 100),
    FIELD("temperature", 10, 0, 1, 0, TEMPERATURE, "deg C", 0, 255),
    FIELD("voltage", 11, 0, 2, 0, VOLTAGE, "1 mV", 0, 65535),
    FIELD("present_position", 12, 0, 2, 1, POSITION, "0.24 deg", -32768, 32767),
    FIELD("motor_mode", 13, 0, 1, 0, MODE, "", 0, 1),
    FIELD("speed", 13, 2, 2, 1, GOAL_SPEED, "0.1 %", -1000, 1000),
    FIELD("torque", 14, 0, 1, 0, TORQUE, "", 0, 1),
    FIELD("led_off", 15, 0, 1, 0, NONE, "", 0, 1),
    FIELD("led_alarm", 16, 0, 1, 0, NONE, "bits", 0, 7),
};

static const grobo_servo_table table;

static const grobo_servo_model models[] = {
    {.name = "LX-16A", .span_ticks = 1000, .span_deg = 240, .middle = 500, .table = &table}};

static const uint64_t one_model[] = {1};

static const grobo_servo_table table = {.name = "Hiwonder LX",
                                        .registers = fields,
                                        .models = models,
                                        .sets = one_model,
                                        .register_count = sizeof fields / sizeof *fields,
                                        .model_count = 1};

static const order *order_of(uint8_t command)
{
    for (size_t i = 0; command > 0 && i < sizeof orders / sizeof *orders; i++) {
        if (orders[i].write == command || orders[i].read == command) {
            return &orders[i];
        }
    }
    return NULL;
}

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n);

static int peek(const grobo_words_look *look, grobo_words_frame *found)
{
    unsigned accept =
        look->from_robot ? GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS : GROBO_ACCEPT_COMMANDS;
    int size = grobo_lx16a_measure(look->bytes, look->n, accept);
    found->sum_ok = size != GROBO_ERR_CHECKSUM;
    size = size == GROBO_ERR_CHECKSUM ? look->bytes[3] + 3 : size;
    if (size > 0) {
        size_t data = (size_t)size - GROBO_LX16A_OVERHEAD_BYTES;
        found->reply =
            look->from_robot && data > 0 && grobo_lx16a_reply_bytes(look->bytes[4]) == data;
        found->echo = !found->reply && !look->from_host;
        found->sent = found->reply ? grobo_i_words_asked(answers, look, (size_t)size) : NULL;
    }
    return size < 0 ? GROBO_ERR_FRAME : size;
}

static const char *why(const uint8_t *bytes, size_t n)
{
    if (n < 3 || bytes[0] != 0x55 || bytes[1] != 0x55) {
        return NULL;
    }
    if (bytes[2] > GROBO_LX16A_ID_ALL) {
        return "no servo has this id";
    }
    return n > 3 && (bytes[3] < 3 || bytes[3] > 7) ? "no frame has this length" : NULL;
}

static bool answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n)
{
    return grobo_lx16a_answer(sent->bytes, sent->n, bytes, n) == (int)n;
}

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, grobo_telegram *to)
{
    const order *o = order_of(bytes[4]);
    int length = (int)n - GROBO_LX16A_OVERHEAD_BYTES;
    grobo_i_words_sum(bytes, n, to);
    to->id = bytes[2];
    to->all = bytes[2] == GROBO_LX16A_ID_ALL;
    to->reply = as->reply;
    to->code = bytes[4];
    memcpy(to->data, bytes + 5, (size_t)length);
    if (!o) {
        return;
    }
    bool reads = o->read == bytes[4] && !as->reply;
    to->action = as->reply ? "returns" : reads ? "read" : o->action ? o->action : "write";
    if (!reads && length < o->bytes) {
        snprintf(to->trouble, sizeof to->trouble, "its parameters are missing");
    }
    if (o->bytes > 0 && (reads || length > 0)) {
        to->part[0] = (grobo_telegram_part){to->id, 8 * (int)(o - orders),
                                            reads ? o->bytes : length, reads ? NULL : to->data};
        to->n_parts = 1;
    }
}

static const grobo_words words = {.name = "lx16a",
                                  .title = "Hiwonder LX",
                                  .table = &table,
                                  .peek = peek,
                                  .why = why,
                                  .protocol = &grobo_i_lx16a_protocol,
                                  .answers = answers,
                                  .explain = explain};

const grobo_words *const grobo_i_words_lx16a[] = {&words, NULL};
