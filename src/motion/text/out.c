/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/text/number.h"
#include "src/motion/text/out.h"

void grobo_i_out_begin(grobo_i_out *out, const grobo_sink *sink)
{
    out->sink = sink;
    out->result = 0;
    out->used = 0;
}

static void flush(grobo_i_out *out)
{
    if (out->result == 0 && out->used > 0) {
        out->result = out->sink->write(out->sink->ctx, out->buffer, out->used);
    }
    out->used = 0;
}

void grobo_i_put(grobo_i_out *out, const char *text, size_t length)
{
    if (length > sizeof out->buffer - out->used) {
        flush(out);
        if (length > sizeof out->buffer) {
            if (out->result == 0) {
                out->result = out->sink->write(out->sink->ctx, text, length);
            }
            return;
        }
    }
    memcpy(out->buffer + out->used, text, length);
    out->used += length;
}

void grobo_i_put_text(grobo_i_out *out, const char *text)
{
    grobo_i_put(out, text, strlen(text));
}

char *grobo_i_reserve(grobo_i_out *out, size_t length)
{
    if (length > sizeof out->buffer - out->used) {
        flush(out);
    }
    return out->buffer + out->used;
}

void grobo_i_put_number(grobo_i_out *out, double value)
{
    out->used += grobo_i_format_number(value, grobo_i_reserve(out, GROBO_I_NUMBER_BYTES));
}

void grobo_i_put_int(grobo_i_out *out, long value)
{
    char text[GROBO_I_NUMBER_BYTES];
    int length = snprintf(text, sizeof text, "%ld", value);

    grobo_i_put(out, text, (size_t)length);
}

/* The code point at text, which is well-formed UTF-8, and its length. */
static unsigned long code_point(const unsigned char *text, size_t *length)
{
    static const unsigned char masks[] = {0x7F, 0x7F, 0x1F, 0x0F, 0x07};
    *length = text[0] < 0x80 ? 1 : text[0] < 0xE0 ? 2 : text[0] < 0xF0 ? 3 : 4;
    unsigned long code = text[0] & masks[*length];

    for (size_t i = 1; i < *length; i++) {
        code = code << 6 | (text[i] & 0x3FU);
    }
    return code;
}

/* Control characters, line breaks of any kind, and what YAML does not allow raw. */
static bool needs_escape(unsigned long code)
{
    return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 ||
           code == 0xFEFF || code == 0xFFFE || code == 0xFFFF;
}

void grobo_i_put_quoted(grobo_i_out *out, const char *text, size_t length)
{
    grobo_i_put(out, "\"", 1);
    for (size_t i = 0; i < length;) {
        size_t bytes;
        unsigned long code = code_point((const unsigned char *)text + i, &bytes);
        if (needs_escape(code)) {
            char escape[16];
            int n = snprintf(escape, sizeof escape, code < 0x100 ? "\\x%02lX" : "\\u%04lX", code);
            grobo_i_put(out, escape, (size_t)n);
        } else {
            if (code == '"' || code == '\\') {
                grobo_i_put(out, "\\", 1);
            }
            grobo_i_put(out, text + i, bytes);
        }
        i += bytes;
    }
    grobo_i_put(out, "\"", 1);
}

static bool is_word(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        char c = text[i];
        bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
        if (!letter && (c == '\0' || strchr("0123456789_.+-/~", c) == NULL)) {
            return false;
        }
    }
    /* A lone "-" or "---" means something else. */
    return length > 0 && !(text[0] == '-' && (length == 1 || text[1] == '-'));
}

void grobo_i_put_scalar(grobo_i_out *out, const char *text, size_t length)
{
    if (is_word(text, length)) {
        grobo_i_put(out, text, length);
    } else {
        grobo_i_put_quoted(out, text, length);
    }
}

/* What YAML takes for nothing or for true or false, however its letters are. */
static bool is_reserved(const char *text, size_t length)
{
    static const char *const words[] = {"null", "true", "false", "yes", "no", "on", "off"};

    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        size_t n = 0;
        while (n < length && (text[n] | 0x20) == words[i][n]) {
            n++;
        }
        if (n == length && words[i][n] == '\0') {
            return true;
        }
    }
    return false;
}

void grobo_i_put_name(grobo_i_out *out, const char *text, size_t length)
{
    char first = length > 0 ? text[0] : '\0';
    bool lettered =
        (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z') || first == '_';

    if (lettered && !is_reserved(text, length)) {
        grobo_i_put_scalar(out, text, length);
    } else {
        grobo_i_put_quoted(out, text, length);
    }
}

int grobo_i_out_end(grobo_i_out *out)
{
    flush(out);
    return out->result;
}

int grobo_i_text_write(void *text, const void *data, size_t size)
{
    grobo_i_text *to = text;
    size_t room = to->room;

    if (size > to->cap - to->length) {
        return GROBO_ERR_CAP;
    }
    while (room - to->length < size) {
        room = room == 0 ? 256 : room * 2;
    }
    if (room > to->room) {
        char *grown = to->mem->resize(to->mem->ctx, to->data, to->room, room);
        if (grown == NULL) {
            return GROBO_ERR_NOMEM;
        }
        to->data = grown;
        to->room = room;
    }
    memcpy(to->data + to->length, data, size);
    to->length += size;
    return 0;
}

void grobo_i_text_free(grobo_i_text *text)
{
    grobo_i_free(text->mem, text->data, text->room);
    text->data = NULL;
    text->length = text->room = 0;
}
