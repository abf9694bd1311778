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
 * Checks every vector of vectors/rs30x.json; skips the test where the file is missing. check()
 * returns whether a vector was of its kind; fails the test where fewer were than at_least.
 */
void vectors_check(bool (*check)(const vector *v), int at_least);

/* Bytes of "FA AF 01", at most cap; -1 when it is anything else. */
int vector_from_hex(const char *hex, uint8_t *bytes, size_t cap);

/* Fails the test if these n bytes are not those of "FA AF 01". */
void vector_expect(int n, const uint8_t *bytes, const char *hex);

#endif
