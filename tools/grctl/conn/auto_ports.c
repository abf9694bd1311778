/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/conn/auto_ports.h"
#include "tools/grctl/os/os.h"

static const char state_name[] = "last-port";

static void read_last(char *last, size_t capacity)
{
    char path[1024];
    FILE *file = os_state_path(state_name, path, sizeof path) ? fopen(path, "r") : NULL;
    if (!file || !fgets(last, (int)capacity, file)) {
        *last = '\0';
    }
    last[strcspn(last, "\n")] = '\0';
    if (file) {
        fclose(file);
    }
}

int auto_ports(choice *all)
{
    char last[GROBO_DEVICE_MAX_BYTES];
    choose_begin(all);
    int found = grobo_port_list(choose_take, all);
    read_last(last, sizeof last);
    choose_end(all, last);
    return found;
}

void auto_report(const app *a, const choice *all)
{
    char fix[256];
    for (int i = 0; i < all->n_blocked; i++) {
        choose_fix(&all->blocked[i], fix, sizeof fix);
        app_note(a, "auto: %s: %s; fix: %s", all->blocked[i].path,
                 app_error_text(all->blocked[i].open_result), fix);
    }
    for (int i = 0; i < all->n_uart && all->n_usb + all->n_blocked == 0; i++) {
        if (all->uart[i].open_result == GROBO_OK) {
            app_note(a, "auto: no USB adapter; a UART of this machine is not tried unasked: -d %s",
                     all->uart[i].path);
            continue;
        }
        choose_fix(&all->uart[i], fix, sizeof fix);
        app_note(a, "auto: %s: %s; fix: %s; then: -d %s", all->uart[i].path,
                 app_error_text(all->uart[i].open_result), fix, all->uart[i].path);
    }
}

void auto_used(const app *a, const char *device, bool is_auto)
{
    char path[1024], name[GROBO_DEVICE_MAX_BYTES], last[GROBO_DEVICE_MAX_BYTES];
    FILE *file;
    if (is_auto) {
        app_note(a, "auto: %s", device);
    }
    read_last(last, sizeof last);
    if (grobo_port_identity(device, name, sizeof name) < 0 || strcmp(name, last) == 0 ||
        !os_state_path(state_name, path, sizeof path) || !(file = fopen(path, "w"))) {
        return;
    }
    fprintf(file, "%s\n", name);
    fclose(file);
}
