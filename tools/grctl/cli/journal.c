/* SPDX-License-Identifier: MIT */
/* A motion that is recorded, on disk posture by posture: what a power cut leaves of it. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/journal.h"
#include "tools/grctl/cli/sync.h"
#include "tools/grctl/os/os.h"

/* PAGE_BYTES: a file grows by whole pages, or by what one write() adds to a page. */
enum { PAGE_BYTES = 4096, NAMES_MAX = 100 };

int journal_begin(journal *j, const char *target)
{
    memset(j, 0, sizeof *j);
    int length = snprintf(j->path, sizeof j->path, "%s.part.m", target);
    for (int n = 2; length >= 0 && (size_t)length < sizeof j->path; n++) {
        j->file = os_create_new(j->path);
        if (j->file || errno != EEXIST || n == NAMES_MAX) {
            return j->file ? 0 : errno;
        }
        j->left = true;
        length = snprintf(j->path, sizeof j->path, "%s.part%d.m", target, n);
    }
    return ENAMETOOLONG;
}

/* A posture as a file that has no other: a line. */
static int print(heap *line, const grobo_posture *posture, const grobo_model *model)
{
    const grobo_sink sink = {.write = heap_sink, .ctx = line};
    const grobo_write_options how = {GROBO_WRITE_OPTIONS_INIT, .model = model, .exact = true};
    grobo_motion *motion;
    int error = grobo_motion_new(GROBO_MOTION_POSTURES, posture->n_joints, NULL, &motion);
    if (error < 0) {
        return ENOMEM;
    }
    error = grobo_motion_append(motion, posture);
    if (error >= 0) {
        error = grobo_motion_write(motion, GROBO_FORMAT_M, &how, &sink, NULL);
    }
    grobo_motion_free(motion);
    return error < 0 || !line->bytes || line->size > PAGE_BYTES ? ENOMEM : 0;
}

/* In one page, so that half a line is never there: blanks fill the page before. */
static int put(journal *j, const heap *line)
{
    char blanks[PAGE_BYTES];
    size_t room = PAGE_BYTES - (size_t)j->size % PAGE_BYTES;
    size_t n = line->size > room ? room : 0;
    memset(blanks, ' ', n);
    int error = os_write(j->file, blanks, n);
    if (!error) {
        error = os_write(j->file, line->bytes, line->size);
    }
    if (error) {
        (void)os_cut(j->file, j->size); /* of a full disk */
        return error;
    }
    heap_add(&j->begins, &j->size, sizeof j->size);
    j->size += (long)(n + line->size);
    return sync_soon(j->path);
}

int journal_add(journal *j, const grobo_posture *posture, const grobo_model *model)
{
    heap line = {0};
    if (!j->file) {
        return 0;
    }
    int error = print(&line, posture, model);
    if (!error) {
        error = put(j, &line);
    }
    if (error) {
        fclose(j->file);
        j->file = NULL;
    }
    free(line.bytes);
    return error;
}

void journal_drop_last(journal *j)
{
    if (!j->file || journal_size(j) == 0) {
        return;
    }
    j->begins.size -= sizeof j->size;
    memcpy(&j->size, j->begins.bytes + j->begins.size, sizeof j->size);
    (void)os_cut(j->file, j->size);
    (void)sync_soon(j->path);
}

size_t journal_size(const journal *j)
{
    return j->begins.size / sizeof j->size;
}

void journal_end(journal *j, bool keeps)
{
    if (j->file) {
        fclose(j->file);
    }
    sync_end();
    if (*j->path && !keeps) {
        (void)remove(j->path);
    }
    free(j->begins.bytes);
    memset(j, 0, sizeof *j);
}
