/* SPDX-License-Identifier: MIT */
/*
 * The robots of this machine for a fleet: says how they are, and does what is ordered over the
 * broker. It moves nothing by itself: without its broker it keeps what it has, but for a motion,
 * which goes on, stops or leaves as was said when it began.
 *
 * What comes is looked at in handlers of the loop. Stops are carried out there; orders wait until
 * agent_work(), which may wait for a robot.
 */
#ifndef GRCTL_FLEET_AGENT_H
#define GRCTL_FLEET_AGENT_H

#include "tools/grctl/fleet/message.h"
#include "tools/grctl/fleet/mqtt.h"
#include "tools/grctl/play/robot_group.h"

enum {
    AGENT_PENDING = 16,       /* orders that wait for the clock of their sender, or their turn */
    AGENT_LEADERS = 8,        /* whose clocks are known */
    AGENT_GROUPS = 10,        /* all, that of -d, and labels */
    AGENT_UNTAKEN = 256,      /* events that a broker which hangs may owe an answer to */
    AGENT_PERMIT_US = 600000, /* without one for so long, what is played is let go */
    AGENT_SETTLE_US = 200000, /* from the latches to the first order */
    AGENT_CLOCK_AGE_US = 10000000 /* an offset that is older is measured again */
};

/* What becomes of a motion whose permit lapses. */
typedef enum agent_lost { AGENT_STOP = 0, AGENT_FINISH, AGENT_EXIT } agent_lost;

/* A group that its robots are of. Every group has a stop of its own. */
typedef struct agent_group {
    char name[FLEET_NAME_BYTES];
    json_t *latch; /* the stop that stands, to be told again where the broker forgot it; or NULL */
    bool telling;  /* how that went is still to be told */
} agent_group;

typedef struct agent_leader {
    char id[FLEET_ID_BYTES];
    fleet_clock clock;
    int64_t used_us;
    int64_t sent_us[FLEET_CLOCK_SAMPLES]; /* of the burst under way, by number */
} agent_leader;

typedef struct agent_order {
    bool used, timed; /* timed: judged, and its turn comes */
    fleet_order is;
    char response[FLEET_TOPIC_BYTES];
    unsigned char correlation[64];
    size_t correlation_bytes;
    int64_t came_us;
    uint64_t number; /* in the order in which they came */
} agent_order;

typedef struct agent {
    app *a;
    robot_group all;
    mqtt *m;
    const char *motions; /* the folder of motion files */
    const char *cockpit; /* a page of each robot, % for its name; or NULL */
    char host[FLEET_NAME_BYTES];
    agent_group groups[AGENT_GROUPS]; /* the first is "all" */
    int n_groups;
    char epoch[FLEET_ID_BYTES];
    char spool[1000]; /* where events wait for the broker, "" where no file can be had */
    json_t *untaken;  /* events that the broker has not taken yet, by number; or NULL */
    bool keeps;       /* events are on disk, though there is a connection */
    char will[320];   /* connection: CONNECTIONBROKEN */
    int64_t seq;
    bool away;          /* the broker, and that was said */
    bool greeted;       /* the broker heard of this life in an earlier connection */
    bool listens;       /* orders are taken */
    int64_t settled_us; /* when they will be */
    fleet_seen seen;
    agent_leader leaders[AGENT_LEADERS];
    agent_order orders[AGENT_PENDING];
    uint64_t taken; /* orders, in all */
    /* what is played */
    bool plays, started;
    agent_order play; /* whose answer is due until all are ready */
    char permit_group[FLEET_NAME_BYTES];
    int64_t permit_us;
    agent_lost on_lost;
    bool let_go; /* its permit lapsed */
    int64_t spread_us;
    int64_t start_us; /* by the clock of this machine */
    struct event *tick;
    /* robots that are not there */
    int64_t retry_us;
} agent;

/* One more group; one that is known, or that there is no room for, changes nothing. */
void agent_join(agent *g, const char *group);
/* "a stop of group NAME stands", until the next call; NULL: none does. */
const char *agent_latched(const agent *g);
/* The group of that name, or NULL: it is not of it. */
agent_group *agent_find_group(agent *g, const char *name);
/* A stop that brakes at once, not softly. */
bool agent_brakes(const agent_group *group);

/*
 * Begins; a->group or the one robot of -d are its robots. host, groups and motions were set before.
 * 0 or the exit status.
 */
int agent_begin(agent *g, app *a, const mqtt_config *broker);
/* What waits: orders, robots that may be there again, the end of a motion. */
void agent_work(agent *g);
/* Says goodbye, and leaves the robots. Returns the exit status. */
int agent_end(agent *g, int status);

#endif
