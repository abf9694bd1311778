/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/decode/registers.h"

/* What one count of the register table's units is worth. */
typedef struct scale {
    const char *unit;   /* as the table spells it */
    const char *text;   /* as people read it */
    const char *suffix; /* as keys spell it */
    double worth, at_zero;
    int decimals;
} scale;

static const scale scales[] = {
    {"0.1 deg", " deg", "_deg", 0.1, 0, 1}, {"1 deg", " deg", "_deg", 1, 0, 0},
    {"10 ms", " ms", "_ms", 10, 0, 0},      {"deg/s", " deg/s", "_dps", 1, 0, 0},
    {"mA", " mA", "_ma", 1, 0, 0},          {"10 mV", " V", "_v", 0.01, 0, 2},
    {"deg C", " deg C", "_c", 1, 0, 0},     {"1 %", " %", "_pct", 1, 0, 0},
    {"0.01 %", " %", "_pct", 0.01, 0, 2},   {"50 us", " us", "_us", 50, GROBO_RS30X_DELAY_US(0), 0},
    {"code", " bps", "_bps", 1, 0, 0},      {"", "", "", 1, 0, 0},
};

static const scale *scale_of(const grobo_rs30x_register *reg)
{
    const size_t last = sizeof scales / sizeof scales[0] - 1;
    size_t i = 0;
    while (i < last && strcmp(scales[i].unit, reg->unit) != 0) {
        i++;
    }
    return &scales[i];
}

/* Values that have a name; NULL for the others. */
static const char *word_of(const grobo_rs30x_register *reg, int32_t counts)
{
    static const char *const torques[] = {"off", "on", "brake"};
    if (reg->address == GROBO_RS30X_TORQUE && counts >= 0 && counts <= GROBO_TORQUE_BRAKE) {
        return torques[counts];
    }
    if (reg->address == GROBO_RS30X_MODEL) {
        return grobo_rs30x_model_name((uint16_t)counts);
    }
    return NULL;
}

/* The value in the unit of its scale; a code that means nothing stays the code. */
static double value_of(const grobo_rs30x_register *reg, int32_t counts)
{
    const scale *s = scale_of(reg);
    if (reg->address == GROBO_RS30X_BAUD) {
        int32_t baud_bps = grobo_rs30x_baud_bps((uint8_t)counts);
        return baud_bps > 0 ? baud_bps : counts;
    }
    return counts * s->worth + s->at_zero;
}

void registers_text(const grobo_rs30x_register *reg, int32_t counts, char *text, size_t capacity)
{
    const scale *s = scale_of(reg);
    const char *word = word_of(reg, counts);
    if (word) {
        snprintf(text, capacity, "%s", word);
    } else if (reg->address == GROBO_RS30X_BAUD && counts > GROBO_RS30X_BAUD_CODE_MAX) {
        snprintf(text, capacity, "code %d", (int)counts);
    } else {
        snprintf(text, capacity, "%.*f%s", s->decimals, value_of(reg, counts), s->text);
    }
}

void registers_key(const grobo_rs30x_register *reg, char *key, size_t capacity)
{
    snprintf(key, capacity, "%s%s", reg->name, scale_of(reg)->suffix);
}

json_t *registers_json(const grobo_rs30x_register *reg, int32_t counts)
{
    const scale *s = scale_of(reg);
    const char *word = word_of(reg, counts);
    if (word) {
        return json_string(word);
    }
    if (s->decimals == 0) {
        return json_integer((json_int_t)value_of(reg, counts));
    }
    return app_json_number(value_of(reg, counts), s->decimals);
}
