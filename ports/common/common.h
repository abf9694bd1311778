/* SPDX-License-Identifier: MIT */
/* What ports have in common, whatever their system. */
#ifndef GROBO_PORTS_COMMON_H
#define GROBO_PORTS_COMMON_H

#include <grobo/port.h>

/* "tcp:HOST:PORT" taken apart. */
typedef struct grobo_i_tcp_name {
    char host[GROBO_DEVICE_MAX_BYTES];
    char port[8];
} grobo_i_tcp_name;

/* Takes "tcp:HOST:PORT" or "tcp:[HOST]:PORT" apart; GROBO_ERR_ARG when it is neither. */
int grobo_i_tcp_split(const char *device, grobo_i_tcp_name *to);

/* True when `actual` is near enough to `asked` for a UART to understand: 2 %. */
bool grobo_i_baud_fits(int asked, int actual);

/* Fills cause with a text of our own, returns `error`. */
int grobo_i_port_refuse(grobo_os_cause *cause, int error, const char *text);

#endif
