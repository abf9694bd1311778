/* SPDX-License-Identifier: MIT */
/* A robot's description from bytes, or from a file with servo models beside it. */
#include <stdio.h>

#include "ports/common/common.h"
#include "src/base/memory.h"
#include "src/motion/format/stream.h"
#include "src/robots/file/own.h"

enum { BUFFER_BYTES = 16 * 1024 };

static int read_file(grobo_i_reader *reader, grobo_i_robot_file *file)
{
    grobo_i_draft *draft = grobo_i_new(reader->mem, sizeof *draft);
    if (draft == NULL) {
        return GROBO_ERR_NOMEM;
    }
    draft->reader = reader;
    int result = grobo_i_read_draft(reader, draft);
    if (result == 0 && reader->result == 0) {
        result = grobo_i_robot_make(draft, file);
    }
    grobo_i_free(reader->mem, draft, sizeof *draft);
    return result < 0 ? result : reader->result;
}

static void release(grobo_i_robot_file *file, const grobo_mem *mem)
{
    if (file != NULL) {
        grobo_i_own_servos_free(mem, file->own);
    }
    grobo_i_free(mem, file, sizeof *file);
}

int grobo_i_robot_read(const grobo_source *source, const char *name, const grobo_i_beside *beside,
                       grobo_diagnostics *list, const grobo_mem *mem, grobo_robot_def **def)
{
    grobo_i_reader reader = {.options = {.keep_going = true},
                             .file = name,
                             .mem = mem != NULL ? mem : grobo_mem_default(),
                             .list = list,
                             .input = {.source = source, .size = BUFFER_BYTES}};
    grobo_i_robot_file *file = grobo_i_new(reader.mem, sizeof *file);
    reader.input.buffer = grobo_i_alloc(reader.mem, BUFFER_BYTES);
    int result = GROBO_ERR_NOMEM;
    if (file != NULL && reader.input.buffer != NULL) {
        file->beside = beside;
        result = read_file(&reader, file);
        file->beside = NULL;
    }
    grobo_i_free(reader.mem, reader.input.buffer, BUFFER_BYTES);
    if (result < 0) {
        release(file, reader.mem);
        return result;
    }
    file->mem = reader.mem;
    *def = &file->def;
    return GROBO_OK;
}

int grobo_robot_def_read(const grobo_source *source, const char *name, grobo_diagnostics *list,
                         const grobo_mem *mem, grobo_robot_def **def)
{
    if (source == NULL || name == NULL || def == NULL) {
        return GROBO_ERR_ARG;
    }
    return grobo_i_robot_read(source, name, NULL, list, mem, def);
}

/* A pipe would be waited for. */
static int open_beside(void *ctx, const char *path, grobo_source *source)
{
    (void)ctx;
    int result = grobo_i_port_regular(path);
    return result < 0 ? result : grobo_i_stream_open(path, source);
}

static void close_beside(void *ctx, const grobo_source *source)
{
    (void)ctx;
    grobo_i_stream_close(source);
}

int grobo_robot_def_read_file(const char *path, grobo_diagnostics *list, const grobo_mem *mem,
                              grobo_robot_def **def)
{
    static const grobo_i_beside beside = {open_beside, close_beside, NULL};
    grobo_source source;
    if (path == NULL || def == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_i_stream_open_said(path, path, list, &source);
    if (result < 0) {
        return result;
    }
    result = grobo_i_robot_read(&source, path, &beside, list, mem, def);
    grobo_i_stream_close(&source);
    return result;
}

void grobo_robot_def_free(grobo_robot_def *def)
{
    grobo_i_robot_file *file = (grobo_i_robot_file *)(void *)def;
    if (file != NULL) {
        release(file, file->mem);
    }
}
