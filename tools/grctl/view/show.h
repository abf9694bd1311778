/* SPDX-License-Identifier: MIT */
/* The postures of a motion as rows: as its file has them, or as they are played. */
#ifndef GRCTL_SHOW_H
#define GRCTL_SHOW_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/play/whole.h"

typedef struct show_rows {
    const grobo_motion *motion;
    const grobo_model *model; /* NULL: the motion is none of its */
    whole played;             /* meaningful with as_played */
    bool as_played;
    double rate_hz;    /* of as_played: rows a second; 0: at key poses */
    double *reached_s; /* when posture i is reached; NULL: the motion's own times say so */
    size_t n;
    int joint[GROBO_JOINTS_MAX];
    int n_joints; /* that are shown */
} show_rows;

/* Row i and its time. Returns 0 or a library error. */
int show_row(const show_rows *rows, size_t i, grobo_posture *posture, double *time_s);
/* The name of column c's joint. */
const char *show_joint_name(const show_rows *rows, int c, char *buffer, size_t capacity);

/* True of increments, which have no place. */
bool show_is_steps(const show_rows *rows);

/* Prints the rows; in columns that fit the terminal, or one line a row where there is none. */
void show_table(const app *a, const show_rows *rows);

#endif
