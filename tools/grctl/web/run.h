/* SPDX-License-Identifier: MIT */
/* `grctl serve`, run by the program grctl-serve: its options and what it does. */
#ifndef GRCTL_WEB_RUN_H
#define GRCTL_WEB_RUN_H

#include "tools/grctl/fleet/broker.h"

enum {
    SERVE_PORT = BROKER_OPTIONS,
    SERVE_LISTEN,
    SERVE_NAME,
    SERVE_OPERATOR,
    SERVE_GROUP,
    SERVE_REALTIME,
    SERVE_IMU,
    SERVE_OPTIONS
};

/* The exit status. */
int serve_run(struct app *a);

#endif
