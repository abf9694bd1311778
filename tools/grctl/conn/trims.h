/* SPDX-License-Identifier: MIT */
/* A driver whose servos stand off by some degrees: the rest of the program does not notice. */
#ifndef GRCTL_TRIMS_H
#define GRCTL_TRIMS_H

#include "tools/grctl/cli/config.h"

typedef struct trims {
    /* private */
    grobo_driver driver;
    grobo_model model;
    grobo_joint joints[GROBO_JOINTS_MAX];
    grobo_readback readback[GROBO_JOINTS_MAX];
    const grobo_driver *inner;
    double trim_rad[GROBO_JOINTS_MAX];
    double rest_rad[GROBO_JOINTS_MAX];
} trims;

/*
 * A driver like `inner` for a configured robot; its context is the trims. A joint's limits become
 * those that hold before and behind its trim: what goes over the wire stays within the servo's.
 */
const grobo_driver *trims_driver(trims *t, const grobo_driver *inner, const config_robot *robot);

#endif
