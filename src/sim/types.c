/* SPDX-License-Identifier: MIT */
/* The servos that can be simulated: what tells one from another is a row of this table. */
#include <string.h>

#include "src/base/bytes.h"
#include "src/sim/registers.h"

/*
 * Name, model, stall current, speed (0.11 and 0.16 s for 60 degrees at 7.4 V), early:
 * RS301CR/RS302CD manual. That RS303MR and RS304MD move as these two do is
 * an assumption.
 */
static const grobo_sim_type types[] = {
    {"RS301CR", GROBO_RS30X_RS301CR, 1200, 545455, true},
    {"RS302CD", GROBO_RS30X_RS302CD, 900, 375000, true},
    {"RS303MR", GROBO_RS30X_RS303MR, 1200, 545455, false},
    {"RS304MD", GROBO_RS30X_RS304MD, 900, 375000, false},
};

enum { TYPES = sizeof types / sizeof *types };

const grobo_sim_type *grobo_sim_type_row(size_t index)
{
    return index < TYPES ? &types[index] : NULL;
}

static char upper(char c)
{
    return c >= 'a' && c <= 'z' ? (char)(c - 'a' + 'A') : c;
}

static bool is_called(const grobo_sim_type *type, const char *name, size_t length)
{
    size_t i = 0;
    while (i < length && type->name[i] != '\0' && upper(name[i]) == type->name[i]) {
        i++;
    }
    return i == length && type->name[i] == '\0';
}

const grobo_sim_type *grobo_sim_type_named(const char *name, size_t length)
{
    if (name == NULL && length > 0) {
        return NULL;
    }
    for (size_t i = 0; i < TYPES; i++) {
        if (is_called(&types[i], name, length)) {
            return &types[i];
        }
    }
    return NULL;
}

const grobo_sim_type *grobo_i_sim_type_of(const grobo_sim_servo *servo)
{
    uint16_t model = grobo_i_get_u16(&servo->reg[GROBO_RS30X_MODEL]);
    for (size_t i = 1; i < TYPES; i++) {
        if (types[i].model == model) {
            return &types[i];
        }
    }
    return &types[0];
}
