/* SPDX-License-Identifier: MIT */
/*
 * A connection to an MQTT 5 broker, on the event loop. It is made again when it is lost, with a
 * growing, random pause; nothing of before is delivered then (clean start). All handlers are called
 * from the loop. The connection itself is in a process of its own, which a broker may end by what
 * it says: then it is lost. Where the system has no such process it is in this one.
 */
#ifndef GRCTL_MQTT_H
#define GRCTL_MQTT_H

#include <stdbool.h>
#include <stddef.h>

struct event_base;

enum {
    MQTT_PORT = 1883,
    MQTT_TLS_PORT = 8883,
    MQTT_PAYLOAD_MAX_BYTES = 1 << 20, /* what is longer is dropped */
    MQTT_QUEUE_MAX_BYTES = 1 << 18    /* QoS 0 is left out while the broker does not take this */
};

typedef struct mqtt mqtt;

typedef struct mqtt_message {
    const char *topic;
    const void *payload;
    size_t size;
    bool retained;        /* it stood at the broker before we came */
    const char *response; /* where an answer goes, or NULL */
    const void *correlation;
    size_t correlation_bytes;
} mqtt_message;

typedef struct mqtt_config {
    struct event_base *base;
    const char *host;
    int port;
    const char *id;                     /* of the client */
    const char *user, *password;        /* or NULL */
    const char *ca, *certificate, *key; /* files; ca NULL: no TLS */
    const char *will_topic, *will;      /* what the broker says, retained, when we are gone; NULL */
    int keepalive_s;
    void (*on_up)(void *ctx);
    void (*on_down)(void *ctx, const char *why);
    void (*on_message)(void *ctx, const mqtt_message *message);
    void (*on_refused)(void *ctx, const char *why); /* what was published with QoS 1 */
    /* The broker has taken, or refused, what mqtt_publish() gave this number; QoS 1 alone. */
    void (*on_taken)(void *ctx, int number, bool taken);
    /* In this process: may a name be looked up now? It may take seconds. NULL: yes */
    bool (*may_block)(void *ctx);
    void *ctx;
} mqtt_config;

/* What this program was called as: it is what the process of a connection is. */
void mqtt_note_program(const char *argv0);

/* Is this build able to? */
bool mqtt_possible(void);

/* Texts are borrowed for this call. May wait a moment. NULL: why says it. */
mqtt *mqtt_new(const mqtt_config *config, const char **why);
/* Begins, and goes on trying. */
void mqtt_start(mqtt *m);
bool mqtt_is_up(const mqtt *m);
/* Its number, above 0; 0: it was left out. qos 0 or 1; expiry_s 0: it does not expire. */
int mqtt_publish(mqtt *m, const mqtt_message *message, int qos, int expiry_s);
/* Every message of the filter from now on, and, where asked for, what is retained. */
bool mqtt_subscribe(mqtt *m, const char *filter, int qos, bool retained);
/* Says goodbye, so that there is no will, and frees. NULL is fine. Not from a handler. */
void mqtt_free(mqtt *m);

#endif
