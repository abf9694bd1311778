/* SPDX-License-Identifier: MIT */
/* From errno to GROBO_ERR_* and a phrase. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "ports/posix/posix.h"

static int error_of(int code)
{
    static const struct {
        int code;
        int error;
    } table[] = {
        {ENOENT, GROBO_ERR_NOENT},         {ENOTDIR, GROBO_ERR_NOENT},
        {ELOOP, GROBO_ERR_NOENT},          {ENAMETOOLONG, GROBO_ERR_NOENT},
        {EACCES, GROBO_ERR_PERM},          {EPERM, GROBO_ERR_PERM},
        {EROFS, GROBO_ERR_PERM},           {EBUSY, GROBO_ERR_BUSY},
        {EISDIR, GROBO_ERR_ISDIR},         {ENOTTY, GROBO_ERR_TYPE},
        {EIO, GROBO_ERR_UNPLUGGED},        {ENXIO, GROBO_ERR_UNPLUGGED},
        {ENODEV, GROBO_ERR_UNPLUGGED},     {EPIPE, GROBO_ERR_UNPLUGGED},
        {ECONNRESET, GROBO_ERR_UNPLUGGED}, {ETIMEDOUT, GROBO_ERR_UNPLUGGED},
        {ENOMEM, GROBO_ERR_NOMEM},         {EAGAIN, GROBO_ERR_NOMEM},
        {EMFILE, GROBO_ERR_NOMEM},         {ENFILE, GROBO_ERR_NOMEM},
        {ENOBUFS, GROBO_ERR_NOMEM},
    };

    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (table[i].code == code) {
            return table[i].error;
        }
    }
    return GROBO_ERR_IO;
}

int grobo_i_posix_fail(grobo_os_cause *cause, int code, const char *what)
{
    char words[128];

    if (strerror_r(code, words, sizeof words) != 0) {
        snprintf(words, sizeof words, "error %d", code);
    }
    cause->code = code;
    snprintf(cause->text, sizeof cause->text, "%s: %s", what, words);
    return error_of(code);
}
