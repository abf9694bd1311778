/* SPDX-License-Identifier: MIT */
/* Hex from text: lines of bytes, `time_ms bytes` as of play --dry-run, or JSON with "hex". */
#include <string.h>

#include "tools/grctl/decode/decoder.h"
#include "tools/grctl/decode/hextext.h"
#include "tools/grctl/lang/lang.h"

enum { LINE_BYTES = 65536 };

typedef struct reader {
    decoder *d;
    input *in;
    unsigned line;
    char text[LINE_BYTES];
    uint8_t bytes[LINE_BYTES / 2];
} reader;

static int fail(const reader *r, size_t column, const char *what, const char *word)
{
    return app_fail(r->d->a, EXIT_FILE, "SYNTAX", "%s:%u:%zu: %s%.*s%s", r->in->name, r->line,
                    column + 1, *word ? "'" : "", hextext_word(word) > 20 ? 20 : hextext_word(word),
                    word, lang_text(what));
}

/* A line without its end. 1, 0 at the end of the file, or the exit status, negative. */
static int read_line(reader *r)
{
    size_t n = 0;
    int c;
    r->line++;
    while ((c = input_getc(r->in)) != EOF && c != '\n') {
        if (c == '\0' || (c >= 0x7F) || (c < 0x20 && c != '\t' && c != '\r')) {
            return -fail(r, n, "neither hex nor a pcapng trace", "");
        }
        if (n == sizeof r->text - 1) {
            return -fail(r, n, "the line is too long", "");
        }
        r->text[n++] = (char)c;
    }
    r->text[n] = '\0';
    return n > 0 || c != EOF;
}

/* True if bytes could be the beginning of a frame. */
static bool begins_frame(const reader *r, const uint8_t *bytes, int n)
{
    frame found;
    return n > 0 &&
           frame_peek(&r->d->talk, FRAMES_EITHER, FRAMES_ANY_WIRING, bytes, (size_t)n, &found) >= 0;
}

/*
 * Where the bytes of a line begin that may have a time in front. "20 FA AF" has: two digits could
 * be a byte, but then what follows would be no frame. Once a line had one, all have.
 */
static const char *behind_time(reader *r, const char *text, double *time_ms)
{
    char number[32];
    size_t n = strspn(text, "0123456789.");
    size_t at;
    const char *rest = text + n;
    if (n == 0 || n >= sizeof number || !strchr(" \t", *rest) || *rest == '\0') {
        return text;
    }
    memcpy(number, text, n);
    number[n] = '\0';
    if (!cli_read_number(number, time_ms)) {
        return text;
    }
    if (r->d->timed || n % 2 != 0 || strchr(number, '.')) {
        return rest;
    }
    int whole = hextext_parse(text, r->bytes, sizeof r->bytes, &at);
    if (begins_frame(r, r->bytes, whole)) {
        return text;
    }
    int behind = hextext_parse(rest, r->bytes, sizeof r->bytes, &at);
    return begins_frame(r, r->bytes, behind) ? rest : text;
}

static int feed_hex(reader *r, frames_side side, const char *text, double time_ms)
{
    size_t at = 0;
    int n = hextext_parse(text, r->bytes, sizeof r->bytes, &at);
    if (n < 0) {
        return fail(r, (size_t)(text - r->text) + at, "' is not a byte in hex", text + at);
    }
    if (n > 0) {
        decoder_feed(r->d, side, (int64_t)(time_ms * 1e3), r->bytes, (size_t)n);
    }
    return 0;
}

/* {"time_ms": 0, "hex": "41 00"}, as of play --dry-run --json and of decode --json. */
static int feed_json(reader *r)
{
    json_error_t error;
    json_t *line = json_loads(r->text, 0, &error);
    json_t *hex = json_object_get(line, "hex");
    json_t *time = json_object_get(line, "time_ms");
    const char *from = json_string_value(json_object_get(line, "from"));
    frames_side side = FRAMES_EITHER;
    int status = 0;
    if (!line) {
        return fail(r, error.column > 0 ? (size_t)error.column - 1 : 0, "malformed JSON", "");
    }
    if (from) {
        side = strcmp(from, "host") == 0    ? FRAMES_HOST
               : strcmp(from, "robot") == 0 ? FRAMES_ROBOT
                                            : FRAMES_EITHER;
    }
    r->d->timed = r->d->timed || json_is_number(time);
    if (json_is_string(hex)) {
        size_t at = 0;
        int n = hextext_parse(json_string_value(hex), r->bytes, sizeof r->bytes, &at);
        if (n < 0) {
            status = fail(r, 0, "' is not a byte in hex", json_string_value(hex) + at);
        } else if (n > 0) {
            decoder_feed(r->d, side, (int64_t)(json_number_value(time) * 1e3), r->bytes, (size_t)n);
        }
    }
    json_decref(line);
    return status;
}

static int feed_line(reader *r)
{
    double time_ms = 0;
    size_t comment = strcspn(r->text, "#");
    const char *text = r->text + strspn(r->text, " \t\r");
    if (*text == '{') {
        return feed_json(r);
    }
    r->text[comment] = '\0';
    const char *bytes = behind_time(r, text, &time_ms);
    if (bytes != text) {
        r->d->timed = true;
    }
    return feed_hex(r, FRAMES_EITHER, bytes, time_ms);
}

int decode_text(decoder *d, input *in)
{
    static reader r;
    int more, status = 0;
    r = (reader){.d = d, .in = in};
    while (!status && (more = read_line(&r)) != 0) {
        status = more < 0 ? -more : feed_line(&r);
    }
    return status;
}
