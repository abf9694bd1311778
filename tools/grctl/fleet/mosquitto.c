/* SPDX-License-Identifier: MIT */
/*
 * libmosquitto on the loop. Its descriptor is closed before it tells of a loss, so the event goes
 * in that callback, before anything else can be opened with the same number. There is one event for
 * reading and writing: of two, libevent would tell the system that one is left, of a descriptor
 * that is closed, and warn. Nothing is freed in its callbacks.
 */
#include <mosquitto.h>
#include <stdlib.h>
#include <string.h>

#include <event2/event.h>
#include <event2/util.h>

#include <grobo/core/port.h>

#include "tools/grctl/fleet/direct.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/alarm.h"

enum { MISC_MS = 500, CONNECT_MS = 5000, AT_ONCE = 10 };

/* MQTT 5.0, 2.2.2.2 and 3.8.3.1. The library's own header of these is deprecated in newer ones,
 * and old ones have no other. */
enum { MESSAGE_EXPIRY_INTERVAL = 2, RESPONSE_TOPIC = 8, CORRELATION_DATA = 9 };
enum { NO_LOCAL = 0x04, RETAIN_AS_PUBLISHED = 0x08, RETAIN_SEND = 0x00, RETAIN_DO_NOT_SEND = 0x20 };

struct direct {
    mqtt_config config;
    struct mosquitto *client;
    struct event *ready, *misc, *again; /* ready: NULL without a connection */
    char address[256]; /* of the host: looked up once, but for TLS, which compares the name */
    int pause_ms;
    int64_t tried_us;
    bool up, connecting;
    const char *refused; /* what the broker said before it closed the connection, or NULL */
    size_t queued_bytes; /* published since the socket took all of it last */
};

/* ---- the descriptor -------------------------------------------------------------------------- */

static void forget_socket(direct *m)
{
    if (m->ready) {
        event_free(m->ready);
    }
    m->ready = NULL;
}

static void on_ready(evutil_socket_t fd, short what, void *ctx);
static void lost(direct *m, const char *why);

/* What any call of the library may have left to be written. */
static void arm(direct *m)
{
    if (!m->ready) {
        return;
    }
    bool writes = mosquitto_want_write(m->client);
    short wanted = (short)(EV_READ | EV_PERSIST | (writes ? EV_WRITE : 0));
    m->queued_bytes = writes ? m->queued_bytes : 0;
    if (wanted != event_get_events(m->ready)) {
        evutil_socket_t fd = event_get_fd(m->ready);
        (void)event_del(m->ready);
        (void)event_assign(m->ready, m->config.base, fd, wanted, on_ready, m);
        if (event_add(m->ready, NULL) != 0) {
            lost(m, _("not enough memory"));
        }
    }
}

static void try_later(direct *m)
{
    m->connecting = false;
    alarm_set(m->again, INT64_C(1000) * pause_next_ms(&m->pause_ms));
}

static void lost(direct *m, const char *why)
{
    bool was = m->up || m->connecting;
    forget_socket(m);
    if (m->up && grobo_now_us() - m->tried_us > INT64_C(1000) * PAUSE_LONGEST_MS) {
        m->pause_ms =
            PAUSE_FIRST_MS; /* a broker that takes and closes is not asked ten times a second */
    }
    m->up = false;
    if (was) {
        try_later(m);
        m->config.on_down(m->config.ctx, m->refused ? m->refused : why);
        m->refused = NULL;
    }
}

/* Of the library's own errors, and those that a broker gives. */
static const char *error_text(int error)
{
    return error >= 128 ? mosquitto_reason_string(error) : mosquitto_strerror(error);
}

static void check(direct *m, int result)
{
    if (result != MOSQ_ERR_SUCCESS && m->ready) {
        lost(m, error_text(result));
    }
    arm(m);
}

/* Of a connection whose TLS has not begun and never will, libmosquitto 2.0.11 says nothing. */
static bool has_ended(evutil_socket_t fd)
{
    char byte;
    return recv(fd, &byte, sizeof byte, MSG_PEEK) == 0;
}

static void on_ready(evutil_socket_t fd, short what, void *ctx)
{
    direct *m = ctx;
    if (what & EV_WRITE) {
        check(m, mosquitto_loop_write(m->client, AT_ONCE));
    }
    if (m->ready && (what & EV_READ)) {
        check(m, mosquitto_loop_read(m->client, AT_ONCE));
        if (m->connecting && m->ready && has_ended(fd)) {
            lost(m, _("the broker cannot be reached"));
        }
    }
}

static void on_misc(evutil_socket_t fd, short what, void *ctx)
{
    direct *m = ctx;
    (void)fd;
    (void)what;
    if (m->connecting && grobo_now_us() - m->tried_us > INT64_C(1000) * CONNECT_MS) {
        lost(m, _("the broker does not answer"));
    } else if (m->ready) {
        check(m, mosquitto_loop_misc(m->client));
    }
}

static void take_socket(direct *m)
{
    evutil_socket_t fd = mosquitto_socket(m->client);
    if (fd < 0) {
        lost(m, _("no socket"));
        return;
    }
    m->ready = event_new(m->config.base, fd, EV_READ | EV_PERSIST, on_ready, m);
    if (!m->ready || event_add(m->ready, NULL) != 0) {
        lost(m, _("not enough memory"));
        return;
    }
    arm(m);
}

/* Of a host: the numeric address. */
static bool look_up(direct *m, const char **why)
{
    static grobo_os_cause cause;
    char device[300], numeric[sizeof m->address];
    const char *host = m->config.host;
    bool six = strchr(host, ':') != NULL;
    snprintf(device, sizeof device, "tcp:%s%s%s:%d", six ? "[" : "", host, six ? "]" : "",
             m->config.port);
    if (grobo_port_resolve(device, numeric, sizeof numeric, &cause) < 0) {
        *why = *cause.text ? cause.text : _("no such host");
        return false;
    }
    char *begin = numeric + strlen("tcp:"), *end = strrchr(begin, ':');
    if (*begin == '[') {
        begin++;
        end--;
    }
    snprintf(m->address, sizeof m->address, "%.*s", (int)(end - begin), begin);
    return true;
}

/* Whether a file has something in the form of PEM (RFC 7468); NULL: none is named. */
static bool has_pem(const char *path)
{
    FILE *file = path ? fopen(path, "r") : NULL;
    char line[128];
    bool found = !path;
    while (file && !found && fgets(line, sizeof line, file)) {
        found = strncmp(line, "-----BEGIN ", 11) == 0;
    }
    if (file) {
        (void)fclose(file);
    }
    return found;
}

/* libmosquitto says the same of its files and of a peer that does not shake hands. */
static const char *why_no_tls(const mqtt_config *c)
{
    return has_pem(c->ca) && has_pem(c->certificate) && has_pem(c->key)
               ? _("no TLS with what listens there, or none that these certificates fit")
               : _("a certificate or key cannot be read");
}

static void connect_now(direct *m)
{
    const mqtt_config *c = &m->config;
    const char *why;
    m->connecting = true;
    m->tried_us = grobo_now_us();
    if (!c->ca && !*m->address && !look_up(m, &why)) {
        lost(m, why);
        return;
    }
    m->tried_us = grobo_now_us();
    int result =
        mosquitto_connect_async(m->client, c->ca ? c->host : m->address, c->port, c->keepalive_s);
    if (result != MOSQ_ERR_SUCCESS) {
        lost(m, result == MOSQ_ERR_ERRNO ? _("the broker cannot be reached")
                : result == MOSQ_ERR_TLS ? why_no_tls(c)
                                         : mosquitto_strerror(result));
        return;
    }
    take_socket(m);
}

static void on_again(evutil_socket_t fd, short what, void *ctx)
{
    direct *m = ctx;
    (void)fd;
    (void)what;
    alarm_clear(m->again);
    if (m->up || m->connecting) {
        return; /* rung by itself */
    }
    bool looks_up = m->config.ca || !*m->address;
    if (looks_up && m->config.may_block && !m->config.may_block(m->config.ctx)) {
        alarm_set(m->again, INT64_C(1000) * MISC_MS);
        return;
    }
    connect_now(m);
}

/* ---- what the library tells ------------------------------------------------------------------ */

static void on_connect(struct mosquitto *client, void *ctx, int reason, int flags,
                       const mosquitto_property *properties)
{
    direct *m = ctx;
    (void)client;
    (void)flags;
    (void)properties;
    if (reason != 0) { /* the loss follows */
        m->refused = mosquitto_reason_string(reason);
        return;
    }
    m->up = true;
    m->connecting = false;
    m->config.on_up(m->config.ctx);
}

static void on_disconnect(struct mosquitto *client, void *ctx, int reason,
                          const mosquitto_property *properties)
{
    (void)client;
    (void)properties;
    lost(ctx, reason ? error_text(reason) : _("the broker closed the connection"));
}

static void on_publish(struct mosquitto *client, void *ctx, int id, int reason,
                       const mosquitto_property *properties)
{
    direct *m = ctx;
    (void)client;
    (void)properties;
    if (reason >= 128) {
        m->config.on_refused(m->config.ctx, mosquitto_reason_string(reason));
    }
    if (m->config.on_taken) {
        m->config.on_taken(m->config.ctx, id, reason < 128);
    }
}

static void on_subscribe(struct mosquitto *client, void *ctx, int id, int n, const int *granted,
                         const mosquitto_property *properties)
{
    direct *m = ctx;
    (void)client;
    (void)id;
    (void)properties;
    for (int i = 0; i < n; i++) {
        if (granted[i] >= 128) {
            m->config.on_refused(m->config.ctx, mosquitto_reason_string(granted[i]));
        }
    }
}

static void on_message(struct mosquitto *client, void *ctx, const struct mosquitto_message *raw,
                       const mosquitto_property *properties)
{
    direct *m = ctx;
    char *response = NULL;
    void *correlation = NULL;
    uint16_t correlation_bytes = 0;
    (void)client;
    if (raw->payloadlen < 0 || raw->payloadlen > MQTT_PAYLOAD_MAX_BYTES) {
        return;
    }
    (void)mosquitto_property_read_string(properties, RESPONSE_TOPIC, &response, false);
    (void)mosquitto_property_read_binary(properties, CORRELATION_DATA, &correlation,
                                         &correlation_bytes, false);
    const mqtt_message message = {.topic = raw->topic,
                                  .payload = raw->payloadlen ? raw->payload : "",
                                  .size = (size_t)raw->payloadlen,
                                  .retained = raw->retain,
                                  .response = response,
                                  .correlation = correlation,
                                  .correlation_bytes = correlation_bytes};
    m->config.on_message(m->config.ctx, &message);
    free(response);
    free(correlation);
}

/* ---- requests -------------------------------------------------------------------------------- */

bool direct_possible(void)
{
    return true;
}

bool direct_is_up(const direct *m)
{
    return m && m->up;
}

int direct_publish(direct *m, const mqtt_message *message, int qos, int expiry_s)
{
    mosquitto_property *properties = NULL;
    int number = 0;
    if (!direct_is_up(m)) {
        return 0;
    }
    if (qos == 0 && m->queued_bytes > MQTT_QUEUE_MAX_BYTES) {
        return 0;
    }
    int result = MOSQ_ERR_SUCCESS;
    if (expiry_s > 0) {
        result =
            mosquitto_property_add_int32(&properties, MESSAGE_EXPIRY_INTERVAL, (uint32_t)expiry_s);
    }
    if (!result && message->response) {
        result = mosquitto_property_add_string(&properties, RESPONSE_TOPIC, message->response);
    }
    if (!result && message->correlation_bytes) {
        result = mosquitto_property_add_binary(&properties, CORRELATION_DATA, message->correlation,
                                               (uint16_t)message->correlation_bytes);
    }
    if (!result) {
        result = mosquitto_publish_v5(m->client, &number, message->topic, (int)message->size,
                                      message->payload, qos, message->retained, properties);
    }
    mosquitto_property_free_all(&properties);
    m->queued_bytes += message->size;
    arm(m);
    return result == MOSQ_ERR_SUCCESS ? number : 0;
}

bool direct_subscribe(direct *m, const char *filter, int qos, bool retained)
{
    int options = NO_LOCAL | (retained ? RETAIN_SEND : RETAIN_DO_NOT_SEND | RETAIN_AS_PUBLISHED);
    bool done = direct_is_up(m) && mosquitto_subscribe_v5(m->client, NULL, filter, qos, options,
                                                          NULL) == MOSQ_ERR_SUCCESS;
    arm(m);
    return done;
}

/* ---- a connection ---------------------------------------------------------------------------- */

static int set_up(direct *m)
{
    const mqtt_config *c = &m->config;
    struct mosquitto *client = m->client;
    int result = mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
    if (!result) {
        result = mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
    }
    if (!result && c->user) {
        result = mosquitto_username_pw_set(client, c->user, c->password);
    }
    if (!result && c->ca) {
        result = mosquitto_tls_set(client, c->ca, NULL, c->certificate, c->key, NULL);
    }
    if (!result && c->will_topic) {
        result = mosquitto_will_set_v5(client, c->will_topic, (int)strlen(c->will), c->will, 1,
                                       true, NULL);
    }
    mosquitto_connect_v5_callback_set(client, on_connect);
    mosquitto_disconnect_v5_callback_set(client, on_disconnect);
    mosquitto_publish_v5_callback_set(client, on_publish);
    mosquitto_subscribe_v5_callback_set(client, on_subscribe);
    mosquitto_message_v5_callback_set(client, on_message);
    return result;
}

static void destroy(direct *m)
{
    forget_socket(m);
    if (m->misc) {
        event_free(m->misc);
    }
    if (m->again) {
        event_free(m->again);
    }
    mosquitto_destroy(m->client);
    mosquitto_lib_cleanup();
    free(m);
}

direct *direct_new(const mqtt_config *config, const char **why)
{
    direct *m = calloc(1, sizeof *m);
    *why = _("not enough memory");
    if (!m) {
        return NULL;
    }
    m->config = *config;
    m->pause_ms = PAUSE_FIRST_MS;
    mosquitto_lib_init();
    m->client = mosquitto_new(config->id, true, m);
    m->misc = alarm_new(config->base, on_misc, m);
    m->again = alarm_new(config->base, on_again, m);
    int result = m->client && m->misc && m->again ? set_up(m) : MOSQ_ERR_NOMEM;
    if (result != MOSQ_ERR_SUCCESS) {
        *why = result == MOSQ_ERR_INVAL && config->ca ? _("a certificate or key cannot be read")
                                                      : mosquitto_strerror(result);
    }
    if (result != MOSQ_ERR_SUCCESS) {
        destroy(m);
        return NULL;
    }
    return m;
}

void direct_start(direct *m)
{
    alarm_set(m->misc, INT64_C(1000) * MISC_MS);
    connect_now(m);
}

void direct_free(direct *m)
{
    if (!m) {
        return;
    }
    bool was_up = m->up;
    m->up = m->connecting = false;
    if (was_up) {
        (void)mosquitto_disconnect(m->client);
        for (int i = 0; i < AT_ONCE && m->ready && mosquitto_want_write(m->client); i++) {
            (void)mosquitto_loop_write(m->client, AT_ONCE);
        }
    }
    destroy(m);
}
