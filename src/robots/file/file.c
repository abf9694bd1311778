/* SPDX-License-Identifier: MIT */
#include "src/base/memory.h"
#include "src/robots/file/draft.h"

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

int grobo_robot_def_read(const grobo_source *source, const char *name, grobo_diagnostics *list,
                         const grobo_mem *mem, grobo_robot_def **def)
{
    if (source == NULL || name == NULL || def == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_reader reader = {.options = {.keep_going = true},
                             .file = name,
                             .mem = mem != NULL ? mem : grobo_mem_default(),
                             .list = list,
                             .input = {.source = source, .size = BUFFER_BYTES}};
    grobo_i_robot_file *file = grobo_i_new(reader.mem, sizeof *file);
    reader.input.buffer = grobo_i_alloc(reader.mem, BUFFER_BYTES);
    int result =
        file != NULL && reader.input.buffer != NULL ? read_file(&reader, file) : GROBO_ERR_NOMEM;
    grobo_i_free(reader.mem, reader.input.buffer, BUFFER_BYTES);
    if (result < 0) {
        grobo_i_free(reader.mem, file, sizeof *file);
        return result;
    }
    file->mem = reader.mem;
    *def = &file->def;
    return GROBO_OK;
}

void grobo_robot_def_free(grobo_robot_def *def)
{
    grobo_i_robot_file *file = (grobo_i_robot_file *)(void *)def;
    if (file != NULL) {
        grobo_i_free(file->mem, file, sizeof *file);
    }
}
