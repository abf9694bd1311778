/* SPDX-License-Identifier: MIT */
/* What the files of the POSIX port share. */
#ifndef GROBO_PORTS_POSIX_H
#define GROBO_PORTS_POSIX_H

#include <sys/types.h>

#include <grobo/port.h>

/* An open byte port of either kind. */
struct grobo_port {
    int fd;
};

/* Fills cause from an errno, with `what` saying what was tried; returns the GROBO_ERR_* for it. */
int grobo_i_posix_fail(grobo_os_cause *cause, int code, const char *what);

/* Fills cause with a text of our own, returns `error`. */
int grobo_i_posix_refuse(grobo_os_cause *cause, int error, const char *text);

/* What read() or recv() returned, in terms of grobo_port_ops.read. */
int grobo_i_posix_received(ssize_t got, grobo_os_cause *cause);

/* What write() or send() returned, in terms of grobo_port_ops.write. */
int grobo_i_posix_sent(ssize_t put, grobo_os_cause *cause);

/* Calls that serial port and connection have in common. */
void grobo_i_posix_close(grobo_port *port);
int grobo_i_posix_waiting(grobo_port *port, grobo_os_cause *cause);
grobo_socket grobo_i_posix_socket(const grobo_port *port);
grobo_handle grobo_i_posix_handle(const grobo_port *port);

/* Sets a speed, reads it back; returns the rate in effect or GROBO_ERR_*. */
int grobo_i_posix_set_baud(int fd, int baud_bps, grobo_os_cause *cause);

/* The same for a rate without a B constant; systems without such rates refuse. */
int grobo_i_posix_set_custom_baud(int fd, int baud_bps, grobo_os_cause *cause);

/* The rate that is set, when it is one without a B constant; else 0. */
int grobo_i_posix_custom_baud(int fd);

/* True when `actual` is near enough to `asked` for a UART to understand: 2 %. */
bool grobo_i_posix_baud_fits(int asked, int actual);

/* grobo_port_ops.set_low_latency for a descriptor. */
int grobo_i_posix_set_low_latency(int fd, grobo_os_cause *cause);

/*
 * True for a terminal whose TIOCEXCL outlives its last close (a pty's slave, as long as its
 * master is open): a program killed while it held it would lock everybody out.
 */
bool grobo_i_posix_exclusive_sticks(dev_t device);

/* grobo_port_owner() that also tells whether the owner holds the lock (flock). */
int grobo_i_posix_owner(const char *device, char *name, size_t name_bytes, bool *locked);

/* grobo_port_list() with the places where it looks, so that a test can bring its own. */
int grobo_i_posix_list(const char *sys_tty, const char *dev,
                       int (*visit)(void *ctx, const grobo_port_info *info), void *ctx);

#endif
