/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/serial.h>

#include "tools/grctl/bringup/checkup.h"
#include "tools/grctl/os/node.h"

enum { FIX_BYTES = 512, QUICK_MS = 2 };

typedef struct search {
    const char *path; /* what the device's name leads to */
    grobo_port_info info;
    bool found;
} search;

static int visit(void *ctx, const grobo_port_info *info)
{
    search *s = ctx;
    if (strcmp(info->path, s->path) != 0) {
        return 0;
    }
    s->info = *info;
    s->found = true;
    return 1;
}

/* Who merely has it open is no hindrance (a simulator holds its own pty): who has locked it is.
 * Asks for low latency as every opening of a serial port does. */
static bool check_owner(checkup *k, const char *device)
{
    const grobo_port_ops *ops = grobo_port_serial_ops();
    grobo_port *port = malloc(ops->size_bytes);
    grobo_os_cause cause = {0};
    char fix[FIX_BYTES], name[64] = "";
    int error = port ? ops->open(port, device, GROBO_BAUD_DEFAULT_BPS, &cause) : GROBO_ERR_NOMEM;
    if (!error) {
        (void)ops->set_low_latency(port, &cause);
        ops->close(port);
    }
    free(port);
    if (!error) {
        checkup_found(k, "owner", NULL, "no other program holds it");
        return true;
    }
    if (error == GROBO_ERR_TYPE) {
        checkup_found(k, "device", "choose one of those that 'grctl ports' lists",
                      "%s is not a serial port", device);
        return false;
    }
    int pid = error == GROBO_ERR_BUSY ? grobo_port_owner(device, name, sizeof name) : 0;
    node_end_program(fix, sizeof fix, pid);
    if (pid > 0) {
        checkup_found(k, "owner", fix, "%s (pid %d) holds it", name, pid);
    } else {
        checkup_found(k, "open", "end the program that holds it, or plug it out and in",
                      "%s: %s%s%s", device, app_error_text(error), *cause.text ? ": " : "",
                      cause.text);
    }
    return false;
}

static void check_latency(checkup *k, const char *path)
{
    search s = {.path = path};
    char fix[FIX_BYTES];
    grobo_port_list(visit, &s);
    if (!s.found || s.info.latency_ms < 0) {
        return;
    }
    if (s.info.latency_ms <= QUICK_MS) {
        checkup_found(k, "latency", NULL, "its latency timer is %d ms", s.info.latency_ms);
        return;
    }
    node_quicken(fix, sizeof fix, path);
    checkup_found(k, "latency", fix, "its latency timer is %d ms: every reply waits so long",
                  s.info.latency_ms);
}

bool checkup_port(checkup *k, const char *device)
{
    char path[GROBO_DEVICE_MAX_BYTES];
    if (!node_look(device, checkup_found, k) || !check_owner(k, device)) {
        return false;
    }
    if (node_true_path(device, path, sizeof path)) {
        check_latency(k, path);
    }
    return true;
}
