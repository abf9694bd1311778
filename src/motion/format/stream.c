/* SPDX-License-Identifier: MIT */
/* Files as sources of bytes, by the C library's streams. */
#include <errno.h>
#include <stdio.h>

#include "src/motion/format/stream.h"
#include "src/motion/store/diagnostics.h"

static int error_of_errno(void)
{
    switch (errno) {
    case ENOENT:
    case ENOTDIR:
        return GROBO_ERR_NOENT;
    case EACCES:
    case EPERM:
        return GROBO_ERR_PERM;
    case EISDIR:
        return GROBO_ERR_ISDIR;
    default:
        return GROBO_ERR_IO;
    }
}

static int read_stream(void *ctx, void *buffer, size_t size)
{
    FILE *stream = ctx;
    size_t count = fread(buffer, 1, size, stream);

    return count == 0 && ferror(stream) ? error_of_errno() : (int)count;
}

int grobo_i_stream_open(const char *path, grobo_source *source)
{
    FILE *stream = fopen(path, "rb");

    *source = (grobo_source){read_stream, stream};
    return stream != NULL ? GROBO_OK : error_of_errno();
}

int grobo_i_stream_open_said(const char *path, const char *name, grobo_diagnostics *list,
                             grobo_source *source)
{
    int result = grobo_i_stream_open(path, source);

    if (result < 0) {
        grobo_i_say(list, &(grobo_i_said){name, "open", 0, 0, GROBO_SEVERITY_ERROR}, "%s",
                    result == GROBO_ERR_NOENT ? "no such file" : grobo_error_text(result));
    }
    return result;
}

void grobo_i_stream_close(const grobo_source *source)
{
    (void)fclose(source->ctx);
}
