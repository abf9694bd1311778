/* SPDX-License-Identifier: MIT */
/*
 * The connection lives in a process of its own, which a broker may end by what it says, and which
 * is started again then: for who uses it that is a broker that was lost. It has a socket to this
 * one and no line of a robot. Where no process can be had it is in this one.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <event2/buffer.h>
#include <event2/event.h>

#include <grobo/core/port.h>

#include "tools/grctl/fleet/direct.h"
#include "tools/grctl/fleet/mqtt_host.h"
#include "tools/grctl/fleet/mqtt_note.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/alarm.h"
#include "tools/grctl/os/child.h"
#include "tools/grctl/os/os.h"

enum {
    SILENT_TICKS = 10, /* of one that is connected */
    SLOW_TICKS = 80,   /* of one that may be looking up a name */
    READY_MS = 5000,
    GOODBYE_MS = 1000,
    KEPT_MAX_BYTES = 1 << 24 /* one that takes no more than this takes nothing */
};

struct mqtt {
    mqtt_config config;     /* without its texts */
    direct *inside;         /* the connection itself, where there is no process, or NULL */
    struct evbuffer *setup; /* what a new process is told */
    os_child child;
    struct evbuffer *in, *out;
    struct event *readable, *writable, *tick, *again;
    int pause_ms;
    bool started; /* it is to connect */
    bool up;
    int64_t up_us; /* since when */
    uint32_t era;  /* of the connection: what was meant for another is dropped over there */
    int last;      /* the number that was given last */
    int silent;    /* ticks without a word of it */
    char why[NOTE_WHY_MAX_BYTES + 1];
};

static const char *called = "grctl";

void mqtt_note_program(const char *argv0)
{
    if (argv0 && *argv0) {
        called = argv0;
    }
}

bool mqtt_possible(void)
{
    return direct_possible();
}

/* ---- the process ----------------------------------------------------------------------------- */

static void forget(struct event **event)
{
    if (*event) {
        event_free(*event);
    }
    *event = NULL;
}

static void empty(struct evbuffer *buffer)
{
    (void)evbuffer_drain(buffer, evbuffer_get_length(buffer));
}

static void on_readable(evutil_socket_t fd, short what, void *ctx);
static void on_writable(evutil_socket_t fd, short what, void *ctx);

/* Whatever it was about to say is not heard. */
static void end_child(mqtt *m)
{
    forget(&m->readable);
    forget(&m->writable);
    os_child_end(&m->child, NULL, 0, 0);
    empty(m->in);
    empty(m->out);
}

static void tell_down(mqtt *m, const char *why)
{
    if (m->up && grobo_now_us() - m->up_us > INT64_C(1000) * PAUSE_LONGEST_MS) {
        m->pause_ms = PAUSE_FIRST_MS; /* one that ends at once is not started ten times a second */
    }
    m->up = false;
    snprintf(m->why, sizeof m->why, "%s", why);
    m->config.on_down(m->config.ctx, m->why);
}

/* It is gone, or no good any more: the next one comes after a pause. */
static void lost(mqtt *m, const char *why)
{
    end_child(m);
    tell_down(m, why);
    alarm_set(m->again, INT64_C(1000) * pause_next_ms(&m->pause_ms));
}

static bool begin_child(mqtt *m)
{
    if (!os_child_begin(&m->child, os_own_program(called), MQTT_HOST_WORD)) {
        return false;
    }
    evutil_socket_t fd = m->child.socket;
    m->silent = 0;
    m->readable = event_new(m->config.base, fd, EV_READ | EV_PERSIST, on_readable, m);
    m->writable = event_new(m->config.base, fd, EV_WRITE, on_writable, m);
    size_t size = evbuffer_get_length(m->setup);
    const unsigned char *setup = evbuffer_pullup(m->setup, -1);
    if (!m->readable || !m->writable || event_add(m->readable, NULL) != 0 || !setup ||
        evbuffer_add(m->out, setup, size) != 0) {
        end_child(m);
        return false;
    }
    return true;
}

static bool say(mqtt *m, const note *n)
{
    return os_is_socket(m->child.socket) && note_write(m->out, n) &&
           event_add(m->writable, NULL) == 0;
}

static void say_kind(mqtt *m, note_kind kind)
{
    const note n = {.kind = kind};
    (void)say(m, &n);
}

static void say_start(mqtt *m)
{
    if (m->started) {
        say_kind(m, NOTE_START);
    }
}

static void on_writable(evutil_socket_t fd, short what, void *ctx)
{
    mqtt *m = ctx;
    (void)what;
    (void)evbuffer_write(m->out, fd); /* its end is read */
    if (evbuffer_get_length(m->out) > 0 && event_add(m->writable, NULL) != 0) {
        lost(m, _("not enough memory"));
    }
}

static void on_again(evutil_socket_t fd, short what, void *ctx)
{
    mqtt *m = ctx;
    (void)fd;
    (void)what;
    alarm_clear(m->again);
    if (os_is_socket(m->child.socket)) {
        return; /* rung by itself */
    }
    if (begin_child(m)) {
        say_start(m);
    } else {
        lost(m, _("no process can be started for the connection"));
    }
}

/* ---- what it says ---------------------------------------------------------------------------- */

/* False: that cannot be, as things stand. */
static bool take(mqtt *m, const note *n)
{
    const mqtt_config *c = &m->config;
    switch (n->kind) {
    case NOTE_UP:
        if (m->up) {
            return false;
        }
        m->up = true;
        m->up_us = grobo_now_us();
        m->era = n->number[0];
        c->on_up(c->ctx);
        return true;
    case NOTE_FAILED:
    case NOTE_DOWN:
        tell_down(m, n->text[0]);
        return true;
    case NOTE_MESSAGE:
        if (m->up) {
            c->on_message(c->ctx, &n->message);
        }
        return m->up;
    case NOTE_REFUSED:
        c->on_refused(c->ctx, n->text[0]);
        return true;
    case NOTE_TAKEN:
        if (n->number[0] <= (uint32_t)m->last && c->on_taken) {
            c->on_taken(c->ctx, (int)n->number[0], n->number[1] == 1);
        }
        return n->number[0] <= (uint32_t)m->last;
    case NOTE_READY:
    case NOTE_BEAT:
        return true;
    case NOTE_CONFIG:
    case NOTE_START:
    case NOTE_PUBLISH:
    case NOTE_SUBSCRIBE:
    case NOTE_BYE:
        break;
    }
    return false;
}

static bool is_nothing_now(int cause)
{
    return cause == EAGAIN || cause == EWOULDBLOCK || cause == EINTR;
}

static void on_readable(evutil_socket_t fd, short what, void *ctx)
{
    mqtt *m = ctx;
    note n;
    (void)what;
    int got = evbuffer_read(m->in, fd, -1);
    bool ended = got == 0 || (got < 0 && !is_nothing_now(EVUTIL_SOCKET_ERROR()));
    int is = note_read(m->in, &n);
    for (m->silent = got > 0 ? 0 : m->silent; is > 0; is = note_read(m->in, &n)) {
        if (!note_is_news(&n) || !take(m, &n)) {
            is = -1;
            break;
        }
        note_drop(m->in);
    }
    if (is < 0) {
        lost(m, _("what the process of the connection says is not understood"));
    } else if (ended) {
        lost(m, _("the process of the connection ended"));
    }
}

/* Each hears of the other that it runs: one that hangs is ended, on either side. */
static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    mqtt *m = ctx;
    (void)fd;
    (void)what;
    if (!os_is_socket(m->child.socket)) {
        return;
    }
    bool full = evbuffer_get_length(m->out) > KEPT_MAX_BYTES;
    m->silent++;
    if (full || m->silent > (m->up ? SILENT_TICKS : SLOW_TICKS)) {
        lost(m, _("the process of the connection hangs"));
    } else {
        say_kind(m, NOTE_BEAT);
    }
}

/* ---- requests -------------------------------------------------------------------------------- */

bool mqtt_is_up(const mqtt *m)
{
    return m && (m->inside ? direct_is_up(m->inside) : m->up);
}

int mqtt_publish(mqtt *m, const mqtt_message *message, int qos, int expiry_s)
{
    if (!mqtt_is_up(m) || message->size > MQTT_PAYLOAD_MAX_BYTES) {
        return 0;
    }
    if (m->inside) {
        return direct_publish(m->inside, message, qos, expiry_s);
    }
    size_t queued = evbuffer_get_length(m->out);
    if (queued > (qos == 0 ? MQTT_QUEUE_MAX_BYTES : KEPT_MAX_BYTES)) {
        return 0;
    }
    m->last = m->last < INT32_MAX ? m->last + 1 : 1;
    const note n = {.kind = NOTE_PUBLISH,
                    .number = {m->era, (uint32_t)m->last, (uint32_t)qos, (uint32_t)expiry_s},
                    .message = *message};
    return say(m, &n) ? m->last : 0;
}

bool mqtt_subscribe(mqtt *m, const char *filter, int qos, bool retained)
{
    if (m && m->inside) {
        return direct_subscribe(m->inside, filter, qos, retained);
    }
    const note n = {
        .kind = NOTE_SUBSCRIBE, .number = {m->era, (uint32_t)qos, retained}, .text = {filter}};
    return mqtt_is_up(m) && say(m, &n);
}

/* ---- a connection ---------------------------------------------------------------------------- */

static void on_wait(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    *(short *)ctx = what;
}

/* One round of waiting for its words, on a loop of its own. False: none came, and none will. */
static bool hear(mqtt *m, struct event_base *alone)
{
    static const struct timeval most = {.tv_sec = READY_MS / 1000};
    short what = 0;
    return event_base_once(alone, m->child.socket, EV_READ, on_wait, &what, &most) == 0 &&
           event_base_loop(alone, EVLOOP_ONCE) >= 0 && (what & EV_READ) &&
           evbuffer_read(m->in, m->child.socket, -1) > 0;
}

/* Its first words: READY, FAILED with why, or NOTE_BYE: it does not run here. */
static note_kind await_first(mqtt *m)
{
    struct event_base *alone = event_base_new();
    note_kind first = NOTE_BYE;
    on_writable(m->child.socket, 0, m);
    for (bool hears = alone != NULL; hears && first == NOTE_BYE;) {
        note n;
        int is = note_read(m->in, &n);
        if (is == 0) {
            hears = hear(m, alone);
        } else if (is < 0 || !note_is_news(&n)) {
            break;
        } else {
            bool says = n.kind == NOTE_READY || n.kind == NOTE_FAILED;
            first = says ? n.kind : NOTE_BYE;
            snprintf(m->why, sizeof m->why, "%s", n.text[0] ? n.text[0] : "");
            note_drop(m->in);
        }
    }
    if (alone) {
        event_base_free(alone);
    }
    return first;
}

/* What a configuration lacks is told before anything begins. No byte of a broker was heard yet: a
 * process that does not come so far is one that this system does not run. */
static bool begin(mqtt *m, const mqtt_config *config, const char **why)
{
    note_kind first = begin_child(m) ? await_first(m) : NOTE_BYE;
    if (first == NOTE_FAILED) {
        *why = m->why;
        return false;
    }
    if (first != NOTE_READY) {
        end_child(m);
        m->inside = direct_new(config, why);
    }
    return first == NOTE_READY || m->inside;
}

static void destroy(mqtt *m)
{
    direct_free(m->inside);
    forget(&m->readable);
    forget(&m->writable);
    forget(&m->tick);
    forget(&m->again);
    struct evbuffer *const buffers[] = {m->setup, m->in, m->out};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++) {
        if (buffers[i]) {
            evbuffer_free(buffers[i]);
        }
    }
    free(m);
}

static mqtt *make(const mqtt_config *config)
{
    mqtt *m = calloc(1, sizeof *m);
    const note setup = note_of_config(config);
    if (!m) {
        return NULL;
    }
    m->config = *config;
    m->child.socket = EVUTIL_INVALID_SOCKET;
    m->pause_ms = PAUSE_FIRST_MS;
    m->setup = evbuffer_new();
    m->in = evbuffer_new();
    m->out = evbuffer_new();
    m->tick = alarm_new(config->base, on_tick, m);
    m->again = alarm_new(config->base, on_again, m);
    if (!m->setup || !m->in || !m->out || !m->tick || !m->again || !note_write(m->setup, &setup)) {
        destroy(m);
        return NULL;
    }
    return m;
}

mqtt *mqtt_new(const mqtt_config *config, const char **why)
{
    static char kept[NOTE_WHY_MAX_BYTES + 1];
    mqtt *m = mqtt_possible() ? make(config) : NULL;
    *why =
        mqtt_possible() ? _("not enough memory") : _("this grctl was built without libmosquitto");
    if (!m) {
        return NULL;
    }
    if (!begin(m, config, why)) {
        snprintf(kept, sizeof kept, "%s", *why);
        *why = kept;
        end_child(m);
        destroy(m);
        return NULL;
    }
    return m;
}

void mqtt_start(mqtt *m)
{
    if (m->inside) {
        direct_start(m->inside);
        return;
    }
    alarm_set(m->tick, INT64_C(1000) * MQTT_BEAT_MS);
    m->started = true;
    say_start(m);
    if (m->readable) { /* more than its answer may have come */
        event_active(m->readable, EV_READ, 0);
    }
}

void mqtt_free(mqtt *m)
{
    if (!m) {
        return;
    }
    if (os_is_socket(m->child.socket)) {
        say_kind(m, NOTE_BYE);
        size_t size = evbuffer_get_length(m->out);
        const unsigned char *last = evbuffer_pullup(m->out, -1);
        forget(&m->readable);
        forget(&m->writable);
        os_child_end(&m->child, last, last ? size : 0, GOODBYE_MS);
    }
    destroy(m);
}
