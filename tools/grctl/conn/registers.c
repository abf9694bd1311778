/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/rs30x.h>

#include "tools/grctl/conn/registers.h"

/* Units of the tables, behind the number that says what one count is worth. */
typedef struct scale {
    const char *unit;   /* as a table spells it; "": a plain number, or one of several meanings */
    const char *text;   /* as people read it */
    const char *suffix; /* as keys spell it */
    double worth;
} scale;

static const scale scales[] = {
    {"deg", " deg", "_deg", 1},
    {"deg/s", " deg/s", "_dps", 1},
    {"deg/s2", " deg/s2", "_dps2", 1},
    {"rpm", " rpm", "_rpm", 1},
    {"ms", " ms", "_ms", 1},
    {"us", " us", "_us", 1},
    {"mA", " mA", "_ma", 1},
    {"V", " V", "_v", 1},
    {"mV", " V", "_v", 0.001},
    {"deg C", " deg C", "_c", 1},
    {"%", " %", "_pct", 1},
    {"code", " bps", "_bps", 1},
    {"", "", "", 1},
};

/* What the unit of a register makes of a count. */
typedef struct meaning {
    const scale *scale;
    double worth, at_zero;
    int decimals;
} meaning;

static const scale *scale_called(const char *unit)
{
    size_t i = 0;
    while (*scales[i].unit && strcmp(scales[i].unit, unit) != 0) {
        i++;
    }
    return &scales[i];
}

static bool is_position(const grobo_servo_register *reg)
{
    return reg->role == GROBO_ROLE_GOAL || reg->role == GROBO_ROLE_POSITION ||
           reg->role == GROBO_ROLE_MIN_POSITION || reg->role == GROBO_ROLE_MAX_POSITION;
}

static meaning meaning_of(const grobo_servo_model *servo, const grobo_servo_register *reg)
{
    char *unit = NULL;
    double number = strtod(reg->unit, &unit);
    bool numbered = unit != reg->unit && *unit == ' ';
    meaning m = {.scale = scale_called(numbered ? unit + 1 : reg->unit), .worth = 1};
    if (*m.scale->unit == '\0') {
        return m;
    }
    m.worth = (numbered ? number : 1) * m.scale->worth;
    m.decimals = m.worth == floor(m.worth) ? 0 : m.worth > 0.02 ? 1 : 2;
    if (is_position(reg) && servo) {
        m.worth = (double)servo->span_deg / servo->span_ticks; /* the unit is rounded */
        m.at_zero = -m.worth * servo->middle;
    } else if (reg->role == GROBO_ROLE_RETURN_DELAY && number == 50) {
        m.at_zero = GROBO_RS30X_DELAY_US(0);
    }
    return m;
}

/* Values that have a name; NULL for the others. */
static const char *word_of(const grobo_servo_model *servo, const grobo_servo_register *reg,
                           int32_t counts)
{
    static const char *const torques[] = {"off", "on", "brake"};
    bool brakes = servo && grobo_servo_series(servo) == grobo_rs30x_table();
    if (reg->role == GROBO_ROLE_TORQUE && counts >= 0 && counts <= (brakes ? 2 : 1)) {
        return torques[counts];
    }
    if (reg->role == GROBO_ROLE_MODEL && servo) {
        const grobo_servo_model *model = grobo_servo_model_numbered(servo->table, (uint16_t)counts);
        return model ? model->name : NULL;
    }
    return NULL;
}

/* The value in the unit of its scale; a code that means nothing stays the code. */
static double value_of(const grobo_servo_model *servo, const grobo_servo_register *reg,
                       const meaning *m, int32_t counts)
{
    if (reg->role == GROBO_ROLE_BAUD) {
        int32_t baud_bps = grobo_servo_baud_bps(servo, counts);
        return baud_bps > 0 ? baud_bps : counts;
    }
    return counts * m->worth + m->at_zero;
}

void registers_text(const grobo_servo_model *servo, const grobo_servo_register *reg, int32_t counts,
                    char *text, size_t capacity)
{
    const meaning m = meaning_of(servo, reg);
    const char *word = word_of(servo, reg, counts);
    if (word) {
        snprintf(text, capacity, "%s", word);
    } else if (strcmp(reg->unit, "bits") == 0) {
        snprintf(text, capacity, "%02Xh", (unsigned)counts);
    } else if (reg->role == GROBO_ROLE_BAUD && grobo_servo_baud_bps(servo, counts) < 0) {
        snprintf(text, capacity, "code %d", (int)counts);
    } else {
        double value = value_of(servo, reg, &m, counts);
        double least = m.decimals == 0 ? 0.5 : m.decimals == 1 ? 0.05 : 0.005;
        snprintf(text, capacity, "%.*f%s", m.decimals, fabs(value) < least ? 0 : value,
                 m.scale->text);
    }
}

void registers_key(const grobo_servo_register *reg, char *key, size_t capacity)
{
    snprintf(key, capacity, "%s%s", reg->name, meaning_of(NULL, reg).scale->suffix);
}

json_t *registers_json(const grobo_servo_model *servo, const grobo_servo_register *reg,
                       int32_t counts)
{
    const meaning m = meaning_of(servo, reg);
    const char *word = word_of(servo, reg, counts);
    if (word) {
        return json_string(word);
    }
    if (m.decimals == 0) {
        return json_integer((json_int_t)value_of(servo, reg, &m, counts));
    }
    return app_json_number(value_of(servo, reg, &m, counts), m.decimals);
}
