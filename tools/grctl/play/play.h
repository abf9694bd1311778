/* SPDX-License-Identifier: MIT */
/* What is to be played: the files of a command line, checked and made into clips. */
#ifndef GRCTL_PLAY_H
#define GRCTL_PLAY_H

#include <grobo/core/motion_io.h>
#include <grobo/core/sequencer.h>

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/play/options.h"

enum { PLAY_FILES_MAX = 1 + GROBO_QUEUE_MAX };

/* A motion or a body as a clip, and whose limits have slack. */
typedef struct playlist_view {
    grobo_clip clip;
    const grobo_model *model;
} playlist_view;

typedef struct playlist {
    int n;
    const char *path[PLAY_FILES_MAX];
    grobo_motion *motion[PLAY_FILES_MAX];
    grobo_body *body[PLAY_FILES_MAX];   /* where legs are solved, else NULL */
    playlist_view view[PLAY_FILES_MAX]; /* of the motion or the body */
    grobo_clip clip[PLAY_FILES_MAX];    /* the same within the slack of limits: what is played */
    grobo_play_options options[PLAY_FILES_MAX];
} playlist;

/* Options of `play`, in the order of its table. */
enum {
    PLAY_REPEAT,
    PLAY_REVERSE,
    PLAY_MIRROR,
    PLAY_SPEED,
    PLAY_FROM,
    PLAY_RATE,
    PLAY_KEY,
    PLAY_CLAMP,
    PLAY_UNWATCHED,
    PLAY_FORCE,
    PLAY_DRY_RUN,
    PLAY_TABLE,
    PLAY_IF_LOST,
    PLAY_REALTIME,
    PLAY_BODY,
    PLAY_OPTIONS = PLAY_BODY + BODY_OPTIONS
};

/*
 * Reads and checks every file of the command line: whatever is wrong is said before anything
 * moves. Returns 0 or the exit status. playlist_free() in either case.
 */
int playlist_load(playlist *list, app *a);

/* The same of one motion, which is the list's from then on; path: borrowed, for messages. */
int playlist_take(playlist *list, app *a, const char *path, grobo_motion *motion);

/* Makes the clips; start: the sensed posture, what increments count from. 0 or the exit status. */
int playlist_prepare(playlist *list, app *a, const grobo_posture *start);
/* The same from where the robot is, which is read first. */
int playlist_prepare_sensed(playlist *list, conn *c);

void playlist_free(playlist *list);

/* `play` for the robots of app.group: they begin together. Returns the exit status. */
int play_together(app *a);

/* Prints "time_ms hex" a frame; touches no port. Returns the exit status. */
int play_dry_run(playlist *list, app *a);

#endif
