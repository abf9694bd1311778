/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/sync.h"
#include "tools/grctl/fleet/message.h"
#include "tools/grctl/fleet/spool.h"

enum { PATH_BYTES = 1024 };

static void name_old(const char *path, char old[PATH_BYTES])
{
    snprintf(old, PATH_BYTES, "%s.old", path);
}

bool spool_add(const char *path, const json_t *event)
{
    char old[PATH_BYTES];
    char *text = json_dumps(event, JSON_COMPACT);
    FILE *file = text && strlen(text) < SPOOL_LINE_BYTES - 1 ? fopen(path, "ab") : NULL;
    /* The last may be half a line: of a full disk, or of one that lost its power. */
    bool ok = file && fprintf(file, "\n%s\n", text) > 0 && fflush(file) == 0;
    bool full = ok && ftell(file) >= SPOOL_FILE_BYTES - SPOOL_LINE_BYTES;
    if (file) {
        ok = fclose(file) == 0 && ok;
    }
    if (full) {
        name_old(path, old);
        (void)remove(old);
        ok = rename(path, old) == 0 && ok;
    }
    free(text);
    return ok && sync_soon(full ? old : path) == 0;
}

static void empty_one(const char *path, void (*take)(void *ctx, json_t *event), void *ctx)
{
    static char line[SPOOL_LINE_BYTES];
    FILE *file = fopen(path, "rb");
    while (file && fgets(line, sizeof line, file)) {
        json_t *event = fleet_read(line, strlen(line));
        if (event) {
            take(ctx, event);
        }
        json_decref(event);
    }
    if (file) {
        fclose(file);
        (void)remove(path);
    }
}

void spool_empty(const char *path, void (*take)(void *ctx, json_t *event), void *ctx)
{
    char old[PATH_BYTES];
    name_old(path, old);
    empty_one(old, take, ctx);
    empty_one(path, take, ctx);
}
