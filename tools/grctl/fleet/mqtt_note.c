/* SPDX-License-Identifier: MIT */
/* Writes the notes between the two processes of a connection, and reads them as foreign bytes. */
#include <string.h>

#include <event2/buffer.h>
#include <jansson.h>

#include "tools/grctl/fleet/mqtt_note.h"

/* Of nothing at all, instead of a length. */
#define NONE UINT32_C(0xFFFFFFFF)

enum { LENGTH_BYTES = 4, LEAST_BYTES = 1 + 1 + 4 * NOTE_NUMBERS + 4 * (NOTE_TEXTS + 4) };

/* ---- writing --------------------------------------------------------------------------------- */

static void put_number(struct evbuffer *to, uint32_t number)
{
    const unsigned char bytes[] = {(unsigned char)number, (unsigned char)(number >> 8),
                                   (unsigned char)(number >> 16), (unsigned char)(number >> 24)};
    (void)evbuffer_add(to, bytes, sizeof bytes);
}

static void put_bytes(struct evbuffer *to, const void *bytes, size_t size)
{
    put_number(to, bytes ? (uint32_t)size : NONE);
    if (bytes) {
        (void)evbuffer_add(to, bytes, size);
    }
}

/* With its end, so that it can be used where it stands. */
static void put_text(struct evbuffer *to, const char *text)
{
    put_bytes(to, text, text ? strlen(text) + 1 : 0);
}

static size_t text_bytes(const char *text)
{
    return text ? strlen(text) + 1 : 0;
}

static size_t size_of(const note *n)
{
    size_t size = LEAST_BYTES + n->message.size + n->message.correlation_bytes +
                  text_bytes(n->message.topic) + text_bytes(n->message.response);
    for (int i = 0; i < NOTE_TEXTS; i++) {
        size += text_bytes(n->text[i]);
    }
    return size;
}

bool note_write(struct evbuffer *to, const note *n)
{
    size_t size = size_of(n);
    unsigned char head[] = {(unsigned char)n->kind, n->message.retained};
    if (size > NOTE_MAX_BYTES || evbuffer_expand(to, LENGTH_BYTES + size) != 0) {
        return false; /* with that room nothing below fails */
    }
    put_number(to, (uint32_t)size);
    (void)evbuffer_add(to, head, sizeof head);
    for (int i = 0; i < NOTE_NUMBERS; i++) {
        put_number(to, n->number[i]);
    }
    for (int i = 0; i < NOTE_TEXTS; i++) {
        put_text(to, n->text[i]);
    }
    put_text(to, n->message.topic);
    put_text(to, n->message.response);
    put_bytes(to, n->message.correlation, n->message.correlation_bytes);
    put_bytes(to, n->message.payload ? n->message.payload : "", n->message.size);
    return true;
}

/* ---- reading --------------------------------------------------------------------------------- */

typedef struct reader {
    const unsigned char *at, *end;
    bool bad;
} reader;

static uint32_t number_at(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint32_t take_number(reader *r)
{
    if (r->bad || r->end - r->at < 4) {
        r->bad = true;
        return 0;
    }
    r->at += 4;
    return number_at(r->at - 4);
}

/* Of at most so many bytes; NULL: none. */
static const void *take_bytes(reader *r, size_t most, size_t *size)
{
    uint32_t n = take_number(r);
    *size = 0;
    if (r->bad || n == NONE) {
        return NULL;
    }
    if (n > most || n > (size_t)(r->end - r->at)) {
        r->bad = true;
        return NULL;
    }
    *size = n;
    r->at += n;
    return r->at - n;
}

/* It has one end, which is its last byte. */
static const char *take_text(reader *r)
{
    size_t size;
    const char *text = take_bytes(r, NOTE_TEXT_MAX_BYTES + 1, &size);
    if (!text) {
        return NULL;
    }
    r->bad = r->bad || size == 0 || memchr(text, '\0', size) != text + size - 1;
    return r->bad ? NULL : text;
}

static void take_all(reader *r, note *n)
{
    mqtt_message *m = &n->message;
    memset(n, 0, sizeof *n);
    n->kind = (note_kind)r->at[0];
    m->retained = r->at[1] == 1;
    r->bad = r->at[0] < NOTE_CONFIG || r->at[0] > NOTE_BEAT || r->at[1] > 1;
    r->at += 2;
    for (int i = 0; i < NOTE_NUMBERS; i++) {
        n->number[i] = take_number(r);
    }
    for (int i = 0; i < NOTE_TEXTS; i++) {
        n->text[i] = take_text(r);
    }
    m->topic = take_text(r);
    m->response = take_text(r);
    m->correlation = take_bytes(r, NOTE_TEXT_MAX_BYTES, &m->correlation_bytes);
    m->payload = take_bytes(r, MQTT_PAYLOAD_MAX_BYTES, &m->size);
    r->bad = r->bad || r->at != r->end || !m->payload;
}

/* The bytes of the first one, once all of them are there; size: 0 until then, or of no note. */
static const unsigned char *first_of(struct evbuffer *from, size_t *size)
{
    const unsigned char *head = evbuffer_pullup(from, LENGTH_BYTES);
    *size = head ? number_at(head) : 0;
    if (!head || *size < LEAST_BYTES || *size > NOTE_MAX_BYTES ||
        evbuffer_get_length(from) < LENGTH_BYTES + *size) {
        return NULL;
    }
    const unsigned char *whole = evbuffer_pullup(from, (ev_ssize_t)(LENGTH_BYTES + *size));
    return whole ? whole + LENGTH_BYTES : NULL;
}

int note_read(struct evbuffer *from, note *n)
{
    size_t size;
    const unsigned char *bytes = first_of(from, &size);
    if (!bytes) {
        bool waits = evbuffer_get_length(from) < LENGTH_BYTES ||
                     (size >= LEAST_BYTES && size <= NOTE_MAX_BYTES);
        return waits ? 0 : -1;
    }
    reader r = {.at = bytes, .end = bytes + size};
    take_all(&r, n);
    return r.bad ? -1 : 1;
}

void note_drop(struct evbuffer *from)
{
    size_t size;
    if (first_of(from, &size)) {
        (void)evbuffer_drain(from, LENGTH_BYTES + size);
    }
}

/* ---- judging --------------------------------------------------------------------------------- */

static bool is_utf8(const char *text)
{
    json_t *whole = json_string(text);
    json_decref(whole);
    return whole != NULL;
}

static bool is_topic(const char *text)
{
    return text && *text && !strpbrk(text, "+#") && is_utf8(text);
}

bool note_is_why(const char *text)
{
    size_t size = text ? strlen(text) : 0;
    for (size_t i = 0; i < size; i++) {
        if ((unsigned char)text[i] < ' ' || text[i] == 0x7f) {
            return false;
        }
    }
    return size > 0 && size <= NOTE_WHY_MAX_BYTES && is_utf8(text);
}

bool note_is_news(const note *n)
{
    switch (n->kind) {
    case NOTE_READY:
    case NOTE_BEAT:
        return true;
    case NOTE_FAILED:
    case NOTE_DOWN:
    case NOTE_REFUSED:
        return note_is_why(n->text[0]);
    case NOTE_UP:
        return n->number[0] > 0;
    case NOTE_MESSAGE:
        return is_topic(n->message.topic) &&
               (!n->message.response || is_topic(n->message.response));
    case NOTE_TAKEN:
        return n->number[0] > 0 && n->number[1] <= 1;
    case NOTE_CONFIG:
    case NOTE_START:
    case NOTE_PUBLISH:
    case NOTE_SUBSCRIBE:
    case NOTE_BYE:
        break;
    }
    return false;
}

/* ---- the configuration ----------------------------------------------------------------------- */

note note_of_config(const mqtt_config *c)
{
    return (note){.kind = NOTE_CONFIG,
                  .number = {(uint32_t)c->port, (uint32_t)c->keepalive_s},
                  .text = {c->id, c->host, c->user, c->password, c->ca, c->certificate, c->key,
                           c->will_topic, c->will}};
}

void note_to_config(const note *n, mqtt_config *c)
{
    c->port = (int)n->number[0];
    c->keepalive_s = (int)n->number[1];
    c->id = n->text[0];
    c->host = n->text[1];
    c->user = n->text[2];
    c->password = n->text[3];
    c->ca = n->text[4];
    c->certificate = n->text[5];
    c->key = n->text[6];
    c->will_topic = n->text[7];
    c->will = n->text[8];
}
