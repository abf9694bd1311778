/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/port.h>
#include <grobo/session.h>

#include "latch.h"
#include "os.h"

enum { PATH_BYTES = 1024 };

/* One mark a device, by the name that stays when it is plugged in elsewhere. */
static bool mark(const char *device, char *path, size_t capacity)
{
    char identity[GROBO_DEVICE_MAX_BYTES], folder[PATH_BYTES];
    int n;
    if (grobo_port_identity(device, identity, sizeof identity) < 0 ||
        !os_private_folder(folder, sizeof folder))
        return false;
    for (char *c = identity; *c; c++)
        if (strchr("/\\:", *c))
            *c = '!';
    n = snprintf(path, capacity, "%s/estop-%s", folder, identity);
    return n > 0 && (size_t)n < capacity;
}

static bool has_none(const char *device)
{
    return strcmp(device, GROBO_DEVICE_SIM) == 0;
}

int latch_set(const char *device)
{
    char path[PATH_BYTES + GROBO_DEVICE_MAX_BYTES];
    if (has_none(device))
        return GROBO_OK;
    return mark(device, path, sizeof path) && os_mark(path) ? GROBO_OK : GROBO_ERR_IO;
}

int latch_clear(const char *device)
{
    char path[PATH_BYTES + GROBO_DEVICE_MAX_BYTES];
    if (has_none(device))
        return GROBO_OK;
    return mark(device, path, sizeof path) && os_unmark(path) ? GROBO_OK : GROBO_ERR_IO;
}

bool latch_is_set(const char *device)
{
    char path[PATH_BYTES + GROBO_DEVICE_MAX_BYTES];
    return !has_none(device) && mark(device, path, sizeof path) && os_is_marked(path);
}
