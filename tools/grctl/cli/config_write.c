/* SPDX-License-Identifier: MIT */
/* Writing trims into a configuration file that a person wrote: only they change. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

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

/* ---- another robot --------------------------------------------------------------------------- */

static void put_text(draft *to, const char *text)
{
    put(to, text, strlen(text));
}

/* A scalar in double quotes. */
static void put_quoted(draft *to, const char *text)
{
    put_text(to, "\"");
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') {
            put_text(to, "\\");
        }
        put(to, text, 1);
    }
    put_text(to, "\"");
}

static void put_entry(draft *to, const config_entry *entry, size_t indent)
{
    char number[32];
    for (size_t i = 0; i < indent; i++) {
        put_text(to, " ");
    }
    put_text(to, entry->name);
    put_text(to, ": {device: ");
    put_quoted(to, entry->device);
    put_text(to, ", robot: ");
    put_quoted(to, entry->def);
    if (entry->baud_bps) {
        snprintf(number, sizeof number, ", baud: %d", entry->baud_bps);
        put_text(to, number);
    }
    if (entry->wiring) {
        put_text(to, ", wiring: ");
        put_text(to, entry->wiring);
    }
    put_text(to, "}\n");
}

static const char *line_behind(const char *line)
{
    line += strcspn(line, "\n");
    return *line ? line + 1 : line;
}

/* What stands in front of the first robot of the list that begins here; 2 where there is none. */
static size_t indent_of(const char *line)
{
    for (; *line; line = line_behind(line)) {
        size_t indent = strspn(line, " ");
        if (line[indent] != '#' && line[indent] != '\n' && line[indent] != '\r' && line[indent]) {
            return indent ? indent : 2;
        }
    }
    return 2;
}

/* The list of robots, one below another: where its first one stands. NULL: it is none. */
static const char *find_robots(const char *text, bool *has)
{
    for (const char *line = text; *line; line = line_behind(line)) {
        if (strncmp(line, "robots:", strlen("robots:")) != 0) {
            continue;
        }
        const char *rest = line + strlen("robots:");
        rest += strspn(rest, " \t\r");
        *has = true;
        return *rest == '\n' || *rest == '#' || *rest == '\0' ? line_behind(line) : NULL;
    }
    *has = false;
    return NULL;
}

/* False: robots stand there in braces. */
static bool put_added(draft *to, const char *text, const config_entry *entry)
{
    bool has;
    const char *at = find_robots(text, &has);
    if (has && !at) {
        return false;
    }
    if (!*text) {
        put_text(to, "default: ");
        put_text(to, entry->name);
        put_text(to, "\n");
    }
    if (at) {
        put(to, text, (size_t)(at - text));
    } else {
        put_text(to, text);
    }
    if (to->used > 0 && to->used <= to->capacity && to->text[to->used - 1] != '\n') {
        put_text(to, "\n");
    }
    if (!at) {
        put_text(to, "robots:\n");
    }
    put_entry(to, entry, at ? indent_of(at) : 2);
    put_text(to, at ? at : "");
    return true;
}

static const char undo_name[] = "setup-undo";

/* What config_undo() goes by. before NULL: there was no file. */
static int keep_undo(app *a, const char *path, const char *before, const char *after,
                     const char *file)
{
    char kept[CONFIG_PATH_BYTES];
    char *made = file ? read_all(file) : NULL;
    json_t *record = json_pack("{s:s,s:s?,s:s,s:s*,s:s*}", "path", path, "before", before, "after",
                               after, "file", file, "made", made);
    char *text = record ? json_dumps(record, JSON_COMPACT) : NULL;
    int error = GROBO_ERR_NOENT;
    if (text && os_state_path(undo_name, kept, sizeof kept)) {
        error = file_save(kept, text, strlen(text));
    }
    free(text);
    free(made);
    json_decref(record);
    return error ? fail(a, path, "what it was before cannot be kept") : 0;
}

/* The folder of the user's file, made where it is not there. */
static bool find_file(char *path, size_t capacity)
{
    return os_config_path(0, path, capacity) && os_make_folders(path);
}

int config_add(app *a, const config_entry *entry, char *path, size_t capacity)
{
    draft made = {.capacity = CONFIG_FILE_MAX_BYTES};
    if (!find_file(path, capacity)) {
        return app_fail(a, EXIT_FILE, "NOENT",
                        "there is no folder for a configuration: HOME is "
                        "not set");
    }
    errno = 0;
    char *before = read_all(path);
    if (!before && errno != ENOENT) {
        return fail(a, path, app_cause_text(errno));
    }
    made.text = calloc(1, made.capacity + 1);
    bool fits = made.text && put_added(&made, before ? before : "", entry);
    int status = 0;
    if (!made.text || made.full) {
        status = fail(a, path, made.text ? "too long" : "not enough memory");
    } else if (!fits) {
        status = fail(a, path, "its robots stand in braces; add the robot by hand");
    } else {
        status = keep_undo(a, path, before, made.text, entry->file);
    }
    if (!status) {
        int error = file_save(path, made.text, made.used);
        status = error ? fail(a, path, file_error_text(error)) : 0;
    }
    free(made.text);
    free(before);
    return status;
}

/* Whether a file still has what setup wrote into it. */
static bool is_as_made(const char *path, const char *made)
{
    char *now = made ? read_all(path) : NULL;
    bool same = now && strcmp(now, made) == 0;
    free(now);
    return same;
}

static int put_back(app *a, const char *path, const char *before, const char *after)
{
    if (!is_as_made(path, after)) {
        return app_fail(a, EXIT_FILE, "STATE",
                        "%s has changed since setup wrote it; nothing is "
                        "undone",
                        path);
    }
    if (!before) {
        return remove(path) == 0 ? 0 : fail(a, path, app_cause_text(errno));
    }
    int error = file_save(path, before, strlen(before));
    return error ? fail(a, path, file_error_text(error)) : 0;
}

int config_undo(app *a, config_undone *undone)
{
    char kept[CONFIG_PATH_BYTES];
    json_t *record = os_state_path(undo_name, kept, sizeof kept)
                         ? json_load_file(kept, JSON_REJECT_DUPLICATES, NULL)
                         : NULL;
    const char *where = json_string_value(json_object_get(record, "path"));
    const char *before = json_string_value(json_object_get(record, "before"));
    const char *after = json_string_value(json_object_get(record, "after"));
    const char *file = json_string_value(json_object_get(record, "file"));
    const char *made = json_string_value(json_object_get(record, "made"));
    if (!where || !after) {
        json_decref(record);
        return app_fail(a, EXIT_USAGE, "NOENT",
                        "setup --undo: setup has written nothing that could be undone");
    }
    int status = put_back(a, where, before, after);
    if (!status) {
        snprintf(undone->path, sizeof undone->path, "%s", where);
        snprintf(undone->file, sizeof undone->file, "%s", file ? file : "");
        undone->removed = file && is_as_made(file, made) && remove(file) == 0;
        (void)remove(kept);
    }
    json_decref(record);
    return status;
}
