/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "src/base/assert.h"
#include "src/bus/framer.h"

void grobo_i_framer_init(grobo_framer *framer)
{
    memset(framer, 0, offsetof(grobo_framer, buf));
}

/* Drops the first n bytes, which are at least those of the frame that was handed out. */
static void discard(grobo_framer *framer, size_t n)
{
    GROBO_ASSERT(framer->taken <= n && n <= framer->used);
    framer->used = (uint16_t)(framer->used - n);
    framer->taken = 0;
    memmove(framer->buf, framer->buf + n, framer->used);
}

size_t grobo_i_framer_feed(grobo_framer *framer, const uint8_t *bytes, size_t n)
{
    if (framer->ending || n == 0) {
        return 0;
    }
    discard(framer, framer->taken);
    size_t room = sizeof framer->buf - framer->used;
    size_t took = n < room ? n : room;
    memcpy(framer->buf + framer->used, bytes, took);
    framer->used = (uint16_t)(framer->used + took);
    GROBO_ASSERT(framer->used <= sizeof framer->buf);
    return took;
}

size_t grobo_i_framer_next(grobo_framer *framer, grobo_i_measure measure, unsigned accept)
{
    size_t at = framer->taken;
    int size = 0;
    while (at < framer->used) {
        size = measure(framer->buf + at, framer->used - at, accept);
        bool may_grow = framer->used - at < sizeof framer->buf && !framer->ending;
        if (size > 0 || (size == 0 && may_grow)) {
            break;
        }
        if (size == GROBO_ERR_CHECKSUM) {
            framer->stats.bad_sums++;
        }
        size = 0;
        at++;
    }
    framer->stats.dropped_bytes += (uint32_t)(at - framer->taken);
    discard(framer, at);
    if (size == 0) {
        framer->ending = false;
        return 0;
    }
    GROBO_ASSERT(size > 0 && size <= framer->used);
    framer->taken = (uint16_t)size;
    framer->stats.frames++;
    framer->stats.frame_bytes += (uint32_t)size;
    return (size_t)size;
}

void grobo_i_framer_end(grobo_framer *framer)
{
    framer->ending = grobo_i_framer_pending(framer) > 0;
}

void grobo_i_framer_reset(grobo_framer *framer)
{
    framer->stats.dropped_bytes += (uint32_t)grobo_i_framer_pending(framer);
    framer->used = 0;
    framer->taken = 0;
    framer->ending = false;
}

size_t grobo_i_framer_pending(const grobo_framer *framer)
{
    GROBO_ASSERT(framer->taken <= framer->used);
    return (size_t)(framer->used - framer->taken);
}
