/* SPDX-License-Identifier: MIT */
/*
 * What the two processes of a connection say to each other: notes of one form, each with its
 * length. The process that speaks with the broker may be anything by the time it says one: what it
 * says is as foreign as what the broker says, and is read here.
 */
#ifndef GRCTL_MQTT_NOTE_H
#define GRCTL_MQTT_NOTE_H

#include <stdint.h>

#include "tools/grctl/fleet/mqtt.h"

struct evbuffer;

enum {
    NOTE_NUMBERS = 4,
    NOTE_TEXTS = 9,
    NOTE_TEXT_MAX_BYTES = 65535, /* as MQTT has it */
    NOTE_WHY_MAX_BYTES = 255,
    NOTE_MAX_BYTES = MQTT_PAYLOAD_MAX_BYTES + (1 << 20)
};

typedef enum note_kind {
    /* to the one that has the connection */
    NOTE_CONFIG = 1, /* numbers: port, keepalive in s, TLS; texts: see note_of_config() */
    NOTE_START,
    NOTE_PUBLISH,   /* numbers: era, its number, QoS, expiry in s; the message */
    NOTE_SUBSCRIBE, /* numbers: era, QoS, retained; texts: the filter */
    NOTE_BYE,       /* it says goodbye to the broker, and ends */
    /* from it */
    NOTE_READY,  /* it can be told to start */
    NOTE_FAILED, /* it cannot; texts: why */
    NOTE_UP,     /* numbers: era */
    NOTE_DOWN,   /* texts: why */
    NOTE_MESSAGE,
    NOTE_REFUSED, /* texts: why */
    NOTE_TAKEN,   /* numbers: its number, whether */
    /* both */
    NOTE_BEAT /* it runs */
} note_kind;

/* Texts are borrowed. The message has its topic, response, payload, correlation and retained. */
typedef struct note {
    note_kind kind;
    uint32_t number[NOTE_NUMBERS];
    const char *text[NOTE_TEXTS]; /* each may be NULL */
    mqtt_message message;
} note;

/* Adds its bytes. False: there is no room, or it is too long; nothing is added. */
bool note_write(struct evbuffer *to, const note *n);
/*
 * The next one: 1, to be dropped by note_drop() when it was used, its texts stand in the buffer; 0:
 * more has to come; -1: it is none, and nothing behind it is.
 */
int note_read(struct evbuffer *from, note *n);
void note_drop(struct evbuffer *from);

/* May that come from the process that has the connection? Its fields are within their bounds. */
bool note_is_news(const note *n);

/* A reason: a short line of text. */
bool note_is_why(const char *text);

/* The one that tells a configuration, and back; texts are borrowed. */
note note_of_config(const mqtt_config *config);
void note_to_config(const note *n, mqtt_config *config);

#endif
