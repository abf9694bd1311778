/* SPDX-License-Identifier: MIT */
/* Traces of grctl: what is written is read; what others write is read; what is broken is told. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/conn/pcapng.h"
#include "tools/grctl/os/os.h"

enum { FILE_BYTES = 16384 };

/* A file in memory: written by the code under test or put together here, read by the reader. */
typedef struct image {
    uint8_t bytes[FILE_BYTES];
    size_t used, at;
    bool big_endian;
    size_t block; /* where the present block begins */
} image;

static size_t read_image(void *ctx, void *buffer, size_t size)
{
    image *i = ctx;
    size_t n = i->used - i->at < size ? i->used - i->at : size;
    memcpy(buffer, i->bytes + i->at, n);
    i->at += n;
    return n;
}

/* What was written to a temporary file becomes the image. */
static void take_file(image *i, FILE *from)
{
    rewind(from);
    i->used = fread(i->bytes, 1, sizeof i->bytes, from);
    fclose(from);
}

static void add(image *i, uint64_t value, int bytes)
{
    assert_true(i->used + (size_t)bytes <= sizeof i->bytes);
    for (int k = 0; k < bytes; k++) {
        int shift = 8 * (i->big_endian ? bytes - 1 - k : k);
        i->bytes[i->used++] = (uint8_t)(value >> shift);
    }
}

static void set_u32(image *i, size_t at, uint32_t value)
{
    size_t used = i->used;
    i->used = at;
    add(i, value, 4);
    i->used = used;
}

static void begin_block(image *i, uint32_t type)
{
    i->block = i->used;
    add(i, type, 4);
    add(i, 0, 4);
}

static void end_block(image *i)
{
    uint32_t total = (uint32_t)(i->used - i->block) + 4;
    add(i, total, 4);
    set_u32(i, i->block + 4, total);
}

static void add_section(image *i, bool big_endian)
{
    i->big_endian = big_endian;
    begin_block(i, 0x0A0D0D0A);
    add(i, 0x1A2B3C4D, 4);
    add(i, 1, 2);
    add(i, 0, 2);
    add(i, UINT64_MAX, 8);
    end_block(i);
}

/* resolution < 0: the option is left out */
static void add_interface(image *i, uint16_t link_type, int resolution, int64_t offset_s)
{
    begin_block(i, 1);
    add(i, link_type, 2);
    add(i, 0, 2);
    add(i, 65535, 4);
    if (resolution >= 0) {
        add(i, 9, 2);
        add(i, 1, 2);
        add(i, (uint64_t)resolution << (i->big_endian ? 24 : 0), 4);
    }
    if (offset_s != 0) {
        add(i, 14, 2);
        add(i, 8, 2);
        add(i, (uint64_t)offset_s, 8);
    }
    end_block(i);
}

static void begin_packet(image *i, uint32_t interface, uint64_t time, uint32_t size)
{
    begin_block(i, 6);
    add(i, interface, 4);
    add(i, time >> 32, 4);
    add(i, time & 0xFFFFFFFFu, 4);
    add(i, size, 4);
    add(i, size, 4);
}

/* A packet of four bytes 41 00 07 08. */
static void add_packet(image *i, uint32_t interface, uint64_t time)
{
    static const uint8_t bytes[] = {0x41, 0x00, 0x07, 0x08};
    begin_packet(i, interface, time, sizeof bytes);
    for (size_t k = 0; k < sizeof bytes; k++) {
        add(i, bytes[k], 1);
    }
    end_block(i);
}

static void write_chunk(FILE *to, int64_t time_us, pcapng_direction direction, const uint8_t *bytes,
                        size_t size)
{
    uint8_t packet[PCAPNG_PACKET_BYTES];
    size_t made = pcapng_make_chunk(packet, 0, time_us, direction, bytes, size);
    assert_int_equal(fwrite(packet, 1, made, to), made);
}

static void write_sample(image *i)
{
    static const uint8_t sent[] = {0x41, 0x00};
    static const uint8_t received[] = {0x07, 0xFD, 0xDF, 0x01, 0x00};
    pcapng_interface interface = {.name = "/dev/ttyUSB0",
                                  .description = "a robot",
                                  .speed_bps = 115200,
                                  .link_type = PCAPNG_LINK_USER0};
    FILE *to = os_temporary();
    assert_non_null(to);
    assert_int_equal(pcapng_write_head(to, "test", "what was done", &interface, 1), 0);
    write_chunk(to, 1700000000123456, PCAPNG_OUT, sent, 2);
    write_chunk(to, 1700000000123999, PCAPNG_IN, received, 5);
    take_file(i, to);
}

static int read_all(image *i, pcapng_reader *reader, int *chunks)
{
    pcapng_chunk chunk;
    int result;
    i->at = 0;
    *chunks = 0;
    pcapng_reader_init(reader, read_image, i);
    while ((result = pcapng_read(reader, &chunk)) > 0) {
        assert_in_range(chunk.size, 1, PCAPNG_CHUNK_BYTES);
        assert_in_range(*chunks, 0, FILE_BYTES);
        (*chunks)++;
    }
    return result;
}

/* The result of reading the whole image, which must be an error that is told. */
static int problem_of(image *i, const char *told)
{
    static pcapng_reader reader;
    int chunks;
    int result = read_all(i, &reader, &chunks);
    assert_true(result < 0);
    assert_non_null(strstr(reader.problem, told));
    assert_non_null(strstr(reader.problem, "byte "));
    return result;
}

TEST(what_is_written_is_read)
{
    static image i;
    static pcapng_reader r;
    pcapng_chunk chunk;
    i = (image){0};
    write_sample(&i);
    assert_true(pcapng_is_start(i.bytes));
    assert_int_equal(i.used % 4, 0);
    pcapng_reader_init(&r, read_image, &i);
    assert_int_equal(pcapng_read(&r, &chunk), 1);
    assert_string_equal(r.comment, "what was done");
    assert_string_equal(chunk.interface->name, "/dev/ttyUSB0");
    assert_string_equal(chunk.interface->description, "a robot");
    assert_int_equal(chunk.interface->speed_bps, 115200);
    assert_int_equal(chunk.interface->link_type, 147);
    assert_int_equal(chunk.time_us, 1700000000123456);
    assert_int_equal(chunk.direction, PCAPNG_OUT);
    assert_int_equal(chunk.size, 2);
    assert_memory_equal(chunk.bytes, "\x41\x00", 2);
    assert_string_equal(chunk.comment, "");
    assert_int_equal(pcapng_read(&r, &chunk), 1);
    assert_int_equal(chunk.time_us, 1700000000123999);
    assert_int_equal(chunk.direction, PCAPNG_IN);
    assert_int_equal(chunk.size, 5);
    assert_memory_equal(chunk.bytes, "\x07\xFD\xDF\x01\x00", 5);
    assert_int_equal(pcapng_read(&r, &chunk), 0);
    assert_int_equal(pcapng_read(&r, &chunk), 0);
}

TEST(packets_are_of_the_interface_that_they_name)
{
    static image i;
    static pcapng_reader r;
    static const pcapng_interface lines[] = {{.name = "left", .speed_bps = 1000000},
                                             {.name = "right", .speed_bps = 57600}};
    static const int order[] = {1, 0, 1};
    pcapng_chunk chunk;
    FILE *to = os_temporary();
    assert_non_null(to);
    assert_int_equal(pcapng_write_head(to, "test", NULL, lines, 2), 0);
    for (int k = 0; k < 3; k++) {
        uint8_t packet[PCAPNG_PACKET_BYTES];
        const uint8_t byte = (uint8_t)k;
        size_t made = pcapng_make_chunk(packet, order[k], 10 + k, PCAPNG_OUT, &byte, 1);
        assert_int_equal(fwrite(packet, 1, made, to), made);
    }
    take_file(&i, to);
    pcapng_reader_init(&r, read_image, &i);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(pcapng_read(&r, &chunk), 1);
        assert_int_equal(r.n_interfaces, 2);
        assert_string_equal(chunk.interface->name, lines[order[k]].name);
        assert_int_equal(chunk.interface->speed_bps, lines[order[k]].speed_bps);
        assert_int_equal(chunk.bytes[0], k);
    }
    assert_int_equal(pcapng_read(&r, &chunk), 0);
}

/* Byte for byte what the format says: block type, length, interface, time, sizes, data, flags. */
TEST(a_packet_block_is_as_the_format_has_it)
{
    static const uint8_t expected[] = {6, 0, 0, 0, 48, 0, 0, 0, 0, 0, 0, 0, 2,  0, 0, 0,
                                       1, 0, 0, 0, 1,  0, 0, 0, 1, 0, 0, 0, 7,  0, 0, 0,
                                       2, 0, 4, 0, 1,  0, 0, 0, 0, 0, 0, 0, 48, 0, 0, 0};
    static image i;
    static const uint8_t byte = 7;
    FILE *to = os_temporary();
    write_chunk(to, 0x200000001, PCAPNG_IN, &byte, 1);
    take_file(&i, to);
    assert_int_equal(i.used, sizeof expected);
    assert_memory_equal(i.bytes, expected, sizeof expected);
}

TEST(texts_longer_than_kept_are_cut)
{
    static image i;
    static pcapng_reader r;
    pcapng_interface interface = {.link_type = PCAPNG_LINK_USER0};
    static const uint8_t byte = 7;
    char text[1000];
    pcapng_chunk chunk;
    FILE *to = os_temporary();
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    memset(interface.name, 'y', sizeof interface.name - 1);
    memset(interface.description, 'z', sizeof interface.description - 1);
    assert_int_equal(pcapng_write_head(to, text, text, &interface, 1), 0);
    write_chunk(to, 0, PCAPNG_IN, &byte, 1);
    take_file(&i, to);
    pcapng_reader_init(&r, read_image, &i);
    assert_int_equal(pcapng_read(&r, &chunk), 1);
    assert_int_equal(strlen(r.comment), PCAPNG_TEXT_BYTES - 1);
    assert_int_equal(strlen(chunk.interface->name), PCAPNG_TEXT_BYTES - 1);
}

TEST(either_byte_order_any_resolution_several_sections)
{
    static const struct {
        bool big_endian;
        int resolution;
        int64_t offset_s;
        uint64_t time;
        int64_t time_us;
    } rows[] = {
        {false, -1, 0, 1700000000123456, 1700000000123456},
        {true, -1, 0, 1700000000123456, 1700000000123456},
        {true, 6, 100, 5, 100000005},
        {false, 9, 0, 1700000000123456789, 1700000000123456},
        {true, 9, -10, 12345678900, 2345678},
        {false, 3, 0, 1234, 1234000},
        {false, 0, 0, 7, 7000000},
        {true, 0x80 | 10, 0, 1536, 1500000},
        {false, 0x80 | 20, 0, 0x180000, 1500000},
        {false, 12, 0, 1500000000000, 1500000},
    };
    static image i;
    static pcapng_reader r;
    pcapng_chunk chunk;
    i = (image){0};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        add_section(&i, rows[k].big_endian);
        add_interface(&i, PCAPNG_LINK_USER0, rows[k].resolution, rows[k].offset_s);
        add_packet(&i, 0, rows[k].time);
    }
    pcapng_reader_init(&r, read_image, &i);
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        assert_int_equal(pcapng_read(&r, &chunk), 1);
        assert_int_equal(chunk.time_us, rows[k].time_us);
        assert_int_equal(chunk.direction, PCAPNG_UNKNOWN);
        assert_int_equal(chunk.size, 4);
        assert_memory_equal(chunk.bytes, "\x41\x00\x07\x08", 4);
    }
    assert_int_equal(pcapng_read(&r, &chunk), 0);
}

TEST(unknown_blocks_and_options_are_skipped)
{
    static image i;
    static pcapng_reader r;
    pcapng_chunk chunk;
    i = (image){0};
    add_section(&i, true);
    begin_block(&i, 0x80000001);
    add(&i, 0x1234567812345678, 8);
    end_block(&i);
    add_interface(&i, PCAPNG_LINK_USER0, -1, 0);
    begin_block(&i, 5); /* interface statistics */
    end_block(&i);
    begin_packet(&i, 0, 1, 2);
    add(&i, 0x41000000, 4);
    add(&i, 0x7FFF, 2); /* an option of nobody's, 5 bytes */
    add(&i, 5, 2);
    add(&i, 0, 8);
    add(&i, 1, 2); /* a comment */
    add(&i, 3, 2);
    add(&i, 0x686F0A00, 4); /* "ho\n" */
    add(&i, 2, 2);          /* flags: outbound, and others */
    add(&i, 4, 2);
    add(&i, 0xFF000002, 4);
    end_block(&i);
    pcapng_reader_init(&r, read_image, &i);
    assert_int_equal(pcapng_read(&r, &chunk), 1);
    assert_int_equal(chunk.size, 2);
    assert_string_equal(chunk.comment, "ho ");
    assert_int_equal(chunk.direction, PCAPNG_OUT);
    assert_int_equal(r.skipped, 2);
    assert_int_equal(pcapng_read(&r, &chunk), 0);
}

TEST(what_is_broken_is_told)
{
    static image i;
    i = (image){.used = 0};
    assert_int_equal(problem_of(&i, "not a pcapng"), GROBO_ERR_TYPE);
    i = (image){.bytes = "53 0C FA AF 03 00", .used = 17};
    assert_int_equal(problem_of(&i, "not a pcapng"), GROBO_ERR_TYPE);
    i = (image){0};
    add_section(&i, false);
    add_packet(&i, 0, 0);
    assert_int_equal(problem_of(&i, "not described"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    add_interface(&i, 1, -1, 0);
    add_packet(&i, 0, 0);
    assert_int_equal(problem_of(&i, "link type 1"), GROBO_ERR_TYPE);
    i = (image){0};
    add_section(&i, false);
    add_interface(&i, PCAPNG_LINK_USER0, -1, 0);
    add_packet(&i, 0, 0);
    i.bytes[i.used - 4]++;
    assert_int_equal(problem_of(&i, "lengths differ"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    i.bytes[8]++;
    assert_int_equal(problem_of(&i, "byte order"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    i.bytes[12]++;
    assert_int_equal(problem_of(&i, "version 2"), GROBO_ERR_SYNTAX);
}

TEST(lengths_that_lie_are_told)
{
    static image i;
    i = (image){0};
    add_section(&i, false);
    set_u32(&i, 4, 24);
    assert_int_equal(problem_of(&i, "impossible length"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    begin_block(&i, 77);
    end_block(&i);
    set_u32(&i, i.block + 4, 0xFFFFFFFC);
    assert_int_equal(problem_of(&i, "impossible length"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    add_interface(&i, PCAPNG_LINK_USER0, -1, 0);
    begin_packet(&i, 0, 0, 0xFFFFFFFF);
    end_block(&i);
    assert_int_equal(problem_of(&i, "more than"), GROBO_ERR_CAP);
    i = (image){0};
    add_section(&i, false);
    add_interface(&i, PCAPNG_LINK_USER0, -1, 0);
    begin_packet(&i, 0, 0, 64); /* but nothing follows */
    end_block(&i);
    assert_int_equal(problem_of(&i, "too short"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    begin_block(&i, 1);
    add(&i, PCAPNG_LINK_USER0, 4);
    add(&i, 0, 4);
    add(&i, 2, 2);
    add(&i, 0xFFFF, 2);
    end_block(&i);
    assert_int_equal(problem_of(&i, "option is longer"), GROBO_ERR_SYNTAX);
    i = (image){0};
    add_section(&i, false);
    for (int k = 0; k <= PCAPNG_INTERFACES_MAX; k++) {
        add_interface(&i, PCAPNG_LINK_USER0, -1, 0);
    }
    assert_int_equal(problem_of(&i, "interfaces"), GROBO_ERR_CAP);
}

TEST(a_file_cut_off_anywhere_gives_what_is_whole)
{
    static image whole, part;
    static pcapng_reader reader;
    int clean = 0;
    write_sample(&whole);
    for (size_t n = 0; n < whole.used; n++) {
        int chunks;
        int result;
        part = whole;
        part.used = n;
        result = read_all(&part, &reader, &chunks);
        if (result == 0) {
            clean++; /* at the end of a block */
        } else {
            assert_int_equal(result, n < 8 ? GROBO_ERR_TYPE : GROBO_ERR_SHORT);
        }
        assert_true(chunks <= 1);
    }
    assert_int_equal(clean, 3);
}

TEST(no_flipped_byte_does_harm)
{
    static image whole, bad;
    static pcapng_reader reader;
    static const uint8_t flips[] = {0x01, 0x80, 0xFF};
    write_sample(&whole);
    for (size_t n = 0; n < whole.used; n++) {
        for (size_t k = 0; k < sizeof flips; k++) {
            int chunks;
            int result;
            bad = whole;
            bad.bytes[n] ^= flips[k];
            result = read_all(&bad, &reader, &chunks);
            assert_true(chunks <= 2);
            assert_true(result == 0 ? *reader.problem == '\0' : *reader.problem != '\0');
        }
    }
}
