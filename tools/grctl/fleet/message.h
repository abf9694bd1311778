/* SPDX-License-Identifier: MIT */
/*
 * What agents and those who ask them say to each other: topics, and JSON of at most 1 MiB. See
 * docs/guide/fleet.md. Everything that comes from the broker is hostile until it was read here.
 */
#ifndef GRCTL_FLEET_MESSAGE_H
#define GRCTL_FLEET_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

enum {
    FLEET_VERSION = 1,
    FLEET_NAME_BYTES = 64, /* of hosts, robots and groups, with its end */
    FLEET_TOPIC_BYTES = 320,
    FLEET_URL_BYTES = 256,
    FLEET_ID_BYTES = 33, /* 16 random bytes in hexadecimal */
    FLEET_SEEN = 1024,
    FLEET_ORDER_LIFE_US = 2000000 /* no order is valid for longer */
};

#define FLEET_ROOT "grobo/v1"
/* The group of every robot. */
#define FLEET_ALL "all"

/* Letters, digits, _ and -, 1 to 63 of them: what no topic gives a meaning. */
bool fleet_is_name(const char *name);
/* A link to a page, and to nothing else. */
bool fleet_is_link(const char *url);
/* Of the machine, with - for what is no character of a name. */
void fleet_host_name(char *name);
void fleet_make_id(char *id);

/* "grobo/v1/A/B/C": parts end at the first NULL. False: too long. */
bool fleet_topic(char *topic, const char *a, const char *b, const char *c, const char *d);
/* The parts of a topic behind the root; how many there are, or 0: it is none of ours. */
int fleet_parts(const char *topic, char parts[4][FLEET_NAME_BYTES]);

/* Of a payload: an object of this version, to be released, or NULL. */
json_t *fleet_read(const void *payload, size_t size);
/* Text and number (a whole one, at most 2^53) of an object; NULL and `otherwise` where there is
 * none. */
const char *fleet_text(const json_t *object, const char *key);
int64_t fleet_number(const json_t *object, const char *key, int64_t otherwise);

/* An order. */
typedef struct fleet_order {
    char verb[FLEET_NAME_BYTES];
    char id[FLEET_ID_BYTES];    /* of the order: what has this one is done once */
    char from[FLEET_ID_BYTES];  /* whose clock the times are of */
    char epoch[FLEET_ID_BYTES]; /* the life of the agent that it is for */
    int64_t issued_us, deadline_us;
    json_t *body; /* the whole, borrowed */
} fleet_order;

/* False: why says what is wrong with it. */
bool fleet_order_read(fleet_order *order, const char *verb, json_t *body, const char **why);

/* What keeps an order from being done now, by the clock of who asks; NULL: nothing. */
const char *fleet_order_judge(const fleet_order *order, const char *epoch, int64_t their_now_us);

/* ---- what was answered before ---------------------------------------------------------------- */

typedef struct fleet_seen {
    char id[FLEET_SEEN][FLEET_ID_BYTES];
    char *answer[FLEET_SEEN];
    int next;
} fleet_seen;

/* The answer that this order got, "" while it is being done; NULL: it is new. */
const char *fleet_seen_find(const fleet_seen *seen, const char *id);
/* Notes that it is being done. The oldest one is forgotten. */
void fleet_seen_begin(fleet_seen *seen, const char *id);
/* Its answer; copied. */
void fleet_seen_end(fleet_seen *seen, const char *id, const char *answer);
void fleet_seen_free(fleet_seen *seen);

/* ---- another's clock ------------------------------------------------------------------------- */

enum { FLEET_CLOCK_SAMPLES = 8 };

/* By exchanges: we ask at `sent`, they say their time, we hear it at `heard`. */
typedef struct fleet_clock {
    int64_t offset_us[FLEET_CLOCK_SAMPLES]; /* theirs minus ours */
    int64_t trip_us[FLEET_CLOCK_SAMPLES];
    int64_t at_us[FLEET_CLOCK_SAMPLES];
    unsigned n; /* in all */
} fleet_clock;

void fleet_clock_add(fleet_clock *clock, int64_t sent_us, int64_t theirs_us, int64_t heard_us);
/*
 * The offset of the shortest of the last eight, and the bound of its error: half of that round
 * trip, and 50 us for each second since, as crystals differ. False: nothing is known.
 */
bool fleet_clock_read(const fleet_clock *clock, int64_t now_us, int64_t *offset_us,
                      int64_t *bound_us);

#endif
