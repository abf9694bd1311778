/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include <event2/util.h>

#include <grobo/version.h>

#include "file.h"
#include "os.h"
#include "trace.h"

/* By grobo_wiring. */
static const char *const descriptions[] = {"GR001 through its board", "servos on a bus"};

static int64_t wall_us(void)
{
    struct timeval now = {0, 0};
    evutil_gettimeofday(&now, NULL);
    return (int64_t)now.tv_sec * 1000000 + now.tv_usec;
}

/* The command line, as far as it says what was done. */
static void describe(const app *a, char *text, size_t capacity)
{
    size_t used = (size_t)snprintf(text, capacity, "grctl %s", a->line.command->name);
    for (int i = 0; i < a->line.n_arguments && used < capacity; i++)
        used += (size_t)snprintf(text + used, capacity - used, " %s", a->line.argument[i]);
}

static bool tried;

bool trace_was_tried(void)
{
    return tried;
}

static int fail(app *a, const trace *t, int cause)
{
    return app_fail(a, EXIT_FILE, "TRACE", "%s: the trace cannot be written: %s", t->path,
                    cause == ENOENT ? file_write_error_text(GROBO_ERR_NOENT)
                                    : file_cause_text(cause));
}

int trace_open(trace *t, app *a, const trace_line *line, int64_t now_us)
{
    pcapng_interface interface = {.link_type = PCAPNG_LINK_USER0};
    char comment[PCAPNG_TEXT_BYTES];
    const char *path = app_global(a, GLOBAL_TRACE)->text;
    int n;
    memset(t, 0, sizeof *t);
    if (!path)
        return 0;
    tried = true;
    n = line->number > 1 ? snprintf(t->path, sizeof t->path, "%s%d", path, line->number)
                         : snprintf(t->path, sizeof t->path, "%s", path);
    if (n < 0 || (size_t)n >= sizeof t->path)
        return fail(a, t, ENAMETOOLONG);
    t->to_wall_us = wall_us() - now_us;
    t->file = fopen(t->path, "wb");
    if (!t->file)
        return fail(a, t, os_is_folder(t->path) ? EISDIR : errno);
    snprintf(interface.name, sizeof interface.name, "%s", line->device);
    snprintf(interface.description, sizeof interface.description, "%s", descriptions[line->wiring]);
    interface.speed_bps = (uint64_t)(line->baud_bps ? line->baud_bps : GROBO_BAUD_DEFAULT_BPS);
    describe(a, comment, sizeof comment);
    if (pcapng_write_head(t->file, "grctl " GROBO_VERSION_STRING, comment, &interface) < 0 ||
        fflush(t->file) != 0) {
        int cause = errno;
        fclose(t->file);
        t->file = NULL;
        return fail(a, t, cause);
    }
    return 0;
}

void trace_bytes(trace *t, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                 size_t size)
{
    pcapng_direction way = direction == GROBO_DIR_TX ? PCAPNG_OUT : PCAPNG_IN;
    while (t->file && !t->error && size > 0) {
        size_t n = size < PCAPNG_CHUNK_BYTES ? size : PCAPNG_CHUNK_BYTES;
        /* Flushed: a program that is killed has its trace, and a watcher behind a pipe sees it. */
        if (pcapng_write_chunk(t->file, now_us + t->to_wall_us, way, bytes, n) < 0 ||
            fflush(t->file) != 0)
            t->error = errno;
        bytes += n;
        size -= n;
    }
}

int trace_close(trace *t, app *a, int status)
{
    int error = t->error;
    if (!t->file)
        return status;
    if (fclose(t->file) != 0 && !error)
        error = errno;
    t->file = NULL;
    if (!error)
        return status;
    error = fail(a, t, error);
    return status == EXIT_DONE ? error : status;
}

bool trace_wiring(const pcapng_interface *interface, grobo_wiring *wiring)
{
    for (int i = 0; i < (int)(sizeof descriptions / sizeof descriptions[0]); i++) {
        if (strcmp(interface->description, descriptions[i]) == 0) {
            *wiring = (grobo_wiring)i;
            return true;
        }
    }
    return false;
}
