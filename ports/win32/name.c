/* SPDX-License-Identifier: MIT */
/* Names of serial ports: COM3, COM10, \\.\COM10. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "ports/win32/win32.h"

static const char device_prefix[] = "\\\\.\\";

static const char *without_prefix(const char *device)
{
    size_t size = sizeof device_prefix - 1;

    return strncmp(device, device_prefix, size) == 0 ? device + size : device;
}

int grobo_i_win32_path(const char *device, char *path, size_t path_bytes)
{
    const char *name = without_prefix(device);
    int n;

    if (*name == '\0') {
        return GROBO_ERR_ARG;
    }
    /* A path of a file is left as it is: there is no serial port behind it, and that is told. */
    n = snprintf(path, path_bytes, "%s%s", strpbrk(name, "\\/:") != NULL ? "" : device_prefix,
                 name);
    return n > 0 && (size_t)n < path_bytes ? GROBO_OK : GROBO_ERR_SPACE;
}

int grobo_i_win32_plain_name(const char *device, char *name, size_t name_bytes)
{
    const char *from = without_prefix(device);
    size_t size = strlen(from);

    if (size == 0) {
        return GROBO_ERR_ARG;
    }
    if (size >= name_bytes) {
        return GROBO_ERR_SPACE;
    }
    /* Windows does not care for the case of a port's name; the host of a connection keeps its. */
    for (size_t i = 0; i <= size; i++) {
        name[i] = strncmp(from, "tcp:", 4) == 0 ? from[i] : (char)toupper((unsigned char)from[i]);
    }
    return GROBO_OK;
}

int grobo_port_identity(const char *device, char *name, size_t name_bytes)
{
    /* Windows gives an adapter with a serial number the same COM again at any socket. */
    return device == NULL || name == NULL ? GROBO_ERR_ARG
                                          : grobo_i_win32_plain_name(device, name, name_bytes);
}
