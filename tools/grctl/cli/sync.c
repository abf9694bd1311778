/* SPDX-License-Identifier: MIT */
/* Files are synced to the disk by a thread of their own: nobody else waits for it. */
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/files.h>

#include "tools/grctl/cli/sync.h"
#include "tools/grctl/os/os.h"

enum { PATHS_MAX = 4 }; /* at once: a file, and the one that it became */

/* Under the lock, but for runs, which only the caller's thread uses. */
static struct {
    grobo_mutex lock;
    grobo_cond changed;
    grobo_thread thread;
    char path[PATHS_MAX][GROBO_PATH_MAX_BYTES]; /* that wait, the first one first */
    int n;
    int error;
    bool ending;
    bool runs;
} all;

/* A file that is gone by now needs nothing. */
static int sync_one(const char *path)
{
    FILE *file = fopen(path, "r+b");
    if (!file) {
        return errno == ENOENT ? 0 : errno;
    }
    int error = os_sync(file);
    fclose(file);
    os_sync_folder(path);
    return error;
}

static GROBO_THREAD_FUNC run(void *arg)
{
    char path[GROBO_PATH_MAX_BYTES];
    (void)arg;
    grobo_mutex_lock(&all.lock);
    while (all.n > 0 || !all.ending) {
        if (all.n == 0) {
            grobo_cond_wait(&all.changed, &all.lock, GROBO_NEVER_US);
            continue;
        }
        memcpy(path, all.path[0], sizeof path);
        memmove(all.path[0], all.path[1], (size_t)--all.n * sizeof all.path[0]);
        grobo_mutex_unlock(&all.lock);
        int error = sync_one(path);
        grobo_mutex_lock(&all.lock);
        all.error = all.error ? all.error : error;
    }
    grobo_mutex_unlock(&all.lock);
    GROBO_THREAD_RETURN;
}

static bool start(void)
{
    all.n = all.error = 0;
    all.ending = false;
    if (grobo_mutex_init(&all.lock) < 0) {
        return false;
    }
    if (grobo_cond_init(&all.changed) == GROBO_OK) {
        if (grobo_thread_start(&all.thread, run, NULL) == GROBO_OK) {
            return true;
        }
        grobo_cond_deinit(&all.changed);
    }
    grobo_mutex_deinit(&all.lock);
    return false;
}

/* Whoever waits already has what was written since synced too. */
static bool waits(const char *path)
{
    for (int i = 0; i < all.n; i++) {
        if (strcmp(all.path[i], path) == 0) {
            return true;
        }
    }
    return false;
}

int sync_soon(const char *path)
{
    all.runs = all.runs || start();
    if (!all.runs) {
        return ENOMEM;
    }
    grobo_mutex_lock(&all.lock);
    if (!waits(path) && all.n < PATHS_MAX) {
        snprintf(all.path[all.n++], sizeof all.path[0], "%s", path);
        grobo_cond_wake_all(&all.changed);
    }
    int error = all.error;
    grobo_mutex_unlock(&all.lock);
    return error;
}

void sync_end(void)
{
    if (!all.runs) {
        return;
    }
    grobo_mutex_lock(&all.lock);
    all.ending = true;
    grobo_cond_wake_all(&all.changed);
    grobo_mutex_unlock(&all.lock);
    grobo_thread_join(all.thread);
    grobo_cond_deinit(&all.changed);
    grobo_mutex_deinit(&all.lock);
    all.runs = false;
}
