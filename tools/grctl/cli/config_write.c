/* SPDX-License-Identifier: MIT */
/* Writing trims into a configuration file that a person wrote: only they change. */
#include <errno.h>
#include <math.h>
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
    return file_bytes(path, CONFIG_FILE_MAX_BYTES - 1).bytes;
}

static void put_trims(const app *a, heap *to, const config_robot *robot)
{
    const char *before = "{";
    for (int j = 0; j < app_model(a)->n_joints; j++) {
        if (robot->trim_deg[j] != 0) {
            heap_print(to, "%s%s: %.10g", before, grobo_model_joint(app_model(a), j)->name,
                       robot->trim_deg[j]);
            before = ", ";
        }
    }
    heap_print(to, *before == '{' ? "{}" : "}");
}

/* Between the trims that are added and their neighbour. */
static void put_break(heap *to, const config_robot *robot)
{
    if (robot->flow) {
        heap_print(to, ", ");
    } else {
        heap_print(to, "\n%*s", (int)robot->first_column, "");
    }
}

static void put_file(const app *a, heap *to, const char *text, const config_robot *robot)
{
    bool adds = !robot->trimmed, behind = adds && robot->def_end;
    size_t at = byte_of(text, robot->trimmed ? robot->trim_at
                              : behind       ? robot->def_end
                                             : robot->first_at);
    size_t end = robot->trimmed ? byte_of(text, robot->trim_end) : at;
    if (behind && !robot->flow) {
        at = end = at + strcspn(text + at, "\n"); /* and behind its comment */
    }
    heap_add(to, text, at);
    if (behind) {
        put_break(to, robot);
    }
    heap_print(to, adds ? "trim: " : "");
    put_trims(a, to, robot);
    if (adds && !behind) {
        put_break(to, robot);
    }
    heap_print(to, "%s", text + end);
}

/* Whether a file of this text has the robot with this device and these trims. */
static bool would_read(const app *a, const heap *made, const config_robot *wanted)
{
    static config_robot found;
    bool same = config_find_in(a, made->bytes, made->size, wanted, &found);
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        same &= fabs(found.trim_deg[j] - wanted->trim_deg[j]) < 1e-6;
    }
    return same;
}

static int refuse(app *a, const char *path)
{
    return fail(a, path, N_("it would not be read as it is meant; change it by hand"));
}

/* Before it takes the place of the file: it must have the robot. 0, or the exit status. */
static int check(app *a, const heap *made, const config_robot *robot)
{
    const char *trouble = !made->bytes                         ? N_("not enough memory")
                          : made->size > CONFIG_FILE_MAX_BYTES ? N_("too long")
                                                               : NULL;
    return trouble                       ? fail(a, robot->path, trouble)
           : !would_read(a, made, robot) ? refuse(a, robot->path)
                                         : 0;
}

static int save(app *a, const char *path, const char *text, size_t size)
{
    int error = file_save(path, text, size);
    return error ? fail(a, path, file_error_text(error)) : EXIT_DONE;
}

/* It may have changed since the robot was read of it, also by the command before in a shell. */
int config_write_trims(app *a, config_robot *robot, grobo_joint_mask joints)
{
    static config_robot now;
    heap made = {0};
    char *text = read_all(robot->path);
    if (!text) {
        return fail(a, robot->path, app_cause_text(errno));
    }
    if (!config_find_in(a, text, strlen(text), robot, &now) || strcmp(now.def, robot->def) != 0) {
        free(text);
        return refuse(a, robot->path);
    }
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        now.trim_deg[j] = joints & GROBO_JOINT_BIT(j) ? robot->trim_deg[j] : now.trim_deg[j];
    }
    *robot = now;
    put_file(a, &made, text, robot);
    int status = check(a, &made, robot);
    status = status ? status : save(a, robot->path, made.bytes, made.size);
    free(made.bytes);
    free(text);
    return status;
}

/* ---- another robot --------------------------------------------------------------------------- */

/* A scalar in double quotes. */
static void put_quoted(heap *to, const char *text)
{
    heap_print(to, "\"");
    for (; *text; text++) {
        heap_print(to, *text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
    }
    heap_print(to, "\"");
}

static void put_entry(heap *to, const config_entry *entry, size_t indent)
{
    heap_print(to, "%*s%s: {device: ", (int)indent, "", entry->name);
    put_quoted(to, entry->device);
    heap_print(to, ", robot: ");
    put_quoted(to, entry->def);
    if (entry->baud_bps) {
        heap_print(to, ", baud: %d", entry->baud_bps);
    }
    if (entry->wiring) {
        heap_print(to, ", wiring: %s", entry->wiring);
    }
    heap_print(to, "}\n");
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
static bool put_added(heap *to, const char *text, const config_entry *entry)
{
    bool has;
    const char *at = find_robots(text, &has);
    if (has && !at) {
        return false;
    }
    if (!*text) {
        heap_print(to, "default: %s\n", entry->name);
    }
    heap_add(to, text, at ? (size_t)(at - text) : strlen(text));
    if (to->size > 0 && to->bytes[to->size - 1] != '\n') {
        heap_print(to, "\n");
    }
    if (!at) {
        heap_print(to, "robots:\n");
    }
    put_entry(to, entry, at ? indent_of(at) : 2);
    heap_print(to, "%s", at ? at : "");
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
    heap made = {0};
    config_robot robot = {.name = ""};
    if (!find_file(path, capacity)) {
        return app_fail(a, EXIT_FILE, "NOENT",
                        "there is no folder for a configuration: HOME is "
                        "not set");
    }
    char *before = read_all(path);
    if (!before && errno != ENOENT) {
        return fail(a, path, app_cause_text(errno));
    }
    bool fits = put_added(&made, before ? before : "", entry);
    snprintf(robot.name, sizeof robot.name, "%s", entry->name);
    snprintf(robot.path, sizeof robot.path, "%s", path);
    snprintf(robot.device, sizeof robot.device, "%s", entry->device);
    int status = fits ? check(a, &made, &robot)
                      : fail(a, path, "its robots stand in braces; add the robot by hand");
    if (!status) {
        status = keep_undo(a, path, before, made.bytes, entry->file);
    }
    if (!status) {
        status = save(a, path, made.bytes, made.size);
    }
    free(made.bytes);
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
    return save(a, path, before, strlen(before));
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
