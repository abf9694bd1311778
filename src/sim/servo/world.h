/* SPDX-License-Identifier: MIT */
/*
 * Where the simulator meets a world with weight. Without one, a shaft is where its servo's plan is:
 * a function of time (shaft.c). With one, the plan is only what the position loop follows, and the
 * shaft is where motor, friction and load have brought it: src/sim/physics fills a grobo_i_body for
 * each servo, step by step. Nothing here refers to that directory: a program without weight does
 * not link it.
 */
#ifndef GROBO_SIM_WORLD_H
#define GROBO_SIM_WORLD_H

#include <grobo/core/sim_static.h>

/* What a shaft does, at the end of the latest step. */
typedef struct grobo_i_body {
    double angle_mdeg, speed_mdeg_s; /* of the shaft, signed */
    double winding_ma;               /* of the motor, signed as its torque */
    double duty;                     /* -1..1 of the supply */
    double strain;                   /* 0..1: how near to its most the motor works */
    int64_t strained_us;    /* since when strain is above `strained_at`; or GROBO_NEVER_US */
    double strained_at;     /* set by the servo's registers */
    int32_t profile_mdeg_s; /* the loop's set point moves no faster; 0: at once */
    bool stale;             /* registers may have changed since they were looked at */
    bool stalled;           /* at its most, and standing */
} grobo_i_body;

typedef struct grobo_i_world_ops {
    /* All shafts are where the plans are, at rest. */
    int (*begin)(grobo_sim_physics *physics, grobo_sim *sim);
    /* Lets whole steps happen up to t_us. */
    void (*advance)(grobo_sim_physics *physics, grobo_sim *sim, int64_t t_us);
    /* How the base stands. */
    int (*imu)(const grobo_sim_physics *physics, struct grobo_imu *imu);
} grobo_i_world_ops;

/* The part that the simulator knows; src/sim/physics has more behind it. */
struct grobo_sim_physics {
    const grobo_i_world_ops *ops;
    int64_t at_us;  /* end of the latest step */
    double bus_mv;  /* what is left of the battery's voltage at the servos */
    bool real_time; /* steps are due as the clock runs: grobo_sim_deadline() names them */
    bool rests;     /* nothing turned, and nothing came since: they may wait a while */
};

/* The registers of a servo may change now. */
static inline void grobo_i_world_touch(const grobo_sim_servo *servo)
{
    grobo_i_body *body = servo->body;
    if (body != NULL) {
        body->stale = true;
    }
}

/* How far behind the clock a world in real time may be: a machine that has no time for it apart. */
#define GROBO_I_WORLD_TEND_US 10000
#define GROBO_I_WORLD_REST_US 500000

static inline int64_t grobo_i_world_deadline(const grobo_sim_physics *physics)
{
    if (physics == NULL || !physics->real_time) {
        return GROBO_NEVER_US;
    }
    return physics->at_us + (physics->rests ? GROBO_I_WORLD_REST_US : GROBO_I_WORLD_TEND_US);
}

/* Something may turn now. */
static inline void grobo_i_world_wake(const grobo_sim *sim)
{
    if (sim->config.physics != NULL) {
        sim->config.physics->rests = false;
    }
}

static inline int grobo_i_world_begin(grobo_sim *sim)
{
    grobo_sim_physics *physics = sim->config.physics;
    if (physics == NULL) {
        return GROBO_OK;
    }
    physics->at_us = sim->now_us;
    return physics->ops->begin(physics, sim);
}

static inline void grobo_i_world_advance(grobo_sim *sim, int64_t t_us)
{
    grobo_sim_physics *physics = sim->config.physics;
    if (physics != NULL) {
        physics->ops->advance(physics, sim, t_us);
    }
}

#endif
