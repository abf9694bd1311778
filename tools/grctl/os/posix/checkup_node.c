/* SPDX-License-Identifier: MIT */
/* Is the device's node there, and may the user open it? */
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/grctl/doctor/checkup.h"

/* The Makefile says where `make install` puts it. */
static const char rules[] = GRCTL_DATADIR "/grobo/udev/60-grobo.rules";

enum { FIX_BYTES = 512 };

static const char *user_name(void)
{
    const struct passwd *who = getpwuid(geteuid());
    return who ? who->pw_name : "$USER";
}

/* In /etc/group, though perhaps not yet in this log-in. */
static bool is_member(const struct group *group)
{
    for (char **member = group->gr_mem; *member; member++)
        if (strcmp(*member, user_name()) == 0)
            return true;
    return false;
}

static void say_forbidden(checkup *k, const char *device, const struct stat *s)
{
    char fix[FIX_BYTES];
    const struct group *group = getgrgid(s->st_gid);
    if (!group || (s->st_mode & 060) != 060)
        snprintf(fix, sizeof fix, "sudo chmod a+rw %s", device);
    else if (is_member(group))
        snprintf(fix, sizeof fix, "log out and in again: you are in %s since", group->gr_name);
    else
        snprintf(fix, sizeof fix, "sudo usermod -aG %s %s; then log out and in again",
                 group->gr_name, user_name());
    checkup_bad(k, "permission", fix, "%s belongs to group %s, mode %03o: %s may not open it",
                device, group ? group->gr_name : "?", (unsigned)s->st_mode & 0777, user_name());
}

bool checkup_node(checkup *k, const char *device)
{
    struct stat s;
    if (stat(device, &s) < 0) {
        checkup_bad(k, "device", "plug the robot's cable in; 'grctl ports' lists what there is",
                    "%s is not there", device);
        return false;
    }
    if (!S_ISCHR(s.st_mode)) {
        checkup_bad(k, "device", "choose one of those that 'grctl ports' lists",
                    "%s is no serial port", device);
        return false;
    }
    checkup_good(k, false, "device", "%s is there", device);
    if (access(device, R_OK | W_OK) < 0) {
        say_forbidden(k, device, &s);
        return false;
    }
    checkup_good(k, false, "permission", "%s may read and write it", user_name());
    return true;
}

bool checkup_true_path(const char *device, char *path, size_t capacity)
{
    char *real = realpath(device, NULL);
    int n = real ? snprintf(path, capacity, "%s", real) : -1;
    free(real);
    return n >= 0 && (size_t)n < capacity;
}

void checkup_end_program(char *fix, size_t capacity, int pid)
{
    snprintf(fix, capacity, "end that program, or: kill %d", pid);
}

void checkup_quicken(char *fix, size_t capacity, const char *path)
{
    snprintf(fix, capacity,
             "sudo cp %s /etc/udev/rules.d/, plug in again; "
             "or: echo 1 | sudo tee /sys/bus/usb-serial/devices/%s/latency_timer",
             access(rules, R_OK) == 0 ? rules : "tools/udev/60-grobo.rules (of the sources)",
             strrchr(path, '/') + 1);
}
