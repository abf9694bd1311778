/* SPDX-License-Identifier: MIT */
/* From a path, memory or a source to a motion: opens, guesses the format, picks the reader. */
#include <string.h>

#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/motion/format/format.h"
#include "src/motion/format/stream.h"

enum { BUFFER_BYTES = 64 * 1024 };

/* ---- reading ------------------------------------------------------------------------------ */

/* The format that was asked for must be the one found; an extension may only be doubted. */
static int check_format(grobo_i_reader *reader, grobo_motion_format format, bool forced)
{
    grobo_motion_format found = grobo_motion_kind_format(reader->motion->kind);
    if (format == GROBO_FORMAT_AUTO || format == found) {
        return 0;
    }
    if (forced) {
        return grobo_i_refuse(reader, GROBO_ERR_TYPE, "format", reader->top, "a %s file, not %s",
                              grobo_motion_format_name(found), grobo_motion_format_name(format));
    }
    grobo_i_warn(reader, "format", reader->top, "by its name a %s file, by its contents %s",
                 grobo_motion_format_name(format), grobo_motion_format_name(found));
    return 0;
}

static int read_as(grobo_i_reader *reader)
{
    grobo_motion_format format = reader->options.format;
    bool forced = format != GROBO_FORMAT_AUTO;
    int got = grobo_i_input_fill(&reader->input);

    if (got < 0) {
        return grobo_i_refuse(reader, got, "read", (grobo_i_place){0, 0}, "%s",
                              grobo_error_text(got));
    }
    if (!forced) {
        format = grobo_motion_format_of_path(reader->file);
    }
    const grobo_i_format *row = format != GROBO_FORMAT_AUTO
                                    ? grobo_i_format_row(format)
                                    : grobo_i_format_sniff(reader->input.buffer, (size_t)got);
    int result = row->read(reader);
    return result < 0 ? result : check_format(reader, format, forced);
}

int grobo_motion_read(const grobo_source *source, const grobo_read_options *options,
                      grobo_diagnostics *list, grobo_motion **motion)
{
    if (source == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_reader reader = {.list = list, .input = {.source = source, .size = BUFFER_BYTES}};

    if (grobo_i_sized_take(&reader.options, sizeof reader.options, options) < 0 ||
        (reader.options.format != GROBO_FORMAT_AUTO &&
         grobo_i_format_row(reader.options.format) == NULL)) {
        return GROBO_ERR_ARG;
    }
    reader.file = reader.options.name != NULL ? reader.options.name : "";
    reader.mem = reader.options.mem != NULL ? reader.options.mem : grobo_mem_default();
    int result = grobo_motion_new(GROBO_MOTION_KEYS, 0, reader.mem, &reader.motion);
    if (result < 0) {
        return result;
    }
    reader.input.buffer = grobo_i_alloc(reader.mem, BUFFER_BYTES);
    result = reader.input.buffer != NULL ? read_as(&reader) : GROBO_ERR_NOMEM;
    grobo_i_free(reader.mem, reader.input.buffer, BUFFER_BYTES);
    if (result >= 0) {
        result = reader.result;
    }
    if (result < 0) {
        grobo_motion_free(reader.motion);
        return result;
    }
    *motion = reader.motion;
    return 0;
}

typedef struct memory_source {
    const unsigned char *data;
    size_t left;
} memory_source;

static int read_memory(void *ctx, void *buffer, size_t size)
{
    memory_source *memory = ctx;
    size_t count = memory->left < size ? memory->left : size;

    if (count > 0) {
        memcpy(buffer, memory->data, count);
        memory->data += count;
        memory->left -= count;
    }
    return (int)count;
}

int grobo_motion_read_memory(const void *data, size_t size, const grobo_read_options *options,
                             grobo_diagnostics *list, grobo_motion **motion)
{
    if ((data == NULL && size > 0) || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    memory_source memory = {data, size};

    return grobo_motion_read(&(grobo_source){read_memory, &memory}, options, list, motion);
}

int grobo_motion_read_file(const char *path, const grobo_read_options *options,
                           grobo_diagnostics *list, grobo_motion **motion)
{
    if (path == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_read_options named;

    if (grobo_i_sized_take(&named, sizeof named, options) < 0) {
        return GROBO_ERR_ARG;
    }
    named.name = named.name != NULL ? named.name : path;
    grobo_source source;
    int result = grobo_i_stream_open_said(path, named.name, list, &source);
    if (result < 0) {
        return result;
    }
    result = grobo_motion_read(&source, &named, list, motion);
    grobo_i_stream_close(&source);
    return result;
}
