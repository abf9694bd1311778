/* SPDX-License-Identifier: MIT */
/*
 * pcapng files of one kind: chunks of bytes as they went over a serial line, link type USER0.
 * https://www.ietf.org/archive/id/draft-ietf-opsawg-pcapng-01.html
 *
 * Writes section header, interface description and enhanced packet blocks. Reads either byte
 * order, any time resolution, several sections and interfaces; skips blocks and options it does
 * not know; takes files that are cut off or made to harm. No allocation, no global state.
 */
#ifndef GRCTL_PCAPNG_H
#define GRCTL_PCAPNG_H

#include <stdio.h>

#include <grobo/types.h>

/* The link type of our traces: DLT_USER0, which Wireshark leaves to private dissectors. */
enum { PCAPNG_LINK_USER0 = 147 };

enum {
    PCAPNG_TEXT_BYTES = 256,    /* of a name or comment that is kept, with its NUL */
    PCAPNG_PACKET_BYTES = 4160, /* of the block of a packet that is written */
    PCAPNG_CHUNK_BYTES = 4096,  /* of one packet that is read; longer ones are refused */
    PCAPNG_INTERFACES_MAX = 16, /* of one section */
};
/* Longest block that is believed; an unknown one is skipped, not kept. */
#define PCAPNG_BLOCK_MAX_BYTES (16u * 1024u * 1024u)

/* Which way a chunk went, as the host sees it; the numbers of the format. */
typedef enum pcapng_direction {
    PCAPNG_UNKNOWN = 0,
    PCAPNG_IN = 1, /* received by the host */
    PCAPNG_OUT = 2 /* sent by the host */
} pcapng_direction;

typedef struct pcapng_interface {
    char name[PCAPNG_TEXT_BYTES];        /* the device; "" where not told */
    char description[PCAPNG_TEXT_BYTES]; /* what is at the other end; "" where not told */
    uint64_t speed_bps;                  /* 0 where not told */
    uint16_t link_type;
    /* private */
    uint8_t resolution; /* if_tsresol */
    int64_t offset_s;   /* if_tsoffset */
} pcapng_interface;

/* ---- writing ---------------------------------------------------------------------------------
 * All return GROBO_OK, or GROBO_ERR_IO with errno set by the C library. */

/* The head of a file: who wrote it, a remark (NULL: none), and its n interfaces. */
int pcapng_write_head(FILE *to, const char *program, const char *comment,
                      const pcapng_interface *interfaces, int n);

/* A chunk of 1..PCAPNG_CHUNK_BYTES bytes of an interface, 0..n-1; time since 1970 in UTC. */
size_t pcapng_make_chunk(uint8_t *packet, int interface, int64_t time_us,
                         pcapng_direction direction, const uint8_t *bytes, size_t size);

/* ---- reading -------------------------------------------------------------------------------- */

/* As fread: gives fewer than `size` bytes at the end only. */
typedef size_t (*pcapng_source)(void *ctx, void *buffer, size_t size);

typedef struct pcapng_reader {
    /* private, but for reading */
    pcapng_source source;
    void *ctx;
    uint64_t at;      /* bytes taken from the source */
    uint64_t skipped; /* blocks that were not understood */
    bool begun;       /* a section's head was read */
    bool big_endian;
    int error; /* why nothing more can be read, 0: it can */
    unsigned n_interfaces;
    pcapng_interface interfaces[PCAPNG_INTERFACES_MAX];
    char comment[PCAPNG_TEXT_BYTES]; /* of the section */
    uint32_t block_left;             /* bytes of the present block not taken yet */
    char problem[PCAPNG_TEXT_BYTES]; /* what is wrong, for a person, after an error */
    uint8_t bytes[PCAPNG_CHUNK_BYTES];
} pcapng_reader;

typedef struct pcapng_chunk {
    int64_t time_us; /* since 1970, UTC */
    pcapng_direction direction;
    const pcapng_interface *interface; /* in the reader, until the next section */
    const uint8_t *bytes;              /* in the reader, until the next call */
    size_t size;
    char comment[PCAPNG_TEXT_BYTES]; /* "" where there is none */
} pcapng_chunk;

/* True for the first four bytes of such a file. */
bool pcapng_is_start(const uint8_t *bytes);

void pcapng_reader_init(pcapng_reader *reader, pcapng_source source, void *ctx);

/*
 * The next chunk. Returns 1, 0 at the end, or GROBO_ERR_SYNTAX (malformed), GROBO_ERR_SHORT (cut
 * off), GROBO_ERR_CAP (larger than we take), GROBO_ERR_TYPE (another link type, or no pcapng):
 * reader->problem says what and at which byte, and nothing more can be read.
 */
int pcapng_read(pcapng_reader *reader, pcapng_chunk *chunk);

#endif
