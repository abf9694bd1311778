/* SPDX-License-Identifier: MIT */
/* Connections, as far as no system is needed: their names, and what none of them can do. */
#include <stdio.h>
#include <string.h>

#include "ports/common/common.h"

static const char prefix[] = "tcp:";

static bool has_prefix(const char *device)
{
    return strncmp(device, prefix, sizeof prefix - 1) == 0;
}

/* A TCP port, 0 to 65535, in digits. */
static bool is_port(const char *text)
{
    size_t size = strlen(text);

    return size > 0 && strspn(text, "0123456789") == size && size <= 5 &&
           (size < 5 || strcmp(text, "65535") <= 0);
}

static bool split(const char *device, grobo_i_tcp_name *to)
{
    const char *host = device + sizeof prefix - 1;
    const char *colon = strrchr(device, ':');
    size_t host_size;

    if (!has_prefix(device) || colon < host) {
        return false;
    }
    host_size = (size_t)(colon - host);
    if (host_size >= 2 && host[0] == '[' && host[host_size - 1] == ']') {
        host++;
        host_size -= 2;
    }
    if (host_size == 0 || host_size >= sizeof to->host || !is_port(colon + 1)) {
        return false;
    }
    memcpy(to->host, host, host_size);
    to->host[host_size] = '\0';
    memcpy(to->port, colon + 1, strlen(colon + 1) + 1);
    return true;
}

int grobo_i_tcp_split(const char *device, bool numeric, grobo_i_tcp_name *to, grobo_os_cause *cause)
{
    if (!split(device, to)) {
        return grobo_i_port_refuse(cause, GROBO_ERR_ARG, "not of the form tcp:HOST:PORT");
    }
    if (numeric && strcmp(to->host, "localhost") == 0) {
        (void)grobo_i_port_copy(to->host, sizeof to->host, "127.0.0.1");
    }
    return GROBO_OK;
}

int grobo_i_tcp_resolve(const char *device, char *numeric, size_t numeric_bytes,
                        grobo_i_tcp_find *find, grobo_os_cause *cause)
{
    char text[GROBO_DEVICE_MAX_BYTES];
    grobo_i_tcp_name at;
    int n;
    int r;

    if (!has_prefix(device)) {
        n = snprintf(text, sizeof text, "%s", device);
    } else {
        r = find(device, &at, cause);
        if (r < 0) {
            return r;
        }
        n = snprintf(text, sizeof text, strchr(at.host, ':') != NULL ? "%s[%s]:%s" : "%s%s:%s",
                     prefix, at.host, at.port);
    }
    if (n < 0 || (size_t)n >= sizeof text || grobo_i_port_copy(numeric, numeric_bytes, text) < 0) {
        return grobo_i_port_refuse(cause, GROBO_ERR_SPACE, "device name too long");
    }
    return GROBO_OK;
}

/* What a connection was given will arrive. */
void grobo_i_tcp_discard_output(grobo_port *port)
{
    (void)port;
}

/* The server has a speed of its own, raw TCP has no way to ask for another. */
int grobo_i_tcp_set_baud(grobo_port *port, int baud_bps, grobo_os_cause *cause)
{
    (void)port;
    (void)cause;
    return baud_bps;
}

int grobo_i_tcp_set_low_latency(grobo_port *port, grobo_os_cause *cause)
{
    (void)port;
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED, "a connection, not a serial port");
}

int grobo_i_port_set_format(grobo_port *port, const grobo_line_format *format,
                            grobo_os_cause *cause)
{
    (void)port;
    (void)format;
    (void)cause;
    return GROBO_OK;
}
