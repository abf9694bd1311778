/* SPDX-License-Identifier: MIT */
/* A session on a loop for tests, and what it told. */
#ifndef GROBO_TESTS_SESSION_KIT_H
#define GROBO_TESTS_SESSION_KIT_H

#include <grobo/session.h>

/* What session_kit_begin() and session_kit_make() make. */
extern struct event_base *base;
extern grobo_session *session;

/* Each event of the line, and each end of a job, ends the loop's run. */
typedef struct session_seen {
    int ups, losts, fails, unguarded;
    int error;        /* of the last event of the line */
    int64_t at_us;    /* when it came */
    int robot;        /* number of the engine's events */
    int job, result;  /* the last job that ended */
    size_t tapped[2]; /* bytes, by grobo_direction */
    size_t taps[2];   /* how often, by grobo_direction */
    /* Called behind, or NULL; they may free the session. */
    void (*then_line)(grobo_session *from);
    void (*then_robot)(const grobo_event *event);
} session_seen;

extern session_seen seen;

/* A new loop, nothing seen. */
void session_kit_begin(void);

/* A session on it that tells what it does. */
void session_kit_make(grobo_session_config config);

/* Waits for a job that a request returned; its result. */
int session_kit_await(int job);

/* Frees session and loop. */
void session_kit_end(void);

#endif
