/* SPDX-License-Identifier: MIT */
/*
 * A servo model's file while it is read. A file says what differs from the one that it is `like`;
 * the generator of the library's tables and the reader of a user's own model share this.
 */
#ifndef GROBO_ROBOTS_SERVO_H
#define GROBO_ROBOTS_SERVO_H

#include <grobo/core/registers.h>

#include "src/motion/format/fields.h"

enum {
    GROBO_I_SERVO_ROWS = 192,
    GROBO_I_SERVO_RATES = 16,
    GROBO_I_SERVO_SOURCES = 12,
    GROBO_I_SERVO_INDIRECTS = 4, /* runs of them */
    GROBO_I_SERVO_LIKES = 4      /* files that are like one that is like ... */
};

typedef char grobo_i_servo_text[48];

/* Where facts of a register come from, bits of grobo_i_servo_draft.source[]. */
typedef struct grobo_i_servo_row {
    grobo_servo_register reg; /* name and unit point into the row that is filled at the end */
    grobo_i_servo_text name, unit;
    uint32_t layout, values; /* address and size; default and range */
    grobo_i_place place;     /* where a file spoke of it last */
} grobo_i_servo_row;

typedef struct grobo_i_servo_draft grobo_i_servo_draft;

struct grobo_i_servo_draft {
    grobo_i_servo_text name;
    grobo_servo_model model;
    uint8_t keeps;
    bool big_endian;
    bool no_joint;   /* it cannot tell its position, or not hold one */
    bool unverified; /* its speed, torque or current is from memory */
    int n_rows, n_rates, n_sources, n_indirect;
    grobo_i_servo_row rows[GROBO_I_SERVO_ROWS];
    grobo_servo_rate rates[GROBO_I_SERVO_RATES];
    grobo_servo_indirect indirect[GROBO_I_SERVO_INDIRECTS];
    grobo_i_servo_text source[GROBO_I_SERVO_SOURCES];
    uint32_t layout, values; /* sources of the file that is being read */
    grobo_i_place place;     /* of what concerns the whole; 0: the file */
    grobo_i_place scale;
    int depth;
    /* Fills the draft with the model or file of this name; complains where there is none. */
    int (*like)(grobo_i_servo_draft *draft, grobo_i_reader *reader, const char *name,
                grobo_i_place place);
    void *ctx;
};

/* Reads a file over what the draft holds already. @return 0 or an error that is said. */
int grobo_i_servo_read(grobo_i_reader *reader, grobo_i_servo_draft *draft);

/* Fills the draft with a model of a table. */
void grobo_i_servo_copy(grobo_i_servo_draft *draft, const grobo_servo_model *model);

/* Complains of what is missing, overlaps or is out of range, and sorts the registers. */
int grobo_i_servo_finish(grobo_i_reader *reader, grobo_i_servo_draft *draft);

/* A role as files spell it, "goal_current". */
const char *grobo_i_role_name(grobo_register_role role);

#endif
