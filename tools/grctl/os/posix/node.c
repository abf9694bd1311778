/* SPDX-License-Identifier: MIT */
/* Is the device's node there, and may the user open it? */
#include <grp.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"

/* The Makefile says where `make install` puts it. */
static const char rules[] = GRCTL_DATADIR "/grobo/udev/60-grobo.rules";
static const char motions[] = GRCTL_DATADIR "/grobo/motions";

enum { FIX_BYTES = 512 };

static const char *user_name(void)
{
    const struct passwd *who = getpwuid(geteuid());
    return who ? who->pw_name : "$USER";
}

/* In /etc/group, though perhaps not yet in this log-in. */
static bool is_member(const struct group *group)
{
    for (char **member = group->gr_mem; *member; member++) {
        if (strcmp(*member, user_name()) == 0) {
            return true;
        }
    }
    return false;
}

static void say_forbidden(const char *device, const struct stat *s, node_found_fn found, void *ctx)
{
    char fix[FIX_BYTES];
    const struct group *group = getgrgid(s->st_gid);
    if (!group || (s->st_mode & 060) != 060) {
        snprintf(fix, sizeof fix, _("sudo chmod a+rw %s"), device);
    } else if (is_member(group)) {
        snprintf(fix, sizeof fix, _("log out and in again: you are in %s since"), group->gr_name);
    } else {
        snprintf(fix, sizeof fix, _("sudo usermod -aG %s %s; then log out and in again"),
                 group->gr_name, user_name());
    }
    found(ctx, "permission", fix, "%s belongs to group %s, mode %03o: %s may not open it", device,
          group ? group->gr_name : "?", (unsigned)s->st_mode & 0777, user_name());
}

bool node_look(const char *device, node_found_fn found, void *ctx)
{
    struct stat s;
    if (stat(device, &s) < 0) {
        found(ctx, "device", "plug the robot's cable in; 'grctl ports' lists what there is",
              "%s is not there", device);
        return false;
    }
    if (!S_ISCHR(s.st_mode)) {
        found(ctx, "device", "choose one of those that 'grctl ports' lists",
              "%s is not a serial port", device);
        return false;
    }
    found(ctx, "device", NULL, "%s is there", device);
    if (access(device, R_OK | W_OK) < 0) {
        say_forbidden(device, &s, found, ctx);
        return false;
    }
    found(ctx, "permission", NULL, "%s may read and write it", user_name());
    return true;
}

bool node_true_path(const char *device, char *path, size_t capacity)
{
    char *real = realpath(device, NULL);
    int n = real ? snprintf(path, capacity, "%s", real) : -1;
    free(real);
    return n >= 0 && (size_t)n < capacity;
}

bool node_installed_motion(const char *name, char *path, size_t capacity)
{
    int n = snprintf(path, capacity, "%s/%s", motions, name);
    return *name && !strchr(name, '/') && n >= 0 && (size_t)n < capacity && access(path, R_OK) == 0;
}

void node_end_program(char *fix, size_t capacity, int pid)
{
    snprintf(fix, capacity, _("end that program, or: kill %d"), pid);
}

void node_quicken(char *fix, size_t capacity, const char *path)
{
    snprintf(fix, capacity,
             _("sudo cp %s /etc/udev/rules.d/, plug in again; "
               "or: echo 1 | sudo tee /sys/bus/usb-serial/devices/%s/latency_timer"),
             access(rules, R_OK) == 0 ? rules : _("tools/udev/60-grobo.rules (of the sources)"),
             strrchr(path, '/') + 1);
}
