/* SPDX-License-Identifier: MIT */
/*
 * The process that has the connection. It waits for nobody but the one that began it: where that
 * one is gone, or says nothing for a while, it ends without a goodbye, and the broker says the
 * will.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <event2/buffer.h>
#include <event2/event.h>

#include "tools/grctl/fleet/direct.h"
#include "tools/grctl/fleet/mqtt_host.h"
#include "tools/grctl/fleet/mqtt_note.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/child.h"

enum {
    SILENT_TICKS = 14,  /* a broker would say the will by then, of one process that hangs */
    HANGS_S = 8,        /* where it is connected */
    SLOW_S = 35,        /* where a name may be looked up */
    IDENTIFIERS = 65536 /* of MQTT */
};

/* Exit statuses. */
enum { DONE = 0, FAILED = 1, MISUSED = 2 };

typedef struct host {
    evutil_socket_t socket;
    struct event_base *base;
    struct evbuffer *in, *out;
    direct *d;
    char *text[NOTE_TEXTS]; /* of the configuration */
    uint32_t *number;       /* of each identifier in use, what the other side calls it */
    uint32_t era;
    int silent;
    bool good; /* the other side is there, and makes sense */
    bool bye;
} host;

static void say(host *h, const note *n)
{
    bool done = h->good && note_write(h->out, n);
    size_t size = evbuffer_get_length(h->out);
    const unsigned char *bytes = done ? evbuffer_pullup(h->out, -1) : NULL;
    h->good = bytes && os_child_send(h->socket, bytes, size);
    (void)evbuffer_drain(h->out, size);
    if (!h->good) {
        (void)event_base_loopbreak(h->base);
    }
}

/* Texts of the library and of the system: a broker has no part in them, but for its choice. */
static void say_why(host *h, note_kind kind, const char *why)
{
    const note n = {.kind = kind, .text = {note_is_why(why) ? why : _("an unknown error")}};
    say(h, &n);
}

/* ---- what the connection says ---------------------------------------------------------------- */

static void on_up(void *ctx)
{
    host *h = ctx;
    const note n = {.kind = NOTE_UP, .number = {++h->era}};
    os_child_expect(HANGS_S);
    say(h, &n);
}

static void on_down(void *ctx, const char *why)
{
    os_child_expect(SLOW_S);
    say_why(ctx, NOTE_DOWN, why);
}

static void on_message(void *ctx, const mqtt_message *message)
{
    const note n = {.kind = NOTE_MESSAGE, .message = *message};
    say(ctx, &n);
}

static void on_refused(void *ctx, const char *why)
{
    say_why(ctx, NOTE_REFUSED, why);
}

static void say_taken(host *h, uint32_t number, bool taken)
{
    const note n = {.kind = NOTE_TAKEN, .number = {number, taken}};
    if (number) {
        say(h, &n);
    }
}

static void on_taken(void *ctx, int identifier, bool taken)
{
    host *h = ctx;
    uint32_t *number = &h->number[(unsigned)identifier % IDENTIFIERS];
    say_taken(h, *number, taken);
    *number = 0;
}

/* ---- what the other side says ---------------------------------------------------------------- */

/* Kept for the life of the process. */
static bool keep_texts(host *h, note *n)
{
    for (int i = 0; i < NOTE_TEXTS; i++) {
        if (n->text[i]) {
            h->text[i] = strdup(n->text[i]);
            if (!h->text[i]) {
                return false;
            }
        }
        n->text[i] = h->text[i];
    }
    return true;
}

static void set_up(host *h, note *n)
{
    mqtt_config config = {.base = h->base,
                          .on_up = on_up,
                          .on_down = on_down,
                          .on_message = on_message,
                          .on_refused = on_refused,
                          .on_taken = on_taken,
                          .ctx = h};
    const char *why = _("not enough memory");
    const note ready = {.kind = NOTE_READY};
    if (!h->d && keep_texts(h, n)) {
        note_to_config(n, &config);
        h->d = direct_new(&config, &why);
    }
    if (h->d) {
        say(h, &ready);
    } else {
        say_why(h, NOTE_FAILED, why);
    }
}

static void publish(host *h, const note *n)
{
    if (n->number[0] != h->era || !direct_is_up(h->d)) {
        return; /* it is told, or was, that this connection is no more */
    }
    bool sure = n->number[2] > 0;
    int identifier = direct_publish(h->d, &n->message, sure, (int)n->number[3]);
    if (identifier > 0) {
        h->number[(unsigned)identifier % IDENTIFIERS] = sure ? n->number[1] : 0;
    } else if (sure) {
        say_why(h, NOTE_REFUSED, _("a message could not be sent"));
        say_taken(h, n->number[1], false);
    }
}

static void take(host *h, note *n)
{
    switch (n->kind) {
    case NOTE_CONFIG:
        set_up(h, n);
        break;
    case NOTE_START:
        if (h->d) {
            os_child_expect(SLOW_S);
            direct_start(h->d);
        }
        break;
    case NOTE_PUBLISH:
        if (h->d && n->message.topic) {
            publish(h, n);
        }
        break;
    case NOTE_SUBSCRIBE:
        if (h->d && n->text[0] && n->number[0] == h->era) {
            (void)direct_subscribe(h->d, n->text[0], n->number[1] > 0, n->number[2] > 0);
        }
        break;
    case NOTE_BYE:
        h->bye = true;
        (void)event_base_loopbreak(h->base);
        break;
    case NOTE_BEAT:
    case NOTE_READY:
    case NOTE_FAILED:
    case NOTE_UP:
    case NOTE_DOWN:
    case NOTE_MESSAGE:
    case NOTE_REFUSED:
    case NOTE_TAKEN:
        break;
    }
}

static void on_readable(evutil_socket_t fd, short what, void *ctx)
{
    host *h = ctx;
    note n;
    (void)what;
    int got = evbuffer_read(h->in, fd, -1);
    int is = 0;
    h->silent = 0;
    while (got > 0 && h->good && !h->bye && (is = note_read(h->in, &n)) > 0) {
        take(h, &n);
        note_drop(h->in);
    }
    if (got <= 0 || is < 0) {
        h->good = false;
        (void)event_base_loopbreak(h->base);
    }
}

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    host *h = ctx;
    const note beat = {.kind = NOTE_BEAT};
    (void)fd;
    (void)what;
    os_child_expect(h->d && direct_is_up(h->d) ? HANGS_S : SLOW_S);
    if (++h->silent > SILENT_TICKS) {
        h->good = false;
        (void)event_base_loopbreak(h->base);
    } else {
        say(h, &beat);
    }
}

/* ---- all of it ------------------------------------------------------------------------------- */

static void run(host *h)
{
    static const struct timeval period = {.tv_usec = 1000 * MQTT_BEAT_MS};
    struct event *readable = event_new(h->base, h->socket, EV_READ | EV_PERSIST, on_readable, h);
    struct event *tick = event_new(h->base, -1, EV_PERSIST, on_tick, h);
    h->good = readable && tick && event_add(readable, NULL) == 0 && event_add(tick, &period) == 0;
    while (h->good && !h->bye) {
        h->good = event_base_loop(h->base, EVLOOP_ONCE) == 0 && h->good;
    }
    if (h->bye) {
        direct_free(h->d);
    }
}

int mqtt_host_main(void)
{
    static host h;
    h.socket = os_child_settle();
    if (!os_is_socket(h.socket) || !direct_possible()) {
        fprintf(stderr, _("grctl: broker: is started by grctl itself, for its connection\n"));
        return MISUSED;
    }
    os_child_expect(SLOW_S);
    h.base = event_base_new();
    h.in = evbuffer_new();
    h.out = evbuffer_new();
    h.number = calloc(IDENTIFIERS, sizeof *h.number);
    if (!h.base || !h.in || !h.out || !h.number) {
        return FAILED;
    }
    run(&h);
    return h.bye ? DONE : FAILED;
}
