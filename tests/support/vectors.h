/* SPDX-License-Identifier: MIT */
/* The collected wire vectors of the reference material beside the checkout, one by one. */
#ifndef GROBO_TEST_VECTORS_H
#define GROBO_TEST_VECTORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { VECTOR_MAX_BYTES = 160, VECTOR_TEXT_MAX = 64 };

typedef struct vector {
    char name[VECTOR_TEXT_MAX];
    char kind[VECTOR_TEXT_MAX];
    char layer[VECTOR_TEXT_MAX];
    uint8_t bytes[VECTOR_MAX_BYTES];
    size_t n;
    bool valid;
} vector;

/*
 * Calls use with every vector of $GROBO_SHARED/vectors/rs30x.json (default ../shared).
 * Returns how many there were, 0 when the file is missing (and says so), -1 for a broken file.
 */
int vectors_each(void (*use)(const vector *v, void *ctx), void *ctx);

/* Bytes of "FA AF 01", at most cap; -1 when it is anything else. */
int vector_from_hex(const char *hex, uint8_t *bytes, size_t cap);

#endif
