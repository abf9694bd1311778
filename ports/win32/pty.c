/* SPDX-License-Identifier: MIT */
/* Pseudo-terminals, which Windows has not. */
#include "ports/common/common.h"

const grobo_port_ops *grobo_port_pty_ops(void)
{
    return NULL;
}

int grobo_port_pty_path(const grobo_port *port, char *path, size_t path_bytes)
{
    (void)path_bytes;
    return port == NULL || path == NULL ? GROBO_ERR_ARG : GROBO_ERR_UNSUPPORTED;
}

int grobo_port_pty_baud(const grobo_port *port)
{
    return port == NULL ? GROBO_ERR_ARG : 0;
}

bool grobo_port_pty_in_use(grobo_port *port)
{
    return port != NULL;
}
