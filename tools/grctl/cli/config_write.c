/* SPDX-License-Identifier: MIT */
/* Writing trims into a configuration file that a person wrote: only they change. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/model.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/lang/lang.h"

static int fail(app *a, const char *path, const char *cause)
{
    return app_fail(a, EXIT_FILE, "IO", "%s: cannot be written: %s", path, lang_text(cause));
}

/* libyaml counts characters, files bytes. */
static size_t byte_of(const char *text, size_t characters)
{
    size_t i = 0;
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0) { /* a byte order mark counts as none */
        i = 3;
    }
    for (; text[i] && characters > 0; characters--) {
        for (i++; ((unsigned char)text[i] & 0xc0) == 0x80;) {
            i++;
        }
    }
    return i;
}

static char *read_all(const char *path)
{
    FILE *file = fopen(path, "rb");
    char *text = file ? calloc(1, CONFIG_FILE_MAX_BYTES + 1) : NULL;
    if (text && fread(text, 1, CONFIG_FILE_MAX_BYTES, file) == CONFIG_FILE_MAX_BYTES) {
        errno = EFBIG;
        free(text);
        text = NULL;
    }
    if (file) {
        fclose(file);
    }
    return text;
}

/* Text that is put together; what has no room is missed, and `full` says so. */
typedef struct draft {
    char *text;
    size_t used, capacity;
    bool full;
} draft;

static void put(draft *to, const char *text, size_t size)
{
    to->full |= size > to->capacity - to->used;
    if (to->full) {
        return;
    }
    memcpy(to->text + to->used, text, size);
    to->used += size;
}

static void put_trims(const app *a, draft *to, const config_robot *robot)
{
    const char *before = "{";
    char one[64];
    for (int j = 0; j < app_model(a)->n_joints; j++) {
        if (robot->trim_deg[j] == 0) {
            continue;
        }
        snprintf(one, sizeof one, "%s%s: %.1f", before, app_model(a)->joints[j].name,
                 robot->trim_deg[j]);
        put(to, one, strlen(one));
        before = ", ";
    }
    put(to, "{}", *before == '{' ? 2 : 0);
    put(to, "}", *before == '{' ? 0 : 1);
}

static void put_file(const app *a, draft *to, const char *text, const config_robot *robot)
{
    size_t at = byte_of(text, robot->trimmed ? robot->trim_at : robot->first_at);
    size_t end = byte_of(text, robot->trimmed ? robot->trim_end : robot->first_at);
    put(to, text, at);
    if (!robot->trimmed) {
        put(to, "trim: ", strlen("trim: "));
    }
    put_trims(a, to, robot);
    if (!robot->trimmed && robot->flow) {
        put(to, ", ", strlen(", "));
    } else if (!robot->trimmed) {
        put(to, "\n", 1);
    }
    for (size_t i = 0; !robot->trimmed && !robot->flow && i < robot->first_column; i++) {
        put(to, " ", 1);
    }
    put(to, text + end, strlen(text + end));
}

int config_write_trims(app *a, const config_robot *robot)
{
    draft made = {.capacity = CONFIG_FILE_MAX_BYTES};
    char *text = read_all(robot->path);
    int status;
    if (!text) {
        return fail(a, robot->path, app_cause_text(errno));
    }
    made.text = malloc(made.capacity);
    if (made.text) {
        put_file(a, &made, text, robot);
    }
    if (!made.text || made.full) {
        status = fail(a, robot->path, made.text ? "too long" : "not enough memory");
    } else {
        int error = file_save(robot->path, made.text, made.used);
        status = error ? fail(a, robot->path, file_error_text(error)) : EXIT_DONE;
    }
    free(made.text);
    free(text);
    return status;
}
