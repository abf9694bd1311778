/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "tools/grctl/conn/trims.h"

static int posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                   grobo_exchange *exchange)
{
    const trims *t = ctx;
    grobo_target moved = *target;
    for (int j = 0; j < t->model.n_joints; j++) {
        moved.posture.angle_rad[j] += t->trim_rad[j];
    }
    return t->inner->posture(self, NULL, &moved, part, exchange);
}

static int parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                 grobo_joint_state *state)
{
    const trims *t = ctx;
    int error = t->inner->parse(self, NULL, joint, reply, state);
    if (error < 0) {
        return error;
    }
    if (state->valid & GROBO_FIELD_ANGLE) {
        state->angle_rad -= t->trim_rad[joint];
    }
    if (state->valid & GROBO_FIELD_GOAL) {
        state->goal_rad -= t->trim_rad[joint];
    }
    if (state->valid & GROBO_FIELD_RANGE) {
        state->low_rad -= t->trim_rad[joint];
        state->high_rad -= t->trim_rad[joint];
    }
    return error;
}

static int inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                   grobo_target *target, grobo_joint_mask *torqued)
{
    const trims *t = ctx;
    int error = t->inner->inspect(self, NULL, frame, size, target, torqued);
    for (int j = 0; error == 0 && j < t->model.n_joints; j++) {
        if (target->posture.set & GROBO_JOINT_BIT(j)) {
            target->posture.angle_rad[j] -= t->trim_rad[j];
        }
    }
    return error;
}

static double clamp(double value, double min, double max)
{
    return value < min ? min : value > max ? max : value;
}

/* The wire counts tenths of a degree: a trim between two of them would be lost in rounding. */
static double wire_rad(double deg)
{
    return grobo_rad_from_deg(round(deg * 10) / 10);
}

static void narrow(trims *t, int joint)
{
    grobo_joint *j = &t->joints[joint];
    double trim_rad = t->trim_rad[joint];
    if (trim_rad > 0) {
        j->max_rad -= trim_rad;
    } else {
        j->min_rad -= trim_rad;
    }
    j->init_rad = clamp(j->init_rad, j->min_rad, j->max_rad);
}

/* Where the narrowed limits cut the resting posture off, it ends there. */
static void narrow_rest(trims *t)
{
    if (!t->inner->rest_rad) {
        return;
    }
    for (int j = 0; j < t->model.n_joints; j++) {
        t->rest_rad[j] = clamp(t->inner->rest_rad[j], t->joints[j].min_rad, t->joints[j].max_rad);
    }
    t->driver.rest_rad = t->rest_rad;
}

/* In place of the driver's own corrections. */
static void take_offsets(trims *t, const config_robot *robot)
{
    t->driver.readback = t->readback;
    t->driver.n_readback = 0;
    for (int j = 0; j < t->model.n_joints; j++) {
        if (robot->offset_deg[j] != 0) {
            t->readback[t->driver.n_readback++] =
                (grobo_readback){grobo_rad_from_deg(robot->offset_deg[j]), (uint8_t)j};
        }
    }
}

const grobo_driver *trims_driver(trims *t, const grobo_driver *inner, const config_robot *robot)
{
    memset(t, 0, sizeof *t);
    t->inner = inner;
    t->driver = *inner;
    t->model = *inner->model;
    memcpy(t->joints, inner->model->joints, sizeof t->joints[0] * inner->model->n_joints);
    t->model.joints = t->joints;
    t->driver.model = &t->model;
    t->driver.posture = posture;
    t->driver.parse = parse;
    t->driver.inspect = inner->inspect ? inspect : NULL;
    if (robot->on_exit.given) {
        t->driver.on_exit = (grobo_exit_policy)(robot->on_exit.choice + GROBO_EXIT_OFF);
    }
    for (int j = 0; j < t->model.n_joints; j++) {
        t->trim_rad[j] = wire_rad(robot->trim_deg[j]);
        narrow(t, j);
    }
    narrow_rest(t);
    if (robot->offsets) {
        take_offsets(t, robot);
    }
    return &t->driver;
}
