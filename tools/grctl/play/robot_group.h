/* SPDX-License-Identifier: MIT */
/* Robots of the configuration on one loop, and a team of those that play a motion. */
#ifndef GRCTL_ROBOT_GROUP_H
#define GRCTL_ROBOT_GROUP_H

#include <grobo/core/team.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/play/play.h"

/* One robot. What it says stands behind its name. */
typedef struct seat {
    struct robot_group *all;
    const char *name;
    app a;
    config_robot robot;
    conn c;
    playlist list;
    bool is_open;
    bool chosen;      /* to be of the next team */
    int member;       /* of the team, -1: none */
    int64_t began_us; /* when its part of the motion began, 0: not yet */
    int status;       /* the exit status so far */
} seat;

typedef struct robot_group {
    app *a;
    conn_link host; /* whose loop and signals all use */
    seat *seats;
    int n;
    grobo_team *team; /* NULL: nothing is played */
    grobo_team_event_fn on_team;
    void (*on_robot)(seat *s, const grobo_event *event); /* besides, or NULL */
    void *ctx;                                           /* of on_team */
    /* private */
    struct event *timer;
} robot_group;

/* Seats for these robots, none open. names: borrowed. 0 or the exit status. */
int robot_group_begin(robot_group *t, app *a, char (*names)[CONFIG_NAME_BYTES], int n);
/* Connects with one robot, which may be moved then. seat_close() in either case. */
int seat_open(robot_group *t, int i);
/* The same with one that may not be there: then it is closed again, and why says it. */
int seat_try(robot_group *t, int i, char why[APP_LINE_BYTES]);
/* Reads and checks the files of seat.a.line. 0 or the exit status. */
int seat_load(seat *s);
/* Makes the clips, from where the robot is. 0 or the exit status. */
int seat_prepare(seat *s);
/* What of all its joints is worth a word; hottest -1, NAN: not known. */
typedef struct seat_worst {
    int on, hottest;
    double hottest_c, lowest_v;
} seat_worst;
seat_worst seat_get_worst(const seat *s);
/* Plays the first clip of every chosen seat. 0, or an error: see grobo_team_play(). */
int robot_group_play(robot_group *t, grobo_team_policy policy, const grobo_play_options *options);
/* Lets the team look at the time; after any request of it. */
void robot_group_look(robot_group *t);
/* Ends the team; what it played must be over, or be stopped by who asks. */
void robot_group_disband(robot_group *t);
/* As conn_close(). */
int seat_close(seat *s, int status);
void robot_group_end(robot_group *t);

#endif
