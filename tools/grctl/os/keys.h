/* SPDX-License-Identifier: MIT */
/* Single keys on the event loop; the terminal is as it was again on every way out. */
#ifndef GRCTL_KEYS_H
#define GRCTL_KEYS_H

#include <stdbool.h>

#include <event2/event.h>

/* What keys_fn gets at the end of standard input. */
enum { KEYS_END = -1 };

typedef void (*keys_fn)(void *ctx, int key);

enum { KEYS_EVENTS = 2 };

typedef struct keys {
    /* private */
    struct event *events[KEYS_EVENTS]; /* of input, SIGCONT */
    keys_fn on_key;
    void *ctx;
} keys;

/*
 * Hears keys from now on, without echo and without waiting for the end of a line: of a terminal
 * that this process has in the foreground, or of a pipe if `pipes`. Else nothing happens. Ctrl-C
 * and Ctrl-Z stay signals.
 * Returns whether it hears.
 */
bool keys_start(keys *k, struct event_base *base, bool pipes, keys_fn on_key, void *ctx);
void keys_stop(keys *k);
/* Whether a key can come at all: from a terminal in the foreground, or from a pipe that has one or
 * that some program may still write to. */
bool keys_can_come(void);
/* The terminal is as it was, until the process is continued after a suspension. */
void keys_pause(void);

#endif
