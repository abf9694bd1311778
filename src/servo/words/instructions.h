/* SPDX-License-Identifier: MIT */
/*
 * What instructions of DYNAMIXEL and Feetech say, whatever the frame around them: a packet of
 * Protocol 1.0 is read as one of 2.0 with the same fields.
 */
#ifndef GROBO_SERVO_WORDS_INSTRUCTIONS_H
#define GROBO_SERVO_WORDS_INSTRUCTIONS_H

#include <grobo/core/dxl1.h>
#include <grobo/core/dxl2.h>
#include <grobo/core/words.h>

/* Who has an instruction. */
enum { GROBO_I_WORDS_X = 1, GROBO_I_WORDS_AX_MX = 2, GROBO_I_WORDS_STS = 4, GROBO_I_WORDS_SCS = 8 };

/* "write", or NULL for one that there is not. */
const char *grobo_i_words_action(unsigned code);
/* Another part of a telegram; NULL: there is no room. */
grobo_telegram_part *grobo_i_words_part(grobo_telegram *to, int id, int address, int length);
void grobo_i_words_instruction(grobo_telegram *to, const grobo_dxl2_packet *p, unsigned series);
/* A status of one servo, which was asked for this. */
void grobo_i_words_reply(grobo_telegram *to, const grobo_dxl2_packet *p, const grobo_reply *asked);
/* What a request asks servo `id` for; sent NULL: nothing. */
void grobo_i_words_ask_of(const grobo_protocol *protocol, const grobo_words_sent *sent, int id,
                          grobo_reply *asked);

#endif
