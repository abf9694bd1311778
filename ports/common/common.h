/* SPDX-License-Identifier: MIT */
/* What ports have in common, whatever their system. */
#ifndef GROBO_PORTS_COMMON_H
#define GROBO_PORTS_COMMON_H

#include <grobo/core/port.h>

/* ---- any port: common.c ------------------------------------------------------------------- */

/* Fills cause with a text of our own, returns `error`. */
int grobo_i_port_refuse(grobo_os_cause *cause, int error, const char *text);

/* The same for a device that process `pid`, called `name`, holds (0: not known); GROBO_ERR_BUSY. */
int grobo_i_port_refuse_busy(grobo_os_cause *cause, int code, int pid, const char *name);

/* The actual rate where a UART understands it for the one asked for: 2 %. Else refused. */
int grobo_i_port_check_baud(int asked_bps, int actual_bps, grobo_os_cause *cause);

/* A port without a connection to wait for: grobo_port_ops.ready. */
int grobo_i_port_ready(grobo_port *port, grobo_os_cause *cause);

/* Copies a text; GROBO_ERR_SPACE where it does not fit. */
int grobo_i_port_copy(char *to, size_t size, const char *text);

/* ---- files: files.c of each port ------------------------------------------------------------ */

/* GROBO_OK where path leads to a regular file; else GROBO_ERR_NOENT, GROBO_ERR_PERM,
 * GROBO_ERR_ISDIR, or GROBO_ERR_UNSUPPORTED of what may be waited for or has no end: a pipe, a
 * socket, a device. */
int grobo_i_port_regular(const char *path);

/* ---- connections: tcp.c ------------------------------------------------------------------- */

/* "tcp:HOST:PORT" taken apart. */
typedef struct grobo_i_tcp_name {
    char host[GROBO_DEVICE_MAX_BYTES];
    char port[8];
} grobo_i_tcp_name;

/*
 * Takes "tcp:HOST:PORT" or "tcp:[HOST]:PORT" apart; GROBO_ERR_ARG when it is neither. Numeric:
 * localhost is given as an address.
 */
int grobo_i_tcp_split(const char *device, bool numeric, grobo_i_tcp_name *to,
                      grobo_os_cause *cause);

/* Has the system look up a connection's name: the numeric form of the first address it has. */
typedef int grobo_i_tcp_find(const char *device, grobo_i_tcp_name *at, grobo_os_cause *cause);

/* grobo_port_resolve(), by such a function. */
int grobo_i_tcp_resolve(const char *device, char *numeric, size_t numeric_bytes,
                        grobo_i_tcp_find *find, grobo_os_cause *cause);

/* Of grobo_port_ops: what a connection cannot do. */
void grobo_i_tcp_discard_output(grobo_port *port);
int grobo_i_tcp_set_baud(grobo_port *port, int baud_bps, grobo_os_cause *cause);
int grobo_i_tcp_set_low_latency(grobo_port *port, grobo_os_cause *cause);
/* Of any kind whose bytes have no form of their own. */
int grobo_i_port_set_format(grobo_port *port, const grobo_line_format *format,
                            grobo_os_cause *cause);

#endif
