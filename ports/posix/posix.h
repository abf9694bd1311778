/* SPDX-License-Identifier: MIT */
/* What the files of the POSIX port share. */
#ifndef GROBO_PORTS_POSIX_H
#define GROBO_PORTS_POSIX_H

#include <sys/types.h>
#include <time.h>

#include "ports/common/common.h"

/* An open byte port of any kind. */
struct grobo_port {
    int fd;
    bool abandoned; /* the guard releases the device: see ports/common/guard.h */
    /* of a pseudo-terminal only */
    int slave;                         /* held open, so that programs may come and go */
    char path[64];                     /* of the slave */
    char link[GROBO_DEVICE_MAX_BYTES]; /* to it, or empty */
};

/* Now, in microseconds of this clock. */
int64_t grobo_i_posix_us(clockid_t clock);

/* The GROBO_ERR_* for an errno: of a line, a socket or a process; and of a file. */
int grobo_i_posix_error(int code);
int grobo_i_posix_file_error(int code);

/* Fills cause from an errno, with `what` saying what was tried; returns the GROBO_ERR_* for it. */
int grobo_i_posix_fail(grobo_os_cause *cause, int code, const char *what);

struct grobo_i_note_folders;

/* The directories of notes, made where they are missing. How many there are for this process (an
 * empty path: none), GROBO_ERR_NOENT where there may be another one later. */
int grobo_i_posix_note_folders(struct grobo_i_note_folders *folders);

struct pollfd;

/* poll(), which refuses all where the process may have fewer descriptors than are asked about. */
int grobo_i_posix_poll(struct pollfd *what, int n, int limit_ms);

/* Makes a descriptor non-blocking and closed on exec. */
int grobo_i_posix_prepare(int fd, grobo_os_cause *cause);

/* What read() or recv() returned, in terms of grobo_port_ops.read. */
int grobo_i_posix_received(ssize_t got, grobo_os_cause *cause);

/* What write() or send() returned, in terms of grobo_port_ops.write. */
int grobo_i_posix_sent(ssize_t put, grobo_os_cause *cause);

struct addrinfo;

/* Finds the address of "tcp:HOST:PORT", numeric or by its name; freed by freeaddrinfo(). */
int grobo_i_posix_look_up(const char *device, bool numeric, struct addrinfo **found,
                          grobo_os_cause *cause);

/* Makes a socket for an address; an error leaves none behind. */
int grobo_i_posix_make_socket(const struct addrinfo *to, grobo_os_cause *cause);

/* Sets a socket non-blocking, not inherited, without Nagle's delay, looking for dead peers. */
int grobo_i_posix_prepare_tcp(int fd, grobo_os_cause *cause);

/* Calls that serial port and connection have in common. */
void grobo_i_posix_close(grobo_port *port);
int grobo_i_posix_waiting(grobo_port *port, grobo_os_cause *cause);
int grobo_i_posix_unsent(const grobo_port *port);
grobo_socket grobo_i_posix_socket(const grobo_port *port);
grobo_handle grobo_i_posix_handle(const grobo_port *port);

/* Sets a terminal raw: 8 data bits, no parity, 1 stop bit, no flow control. */
int grobo_i_posix_make_raw(int fd, grobo_os_cause *cause);

/* Reads and writes a descriptor: grobo_port_ops.read and .write. */
int grobo_i_posix_read(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause);
int grobo_i_posix_write(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause);

/* Sets a speed, reads it back; returns the rate in effect or GROBO_ERR_*. */
int grobo_i_posix_set_baud(int fd, int baud_bps, grobo_os_cause *cause);

/* The rate a descriptor runs at, 0 for one that nobody knows, or GROBO_ERR_*. */
int grobo_i_posix_get_baud(int fd, grobo_os_cause *cause);

/* Sets a rate without a B constant; systems without such rates refuse. */
int grobo_i_posix_set_custom_baud(int fd, int baud_bps, grobo_os_cause *cause);

/* The rate that is set, when it is one without a B constant; else 0. */
int grobo_i_posix_custom_baud(int fd);

/* The rate that the chip behind a descriptor makes of one its driver has taken. */
int grobo_i_posix_divided_baud(int fd, int baud_bps);

/* Has the driver switch the transmitter of an RS-485 line. */
int grobo_i_posix_set_rs485(int fd, grobo_os_cause *cause);

/* grobo_port_ops.set_low_latency for a descriptor. */
int grobo_i_posix_set_low_latency(int fd, grobo_os_cause *cause);

/*
 * True for a terminal whose TIOCEXCL outlives its last close (a pty's slave, as long as its
 * master is open): a program killed while it held it would lock everybody out.
 */
bool grobo_i_posix_exclusive_sticks(dev_t device);

/* grobo_port_owner() that also tells whether the owner holds the lock (flock). */
int grobo_i_posix_owner(const char *device, char *name, size_t name_bytes, bool *locked);

/* This thread's rights on files are those of the user and his group. GROBO_OK, GROBO_ERR_PERM,
 * GROBO_ERR_UNSUPPORTED. */
int grobo_i_posix_be_user(uid_t user, gid_t group);

/* Sends a signal to a process behind a pidfd. GROBO_OK, GROBO_ERR_NOENT, GROBO_ERR_PERM,
 * GROBO_ERR_UNSUPPORTED. */
int grobo_i_posix_signal(int pidfd, int number);

/* A pidfd, or GROBO_ERR_NOENT, GROBO_ERR_UNSUPPORTED (a kernel before 5.3), GROBO_ERR_NOMEM. */
int grobo_i_posix_open_process(int pid);

/* ---- of a guard process, guard.c ---- */

/* Closes every descriptor from this one on. */
void grobo_i_posix_close_from(int first);

/* Has the system call this process so, where it can. */
void grobo_i_posix_call_it(const char *name);

/* realtime_linux.c: has the calling thread run on every CPU (the first 64) again. */
void grobo_i_posix_take_every_cpu(void);

/* A descriptor that becomes readable when the process dies, or -1. */
int grobo_i_posix_watch_death(pid_t pid);

/* What grobo_i_posix_is_stopped() reads, or -1. */
int grobo_i_posix_watch_state(pid_t pid);

/* By this one a guard is asked to stop the robot. */
#define GUARD_SIGNAL SIGUSR1

/* A descriptor that becomes readable when that comes, from now on, or -1; and takes it. */
int grobo_i_posix_watch_asked(void);
void grobo_i_posix_take_asked(int fd);

/* Is the process stopped by a signal? Not by a debugger. */
bool grobo_i_posix_is_stopped(int fd);

/* grobo_port_list() with the places where it looks, so that a test can bring its own. */
int grobo_i_posix_list(const char *sys_tty, const char *proc, const char *dev,
                       int (*visit)(void *ctx, const grobo_port_info *info), void *ctx);

#endif
