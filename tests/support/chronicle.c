/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/chronicle.h"
#include "tests/support/test.h"

static chronicle_line *next_line(chronicle *c, int64_t at_us)
{
    chronicle_line *line = &c->lines[c->n++ % CHRONICLE_LINES];
    line->at_us = at_us;
    line->n = 0;
    line->asked = 0;
    return line;
}

void chronicle_note(chronicle *c, int64_t at_us, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf((char *)next_line(c, at_us)->bytes, CHRONICLE_BYTES, format, arguments);
    va_end(arguments);
}

void chronicle_frame(chronicle *c, int64_t at_us, const uint8_t *bytes, size_t n)
{
    chronicle_line *line = next_line(c, at_us);
    assert_true(n <= CHRONICLE_BYTES);
    line->n = (uint8_t)n;
    memcpy(line->bytes, bytes, n);
}

void chronicle_asked(chronicle *c, int64_t at_us)
{
    chronicle_line *last = c->n > 0 ? &c->lines[(c->n - 1) % CHRONICLE_LINES] : NULL;
    if (last == NULL || last->asked == 0) {
        last = next_line(c, at_us);
    }
    last->asked++;
    (void)snprintf((char *)last->bytes, CHRONICLE_BYTES, "%u questions", last->asked);
}

static void print_line(const chronicle_line *line)
{
    char hex[3 * CHRONICLE_BYTES + 1] = "";
    for (int i = 0; i < line->n; i++) {
        (void)snprintf(hex + 3 * i, 4, " %02X", line->bytes[i]);
    }
    print_message("# %13.6f s  %s%s\n", (double)line->at_us / 1e6,
                  line->n > 0 ? "frame" : (const char *)line->bytes, hex);
}

void chronicle_print(const chronicle *c)
{
    unsigned first = c->n < CHRONICLE_LINES ? 0 : c->n - CHRONICLE_LINES;
    for (unsigned i = first; i < c->n; i++) {
        print_line(&c->lines[i % CHRONICLE_LINES]);
    }
}
