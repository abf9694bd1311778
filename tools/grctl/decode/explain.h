/* SPDX-License-Identifier: MIT */
/* Telegrams in words, for people and for scripts. */
#ifndef GRCTL_EXPLAIN_H
#define GRCTL_EXPLAIN_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"
#include "tools/grctl/decode/saytext.h"

/* For RS30x: the last model has all registers. */
#define EXPLAIN_RS30X (&grobo_rs30x_table.models[grobo_rs30x_table.model_count - 1])

/* A register in a part; bytes of none (reg NULL), or of one that is not there as a whole. */
typedef struct explain_item {
    const grobo_servo_model *servo;
    const grobo_servo_register *reg;
    int address, bytes;
    int32_t value;
    bool whole;
} explain_item;

/* What stands at an offset of a part that has data or asks for them. */
explain_item explain_item_at(const grobo_servo_model *servo, const telegram_part *part, int at);

/* What is wrong with writing it; false: nothing. */
bool explain_is_wrong(const explain_item *i, char *why, size_t capacity);

/* A part for scripts. Reserved bytes are told where they are not 0. */
json_t *explain_part(const talk *who, const grobo_servo_model *servo, const telegram_part *part);

/* What a frame of a dialect says, without its newline; for a telegram of shares, explain_shares()
 * has a line for each servo. */
void explain_say(text *t, const frame *f, const telegram *said);
void explain_shares(text *t, const telegram *said);

/* What no servo can do with a whole command of a good sum: a code ("request", "range") and why, or
 * NULL. */
const char *explain_offence(const talk *who, const telegram *said, char *why, size_t capacity);

/* The same for scripts: members of the frame's object, as words_json() has them. */
json_t *explain_packet(const frame *f, const telegram *said);

#endif
