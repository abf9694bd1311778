/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/files.h>
#include <grobo/robot_file.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/os/pipe.h"

const char *file_write_error_text(int error)
{
    return error == GROBO_ERR_NOENT ? _("no such folder") : file_error_text(error);
}

const char *file_error_text(int error)
{
    switch (error) {
    case GROBO_ERR_NOENT:
        return _("no such file");
    case GROBO_ERR_ISDIR:
        return _("is a directory, not a file");
    case GROBO_ERR_EMPTY:
        return _("is empty");
    }
    return app_error_text(error);
}

const grobo_model *file_model(const app *a, const grobo_motion *motion)
{
    if (grobo_motion_is_for(motion, app_model(a))) {
        return app_model(a);
    }
    for (size_t i = 0; grobo_robot_def_at(i) && !app_global(a, GLOBAL_ROBOT)->given; i++) {
        if (grobo_motion_is_for(motion, grobo_robot_def_at(i)->model)) {
            return grobo_robot_def_at(i)->model;
        }
    }
    return NULL;
}

int file_fits(app *a, const char *path, const grobo_motion *motion, bool forced)
{
    const grobo_model *model = app_model(a);
    const char *body = grobo_motion_target_body(motion), *name = file_shown_name(path);
    int n_joints = grobo_motion_joints(motion), has = model->n_joints;
    bool other = *body && strcmp(body, "SerialRobot") != 0 && strcmp(body, model->name) != 0;
    if (grobo_motion_is_for(motion, model) || (forced && n_joints <= has)) {
        return 0;
    }
    if (n_joints > has) {
        return app_fail(a, EXIT_FILE, grobo_error_name(GROBO_ERR_ARG),
                        "%s: has %d joints, %s has %d", name, n_joints, model->name, has);
    }
    if (other) {
        return app_fail(a, EXIT_USAGE, "TYPE",
                        "%s: made for %s, not for %s; choose that robot with --robot; 'play "
                        "--force' moves the first joints of this one",
                        name, body, model->name);
    }
    return app_fail(a, EXIT_USAGE, "TYPE",
                    "%s: has fewer angles than %s has joints (%d), and names no robot; 'play "
                    "--force' moves the first ones",
                    name, model->name, has);
}

/* What a code means, where the language is not that of the library's text. */
static void explain(const grobo_diagnostic *d, char *text, size_t capacity)
{
    char code[64];
    snprintf(code, sizeof code, "[%s]", d->code);
    const char *means = lang_text(code);
    if (means != code) {
        snprintf(text, capacity, " (%s)", means);
    }
}

void file_format(const grobo_diagnostic *d, bool with_code, char *text, size_t capacity)
{
    char place[32] = "", means[128] = "";
    if (d->line && d->column) {
        snprintf(place, sizeof place, "%u:%u:", d->line, d->column);
    } else if (d->line) {
        snprintf(place, sizeof place, "%u:", d->line);
    }
    if (!with_code) {
        explain(d, means, sizeof means);
    }
    snprintf(text, capacity, "%s:%s %s%s%s%s%s%s%s", d->file, place,
             d->severity == GROBO_SEVERITY_ERROR ? "" : grobo_severity_name(d->severity),
             d->severity == GROBO_SEVERITY_ERROR ? "" : ": ", d->message, with_code ? " [" : "",
             with_code ? d->code : "", with_code ? "]" : "", means);
    app_make_one_line(text);
}

void file_print(const app *a, const grobo_diagnostic *d, const char *color)
{
    char text[APP_LINE_BYTES], means[128] = "";
    file_format(d, true, text, sizeof text);
    if (a->tty_out) {
        explain(d, means, sizeof means);
    }
    app_print("%s%s%s%s\n", color, text, *color ? "\033[0m" : "", means);
}

json_t *file_json(const grobo_diagnostics *list)
{
    json_t *all = json_array();
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        json_array_append_new(all,
                              json_pack("{s:o,s:I,s:I,s:s,s:s,s:o}", "file", app_json_text(d.file),
                                        "line", (json_int_t)d.line, "column", (json_int_t)d.column,
                                        "severity", grobo_severity_name(d.severity), "code", d.code,
                                        "message", app_json_text(d.message)));
    }
    return all;
}

void file_say_one(const app *a, const grobo_diagnostic *d)
{
    char text[1024];
    file_format(d, false, text, sizeof text);
    if (d->severity == GROBO_SEVERITY_WARNING) {
        app_note(a, "%s", text);
    } else {
        app_detail(a, "%s", text);
    }
}

/* Warnings and notes of reading, on standard error. */
static void say_all(const app *a, const grobo_diagnostics *list)
{
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        file_say_one(a, &d);
    }
}

/* The first error of the list, or what happened to the file as a whole. */
static int complain(app *a, const char *path, int error, const grobo_diagnostics *list)
{
    char text[1024];
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        if (d.severity != GROBO_SEVERITY_ERROR || strcmp(d.code, "open") == 0) {
            continue;
        }
        file_format(&d, false, text, sizeof text);
        return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s", text);
    }
    if (error == GROBO_ERR_NOENT &&
        node_installed_motion(file_last_part(path), text, sizeof text)) {
        return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: no such file; see %s", path,
                        text);
    }
    return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: %s", path, file_error_text(error));
}

static int read_stream(void *ctx, void *buffer, size_t size)
{
    FILE *stream = ctx;
    size_t n = fread(buffer, 1, size, stream);
    return n == 0 && ferror(stream) ? GROBO_ERR_IO : (int)n;
}

const char *file_last_part(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

const char *file_shown_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "(standard input)" : path;
}

int file_read(const char *path, const grobo_read_options *options, grobo_diagnostics *list,
              grobo_motion **motion)
{
    grobo_source source = {.read = read_stream, .ctx = stdin};
    grobo_read_options named = options ? *options : (grobo_read_options){GROBO_READ_OPTIONS_INIT};
    if (strcmp(path, "-") != 0 && os_is_folder(path)) {
        return GROBO_ERR_ISDIR;
    }
    if (strcmp(path, "-") != 0) {
        return pipe_is(path) ? pipe_read(path, options, list, motion)
                             : grobo_motion_read_file(path, options, list, motion);
    }
    named.name = file_shown_name(path);
    return grobo_motion_read(&source, &named, list, motion);
}

int file_refuse_pipe(app *a, const char *path)
{
    return pipe_is(path) ? app_fail(a, EXIT_FILE, grobo_error_name(GROBO_ERR_UNSUPPORTED), "%s: %s",
                                    path, _("is a pipe; a regular file is needed"))
                         : EXIT_DONE;
}

bool file_is_there(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file) {
        fclose(file);
    }
    return file != NULL;
}

heap file_rest(FILE *from, size_t most)
{
    char piece[1 << 14];
    size_t n = 0;
    heap all = {0};
    do {
        heap_add(&all, piece, n);
        n = fread(piece, 1, sizeof piece, from);
    } while (n > 0 && all.size <= most);
    int error = ferror(from) ? errno : !all.bytes ? ENOMEM : all.size > most ? EFBIG : 0;
    if (error) {
        free(all.bytes);
        all.bytes = NULL;
        errno = error;
    }
    return all;
}

heap file_bytes(const char *path, size_t most)
{
    heap all = {0};
    FILE *file = fopen(path, "rb");
    if (file) {
        all = file_rest(file, most);
        int error = errno;
        fclose(file);
        errno = error;
    }
    return all;
}

static int save(const char *path, bool exclusive, const void *bytes, size_t size)
{
    const grobo_files *files = grobo_files_os();
    grobo_file file;
    int error = files->create(&file, path, exclusive);
    if (error) {
        return error;
    }
    error = files->write(&file, bytes, size);
    if (!error) {
        return files->commit(&file);
    }
    files->discard(&file);
    return error;
}

int file_save(const char *path, const void *bytes, size_t size)
{
    return save(path, false, bytes, size);
}

int file_save_new(const char *path, const void *bytes, size_t size)
{
    return save(path, true, bytes, size);
}

/* A copy of what the shell has recorded. */
static int load_record(app *a, grobo_motion **motion)
{
    int error = a->record ? grobo_motion_dup(a->record, motion) : GROBO_ERR_EMPTY;
    return error ? app_fail(a, EXIT_FILE, grobo_error_name(error), "@record: %s",
                            a->link ? file_error_text(error) : _("only a shell has a record"))
                 : 0;
}

int file_load_listed(app *a, const char *path, const grobo_read_options *options,
                     grobo_diagnostics *list, grobo_motion **motion)
{
    if (strcmp(path, "@record") == 0) {
        return load_record(a, motion);
    }
    int error = file_read(path, options, list, motion);
    return error ? complain(a, path, error, list) : EXIT_DONE;
}

int file_list(app *a, grobo_diagnostics **list)
{
    int error = grobo_diagnostics_new(NULL, list);
    return error ? app_fail(a, EXIT_ROBOT, grobo_error_name(error), "%s", app_error_text(error))
                 : 0;
}

int file_load(app *a, const char *path, const grobo_read_options *options, grobo_motion **motion)
{
    grobo_diagnostics *list = NULL;
    int error = file_list(a, &list);
    if (error) {
        return error;
    }
    error = file_load_listed(a, path, options, list, motion);
    if (!error) {
        say_all(a, list);
    }
    grobo_diagnostics_free(list);
    return error;
}
