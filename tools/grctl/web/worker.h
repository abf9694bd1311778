/* SPDX-License-Identifier: MIT */
/*
 * A thread for what takes long: reading motion files, checking them, solving them for balance. What
 * it works on belongs to it until it is done; nothing else of the command runs there.
 */
#ifndef GRCTL_WEB_WORKER_H
#define GRCTL_WEB_WORKER_H

#include <stdbool.h>

struct event_base;

typedef struct worker worker;
typedef struct worker_task worker_task;

/* The first member of what is to be done. */
struct worker_task {
    void (*work)(worker_task *task); /* in the thread */
    void (*done)(worker_task *task); /* in the loop; the task is its own again, and may be freed */
    worker_task *next;
    bool patient; /* it lets all others pass */
};

/* NULL: there is no memory or thread. */
worker *worker_new(struct event_base *base);
void worker_put(worker *w, worker_task *task);
/* Waits for the task that is being worked on; calls done() of all. NULL is nothing. */
void worker_free(worker *w);

#endif
