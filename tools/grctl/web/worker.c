/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include <event2/event.h>

#include <grobo/core/port.h>

#include "tools/grctl/os/alarm.h"
#include "tools/grctl/web/worker.h"

/* How often the loop looks while something is being worked on. */
enum { LOOK_US = 4000 };

struct worker {
    grobo_mutex lock;
    grobo_cond changed;
    grobo_thread thread;
    struct event *look;
    worker_task *first; /* to be worked on */
    worker_task *ready; /* worked on */
    int n;              /* of the loop's: put, and not done */
    bool ending;
};

static void append(worker_task **list, worker_task *task)
{
    while (*list && (task->patient || !(*list)->patient)) {
        list = &(*list)->next;
    }
    task->next = *list;
    *list = task;
}

static GROBO_THREAD_FUNC run(void *arg)
{
    worker *w = arg;
    grobo_mutex_lock(&w->lock);
    while (!w->ending) {
        worker_task *task = w->first;
        if (!task) {
            grobo_cond_wait(&w->changed, &w->lock, GROBO_NEVER_US);
            continue;
        }
        w->first = task->next;
        grobo_mutex_unlock(&w->lock);
        task->work(task);
        grobo_mutex_lock(&w->lock);
        append(&w->ready, task);
    }
    grobo_mutex_unlock(&w->lock);
    GROBO_THREAD_RETURN;
}

static void finish(worker *w)
{
    grobo_mutex_lock(&w->lock);
    worker_task *task = w->ready;
    w->ready = NULL;
    grobo_mutex_unlock(&w->lock);
    while (task) {
        worker_task *next = task->next;
        w->n--;
        task->done(task);
        task = next;
    }
}

static void on_look(evutil_socket_t fd, short what, void *ctx)
{
    worker *w = ctx;
    (void)fd;
    (void)what;
    finish(w);
    if (w->n == 0) {
        alarm_clear(w->look);
    }
}

worker *worker_new(struct event_base *base)
{
    worker *w = calloc(1, sizeof *w);
    if (!w) {
        return NULL;
    }
    w->look = alarm_new(base, on_look, w);
    if (w->look && grobo_mutex_init(&w->lock) == GROBO_OK) {
        if (grobo_cond_init(&w->changed) == GROBO_OK) {
            if (grobo_thread_start(&w->thread, run, w) == GROBO_OK) {
                return w;
            }
            grobo_cond_deinit(&w->changed);
        }
        grobo_mutex_deinit(&w->lock);
    }
    if (w->look) {
        event_free(w->look);
    }
    free(w);
    return NULL;
}

void worker_put(worker *w, worker_task *task)
{
    if (w->n++ == 0) {
        alarm_set(w->look, LOOK_US);
    }
    grobo_mutex_lock(&w->lock);
    append(&w->first, task);
    grobo_cond_wake_all(&w->changed);
    grobo_mutex_unlock(&w->lock);
}

void worker_free(worker *w)
{
    if (!w) {
        return;
    }
    grobo_mutex_lock(&w->lock);
    w->ending = true;
    grobo_cond_wake_all(&w->changed);
    grobo_mutex_unlock(&w->lock);
    grobo_thread_join(w->thread);
    while (w->first) { /* never worked on: its owner frees it all the same */
        worker_task *task = w->first;
        w->first = task->next;
        append(&w->ready, task);
    }
    finish(w);
    event_free(w->look);
    grobo_cond_deinit(&w->changed);
    grobo_mutex_deinit(&w->lock);
    free(w);
}
