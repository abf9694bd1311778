/* SPDX-License-Identifier: MIT */
/* `grctl agent` and `grctl fleet`, run by the program grctl-fleet: their options and what runs. */
#ifndef GRCTL_FLEET_RUN_H
#define GRCTL_FLEET_RUN_H

#include "tools/grctl/fleet/broker.h"

enum {
    AGENT_HOST = BROKER_OPTIONS,
    AGENT_GROUP,
    AGENT_LABEL,
    AGENT_MOTIONS,
    AGENT_COCKPIT,
    AGENT_REALTIME,
    AGENT_OPTIONS
};

enum {
    FLEET_OPT_GROUP = BROKER_OPTIONS,
    FLEET_OPT_HOST,
    FLEET_OPT_SPEED,
    FLEET_OPT_REPEAT,
    FLEET_OPT_MIRROR,
    FLEET_OPT_IF_LOST,
    FLEET_OPT_ON_LOST,
    FLEET_OPT_SPREAD,
    FLEET_OPT_AT,
    FLEET_OPT_WATCH,
    FLEET_OPTIONS
};

/* The exit status. */
int agent_run(struct app *a);
int fleet_run(struct app *a);

#endif
