/* SPDX-License-Identifier: MIT */
/* Is the port there? Who may open one is not a matter of the port on Windows. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/serial.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"

bool node_look(const char *device, node_found_fn found, void *ctx)
{
    const grobo_port_ops *ops = grobo_port_serial_ops();
    grobo_port *port = malloc(ops->size_bytes);
    grobo_os_cause cause = {0};
    int error = port ? ops->open(port, device, GROBO_BAUD_DEFAULT_BPS, &cause) : GROBO_ERR_NOMEM;
    if (!error) {
        ops->close(port);
    }
    free(port);
    if (error == GROBO_ERR_NOENT) {
        found(ctx, "device", "plug the robot's cable in; 'grctl ports' lists what there is",
              "%s is not there", device);
        return false;
    }
    if (error == GROBO_ERR_TYPE || error == GROBO_ERR_ISDIR) {
        found(ctx, "device", "choose one of those that 'grctl ports' lists",
              "%s is not a serial port", device);
        return false;
    }
    /* Any other error is one of opening, which comes next. */
    found(ctx, "device", NULL, "%s is there", device);
    return true;
}

bool node_true_path(const char *device, char *path, size_t capacity)
{
    return grobo_port_identity(device, path, capacity) == GROBO_OK;
}

/* Nothing else ends a program of another console: what it moves stays under way. */
void node_end_program(char *fix, size_t capacity, int pid)
{
    snprintf(fix, capacity, _("end that program; if nothing else helps: taskkill /f /pid %d"), pid);
}

bool node_installed_motion(const char *name, char *path, size_t capacity)
{
    (void)name;
    (void)path;
    (void)capacity;
    return false;
}

void node_quicken(char *fix, size_t capacity, const char *path)
{
    snprintf(fix, capacity,
             _("device manager, Ports, %s, Port Settings, Advanced: set the latency timer to 1 ms"),
             path);
}
