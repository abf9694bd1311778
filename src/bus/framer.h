/* SPDX-License-Identifier: MIT */
/*
 * What every push parser does: keep bytes until a frame is whole, and after a false start go on
 * with the byte behind it, not behind the whole false frame, which may hide a true one.
 */
#ifndef GROBO_CORE_FRAMER_H
#define GROBO_CORE_FRAMER_H

#include <grobo/core/protocol.h>

/* As grobo_protocol.measure. */
typedef int (*grobo_i_measure)(const uint8_t *bytes, size_t n, unsigned accept);

void grobo_i_framer_init(grobo_framer *framer);

/* Takes what fits; 0 of n > 0 only when next has not given 0 yet. */
size_t grobo_i_framer_feed(grobo_framer *framer, const uint8_t *bytes, size_t n);

/* Size of the next frame, which lies at framer->buf; 0 when there is none. */
size_t grobo_i_framer_next(grobo_framer *framer, grobo_i_measure measure, unsigned accept);

/* What is incomplete now will stay so. */
void grobo_i_framer_end(grobo_framer *framer);

void grobo_i_framer_reset(grobo_framer *framer);

size_t grobo_i_framer_pending(const grobo_framer *framer);

#endif
