/* SPDX-License-Identifier: MIT */
/*
 * The one way bytes are read and written: little-endian get and put, spans that know their end. No
 * pointer is cast onto the wire, so alignment and the machine's byte order do not matter.
 */
#ifndef GROBO_CORE_BYTES_H
#define GROBO_CORE_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint16_t grobo_i_get_u16(const uint8_t *p)
{
    return (uint16_t)(p[0] | p[1] << 8);
}

/* Two's complement, whatever the machine's own idea of a negative number is. */
static inline int16_t grobo_i_get_i16(const uint8_t *p)
{
    int32_t value = grobo_i_get_u16(p);
    return (int16_t)(value < 0x8000 ? value : value - 0x10000);
}

static inline void grobo_i_put_u16(uint8_t *p, uint16_t value)
{
    p[0] = (uint8_t)(value & 0xFF);
    p[1] = (uint8_t)(value >> 8);
}

static inline void grobo_i_put_i16(uint8_t *p, int16_t value)
{
    grobo_i_put_u16(p, (uint16_t)value);
}

/* The sum of a servo packet: XOR. Eight bytes at once where a register has them: a pose takes a
 * fifth of the instructions then. */
static inline uint8_t grobo_i_xor(const uint8_t *p, size_t n)
{
    uint8_t sum = 0;
#if SIZE_MAX > UINT32_MAX
    uint64_t wide = 0;
    for (; n >= sizeof wide; n -= sizeof wide, p += sizeof wide) {
        uint64_t next;
        memcpy(&next, p, sizeof next);
        wide ^= next;
    }
    wide ^= wide >> 32;
    wide ^= wide >> 16;
    sum = (uint8_t)(wide ^ wide >> 8);
#endif
    for (size_t i = 0; i < n; i++) {
        sum ^= p[i];
    }
    return sum;
}

/* Some bytes that end somewhere. */
typedef struct grobo_i_span {
    const uint8_t *data;
    size_t n;
} grobo_i_span;

/* The bytes [offset, offset + n), or NULL when the span does not hold all of them. */
static inline const uint8_t *grobo_i_span_at(grobo_i_span span, size_t offset, size_t n)
{
    return offset <= span.n && n <= span.n - offset ? span.data + offset : NULL;
}

#endif
