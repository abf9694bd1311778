/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include <event2/util.h>

#include <grobo/files.h>
#include <grobo/session.h>
#include <grobo/version.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/narrow.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

enum { QUEUE_BYTES = 1024 * 1024 };

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
    for (int i = 0; i < a->line.n_arguments && used < capacity; i++) {
        used += (size_t)snprintf(text + used, capacity - used, " %s", a->line.argument[i]);
    }
}

static int fail(app *a, const trace *t, int cause)
{
    if (cause == ENOENT || cause == EEXIST) {
        return app_fail(a, EXIT_FILE, cause == ENOENT ? "NOENT" : "EXISTS",
                        "%s: the trace cannot be written: %s", t->path,
                        cause == ENOENT ? file_write_error_text(GROBO_ERR_NOENT)
                                        : _("it is no trace; name another file"));
    }
    return app_fail_cause(a, EXIT_FILE, cause, "%s: the trace cannot be written", t->path);
}

/* A file with something other than a trace, as where the name of a motion stands behind --trace. */
static bool is_foreign(const char *path)
{
    static const char section[] = {'\n', '\r', '\r', '\n'}; /* in either byte order */
    char start[sizeof section];
    FILE *file = grobo_files_os()->holds(path) ? fopen(path, "rb") : NULL;
    if (!file) {
        return false;
    }
    bool same = fread(start, 1, sizeof start, file) == sizeof start &&
                memcmp(start, section, sizeof start) == 0;
    fclose(file);
    return !same;
}

/* No trace keeps a robot from being stopped: then trace_close() reports it. */
static int give_up(app *a, trace *t, int cause)
{
    if (!a->stops) {
        return fail(a, t, cause);
    }
    t->error = cause;
    return 0;
}

static const char between[] = ", "; /* family and device */

static pcapng_interface interface_of(const trace_line *line)
{
    pcapng_interface i = {.link_type = PCAPNG_LINK_USER0};
    if (line->name) {
        snprintf(i.name, sizeof i.name, "%s", line->name);
        snprintf(i.description, sizeof i.description, "%s%s%s", line->family, between,
                 line->device);
    } else {
        snprintf(i.name, sizeof i.name, "%s", line->device);
        snprintf(i.description, sizeof i.description, "%s", descriptions[line->wiring]);
    }
    i.speed_bps = (uint64_t)(line->baud_bps ? line->baud_bps : GROBO_BAUD_DEFAULT_BPS);
    return i;
}

int trace_open(trace *t, app *a, const trace_line *lines, int n_lines, int64_t now_us)
{
    pcapng_interface interfaces[GROBO_LINES_MAX];
    char comment[PCAPNG_TEXT_BYTES];
    const char *path = app_global(a, GLOBAL_TRACE)->text;
    memset(t, 0, sizeof *t);
    if (!path) {
        return 0;
    }
    a->traced = true;
    int n = lines->number > 1 ? snprintf(t->path, sizeof t->path, "%s%d", path, lines->number)
                              : snprintf(t->path, sizeof t->path, "%s", path);
    if (n < 0 || (size_t)n >= sizeof t->path) {
        return give_up(a, t, ENAMETOOLONG);
    }
    t->to_wall_us = wall_us() - now_us;
    if (is_foreign(t->path)) {
        return give_up(a, t, EEXIST);
    }
    t->file = os_create(t->path, !a->stops);
    if (!t->file) {
        return give_up(a, t, os_is_folder(t->path) ? EISDIR : errno);
    }
    for (int i = 0; i < n_lines; i++) {
        interfaces[i] = interface_of(&lines[i]);
    }
    describe(a, comment, sizeof comment);
    if (pcapng_write_head(t->file, "grctl " GROBO_VERSION_STRING, comment, interfaces, n_lines) <
            0 ||
        fflush(t->file) != 0) {
        int cause = errno;
        fclose(t->file);
        t->file = NULL;
        return give_up(a, t, cause);
    }
    t->queue = writer_new(t->file, QUEUE_BYTES);
    return t->queue ? 0 : give_up(a, t, ENOMEM);
}

int trace_open_robot(trace *t, app *a, const trace_line *line, int64_t now_us)
{
    static char ports[GROBO_LINES_MAX][GROBO_DEVICE_MAX_BYTES];
    trace_line lines[GROBO_LINES_MAX];
    const grobo_robot_def *def = robot_of(a);
    if (def->n_lines == 0) {
        return trace_open(t, a, line, 1, now_us);
    }
    for (int i = 0; i < def->n_lines; i++) {
        bool told = narrow_device(def, i, line->device, ports[i], sizeof ports[i]);
        lines[i] = (trace_line){.name = def->lines[i].name,
                                .family = def->lines[i].family->name,
                                .device = told ? ports[i] : line->device,
                                .baud_bps = (int)def->lines[i].baud_bps};
    }
    return trace_open(t, a, lines, def->n_lines, now_us);
}

void trace_bytes(trace *t, int line, grobo_direction direction, int64_t now_us,
                 const uint8_t *bytes, size_t size)
{
    pcapng_direction way = direction == GROBO_DIR_TX ? PCAPNG_OUT : PCAPNG_IN;
    while (t->queue && size > 0) {
        uint8_t block[PCAPNG_PACKET_BYTES];
        size_t n = size < PCAPNG_CHUNK_BYTES ? size : PCAPNG_CHUNK_BYTES;
        /* At once: a program that is killed has its trace, and a watcher behind a pipe sees it. */
        writer_put(t->queue, block,
                   pcapng_make_chunk(block, line, now_us + t->to_wall_us, way, bytes, n));
        bytes += n;
        size -= n;
    }
}

int trace_close(trace *t, app *a, int status)
{
    int error = t->error;
    uint64_t dropped = 0;
    if (t->queue) {
        writer_drain(t->queue);
        writer_state state = writer_look(t->queue);
        error = error ? error : state.error;
        dropped = state.dropped;
        writer_free(t->queue);
        t->queue = NULL;
    }
    if (t->file && fclose(t->file) != 0 && !error) {
        error = errno;
    }
    t->file = NULL;
    t->error = 0;
    if (error) {
        error = fail(a, t, error);
    } else if (dropped) {
        error = app_fail(a, EXIT_FILE, "IO",
                         "%s: the trace lacks %llu packets: its reader was too slow", t->path,
                         (unsigned long long)dropped);
    } else {
        return status;
    }
    return status == EXIT_DONE ? error : status;
}

bool trace_family(const pcapng_interface *interface, char *family, size_t capacity,
                  const char **device)
{
    const char *end = strstr(interface->description, between);
    size_t n = end ? (size_t)(end - interface->description) : 0;
    if (n == 0 || n >= capacity) {
        return false;
    }
    memcpy(family, interface->description, n);
    family[n] = '\0';
    *device = end + strlen(between);
    return true;
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
