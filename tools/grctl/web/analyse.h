/* SPDX-License-Identifier: MIT */
/* A motion before it is played: may it be, would the robot fall, what would it look like. */
#ifndef GRCTL_WEB_ANALYSE_H
#define GRCTL_WEB_ANALYSE_H

#include <jansson.h>

#include "tools/grctl/play/play.h"

/* Postures of an answer at most: longer motions are told at a lower rate. */
enum { ANALYSE_FRAMES_MAX = 3000, ANALYSE_POSES = 5 };

typedef struct analysis {
    app app; /* hushed; its line is that of `play` */
    char said[APP_LINE_BYTES];
    grobo_motion *motion; /* as the file has it; NULL: unreadable */
    grobo_diagnostics *found;
    playlist list;
    int status; /* the exit status of `play` */
    bool clip;  /* the list has one */
    bool falls;
    double falls_s;
    bool assumed;               /* the feet are taken to stand */
    json_t *findings, *balance; /* lists by time; NULL: no balance is known */
} analysis;

/*
 * Begins one: the options of `play` are to be set in app.line after it. path: borrowed, for
 * messages. False: no memory.
 */
bool analysis_begin(analysis *n, const app *a, const char *path);
/* Reads, checks, solves. balance: each frame is kept for a time line. */
void analysis_read(analysis *n, const void *bytes, size_t size, bool balance);
/* The same for a motion that is there, which it takes. */
void analysis_take(analysis *n, grobo_motion *motion, bool balance);
void analysis_end(analysis *n);

json_t *analysis_check_json(const analysis *n);
json_t *analysis_diagnostics_json(const analysis *n);
json_t *analysis_balance_json(const analysis *n);
json_t *analysis_keys_json(const analysis *n);
json_t *analysis_frames_json(analysis *n, double rate_hz);
json_t *analysis_thumbnail_json(analysis *n);
double analysis_length_ms(const analysis *n);
const char *analysis_kind(const analysis *n);

#endif
