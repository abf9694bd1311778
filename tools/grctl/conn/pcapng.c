/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <string.h>

#include "tools/grctl/conn/pcapng.h"
#include "tools/grctl/lang/lang.h"

enum {
    BLOCK_SECTION = 0x0A0D0D0A, /* the same in either byte order */
    BLOCK_INTERFACE = 1,
    BLOCK_PACKET = 6,
    BYTE_ORDER_MAGIC = 0x1A2B3C4D,

    OPTION_END = 0,
    OPTION_COMMENT = 1,
    OPTION_PROGRAM = 4,      /* of a section */
    OPTION_NAME = 2,         /* of an interface */
    OPTION_DESCRIPTION = 3,  /* of an interface */
    OPTION_SPEED = 8,        /* of an interface */
    OPTION_RESOLUTION = 9,   /* of an interface */
    OPTION_TIME_OFFSET = 14, /* of an interface */
    OPTION_FLAGS = 2,        /* of a packet; its two lowest bits are the direction */

    BLOCK_HEAD_BYTES = 8,
    BLOCK_FRAME_BYTES = 12, /* head, and the length again at the end */
    SECTION_BYTES = 16,     /* fixed fields */
    INTERFACE_BYTES = 8,
    PACKET_BYTES = 20,
    OPTION_HEAD_BYTES = 4,

    RESOLUTION_US = 6, /* if_tsresol: ten to the minus six */
    DIRECTION_MASK = 3
};

/* ---- writing -------------------------------------------------------------------------------- */

/* A block under construction. */
typedef struct block {
    uint8_t *bytes;
    size_t used;
} block;

/* The caps of the texts keep the head's blocks in bounds. */
enum { HEAD_BYTES = BLOCK_FRAME_BYTES + SECTION_BYTES + 3 * (PCAPNG_TEXT_BYTES + 8) + 64 };

static void put(uint8_t *to, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        to[i] = (uint8_t)(value >> (8 * i));
    }
}

static void add(block *b, uint64_t value, int bytes)
{
    put(b->bytes + b->used, value, bytes);
    b->used += (size_t)bytes;
}

static size_t padded(size_t n)
{
    return (n + 3) & ~(size_t)3;
}

static void add_bytes(block *b, const void *bytes, size_t n)
{
    memcpy(b->bytes + b->used, bytes, n);
    memset(b->bytes + b->used + n, 0, padded(n) - n);
    b->used += padded(n);
}

static void add_option(block *b, unsigned option, const void *value, size_t n)
{
    add(b, option, 2);
    add(b, n, 2);
    add_bytes(b, value, n);
}

static void add_text(block *b, unsigned option, const char *text)
{
    if (text && *text) {
        add_option(b, option, text, strnlen(text, PCAPNG_TEXT_BYTES - 1));
    }
}

static void add_number(block *b, unsigned option, uint64_t value, int bytes)
{
    uint8_t raw[8];
    put(raw, value, bytes);
    add_option(b, option, raw, (size_t)bytes);
}

static block begin(uint8_t *bytes, uint32_t type)
{
    block b = {.bytes = bytes};
    add(&b, type, 4);
    add(&b, 0, 4); /* the length, by finish() */
    return b;
}

static size_t finish(block *b)
{
    add(b, OPTION_END, 4);
    add(b, b->used + 4, 4);
    put(b->bytes + 4, b->used, 4);
    return b->used;
}

static int write_all(FILE *to, const uint8_t *bytes, size_t size)
{
    return fwrite(bytes, 1, size, to) == size ? GROBO_OK : GROBO_ERR_IO;
}

static int write_interface(FILE *to, const pcapng_interface *interface)
{
    uint8_t bytes[HEAD_BYTES];
    block b = begin(bytes, BLOCK_INTERFACE);
    add(&b, PCAPNG_LINK_USER0, 2);
    add(&b, 0, 2);
    add(&b, 0, 4); /* no limit to a packet's length */
    add_text(&b, OPTION_NAME, interface->name);
    add_text(&b, OPTION_DESCRIPTION, interface->description);
    if (interface->speed_bps) {
        add_number(&b, OPTION_SPEED, interface->speed_bps, 8);
    }
    add_number(&b, OPTION_RESOLUTION, RESOLUTION_US, 1);
    return write_all(to, bytes, finish(&b));
}

int pcapng_write_head(FILE *to, const char *program, const char *comment,
                      const pcapng_interface *interfaces, int n)
{
    uint8_t bytes[HEAD_BYTES];
    block b = begin(bytes, BLOCK_SECTION);
    add(&b, BYTE_ORDER_MAGIC, 4);
    add(&b, 1, 2); /* version 1.0 */
    add(&b, 0, 2);
    add(&b, UINT64_MAX, 8); /* the section's length is not known */
    add_text(&b, OPTION_COMMENT, comment);
    add_text(&b, OPTION_PROGRAM, program);
    int error = write_all(to, bytes, finish(&b));
    for (int i = 0; i < n && !error; i++) {
        error = write_interface(to, &interfaces[i]);
    }
    return error;
}

size_t pcapng_make_chunk(uint8_t *packet, int interface, int64_t time_us,
                         pcapng_direction direction, const uint8_t *bytes, size_t size)
{
    block b = begin(packet, BLOCK_PACKET);
    add(&b, (uint64_t)interface, 4);
    add(&b, (uint64_t)time_us >> 32, 4);
    add(&b, (uint64_t)time_us & 0xFFFFFFFFu, 4);
    add(&b, size, 4);
    add(&b, size, 4);
    add_bytes(&b, bytes, size);
    add_number(&b, OPTION_FLAGS, (uint64_t)direction, 4);
    return finish(&b);
}

/* ---- reading -------------------------------------------------------------------------------- */

static int fail(pcapng_reader *r, int error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static int fail(pcapng_reader *r, int error, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(r->problem, sizeof r->problem, lang_text(format), list);
    va_end(list);
    size_t used = strlen(r->problem);
    snprintf(r->problem + used, sizeof r->problem - used, _(" (byte %llu)"),
             (unsigned long long)r->at);
    r->error = error;
    return error;
}

static uint64_t get(const pcapng_reader *r, const uint8_t *from, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++) {
        value = value << 8 | from[r->big_endian ? i : bytes - 1 - i];
    }
    return value;
}

/* Takes n bytes of the present block; nothing but the block's own bytes. */
static int take(pcapng_reader *r, void *buffer, size_t n)
{
    if (n > r->block_left) {
        return fail(r, GROBO_ERR_SYNTAX, "a block is too short for what it holds");
    }
    size_t got = r->source(r->ctx, buffer, n);
    r->at += got;
    r->block_left -= (uint32_t)got;
    return got == n ? GROBO_OK : fail(r, GROBO_ERR_SHORT, "cut off in the middle of a block");
}

static int skip(pcapng_reader *r, size_t n)
{
    uint8_t rest[512];
    int error = GROBO_OK;
    while (n > 0 && !error) {
        size_t part = n < sizeof rest ? n : sizeof rest;
        error = take(r, rest, part);
        n -= part;
    }
    return error;
}

/* Text of an option: kept up to our cap, without control characters. */
static void keep_text(char *to, const uint8_t *from, size_t n)
{
    if (n > PCAPNG_TEXT_BYTES - 1) {
        n = PCAPNG_TEXT_BYTES - 1;
    }
    for (size_t i = 0; i < n; i++) {
        to[i] = from[i] < 0x20 || from[i] == 0x7F ? ' ' : (char)from[i];
    }
    to[n] = '\0';
}

/* One option of a block; `value` holds the first `n` bytes of it. */
typedef void (*option_fn)(pcapng_reader *r, void *to, unsigned code, const uint8_t *value,
                          size_t n);

/* Reads options until their end or the block's, keeping the first bytes of each. */
static int read_options(pcapng_reader *r, option_fn use, void *to)
{
    uint8_t head[OPTION_HEAD_BYTES];
    uint8_t value[PCAPNG_TEXT_BYTES];
    while (r->block_left >= sizeof head) {
        int error = take(r, head, sizeof head);
        unsigned code = (unsigned)get(r, head, 2);
        size_t length = (size_t)get(r, head + 2, 2);
        size_t kept = length < sizeof value ? length : sizeof value;
        if (error || code == OPTION_END) {
            return error;
        }
        if (padded(length) > r->block_left) {
            return fail(r, GROBO_ERR_SYNTAX, "an option is longer than its block");
        }
        error = take(r, value, kept);
        if (!error) {
            error = skip(r, padded(length) - kept);
        }
        if (error) {
            return error;
        }
        use(r, to, code, value, kept);
    }
    return GROBO_OK;
}

static void section_option(pcapng_reader *r, void *to, unsigned code, const uint8_t *value,
                           size_t n)
{
    (void)r;
    if (code == OPTION_COMMENT) {
        keep_text(to, value, n);
    }
}

static void interface_option(pcapng_reader *r, void *to, unsigned code, const uint8_t *value,
                             size_t n)
{
    pcapng_interface *interface = to;
    if (code == OPTION_NAME) {
        keep_text(interface->name, value, n);
    } else if (code == OPTION_DESCRIPTION) {
        keep_text(interface->description, value, n);
    } else if (code == OPTION_SPEED && n == 8) {
        interface->speed_bps = get(r, value, 8);
    } else if (code == OPTION_RESOLUTION && n == 1) {
        interface->resolution = value[0];
    } else if (code == OPTION_TIME_OFFSET && n == 8) {
        interface->offset_s = (int64_t)get(r, value, 8);
    }
}

static void packet_option(pcapng_reader *r, void *to, unsigned code, const uint8_t *value, size_t n)
{
    pcapng_chunk *chunk = to;
    if (code == OPTION_COMMENT) {
        keep_text(chunk->comment, value, n);
    } else if (code == OPTION_FLAGS && n == 4) {
        unsigned direction = (unsigned)get(r, value, 4) & DIRECTION_MASK;
        chunk->direction = direction == PCAPNG_IN    ? PCAPNG_IN
                           : direction == PCAPNG_OUT ? PCAPNG_OUT
                                                     : PCAPNG_UNKNOWN;
    }
}

/* A section's head tells its byte order behind its length: both are read before either is used. */
static int read_section(pcapng_reader *r, const uint8_t *length)
{
    uint8_t fixed[SECTION_BYTES];
    r->block_left = 4;
    int error = take(r, fixed, 4);
    if (error) {
        return error;
    }
    r->big_endian = false;
    if (get(r, fixed, 4) != BYTE_ORDER_MAGIC) {
        r->big_endian = true;
        if (get(r, fixed, 4) != BYTE_ORDER_MAGIC) {
            return fail(r, GROBO_ERR_SYNTAX, "the section has no byte order");
        }
    }
    uint64_t total = get(r, length, 4);
    if (total % 4 != 0 || total < BLOCK_FRAME_BYTES + SECTION_BYTES ||
        total > PCAPNG_BLOCK_MAX_BYTES) {
        return fail(r, GROBO_ERR_SYNTAX, "the section's head has an impossible length");
    }
    r->block_left = (uint32_t)total - BLOCK_FRAME_BYTES - 4;
    error = take(r, fixed + 4, SECTION_BYTES - 4);
    if (error) {
        return error;
    }
    if (get(r, fixed + 4, 2) != 1) {
        return fail(r, GROBO_ERR_SYNTAX, "version %llu of the format is not known",
                    (unsigned long long)get(r, fixed + 4, 2));
    }
    r->n_interfaces = 0;
    r->comment[0] = '\0';
    return read_options(r, section_option, r->comment);
}

static int read_interface(pcapng_reader *r)
{
    uint8_t fixed[INTERFACE_BYTES];
    pcapng_interface *interface = &r->interfaces[r->n_interfaces];
    if (r->n_interfaces == PCAPNG_INTERFACES_MAX) {
        return fail(r, GROBO_ERR_CAP, "more than %d interfaces", PCAPNG_INTERFACES_MAX);
    }
    int error = take(r, fixed, sizeof fixed);
    if (error) {
        return error;
    }
    memset(interface, 0, sizeof *interface);
    interface->link_type = (uint16_t)get(r, fixed, 2);
    interface->resolution = RESOLUTION_US;
    r->n_interfaces++;
    return read_options(r, interface_option, interface);
}

/* Counts of an interface's resolution to microseconds. Nonsense becomes some time, no overflow. */
static int64_t to_us(const pcapng_interface *interface, uint64_t counts)
{
    const uint64_t most_s = 4000000000000u, million = 1000000u;
    unsigned exponent = interface->resolution & 0x7Fu;
    uint64_t per_s = 1, us;
    int64_t offset_s = interface->offset_s;
    bool binary = interface->resolution & 0x80u;
    for (unsigned i = 0; i < exponent && per_s <= UINT64_MAX / 10; i++) {
        per_s *= binary ? 2 : 10;
    }
    uint64_t s = counts / per_s;
    if (binary) {
        us = (uint64_t)((double)(counts % per_s) / (double)per_s * 1e6 + 0.5);
    } else if (per_s <= million) {
        us = counts % per_s * (million / per_s);
    } else {
        us = counts % per_s / (per_s / million);
    }
    if (s > most_s) {
        s = most_s;
    }
    if (offset_s > (int64_t)most_s || offset_s < -(int64_t)most_s) {
        offset_s = 0;
    }
    return ((int64_t)s + offset_s) * (int64_t)million + (int64_t)us;
}

static int read_packet(pcapng_reader *r, pcapng_chunk *chunk)
{
    uint8_t fixed[PACKET_BYTES];
    int error = take(r, fixed, sizeof fixed);
    if (error) {
        return error;
    }
    uint64_t index = get(r, fixed, 4);
    uint64_t size = get(r, fixed + 12, 4);
    if (index >= r->n_interfaces) {
        return fail(r, GROBO_ERR_SYNTAX, "a packet of an interface that was not described");
    }
    const pcapng_interface *interface = &r->interfaces[index];
    if (interface->link_type != PCAPNG_LINK_USER0) {
        return fail(r, GROBO_ERR_TYPE, "link type %u: not a trace of grctl (%d)",
                    interface->link_type, PCAPNG_LINK_USER0);
    }
    if (size > sizeof r->bytes) {
        return fail(r, GROBO_ERR_CAP, "a packet of more than %zu bytes", sizeof r->bytes);
    }
    memset(chunk, 0, sizeof *chunk);
    chunk->interface = interface;
    chunk->time_us = to_us(interface, get(r, fixed + 4, 4) << 32 | get(r, fixed + 8, 4));
    chunk->bytes = r->bytes;
    chunk->size = (size_t)size;
    error = take(r, r->bytes, chunk->size);
    if (!error) {
        error = skip(r, padded(chunk->size) - chunk->size);
    }
    return error ? error : read_options(r, packet_option, chunk);
}

/* The rest of a block, and its length once more at its end. */
static int end_block(pcapng_reader *r, const uint8_t *length)
{
    uint8_t again[4];
    int error = skip(r, r->block_left);
    if (error) {
        return error;
    }
    r->block_left = sizeof again;
    error = take(r, again, sizeof again);
    if (!error && memcmp(again, length, sizeof again) != 0) {
        return fail(r, GROBO_ERR_SYNTAX, "a block's two lengths differ");
    }
    return error;
}

/* One block that is no section. 1: *chunk has a packet. */
static int read_block(pcapng_reader *r, uint32_t type, const uint8_t *length, pcapng_chunk *chunk)
{
    uint64_t total = get(r, length, 4);
    int found = 0;
    if (total % 4 != 0 || total < BLOCK_FRAME_BYTES || total > PCAPNG_BLOCK_MAX_BYTES) {
        return fail(r, GROBO_ERR_SYNTAX, "a block has an impossible length");
    }
    r->block_left = (uint32_t)total - BLOCK_FRAME_BYTES;
    if (type == BLOCK_INTERFACE) {
        found = read_interface(r);
    } else if (type == BLOCK_PACKET) {
        found = read_packet(r, chunk);
        if (!found) {
            found = chunk->size > 0;
        }
    } else {
        r->skipped++;
    }
    return found;
}

bool pcapng_is_start(const uint8_t *bytes)
{
    static const uint8_t start[] = {0x0A, 0x0D, 0x0D, 0x0A};
    return memcmp(bytes, start, sizeof start) == 0;
}

void pcapng_reader_init(pcapng_reader *reader, pcapng_source source, void *ctx)
{
    memset(reader, 0, sizeof *reader);
    reader->source = source;
    reader->ctx = ctx;
}

int pcapng_read(pcapng_reader *reader, pcapng_chunk *chunk)
{
    uint8_t head[BLOCK_HEAD_BYTES];
    int found = 0;
    while (!reader->error && found == 0) {
        size_t got = reader->source(reader->ctx, head, sizeof head);
        reader->at += got;
        if (got == 0 && reader->begun) {
            return 0;
        }
        if (got == sizeof head && pcapng_is_start(head)) {
            found = read_section(reader, head + 4);
        } else if (!reader->begun) {
            return fail(reader, GROBO_ERR_TYPE, "is not a pcapng file");
        } else if (got < sizeof head) {
            return fail(reader, GROBO_ERR_SHORT, "cut off in the head of a block");
        } else {
            found = read_block(reader, (uint32_t)get(reader, head, 4), head + 4, chunk);
        }
        reader->begun = true;
        if (found >= 0 && end_block(reader, head + 4) < 0) {
            break;
        }
    }
    return reader->error ? reader->error : found;
}
