/* SPDX-License-Identifier: MIT */
/* What words as text and words as JSON share. */
#ifndef GRCTL_WORDS_I_H
#define GRCTL_WORDS_I_H

#include "tools/grctl/decode/frames.h"

/* A joint of GR001 by its servo's id, or NULL. */
const char *words_i_joint(uint8_t id);

/* What a packet holds for one servo. */
typedef struct words_i_part {
    uint8_t id;
    uint8_t address;
    const uint8_t *data;
    size_t n;
} words_i_part;

/* Part number `index` of a packet: 1, or 0 behind the last. */
int words_i_share(const grobo_rs30x_packet *p, int index, words_i_part *part);

/* A register in a part; a byte of none (reg NULL), or of one that is not there as a whole. */
typedef struct words_i_item {
    const grobo_rs30x_register *reg;
    unsigned address;
    int32_t value;
    bool whole;
} words_i_item;

/* What stands at offset `at` of a part: how many bytes it takes. */
size_t words_i_value(const words_i_part *part, size_t at, words_i_item *item);

/* "write", "read", "ping", "flash", "reboot", "flash and reboot", "factory reset", "return". */
const char *words_i_action(const grobo_rs30x_packet *p);

/* The flags of a return packet. */
typedef struct words_i_flag {
    uint8_t bit;
    const char *key, *text;
} words_i_flag;
extern const words_i_flag words_i_status[];
extern const size_t words_i_n_status;

/* The sum that a packet should have, or -1 for one that cannot be built. */
int words_i_right_sum(const grobo_rs30x_packet *p);

/*
 * As frame_reply(); GROBO_ERR_TYPE for what is no command, GROBO_ERR_MISMATCH (with *reply) for a
 * relay frame that wants another number of bytes than its packet will return.
 */
int words_i_expects(const frame *f, grobo_reply *reply);

#endif
