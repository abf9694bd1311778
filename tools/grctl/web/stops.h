/* SPDX-License-Identifier: MIT */
/* The STOP of the page: every joint stands, nothing moves before a reset, each joint confirms. */
#ifndef GRCTL_WEB_STOPS_H
#define GRCTL_WEB_STOPS_H

#include <jansson.h>

#include <grobo/core/robot.h>

#include "tools/grctl/web/lease.h"

typedef struct serve serve;
typedef struct http_request http_request;

typedef enum stops_joint {
    STOPS_SENT,    /* not read since */
    STOPS_STOPPED, /* read, and it stands */
    STOPS_MOVING,  /* read, and it turns */
    STOPS_LIMP,    /* read, and it has no torque */
    STOPS_SILENT   /* asked, and it does not answer */
} stops_joint;

typedef struct stops {
    bool latched; /* by a stop of ours */
    bool estop;
    bool held;   /* the engine is latched too */
    bool untold; /* who stops is not known yet: no event has told it */
    int64_t at_us;
    int reading; /* number of the job that confirms, 0: none */
    char by[LEASE_NAME_BYTES];
    stops_joint joints[GROBO_JOINTS_MAX];
} stops;

/*
 * A stop, again as often as it is asked for. by NULL: of a request that is not read yet; the same
 * may come again with its name. Returns the number of a job, 0, or an error.
 */
int stops_ask(serve *s, const char *by, bool estop);
/* The robot is there: a stop that was asked for before is carried out. */
void stops_begin(serve *s);
/* From each reading, each end of a job, and 30 times a second: confirms, latches. */
void stops_on_event(serve *s, const grobo_event *event);
void stops_look(serve *s);
/* Something of it is not over: it has to be looked at. */
bool stops_are_busy(const serve *s);
/* Takes it back. Returns 0 or an error. */
int stops_reset(serve *s);
/* Ours, an emergency stop of another program, or the engine's own. */
bool stops_is_latched(serve *s);
/* For what moves: no stop stands, and what it is based on is still so; else it is refused. */
bool stops_may_move(serve *s, http_request *r, const json_t *body, const char *doing);
/* Ends jogging; what moves stops softly. Latches nothing. */
void stops_halt(serve *s);
json_t *stops_json(serve *s);

#endif
