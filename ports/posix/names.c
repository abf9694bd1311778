/* SPDX-License-Identifier: MIT */
/* The names of a device: as given, where its links lead, and the one that stays. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ports/common/common.h"
#include "ports/common/notes.h"

/* Links that are followed one by one; realpath() follows all. */
enum { HOPS_MAX = 3 };

/* Returns its place, -1 where there is no room. */
static int add(grobo_i_device_names *names, const char *name)
{
    for (int i = 0; i < names->n; i++) {
        if (strcmp(names->name[i], name) == 0) {
            return i;
        }
    }
    if (names->n == DEVICE_NAMES ||
        grobo_i_port_copy(names->name[names->n], sizeof names->name[0], name) < 0) {
        return -1;
    }
    return names->n++;
}

/* From the root, links to directories followed: "../dev/x" and "/dev/x" are one. */
static bool make_absolute(const char *name, char *path)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(name, '/');
    const char *last = slash != NULL ? slash + 1 : name;
    int n = snprintf(folder, sizeof folder, "%.*s", slash != NULL ? (int)(slash + 1 - name) : 1,
                     slash != NULL ? name : ".");
    char *real = n < (int)sizeof folder ? realpath(folder, NULL) : NULL;

    n = real == NULL ? snprintf(path, PATH_MAX, "%s", name)
                     : snprintf(path, PATH_MAX, "%s/%s", strcmp(real, "/") == 0 ? "" : real, last);
    free(real);
    return n > 0 && n < PATH_MAX;
}

/* Where a link leads to; false for anything else. */
static bool follow(const char *link, char *path)
{
    char target[PATH_MAX];
    char joined[2 * PATH_MAX];
    ssize_t size = readlink(link, target, sizeof target - 1);
    const char *slash = strrchr(link, '/');

    if (size <= 0) {
        return false;
    }
    target[size] = '\0';
    snprintf(joined, sizeof joined, "%.*s%s",
             target[0] == '/' || slash == NULL ? 0 : (int)(slash + 1 - link), link, target);
    return strlen(joined) < PATH_MAX && make_absolute(joined, path);
}

static void find_path(const char *device, grobo_i_device_names *names)
{
    char path[PATH_MAX];
    char next[PATH_MAX];
    char lasting[GROBO_DEVICE_MAX_BYTES];
    char *real = realpath(device, NULL);

    if (make_absolute(device, path)) {
        (void)add(names, path);
        for (int hop = 0; hop < HOPS_MAX && follow(path, next); hop++) {
            (void)add(names, next);
            memcpy(path, next, sizeof path);
        }
    }
    if (real != NULL) {
        int at = add(names, real);

        if (grobo_port_identity(real, lasting, sizeof lasting) == GROBO_OK &&
            strcmp(lasting, real) != 0 && add(names, lasting) >= 0) {
            names->passing = at;
        }
    }
    free(real);
}

void grobo_i_device_names_find(const char *device, grobo_i_device_names *names)
{
    char name[GROBO_DEVICE_MAX_BYTES];
    grobo_i_tcp_name at;
    grobo_os_cause cause;

    names->n = 0;
    names->passing = -1;
    if (strncmp(device, "tcp:", 4) != 0) {
        find_path(device, names);
    } else if (grobo_i_tcp_split(device, true, &at, &cause) == GROBO_OK &&
               snprintf(name, sizeof name, "tcp:%s:%s", at.host, at.port) < (int)sizeof name) {
        (void)add(names, name);
    }
}
