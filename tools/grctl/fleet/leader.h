/* SPDX-License-Identifier: MIT */
/* Who asks a fleet: finds its agents at the broker, orders, and hears their answers. */
#ifndef GRCTL_FLEET_LEADER_H
#define GRCTL_FLEET_LEADER_H

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/fleet/message.h"
#include "tools/grctl/mqtt/mqtt.h"

enum { LEADER_PEERS = 1024, LEADER_ROBOTS = 64, LEADER_PERMIT_US = 200000 };

/* An agent. */
typedef struct peer {
    char host[FLEET_NAME_BYTES];
    char epoch[FLEET_ID_BYTES];
    char state[FLEET_NAME_BYTES]; /* of its connection */
    json_t *facts;                /* or NULL */
    json_t *states;               /* of its robots, by name; each with heard_us, of our clock */
    bool chosen;
    char waiting[FLEET_ID_BYTES]; /* the order whose answer is awaited, or "" */
    char prepared[FLEET_ID_BYTES];
    json_t *answer;  /* of the last order, or NULL */
    json_t *ended;   /* of what was prepared, or NULL */
    json_t *stopped; /* how its robots obeyed the latch that was published, or NULL */
    int64_t asked_us, took_us;
    int64_t told_us; /* from the latch to the news that its robots were told to stop; -1: none */
} peer;

typedef struct leader {
    app *a;
    conn_link link; /* its loop and signals */
    mqtt *m;
    char id[FLEET_ID_BYTES];
    char ack[FLEET_TOPIC_BYTES];
    const char *group; /* whom it asks: a group, */
    const char *host;  /* or a host alone (NULL) */
    peer *peers;
    int n;
    bool up;
    unsigned kept; /* retained messages that have come */
    const char *why;
    json_t *latch;             /* of the group, or NULL */
    char stop[FLEET_ID_BYTES]; /* the id of the latch that was published last, or "" */
    int64_t stop_us;           /* when */
    unsigned news;             /* how often agents said that they are there, or what they have */
    unsigned refused;          /* how often the broker refused what we said */
    const char *listens;       /* see leader_listen(), NULL: to no more */
    bool permits;              /* a motion is led: then a broker that goes away ends every wait */
    bool lost;                 /* it did */
    int64_t permit_seq;
    struct event *tick;
    void (*on_event)(struct leader *l, const peer *p, json_t *event); /* or NULL */
} leader;

/* Connects and finds the agents. 0 or the exit status. leader_end() in either case. */
int leader_begin(leader *l, app *a, const mqtt_config *broker, const char *group, const char *host);
void leader_end(leader *l);

/* Is it one of those that are asked? */
bool leader_has(const leader *l, const peer *p);
/* Chooses who is online; their number. */
int leader_choose(leader *l);
/* An order for each that is chosen. Takes the reference of body. */
void leader_order(leader *l, const char *verb, json_t *body);
/* Runs the loop until done (which may be NULL) says so (true), or the time is over, or a signal
 * comes. */
bool leader_wait(leader *l, int64_t bound_us, bool (*done)(const leader *l));
/* Every chosen one has answered. */
bool leader_answered(const leader *l);
/* Publishes the latch of the group: "stop", "estop", NULL to take it back. False: it is not out. */
bool leader_latch(leader *l, const char *how);
/* More of what agents say: "state", "event". */
void leader_listen(leader *l, const char *what);

#endif
