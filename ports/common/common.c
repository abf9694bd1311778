/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "ports/common/common.h"

/* A TCP port, 0 to 65535, in digits. */
static bool is_port(const char *text)
{
    size_t size = strlen(text);

    return size > 0 && strspn(text, "0123456789") == size && size <= 5 &&
           (size < 5 || strcmp(text, "65535") <= 0);
}

int grobo_i_tcp_split(const char *device, grobo_i_tcp_name *to)
{
    const char *host = device + strlen("tcp:");
    const char *colon = strrchr(device, ':');
    size_t host_size;

    if (strncmp(device, "tcp:", 4) != 0 || colon < host) {
        return GROBO_ERR_ARG;
    }
    host_size = (size_t)(colon - host);
    if (host_size >= 2 && host[0] == '[' && host[host_size - 1] == ']') {
        host++;
        host_size -= 2;
    }
    if (host_size == 0 || host_size >= sizeof to->host || !is_port(colon + 1)) {
        return GROBO_ERR_ARG;
    }
    memcpy(to->host, host, host_size);
    to->host[host_size] = '\0';
    memcpy(to->port, colon + 1, strlen(colon + 1) + 1);
    return GROBO_OK;
}

bool grobo_i_baud_fits(int asked, int actual)
{
    int64_t off = (int64_t)asked - actual;

    return (off < 0 ? -off : off) * 50 <= asked;
}

int grobo_i_port_refuse(grobo_os_cause *cause, int error, const char *text)
{
    cause->code = 0;
    snprintf(cause->text, sizeof cause->text, "%s", text);
    return error;
}
