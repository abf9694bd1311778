/* SPDX-License-Identifier: MIT */
/* Is the port there? Who may open one is not a matter of the port on Windows. */
#include <stdlib.h>
#include <string.h>

#include <grobo/serial.h>

#include "tools/grctl/doctor/checkup.h"

bool checkup_node(checkup *k, const char *device)
{
    const grobo_port_ops *ops = grobo_port_serial_ops();
    grobo_port *port = malloc(ops->size_bytes);
    grobo_os_cause cause = {0};
    int error = port ? ops->open(port, device, GROBO_BAUD_DEFAULT_BPS, &cause) : GROBO_ERR_NOMEM;
    if (!error)
        ops->close(port);
    free(port);
    if (error == GROBO_ERR_NOENT) {
        checkup_bad(k, "device", "plug the robot's cable in; 'grctl ports' lists what there is",
                    "%s is not there", device);
        return false;
    }
    if (error == GROBO_ERR_TYPE || error == GROBO_ERR_ISDIR) {
        checkup_bad(k, "device", "choose one of those that 'grctl ports' lists",
                    "%s is no serial port", device);
        return false;
    }
    /* Any other error is one of opening, which comes next. */
    checkup_good(k, false, "device", "%s is there", device);
    return true;
}

bool checkup_true_path(const char *device, char *path, size_t capacity)
{
    return grobo_port_identity(device, path, capacity) == GROBO_OK;
}

/* Nothing else ends a program of another console: what it moves stays under way. */
void checkup_end_program(char *fix, size_t capacity, int pid)
{
    snprintf(fix, capacity, "end that program; if nothing else helps: taskkill /f /pid %d", pid);
}

void checkup_quicken(char *fix, size_t capacity, const char *path)
{
    snprintf(fix, capacity,
             "device manager, Ports, %s, Port Settings, Advanced: set the latency timer to 1 ms",
             path);
}
