/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <stdbool.h>
#include <string.h>

#include <grobo/error.h>

#include "tools/grctl/decode/hextext.h"

static const char separators[] = " \t\r\n,;:-|";

static int digit(char c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

static bool has_prefix(const char *text)
{
    return (text[0] == '0' || text[0] == '\\') && (text[1] == 'x' || text[1] == 'X');
}

int hextext_word(const char *text)
{
    size_t n = strcspn(text, separators);
    return n > INT_MAX ? INT_MAX : (int)n;
}

int hextext_parse(const char *text, uint8_t *bytes, size_t capacity, size_t *at)
{
    const char *c = text;
    size_t n = 0;
    for (;;) {
        c += strspn(c, separators);
        if (*c == '\0') {
            return n > INT_MAX ? GROBO_ERR_CAP : (int)n;
        }
        if (has_prefix(c)) {
            c += 2;
        }
        int high = digit(c[0]);
        int low = high < 0 ? -1 : digit(c[1]);
        if (low < 0) {
            *at = (size_t)(c - text);
            return GROBO_ERR_SYNTAX;
        }
        if (n == capacity) {
            return GROBO_ERR_CAP;
        }
        bytes[n++] = (uint8_t)(high << 4 | low);
        c += 2;
    }
}
