/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "ports/common/common.h"

int grobo_i_port_refuse(grobo_os_cause *cause, int error, const char *text)
{
    cause->code = 0;
    snprintf(cause->text, sizeof cause->text, "%s", text);
    return error;
}

int grobo_i_port_refuse_busy(grobo_os_cause *cause, int code, int pid, const char *name)
{
    if (pid == 0) {
        (void)grobo_i_port_refuse(cause, GROBO_ERR_BUSY, "held by another program");
    } else {
        snprintf(cause->text, sizeof cause->text, "held by %s (pid %d)", name, pid);
    }
    cause->code = code;
    return GROBO_ERR_BUSY;
}

int grobo_i_port_check_baud(int asked_bps, int actual_bps, grobo_os_cause *cause)
{
    int64_t off_bps = (int64_t)asked_bps - actual_bps;

    if ((off_bps < 0 ? -off_bps : off_bps) * 50 <= asked_bps) {
        return actual_bps;
    }
    cause->code = 0;
    snprintf(cause->text, sizeof cause->text, "device takes %d bps for %d", actual_bps, asked_bps);
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_port_ready(grobo_port *port, grobo_os_cause *cause)
{
    (void)port;
    (void)cause;
    return 1;
}

int grobo_i_port_copy(char *to, size_t size, const char *text)
{
    size_t length = strlen(text);

    if (length >= size) {
        return GROBO_ERR_SPACE;
    }
    memcpy(to, text, length + 1);
    return GROBO_OK;
}
