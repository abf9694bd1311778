/* SPDX-License-Identifier: MIT */
/* Motions to files that are replaced whole or not at all, and from a directory of motions. */
#include <stdio.h>
#include <string.h>

#include "src/base/sized.h"
#include "src/motion/format/format.h"
#include "src/motion/store/container.h"
#include "src/motion/store/diagnostics.h"

enum { NEXT_MAX = 1000000, NEXT_AT_ONCE = 100 };

typedef struct file_sink {
    const grobo_files *files;
    grobo_file *file;
} file_sink;

static int write_file(void *ctx, const void *data, size_t size)
{
    file_sink *to = ctx;

    return to->files->write(to->file, data, size);
}

int grobo_motion_may_save(const grobo_files *files, const char *path, grobo_motion_format format)
{
    grobo_motion *there = NULL;

    if (grobo_i_format_row(format) == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!files->holds(path)) {
        return 0;
    }
    int result = grobo_motion_read_file(
        path, &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .format = format}, NULL, &there);
    grobo_motion_free(there);
    return result < 0 && result != GROBO_ERR_NOMEM ? GROBO_ERR_EXISTS : result;
}

/* Writes to path, which with exclusive must not be there. */
static int save(const grobo_motion *motion, const grobo_files *files, const char *path,
                const grobo_write_options *options, grobo_diagnostics *list, bool exclusive)
{
    grobo_file file;
    file_sink sink = {files, &file};
    int result = files->create(&file, path, exclusive);

    if (result < 0) {
        return result;
    }
    grobo_motion_format format = exclusive ? GROBO_FORMAT_M : options->format;
    result = grobo_motion_write(motion, format, options, &(grobo_sink){write_file, &sink}, list);
    if (result < 0) {
        files->discard(&file);
        return result;
    }
    return files->commit(&file);
}

int grobo_motion_save(const grobo_motion *motion, const grobo_files *files, const char *path,
                      const grobo_write_options *options, grobo_diagnostics *list)
{
    if (files == NULL || path == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_write_options named;

    if (grobo_i_sized_take(&named, sizeof named, options) < 0) {
        return GROBO_ERR_ARG;
    }
    named.name = named.name != NULL ? named.name : path;
    if (named.format == GROBO_FORMAT_AUTO) {
        named.format = grobo_motion_format_of_path(path);
    }
    if (named.format == GROBO_FORMAT_AUTO) {
        named.format = grobo_motion_kind_format(motion->kind);
    }
    int result = named.replace ? 0 : grobo_motion_may_save(files, path, named.format);
    if (result == GROBO_ERR_EXISTS) {
        grobo_i_say(list, &(grobo_i_said){named.name, "save", 0, 0, GROBO_SEVERITY_ERROR},
                    "the file holds something other than a .%s motion",
                    grobo_motion_format_name(named.format));
        return result;
    }
    if (result == 0) {
        result = save(motion, files, path, &named, list, false);
    }
    if (result < 0 && result != GROBO_ERR_NOMEM) {
        grobo_i_say(list, &(grobo_i_said){named.name, "save", 0, 0, GROBO_SEVERITY_ERROR}, "%s",
                    grobo_error_text(result));
    }
    return result;
}

int grobo_motion_save_next(const grobo_motion *motion, const grobo_files *files,
                           const char *directory, const grobo_write_options *options, char *path,
                           size_t path_bytes)
{
    if (motion == NULL || files == NULL || directory == NULL || path == NULL) {
        return GROBO_ERR_ARG;
    }
    char tried[GROBO_PATH_MAX_BYTES];
    char found[GROBO_PATH_MAX_BYTES];
    int raced = 0;

    for (int n = 1; n <= NEXT_MAX && raced < NEXT_AT_ONCE; n++) {
        char name[32];
        (void)snprintf(name, sizeof name, "Motion%d.m", n);
        int length = snprintf(tried, sizeof tried, "%s%s%s", directory,
                              directory[0] != '\0' ? "/" : "", name);
        if ((size_t)length >= sizeof tried || (size_t)length >= path_bytes) {
            return GROBO_ERR_SPACE;
        }
        int result =
            files->inside(directory[0] != '\0' ? directory : ".", name, found, sizeof found);
        if (result != GROBO_ERR_NOENT) {
            continue; /* there is something of that name, whatever it is */
        }
        result = save(motion, files, tried, options, NULL, true);
        if (result == GROBO_ERR_EXISTS) {
            raced++; /* somebody else was quicker */
            continue;
        }
        if (result == 0) {
            memcpy(path, tried, (size_t)length + 1);
        }
        return result < 0 ? result : n;
    }
    return GROBO_ERR_FULL;
}

/* ---- motion directory --------------------------------------------------------------------- */

/* True for a relative name that does not climb: no root, no drive, no ".." between slashes. */
static bool stays_below(const char *name)
{
    if (name[0] == '\0' || name[0] == '/' || name[0] == '\\' || strchr(name, ':') != NULL) {
        return false;
    }
    for (const char *part = name; part != NULL;) {
        size_t length = strcspn(part, "/\\");
        if (length == 2 && part[0] == '.' && part[1] == '.') {
            return false;
        }
        part = part[length] != '\0' ? part + length + 1 : NULL;
    }
    return true;
}

int grobo_motion_find(const grobo_files *files, const char *directory, const char *name, char *path,
                      size_t path_bytes)
{
    if (directory == NULL || name == NULL || path == NULL || files == NULL) {
        return GROBO_ERR_ARG;
    }
    static const char *const extensions[] = {".m", ".yaml", ".pseq", ".mseq"};
    char tried[GROBO_PATH_MAX_BYTES];

    if (!stays_below(name)) {
        return GROBO_ERR_OUTSIDE;
    }
    if (grobo_motion_format_of_path(name) != GROBO_FORMAT_AUTO) {
        return files->inside(directory, name, path, path_bytes);
    }
    for (size_t i = 0; i < sizeof extensions / sizeof extensions[0]; i++) {
        int length = snprintf(tried, sizeof tried, "%s%s", name, extensions[i]);
        if (length < 0 || (size_t)length >= sizeof tried) {
            return GROBO_ERR_SPACE;
        }
        int result = files->inside(directory, tried, path, path_bytes);
        if (result != GROBO_ERR_NOENT) {
            return result;
        }
    }
    return GROBO_ERR_NOENT;
}

/* ---- printing ----------------------------------------------------------------------------- */

static int write_stream(void *ctx, const void *data, size_t size)
{
    return fwrite(data, 1, size, ctx) == size ? 0 : GROBO_ERR_IO;
}

int grobo_motion_print(const grobo_motion *motion, const grobo_model *model, FILE *stream)
{
    if (stream == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = model};
    grobo_sink sink = {write_stream, stream};

    return grobo_motion_write(motion, GROBO_FORMAT_M, &options, &sink, NULL);
}

int grobo_posture_print(const grobo_posture *posture, FILE *stream)
{
    if (stream == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < posture->n_joints; j++) {
        char text[GROBO_NAME_MAX_BYTES];
        int length = snprintf(text, sizeof text, "%s-", j > 0 ? " " : "");
        if ((posture->set & GROBO_JOINT_BIT(j)) != 0) {
            int ddeg = grobo_ddeg_from_rad(posture->angle_rad[j]);
            int whole = ddeg < 0 ? -ddeg : ddeg;
            length = snprintf(text, sizeof text, "%s%s%d.%d", j > 0 ? " " : "", ddeg < 0 ? "-" : "",
                              whole / 10, whole % 10);
        }
        int result = write_stream(stream, text, (size_t)length);
        if (result < 0) {
            return result;
        }
    }
    return write_stream(stream, "\n", 1);
}
