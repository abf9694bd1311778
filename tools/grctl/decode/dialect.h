/* SPDX-License-Identifier: MIT */
/*
 * How families other than RS30x talk: where a frame ends, what it says, who answers whom. A family
 * is a row of a table; what it says goes into one form, which text and JSON are made of.
 */
#ifndef GRCTL_DIALECT_H
#define GRCTL_DIALECT_H

#include <grobo/model.h>
#include <grobo/protocol.h>
#include <grobo/registers.h>

/* ---- what a frame says ----------------------------------------------------------------------- */

enum {
    TELEGRAM_PARTS_MAX = 256,
    TELEGRAM_STATUS_MAX = 9,
    TELEGRAM_TEXT_BYTES = 48,
    DIALECT_FRAME_BYTES = 1024,
    DIALECT_SENT_MAX = 4, /* requests that may still be answered */
    DIALECT_IDS = 256
};

/* One servo's share: registers that are asked for (data NULL), or bytes of them. */
typedef struct telegram_part {
    int id;
    int address; /* -1: not known which registers they are */
    int length;
    const uint8_t *data;
} telegram_part;

typedef struct telegram {
    bool reply;
    bool all;           /* to all servos; then id says nothing */
    int id;             /* -1: it names none */
    const char *action; /* "write", "sync read", "returns"; NULL: see code */
    unsigned code;      /* instruction, or the error of a reply */
    bool shares;        /* each part is a servo's own */
    size_t n_parts;
    telegram_part part[TELEGRAM_PARTS_MAX];
    size_t n_status;
    const char *status[TELEGRAM_STATUS_MAX]; /* what a reply reports of the servo */
    char trouble[TELEGRAM_TEXT_BYTES];       /* why it is no good frame though its sum is right */
    unsigned sum, right_sum;
    int sum_bytes;                     /* 0: frames of the family have no sum */
    uint8_t data[DIALECT_FRAME_BYTES]; /* room for what parts point into */
} telegram;

/* ---- how it is said -------------------------------------------------------------------------- */

/* A request, to know its reply by. */
typedef struct sent_frame {
    uint8_t bytes[DIALECT_FRAME_BYTES];
    size_t n; /* 0: none */
} sent_frame;

/* What a family looks for in bytes. */
typedef struct dialect_look {
    const uint8_t *bytes;
    size_t n;
    bool from_host, from_robot; /* both: nobody knows */
    const sent_frame *sent;     /* DIALECT_SENT_MAX of them, the last one first */
} dialect_look;

typedef struct dialect_frame {
    bool reply, echo, sum_ok;
    const sent_frame *sent; /* the request that a reply answers; NULL: not known */
} dialect_frame;

typedef struct dialect {
    const char *name;   /* of --family */
    const char *family; /* as a robot's file names it */
    const char *title;
    const grobo_servo_table *table;
    /* The frame that look->bytes begin with, whatever its sum: its size, 0 when more bytes are
     * needed, GROBO_ERR_FRAME when none begins here. */
    int (*peek)(const dialect_look *look, dialect_frame *found);
    /* Why bytes that begin no frame are none; NULL: nothing to say. */
    const char *(*why)(const uint8_t *bytes, size_t n);
    const grobo_protocol *protocol;
    /* What a command is answered by, where the protocol does not tell of all; NULL: it does. */
    int (*reply_to)(const uint8_t *frame, size_t n, grobo_reply *reply);
    /* Whether a good frame answers a request. */
    bool (*answers)(const sent_frame *sent, const uint8_t *bytes, size_t n);
    /* Takes a whole frame apart; *to comes zeroed. */
    void (*explain)(const uint8_t *bytes, size_t n, const dialect_frame *as, telegram *to);
} dialect;

extern const dialect dialect_dxl2, dialect_dxl1, dialect_sts, dialect_scs, dialect_lx16a,
    dialect_ics;

/* The row of this name; NULL for RS30x, whose frames are a line's without a dialect. */
const dialect *dialect_named(const char *name);

/* How a servo talks; NULL as above. */
const dialect *dialect_of_servo(const grobo_servo_model *servo);

/* ---- who talks ------------------------------------------------------------------------------- */

/* A line: its dialect, who is on it, and what was asked last. */
typedef struct talk {
    const dialect *dialect;   /* NULL: RS30x, straight or through GR001's board */
    const grobo_model *model; /* whose joints have names; NULL: ids only */
    const grobo_servo_model *servo[DIALECT_IDS]; /* as far as known; NULL: the first of the table */
    sent_frame sent[DIALECT_SENT_MAX];
} talk;

/* The servo of an id, for its registers; NULL: the family has none. */
const grobo_servo_model *talk_servo(const talk *t, int id);

/* The name of an id's joint, or NULL. */
const char *talk_joint(const talk *t, int id);

/* Keeps a request. */
void talk_ask(talk *t, const uint8_t *bytes, size_t n);

/* Learns from a reply which servo an id is. */
void talk_learn(talk *t, const telegram *said);

/* ---- for dialects ---------------------------------------------------------------------------- */

/* The sum of DYNAMIXEL 1.0 and LX: of the bytes behind the header, inverted. */
void dialect_sum(const uint8_t *bytes, size_t n, telegram *to);

/* The request that a frame answers, or NULL. */
const sent_frame *dialect_asked(const dialect *d, const dialect_look *look, size_t size);

/* Whether the bytes begin as one of the requests does, which an adapter returns. Its size, 0 for
 * more bytes, -1: no. */
int dialect_echo(const dialect_look *look);

#endif
