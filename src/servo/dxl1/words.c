/* SPDX-License-Identifier: MIT */
/* What frames of AX and MX say. */
#include <grobo/core/dxl1.h>

#include "src/servo/dxl1/words_frames.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/words/instructions.h"

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, grobo_telegram *to)
{
    static const grobo_i_dxl1_bits bits = {"voltage out of range",
                                           "the goal is outside the limits",
                                           "too hot",
                                           "a value is out of range",
                                           "the sum of the instruction was wrong",
                                           "overload",
                                           "it does not know the instruction",
                                           NULL};
    grobo_i_dxl1_words_explain(bytes, n, as, GROBO_I_WORDS_AX_MX, &bits, to);
}

static const grobo_words words = {
    .name = "dynamixel1",
    .title = "DYNAMIXEL 1.0",
    .table = &grobo_i_dxl1_table,
    .protocol = &grobo_i_dxl1_protocol,
    .peek = grobo_i_dxl1_words_peek,
    .why = grobo_i_dxl1_words_why,
    .answers = grobo_i_dxl1_words_answers,
    .explain = explain,
};

const grobo_words *const grobo_i_words_dxl1[] = {&words, NULL};
