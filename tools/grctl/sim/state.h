/* SPDX-License-Identifier: MIT */
/* `sim --state FILE`: the servos' flash, kept in a file from one simulator to the next. */
#ifndef GRCTL_SIM_STATE_H
#define GRCTL_SIM_STATE_H

#include <event2/event.h>

#include <grobo/sim_server.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/os/os.h"

typedef struct sim_state {
    app *a; /* NULL: nothing is kept */
    /* private */
    grobo_sim_server *server;
    struct event *settle; /* an alarm: a flash write is over */
    bool settling;        /* it is set */
    os_lock lock;
    bool dirty, failed;
    char path[1024];
} sim_state;

/*
 * Takes the file for this simulator alone, and gives the servos the flash that is in it; a file
 * that is not there is made. Returns 0, or the exit status with the reason printed.
 */
int sim_state_start(sim_state *s, app *a, struct event_base *base, grobo_sim_server *server,
                    const char *path);
/* What happened in the simulator. */
void sim_state_event(sim_state *s, const grobo_sim_event *event);
/* Writes what is new and releases the file. Returns status, or that of a file that failed. */
int sim_state_end(sim_state *s, int status);

#endif
