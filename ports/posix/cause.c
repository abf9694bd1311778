/* SPDX-License-Identifier: MIT */
/* From errno to GROBO_ERR_* and a phrase. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "ports/posix/posix.h"

/* What a code means of a file, and of a line, a socket or a process. */
typedef struct meaning {
    int code;
    int file;
    int line;
} meaning;

static const meaning *find(int code)
{
    static const meaning meanings[] = {
        {ENOENT, GROBO_ERR_NOENT, GROBO_ERR_NOENT},
        {ENOTDIR, GROBO_ERR_NOENT, GROBO_ERR_NOENT},
        {ELOOP, GROBO_ERR_NOENT, GROBO_ERR_NOENT},
        {ENAMETOOLONG, GROBO_ERR_SPACE, GROBO_ERR_NOENT},
        {EACCES, GROBO_ERR_PERM, GROBO_ERR_PERM},
        {EPERM, GROBO_ERR_PERM, GROBO_ERR_PERM},
        {EROFS, GROBO_ERR_PERM, GROBO_ERR_PERM},
        {ENOEXEC, GROBO_ERR_PERM, GROBO_ERR_PERM},
        {EISDIR, GROBO_ERR_ISDIR, GROBO_ERR_ISDIR},
        {EEXIST, GROBO_ERR_EXISTS, GROBO_ERR_IO},
        {ENOSPC, GROBO_ERR_DISK, GROBO_ERR_IO},
        {EDQUOT, GROBO_ERR_DISK, GROBO_ERR_IO},
        {EBUSY, GROBO_ERR_IO, GROBO_ERR_BUSY},
        {ENOTTY, GROBO_ERR_IO, GROBO_ERR_TYPE},
        {EIO, GROBO_ERR_IO, GROBO_ERR_UNPLUGGED},
        {ENXIO, GROBO_ERR_IO, GROBO_ERR_UNPLUGGED},
        {ENODEV, GROBO_ERR_IO, GROBO_ERR_UNPLUGGED},
        {EPIPE, GROBO_ERR_IO, GROBO_ERR_UNPLUGGED},
        {ECONNRESET, GROBO_ERR_IO, GROBO_ERR_UNPLUGGED},
        {ETIMEDOUT, GROBO_ERR_IO, GROBO_ERR_UNPLUGGED},
        {EAGAIN, GROBO_ERR_IO, GROBO_ERR_NOMEM},
        {ENOMEM, GROBO_ERR_NOMEM, GROBO_ERR_NOMEM},
        {EMFILE, GROBO_ERR_NOMEM, GROBO_ERR_NOMEM},
        {ENFILE, GROBO_ERR_NOMEM, GROBO_ERR_NOMEM},
        {ENOBUFS, GROBO_ERR_NOMEM, GROBO_ERR_NOMEM},
    };
    static const meaning other = {0, GROBO_ERR_IO, GROBO_ERR_IO};

    for (size_t i = 0; i < sizeof meanings / sizeof meanings[0]; i++) {
        if (meanings[i].code == code) {
            return &meanings[i];
        }
    }
    return &other;
}

int grobo_i_posix_file_error(int code)
{
    return find(code)->file;
}

int grobo_i_posix_error(int code)
{
    return find(code)->line;
}

int grobo_i_posix_fail(grobo_os_cause *cause, int code, const char *what)
{
    char words[128];

    if (strerror_r(code, words, sizeof words) != 0) {
        snprintf(words, sizeof words, "error %d", code);
    }
    cause->code = code;
    snprintf(cause->text, sizeof cause->text, "%s: %s", what, words);
    return grobo_i_posix_error(code);
}
