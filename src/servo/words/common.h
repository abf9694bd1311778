/* SPDX-License-Identifier: MIT */
/* For the words of a family (words.c in its directory). */
#ifndef GROBO_SERVO_WORDS_COMMON_H
#define GROBO_SERVO_WORDS_COMMON_H

#include <grobo/core/words.h>

/* What of packets is believed: GROBO_ACCEPT_... */
unsigned grobo_i_words_accept(const grobo_words_look *look);

/* Another thing that a reply reports. */
void grobo_i_words_status(grobo_telegram *to, const char *text);

/* The sum of DYNAMIXEL 1.0 and LX: of the bytes behind the header, inverted. */
void grobo_i_words_sum(const uint8_t *bytes, size_t n, grobo_telegram *to);

/* As grobo_words.answers. */
typedef bool (*grobo_i_words_answers)(const grobo_words_sent *sent, const uint8_t *bytes, size_t n);

/* The request that a frame of `size` bytes answers, or NULL. */
const grobo_words_sent *grobo_i_words_asked(grobo_i_words_answers answers,
                                            const grobo_words_look *look, size_t size);

/* Whether the bytes begin as one of the requests does, which an adapter returns. Its size, 0 for
 * more bytes, -1: no. */
int grobo_i_words_echo(const grobo_words_look *look);

#endif
