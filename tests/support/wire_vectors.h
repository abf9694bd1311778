/* SPDX-License-Identifier: MIT */
/* The wire vectors of the reference material, of families whose file says what a frame means. */
#ifndef GROBO_TEST_WIRE_VECTORS_H
#define GROBO_TEST_WIRE_VECTORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { WIRE_BYTES_MAX = 256, WIRE_LIST_MAX = 24 };

typedef struct wire_bytes {
    uint8_t bytes[WIRE_BYTES_MAX];
    size_t n;
} wire_bytes;

/* A vector; numbers that are not given are -1. */
typedef struct wire_vector {
    const char *name;
    const char *instruction; /* "" where there is none */
    const char *series;
    const char *fault; /* what is wrong with it; "" */
    bool valid, from_servo;
    wire_bytes whole;
    wire_bytes sent;                  /* the request before, if there is one */
    wire_bytes frames[WIRE_LIST_MAX]; /* whole frames in it; of a valid one itself */
    wire_bytes chunks[WIRE_LIST_MAX]; /* how it arrives; at least one */
    wire_bytes data;                  /* of the meaning */
    size_t frame_count, chunk_count;
    int id, error, address, count, command;
} wire_vector;

/* Checks every vector of vectors/FILE; skips the test where the file is missing. Prints the name
 * of a vector that check() fails on. */
void wire_vectors_check(const char *file, void (*check)(const wire_vector *v), int at_least);

/* Finds what there is of frames in v's chunks, as a framer does: measure() says the size of the
 * frame that bytes start with, 0 for more, < 0 for none. Fails unless it is v->frames. */
void wire_vector_scan(const wire_vector *v,
                      int (*measure)(const wire_vector *v, const uint8_t *bytes, size_t n));

#endif
