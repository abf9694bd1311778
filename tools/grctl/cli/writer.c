/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/port.h>

#include "tools/grctl/cli/writer.h"
#include "tools/grctl/os/os.h"

/* What is written at once, and how often a file that takes nothing is looked at. */
enum { PIECE_BYTES = 4096, LOOK_US = 20000 };

/* Before each record in a queue. */
typedef struct head {
    uint64_t number; /* of all records of all writers */
    size_t size;
} head;

struct writer {
    writer *next;
    FILE *to;
    uint8_t *ring;
    size_t capacity, begin, used;
    head record; /* the one being written; size: what is left of it */
    bool writing;
    int error;
    uint64_t dropped;
};

/* Under the lock, but for what only the caller's thread uses. */
static struct {
    grobo_mutex lock;
    grobo_cond changed;
    grobo_thread thread;
    writer *first;
    uint64_t records;
    bool ending;
} all;

/* ---- queues --------------------------------------------------------------------------------- */

static void push(writer *w, const void *bytes, size_t size)
{
    size_t end = (w->begin + w->used) % w->capacity;
    size_t first = size < w->capacity - end ? size : w->capacity - end;
    memcpy(w->ring + end, bytes, first);
    memcpy(w->ring, (const uint8_t *)bytes + first, size - first);
    w->used += size;
}

static void pull(writer *w, void *bytes, size_t size)
{
    size_t first = size < w->capacity - w->begin ? size : w->capacity - w->begin;
    memcpy(bytes, w->ring + w->begin, first);
    memcpy((uint8_t *)bytes + first, w->ring, size - first);
    w->begin = (w->begin + size) % w->capacity;
    w->used -= size;
}

static bool is_behind(const writer *w)
{
    return w->used > 0 || w->writing;
}

/* ---- the thread ----------------------------------------------------------------------------- */

/* The writer with the oldest record of those whose files take it; *waits: another has some. */
static writer *choose(bool *waits)
{
    writer *oldest = NULL;
    *waits = false;
    for (writer *w = all.first; w; w = w->next) {
        if (w->used == 0) {
            continue;
        }
        if (w->record.size == 0) {
            pull(w, &w->record, sizeof w->record);
        }
        if (!os_takes_bytes(w->to)) {
            *waits = true;
        } else if (!oldest || w->record.number < oldest->record.number) {
            oldest = w;
        }
    }
    return oldest;
}

static void write_piece(writer *w)
{
    uint8_t piece[PIECE_BYTES];
    size_t size = w->record.size < sizeof piece ? w->record.size : sizeof piece;
    pull(w, piece, size);
    w->record.size -= size;
    w->writing = true;
    grobo_mutex_unlock(&all.lock);
    int error = os_write(w->to, piece, size);
    grobo_mutex_lock(&all.lock);
    w->writing = false;
    if (error) {
        w->error = error;
        w->used = w->record.size = 0;
    }
    grobo_cond_wake_all(&all.changed);
}

static GROBO_THREAD_FUNC run(void *arg)
{
    (void)arg;
    grobo_mutex_lock(&all.lock);
    while (!all.ending) {
        bool waits;
        writer *w = choose(&waits);
        if (w) {
            write_piece(w);
        } else {
            grobo_cond_wait(&all.changed, &all.lock,
                            waits ? grobo_now_us() + LOOK_US : GROBO_NEVER_US);
        }
    }
    grobo_mutex_unlock(&all.lock);
    GROBO_THREAD_RETURN;
}

static bool start(void)
{
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

static void end(void)
{
    grobo_mutex_lock(&all.lock);
    all.ending = true;
    grobo_cond_wake_all(&all.changed);
    grobo_mutex_unlock(&all.lock);
    grobo_thread_join(all.thread);
    grobo_cond_deinit(&all.changed);
    grobo_mutex_deinit(&all.lock);
}

/* ---- for the caller ------------------------------------------------------------------------- */

writer *writer_new(FILE *to, size_t capacity)
{
    writer *w = calloc(1, sizeof *w);
    if (!w) {
        return NULL;
    }
    w->to = to;
    w->capacity = capacity;
    w->ring = malloc(capacity);
    if (!w->ring || (!all.first && !start())) {
        free(w->ring);
        free(w);
        return NULL;
    }
    grobo_mutex_lock(&all.lock);
    w->next = all.first;
    all.first = w;
    grobo_mutex_unlock(&all.lock);
    return w;
}

void writer_put(writer *w, const void *bytes, size_t size)
{
    if (size == 0) {
        return;
    }
    grobo_mutex_lock(&all.lock);
    if (!w->error && sizeof(head) + size > w->capacity - w->used) {
        w->dropped++;
    } else if (!w->error) {
        head record = {.number = all.records++, .size = size};
        push(w, &record, sizeof record);
        push(w, bytes, size);
        grobo_cond_wake_all(&all.changed);
    }
    grobo_mutex_unlock(&all.lock);
}

writer_state writer_look(const writer *w)
{
    grobo_mutex_lock(&all.lock);
    writer_state state = {is_behind(w), w->error, w->dropped};
    grobo_mutex_unlock(&all.lock);
    return state;
}

void writer_drain(writer *w)
{
    grobo_mutex_lock(&all.lock);
    while (is_behind(w)) {
        grobo_cond_wait(&all.changed, &all.lock, GROBO_NEVER_US);
    }
    grobo_mutex_unlock(&all.lock);
}

void writer_free(writer *w)
{
    writer **at = &all.first;
    if (!w) {
        return;
    }
    writer_drain(w);
    grobo_mutex_lock(&all.lock);
    while (*at != w) {
        at = &(*at)->next;
    }
    *at = w->next;
    grobo_mutex_unlock(&all.lock);
    if (!all.first) {
        end();
    }
    free(w->ring);
    free(w);
}
