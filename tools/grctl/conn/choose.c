/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/conn/choose.h"
#include "tools/grctl/lang/lang.h"

void choose_begin(choice *all)
{
    memset(all, 0, sizeof *all);
}

static bool begins(const char *name, const char *prefix)
{
    return strncmp(name, prefix, strlen(prefix)) == 0;
}

/* Without sysfs an adapter has its name alone. */
static bool is_adapter(const grobo_port_info *info)
{
    return info->usb_vendor >= 0 || begins(info->path, "/dev/ttyUSB") ||
           begins(info->path, "/dev/ttyACM");
}

static void keep(grobo_port_info *list, int *n, const grobo_port_info *info)
{
    if (*n < CHOOSE_MAX) {
        list[(*n)++] = *info;
    }
}

int choose_take(void *ctx, const grobo_port_info *info)
{
    choice *all = ctx;
    if (is_adapter(info) && info->open_result == GROBO_OK) {
        keep(all->usb, &all->n_usb, info);
    } else if (is_adapter(info)) {
        keep(all->blocked, &all->n_blocked, info);
    } else if (!info->console && !info->bluetooth) {
        keep(all->uart, &all->n_uart, info);
    }
    return 0;
}

void choose_end(choice *all, const char *last)
{
    for (int i = 1; *last && i < all->n_usb; i++) {
        grobo_port_info first = all->usb[i];
        if (strcmp(first.path, last) != 0 && strcmp(first.by_id, last) != 0) {
            continue;
        }
        memmove(&all->usb[1], &all->usb[0], sizeof all->usb[0] * (size_t)i);
        all->usb[0] = first;
    }
    for (int i = 0; i < all->n_usb; i++) {
        all->scan[i] = all->usb[i].path;
    }
    all->scan[all->n_usb] = NULL;
}

void choose_fix(const grobo_port_info *info, char *fix, size_t capacity)
{
    if (info->open_result == GROBO_ERR_PERM) {
        snprintf(fix, capacity, _("sudo usermod -aG dialout $USER, and log in again"));
    } else if (info->owner_pid > 0) {
        snprintf(fix, capacity, _("end %s (pid %d)"), info->owner_name, info->owner_pid);
    } else {
        snprintf(fix, capacity, _("unplug it and plug it in again"));
    }
}
