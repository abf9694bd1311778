/* SPDX-License-Identifier: MIT */
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <grobo/serial.h>

#include "checkup.h"

enum { FIX_BYTES = 512, QUICK_MS = 2 };

typedef struct search {
    const char *path; /* what the device's name leads to */
    grobo_port_info info;
    bool found;
} search;

static int visit(void *ctx, const grobo_port_info *info)
{
    search *s = ctx;
    if (strcmp(info->path, s->path) != 0)
        return 0;
    s->info = *info;
    s->found = true;
    return 1;
}

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

static bool check_node(checkup *k, const char *device)
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

/* Who merely has it open is no hindrance (a simulator holds its own pty): who has locked it is. */
static bool check_owner(checkup *k, const char *device)
{
    const grobo_port_ops *ops = grobo_port_serial_ops();
    grobo_port *port = malloc(ops->size_bytes);
    grobo_os_cause cause = {0};
    char fix[FIX_BYTES], name[64] = "";
    int error = port ? ops->open(port, device, GROBO_BAUD_DEFAULT_BPS, &cause) : GROBO_ERR_NOMEM;
    int pid;
    if (!error)
        ops->close(port);
    free(port);
    if (!error) {
        checkup_good(k, false, "owner", "no other program holds it");
        return true;
    }
    pid = error == GROBO_ERR_BUSY ? grobo_port_owner(device, name, sizeof name) : 0;
    snprintf(fix, sizeof fix, "end that program, or: kill %d", pid);
    if (pid > 0)
        checkup_bad(k, "owner", fix, "%s (pid %d) holds it", name, pid);
    else
        checkup_bad(k, "open", "end the program that holds it, or plug it out and in", "%s: %s%s%s",
                    device, grobo_error_text(error), *cause.text ? ": " : "", cause.text);
    return false;
}

static void check_latency(checkup *k, const char *path)
{
    search s = {.path = path};
    char fix[FIX_BYTES];
    grobo_port_list(visit, &s);
    if (!s.found || s.info.latency_ms < 0)
        return;
    if (s.info.latency_ms <= QUICK_MS) {
        checkup_good(k, false, "latency", "its latency timer is %d ms", s.info.latency_ms);
        return;
    }
    snprintf(
        fix, sizeof fix,
        "sudo cp /usr/local/share/grobo/udev/60-grobo.rules /etc/udev/rules.d/, plug in again; "
        "or: echo 1 | sudo tee /sys/bus/usb-serial/devices/%s/latency_timer",
        strrchr(path, '/') + 1);
    checkup_bad(k, "latency", fix, "its latency timer is %d ms: every reply waits so long",
                s.info.latency_ms);
}

bool checkup_port(checkup *k, const char *device)
{
    char *path;
    if (!check_node(k, device) || !check_owner(k, device))
        return false;
    path = realpath(device, NULL);
    if (path)
        check_latency(k, path);
    free(path);
    return true;
}
