/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <grobo/port.h>
#include <grobo/session.h>

#include "latch.h"

enum { PATH_BYTES = 1024 };

/* The directory of marks: made with mode 700, and believed only if it is the user's own. */
static bool directory(char *path, size_t capacity)
{
    const char *run = getenv("XDG_RUNTIME_DIR");
    struct stat s;
    int n = run && *run == '/'
                ? snprintf(path, capacity, "%s/grctl", run)
                : snprintf(path, capacity, "/tmp/grctl-%lu", (unsigned long)geteuid());
    if (n < 0 || (size_t)n >= capacity)
        return false;
    if (mkdir(path, 0700) < 0 && errno != EEXIST)
        return false;
    return lstat(path, &s) == 0 && S_ISDIR(s.st_mode) && s.st_uid == geteuid();
}

/* One mark a device, by the name that stays when it is plugged in elsewhere. */
static bool mark(const char *device, char *path, size_t capacity)
{
    char identity[GROBO_DEVICE_MAX_BYTES], folder[PATH_BYTES];
    int n;
    if (grobo_port_identity(device, identity, sizeof identity) < 0 ||
        !directory(folder, sizeof folder))
        return false;
    for (char *c = identity; *c; c++)
        if (*c == '/')
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
    int fd;
    if (has_none(device))
        return GROBO_OK;
    if (!mark(device, path, sizeof path))
        return GROBO_ERR_IO;
    fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0)
        return GROBO_ERR_IO;
    close(fd);
    return GROBO_OK;
}

int latch_clear(const char *device)
{
    char path[PATH_BYTES + GROBO_DEVICE_MAX_BYTES];
    if (has_none(device))
        return GROBO_OK;
    if (!mark(device, path, sizeof path))
        return GROBO_ERR_IO;
    return unlink(path) < 0 && errno != ENOENT ? GROBO_ERR_IO : GROBO_OK;
}

bool latch_is_set(const char *device)
{
    char path[PATH_BYTES + GROBO_DEVICE_MAX_BYTES];
    struct stat s;
    return !has_none(device) && mark(device, path, sizeof path) && lstat(path, &s) == 0;
}
