/* SPDX-License-Identifier: MIT */
/* The cockpit: a robot in a browser. evhttp is what it needs; web/none.c stands where it is not. */
#ifndef GRCTL_WEB_WEB_H
#define GRCTL_WEB_WEB_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/fleet/broker.h"

enum { WEB_PORT = 8717 };

typedef struct web_options {
    const char *folder; /* of motions */
    const char *listen; /* address, NULL: loopback */
    const char *name;   /* what else a browser may call this machine, or NULL */
    const char *imu;    /* a port, or NULL */
    uint16_t port;      /* 0: any */
    bool takes_over;    /* a page that asks for the lease gets it at once */
} web_options;

/* Serves until a signal comes. Returns the exit status. */
int web_run(app *a, const web_options *options);
/* The same of the robots at a broker: how those of a group are, and a stop for all of them. */
int web_run_fleet(app *a, const web_options *options, const broker *b, const char *group);

#endif
