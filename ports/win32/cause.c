/* SPDX-License-Identifier: MIT */
/* From GetLastError() and WSAGetLastError() to GROBO_ERR_* and a phrase. */
#include <stdio.h>
#include <string.h>

#include "ports/win32/win32.h"

/* Of <winerror.h>, which mingw-w64 10 does not have. */
enum { NO_SUCH_DEVICE = 433 };

static int error_of(DWORD code)
{
    static const struct {
        DWORD code;
        int error;
    } table[] = {
        {ERROR_FILE_NOT_FOUND, GROBO_ERR_NOENT},
        {ERROR_PATH_NOT_FOUND, GROBO_ERR_NOENT},
        {ERROR_INVALID_NAME, GROBO_ERR_NOENT},
        {ERROR_BAD_PATHNAME, GROBO_ERR_NOENT},
        {ERROR_SHARING_VIOLATION, GROBO_ERR_BUSY},
        {ERROR_NOT_ENOUGH_MEMORY, GROBO_ERR_NOMEM},
        {ERROR_NO_SYSTEM_RESOURCES, GROBO_ERR_NOMEM},
        {ERROR_TOO_MANY_OPEN_FILES, GROBO_ERR_NOMEM},
        /* A USB adapter that is pulled out: which of these comes depends on its driver. */
        {ERROR_ACCESS_DENIED, GROBO_ERR_UNPLUGGED},
        {ERROR_NOT_READY, GROBO_ERR_UNPLUGGED},
        {ERROR_BAD_COMMAND, GROBO_ERR_UNPLUGGED},
        {ERROR_GEN_FAILURE, GROBO_ERR_UNPLUGGED},
        {ERROR_DEV_NOT_EXIST, GROBO_ERR_UNPLUGGED},
        {ERROR_BROKEN_PIPE, GROBO_ERR_UNPLUGGED},
        {ERROR_HANDLE_EOF, GROBO_ERR_UNPLUGGED},
        {NO_SUCH_DEVICE, GROBO_ERR_UNPLUGGED},
        {ERROR_OPERATION_ABORTED, GROBO_ERR_UNPLUGGED},
        {ERROR_DEVICE_NOT_CONNECTED, GROBO_ERR_UNPLUGGED},
        {ERROR_DEVICE_REMOVED, GROBO_ERR_UNPLUGGED},
        {WSAEACCES, GROBO_ERR_PERM},
        {WSAEMFILE, GROBO_ERR_NOMEM},
        {WSAENOBUFS, GROBO_ERR_NOMEM},
        {WSAEADDRINUSE, GROBO_ERR_BUSY},
        {WSAENETRESET, GROBO_ERR_UNPLUGGED},
        {WSAECONNABORTED, GROBO_ERR_UNPLUGGED},
        {WSAECONNRESET, GROBO_ERR_UNPLUGGED},
        {WSAESHUTDOWN, GROBO_ERR_UNPLUGGED},
        {WSAETIMEDOUT, GROBO_ERR_UNPLUGGED},
    };

    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (table[i].code == code) {
            return table[i].error;
        }
    }
    return GROBO_ERR_IO;
}

int grobo_i_win32_fail(grobo_os_cause *cause, DWORD code, const char *what)
{
    char words[128];
    DWORD size = FormatMessageA(FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS |
                                    FORMAT_MESSAGE_MAX_WIDTH_MASK,
                                NULL, code, 0, words, sizeof words, NULL);

    while (size > 0 && strchr(" .\r\n", words[size - 1]) != NULL) {
        words[--size] = '\0';
    }
    if (size == 0) {
        snprintf(words, sizeof words, "error %lu", code);
    }
    cause->code = (int)code;
    snprintf(cause->text, sizeof cause->text, "%s: %s", what, words);
    return error_of(code);
}
