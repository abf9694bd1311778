/* SPDX-License-Identifier: MIT */
/* The servos that answer on a line, and the robot that they may be. */
#ifndef GRCTL_FOUND_H
#define GRCTL_FOUND_H

#include "tools/grctl/robot/make.h"

typedef struct found_servo {
    const grobo_robot_family *family;
    const grobo_servo_model *servo; /* the first of the family where it does not tell */
    bool told;                      /* its model */
    bool unknown;                   /* it tells one that nobody knows */
    char model[48];                 /* its name, or the number of an unknown one */
    bool turns;                     /* it is set up to count several turns */
    bool calibrated;                /* it keeps an offset: its middle was found by hand */
    int id, baud_bps;
    bool limited; /* by its own registers: */
    double limits_deg[2];
} found_servo;

enum { FOUND_MAX = 256, FOUND_IDS = 32 };

typedef struct found_servos {
    int n;
    bool sure; /* the line left no doubt */
    found_servo servo[FOUND_MAX];
} found_servos;

/*
 * Looks at the line of -d for servos of a family, NULL: of all, at their usual rates or that of
 * -b, and asks each for its limits. All ids are asked where the first FOUND_IDS have none.
 * Returns 0, or the exit status with the reason said.
 */
int found_look(app *a, const char *family, found_servos *all);

/* Keeps those of the family and rate that most of them have; the others are named. */
void found_choose(app *a, found_servos *all);

/* Whether these servos, ids and models, are those of a robot. */
bool found_fits(const found_servos *all, const grobo_robot_def *def);

/* A sketch of joints alone, called joint1 and so on, by rising id. */
void found_sketch(app *a, const found_servos *all, const char *name, sketch *s);

/* robot new: looks, and writes a file. Returns the exit status. */
int found_new(app *a, const char *family, const char *name, const char *out);

#endif
