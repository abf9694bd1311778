/* SPDX-License-Identifier: MIT */
/* What frames of Protocol 1.0 say, of DYNAMIXEL and of Feetech. */
#ifndef GROBO_SERVO_DXL1_WORDS_FRAMES_H
#define GROBO_SERVO_DXL1_WORDS_FRAMES_H

#include <grobo/core/words.h>

/* The meanings of the bits of a status' error; NULL: unknown. */
typedef const char *const grobo_i_dxl1_bits[8];

/* Functions of a grobo_words. */
int grobo_i_dxl1_words_peek(const grobo_words_look *look, grobo_words_frame *found);
const char *grobo_i_dxl1_words_why(const uint8_t *bytes, size_t n);
bool grobo_i_dxl1_words_answers(const grobo_words_sent *sent, const uint8_t *bytes, size_t n);
/* series: who has instructions (src/servo/words/instructions.h). */
void grobo_i_dxl1_words_explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as,
                                unsigned series, const grobo_i_dxl1_bits *bits, grobo_telegram *to);

#endif
