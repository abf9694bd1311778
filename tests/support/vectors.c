/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/files.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

enum { STRING_MAX_BYTES = 1024 };

static int hex_digit(char c)
{
    const char *digits = "0123456789ABCDEF";
    const char *found = c != '\0' ? strchr(digits, toupper((unsigned char)c)) : NULL;
    return found != NULL ? (int)(found - digits) : -1;
}

int vector_from_hex(const char *hex, uint8_t *bytes, size_t cap)
{
    size_t n = 0;
    while (*hex != '\0') {
        int high = hex_digit(hex[0]);
        int low = high >= 0 ? hex_digit(hex[1]) : -1;
        if (low < 0 || n == cap) {
            return -1;
        }
        bytes[n++] = (uint8_t)(high * 16 + low);
        hex += 2;
        while (*hex == ' ') {
            hex++;
        }
    }
    return (int)n;
}

void vector_expect(int n, const uint8_t *bytes, const char *hex)
{
    uint8_t wanted[VECTOR_MAX_BYTES];
    int size = vector_from_hex(hex, wanted, sizeof wanted);
    assert_true(size > 0);
    assert_int_equal(n, size);
    assert_memory_equal(bytes, wanted, (size_t)size);
}

/* Copies the string that starts behind its quote; returns what follows its end, NULL if none. */
static const char *read_string(const char *p, char *text)
{
    size_t n = 0;
    for (; *p != '"'; p++) {
        if (*p == '\\') {
            p++;
        }
        if (*p == '\0' || n + 1 == STRING_MAX_BYTES) {
            return NULL;
        }
        text[n++] = *p;
    }
    text[n] = '\0';
    return p + 1;
}

static int set_field(vector *v, const char *key, const char *value)
{
    char *text = strcmp(key, "name") == 0    ? v->name
                 : strcmp(key, "kind") == 0  ? v->kind
                 : strcmp(key, "layer") == 0 ? v->layer
                                             : NULL;
    if (text != NULL) {
        int n = snprintf(text, VECTOR_TEXT_MAX, "%s", value);
        return n < VECTOR_TEXT_MAX ? 0 : -1;
    }
    if (strcmp(key, "bytes") == 0) {
        int n = vector_from_hex(value, v->bytes, sizeof v->bytes);
        v->n = n > 0 ? (size_t)n : 0;
        return n > 0 ? 0 : -1;
    }
    return 0;
}

/* An array of flat objects whose values are strings, or the words true and false. Returns how many
 * were of the kind that is checked, -1 for a broken file. */
static int scan(const char *p, bool (*check)(const vector *v))
{
    static char key[STRING_MAX_BYTES], value[STRING_MAX_BYTES];
    vector v;
    int count = 0;
    bool is_value = false;
    while (*p != '\0') {
        char c = *p++;
        if (c == '{') {
            memset(&v, 0, sizeof v);
            v.valid = true;
            is_value = false;
        } else if (c == '"') {
            p = read_string(p, is_value ? value : key);
            if (p == NULL || (is_value && set_field(&v, key, value) < 0)) {
                return -1;
            }
        } else if (c == ':') {
            is_value = true;
        } else if (c == ',') {
            is_value = false;
        } else if (c == 'f' && strcmp(key, "valid") == 0) {
            v.valid = false;
        } else if (c == '}') {
            count += check(&v);
        }
    }
    return count;
}

void vectors_check(bool (*check)(const vector *v), int at_least)
{
    char *text = file_text(shared_file("vectors/rs30x.json"), NULL);
    int count = scan(text, check);
    free(text);
    assert_true(count >= at_least);
}
