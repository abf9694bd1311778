/* SPDX-License-Identifier: MIT */
/* Who asks a fleet: finds its agents at the broker, orders, and hears their answers. */
#ifndef GRCTL_FLEET_LEADER_H
#define GRCTL_FLEET_LEADER_H

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/fleet/message.h"
#include "tools/grctl/fleet/mqtt.h"

enum { LEADER_PEERS = 1024, LEADER_ROBOTS = 64, LEADER_PERMIT_US = 200000 };

/* An agent. */
typedef struct peer {
    char host[FLEET_NAME_BYTES];
    char epoch[FLEET_ID_BYTES];
    char state[FLEET_NAME_BYTES]; /* of its connection */
    json_t *facts;                /* or NULL */
    json_t *states;               /* of its robots, by name; each with heard_us, of our clock */
    bool chosen;
    bool gone;                    /* since it was chosen it left, or began another life */
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
    unsigned ups;               /* how often the broker was there */
    unsigned kept;              /* retained messages that have come */
    const char *why;            /* the broker is away, or NULL: it was never told */
    const char *broker;         /* its host */
    json_t *latch;              /* of the group, or NULL */
    char stop[FLEET_ID_BYTES];  /* the id of the latch that was published last, or "" */
    int64_t stop_us;            /* when */
    int stop_number;            /* of that message */
    bool stop_taken;            /* the broker has it */
    bool stop_refused;          /* or wants it not */
    const char *first;          /* how to stop before anything else, or NULL */
    char stood[FLEET_ID_BYTES]; /* the stop that stood when we came, or "" */
    unsigned news;              /* how often agents said that they are there, or what they have */
    unsigned refused;           /* how often the broker refused what we said */
    const char *listens;        /* see leader_listen(), NULL: to no more */
    bool permits;               /* a motion is led: then a broker that goes away ends every wait */
    bool lost;                  /* it did */
    int64_t permit_seq;
    struct event *tick;
    void (*on_event)(struct leader *l, const peer *p, json_t *event); /* or NULL */
} leader;

/*
 * Begins to connect. stop: "stop", "estop", the latch that is published as soon as the broker takes
 * us, before anything is asked or heard; or NULL. 0 or the exit status. leader_end() in either
 * case.
 */
int leader_open(leader *l, app *a, const mqtt_config *broker, const char *group, const char *stop);
/* The same; waits for the broker, and finds the agents. host: NULL, or that of whom it asks. */
int leader_begin(leader *l, app *a, const mqtt_config *broker, const char *group, const char *host,
                 const char *stop);
void leader_end(leader *l);

/* Is it one of those that are asked? */
bool leader_has(const leader *l, const peer *p);
/* It is there, and never said of which groups it is. */
bool leader_is_unknown(const peer *p);
/* Chooses who is online; their number. */
int leader_choose(leader *l);
/* An order for each that is chosen. Takes the reference of body. */
void leader_order(leader *l, const char *verb, json_t *body);
/* Runs the loop until done (which may be NULL) says so (true), or the time is over, or a signal
 * comes. */
bool leader_wait(leader *l, int64_t bound_us, bool (*done)(const leader *l));
/* Every chosen one has answered, or is gone. */
bool leader_answered(const leader *l);
/* One of the chosen is gone. */
bool leader_lacks(const leader *l);
/* Publishes the latch of the group: "stop", "estop", NULL to take it back. False: it is not out. */
bool leader_latch(leader *l, const char *how);
/* More of what agents say: "state", "event". */
void leader_listen(leader *l, const char *what);

#endif
