/* SPDX-License-Identifier: MIT */
/* Telegrams in words, for people and for scripts. */
#ifndef GRCTL_EXPLAIN_H
#define GRCTL_EXPLAIN_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"
#include "tools/grctl/decode/saytext.h"

/* A register in a part; bytes of none (reg NULL), or of one that is not there as a whole. */
typedef struct explain_item {
    const grobo_servo_model *servo;
    const grobo_servo_register *reg;
    int address, bytes;
    int32_t value;
    bool whole;
} explain_item;

/* What stands at an offset of a part that has data or asks for them. */
explain_item explain_item_at(const grobo_servo_model *servo, const grobo_telegram_part *part,
                             int at);

/* A part for scripts. Reserved bytes are told where they are not 0. */
json_t *explain_part(const talk *who, const grobo_servo_model *servo,
                     const grobo_telegram_part *part);

/* What a frame says, without its newline; explain_shares() has a line for each servo of it. */
void explain_say(text *t, const frame *f, const grobo_telegram *said);
void explain_shares(text *t, const grobo_telegram *said);

/* What a frame is answered by. As frame_reply(); GROBO_ERR_TYPE for what is no command,
 * GROBO_ERR_MISMATCH (with *reply) for a board's frame that wants another number of bytes than its
 * packet will return. */
int explain_expects(const frame *f, grobo_reply *reply);

/* What no servo can do with a whole command of a good sum: a code ("request", "range") and why, or
 * NULL. */
const char *explain_offence(const talk *who, const uint8_t *bytes, size_t n,
                            const grobo_telegram *said, char *why, size_t capacity);

/* The same for scripts: members of the frame's object, as words_json() has them; NULL: nothing. */
json_t *explain_packet(const frame *f, const grobo_telegram *said);

#endif
