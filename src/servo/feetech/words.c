/* SPDX-License-Identifier: MIT */
/* What frames of Feetech's servos say: those of Protocol 1.0, with instructions of their own. */
#include <grobo/core/feetech.h>

#include "src/servo/dxl1/words_frames.h"
#include "src/servo/families.h"
#include "src/servo/tables.h"
#include "src/servo/words/instructions.h"

static void explain(const uint8_t *bytes, size_t n, const grobo_words_frame *as, unsigned series,
                    grobo_telegram *to)
{
    static const grobo_i_dxl1_bits bits = {"voltage out of range",
                                           "its sensor fails",
                                           "too hot",
                                           "too much current",
                                           NULL,
                                           "overload",
                                           NULL,
                                           NULL};
    grobo_i_dxl1_words_explain(bytes, n, as, series, &bits, to);
}

static void explain_sts(const uint8_t *bytes, size_t n, const grobo_words_frame *as,
                        grobo_telegram *to)
{
    explain(bytes, n, as, GROBO_I_WORDS_STS, to);
}

static void explain_scs(const uint8_t *bytes, size_t n, const grobo_words_frame *as,
                        grobo_telegram *to)
{
    explain(bytes, n, as, GROBO_I_WORDS_SCS, to);
}

static const grobo_words sts = {
    .name = "feetech",
    .title = "Feetech STS",
    .table = &grobo_i_sts_table,
    .protocol = &grobo_i_dxl1_protocol,
    .peek = grobo_i_dxl1_words_peek,
    .why = grobo_i_dxl1_words_why,
    .answers = grobo_i_dxl1_words_answers,
    .explain = explain_sts,
};

static const grobo_words scs = {
    .name = "scs",
    .title = "Feetech SCS",
    .table = &grobo_i_scs_table,
    .protocol = &grobo_i_dxl1_protocol,
    .peek = grobo_i_dxl1_words_peek,
    .why = grobo_i_dxl1_words_why,
    .answers = grobo_i_dxl1_words_answers,
    .explain = explain_scs,
};

const grobo_words *const grobo_i_words_feetech[] = {&sts, &scs, NULL};
