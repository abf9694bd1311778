/* SPDX-License-Identifier: MIT */
/* The far end of a pseudo-terminal, for a simulator. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "ports/posix/posix.h"

/* A link that leads to another pseudo-terminal: one that a simulator has, or left when killed. */
static bool leads_to_pty(const char *link, const char *pty)
{
    char target[sizeof((grobo_port *)NULL)->path];
    ssize_t size = readlink(link, target, sizeof target);
    size_t stem = strlen(pty);

    while (stem > 0 && strchr("0123456789", pty[stem - 1]) != NULL) {
        stem--;
    }
    return size > 0 && (size_t)size > stem && memcmp(target, pty, stem) == 0;
}

static int make_link(grobo_port *port, const char *link, grobo_os_cause *cause)
{
    struct stat st;

    if (strlen(link) >= sizeof port->link) {
        return grobo_i_port_refuse(cause, GROBO_ERR_CAP, "name of the link too long");
    }
    if (link[0] != '\0') {
        if (lstat(link, &st) == 0 && !leads_to_pty(link, port->path)) {
            return grobo_i_port_refuse(cause, GROBO_ERR_EXISTS, "no link to a pseudo-terminal");
        }
        if ((unlink(link) != 0 && errno != ENOENT) || symlink(port->path, link) != 0) {
            return grobo_i_posix_fail(cause, errno, "symlink");
        }
    }
    memcpy(port->link, link, strlen(link) + 1);
    return GROBO_OK;
}

/* While the port has it open too, the end of a program is none of the line. */
static bool hold_slave(grobo_port *port)
{
    port->slave = open(port->path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    return port->slave >= 0;
}

static int open_slave(grobo_port *port, int baud_bps, grobo_os_cause *cause)
{
    const char *path;
    int r;

    if (grantpt(port->fd) != 0 || unlockpt(port->fd) != 0 || (path = ptsname(port->fd)) == NULL) {
        return grobo_i_posix_fail(cause, errno, "unlockpt");
    }
    if (grobo_i_port_copy(port->path, sizeof port->path, path) < 0) {
        return grobo_i_port_refuse(cause, GROBO_ERR_SPACE, "name of the terminal too long");
    }
    if (!hold_slave(port)) {
        return grobo_i_posix_fail(cause, errno, "open");
    }
    r = grobo_i_posix_make_raw(port->slave, cause);
    return r < 0 ? r : grobo_i_posix_set_baud(port->slave, baud_bps, cause);
}

/* Removes the link, unless it leads elsewhere by now. */
static void remove_link(const grobo_port *port)
{
    char target[sizeof port->path];
    ssize_t size = port->link[0] != '\0' ? readlink(port->link, target, sizeof target) : -1;

    if (size >= 0 && (size_t)size == strlen(port->path) &&
        memcmp(target, port->path, (size_t)size) == 0) {
        (void)unlink(port->link);
    }
}

static void pty_close(grobo_port *port)
{
    remove_link(port);
    if (port->slave >= 0) {
        (void)close(port->slave);
    }
    grobo_i_posix_close(port);
}

static int pty_open(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause)
{
    int r;

    port->slave = GROBO_HANDLE_NULL;
    port->link[0] = '\0';
    port->fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (port->fd < 0) {
        return grobo_i_posix_fail(cause, errno, "posix_openpt");
    }
    r = grobo_i_posix_prepare(port->fd, cause);
    if (r >= 0) {
        r = open_slave(port, baud_bps, cause);
    }
    if (r >= 0) {
        r = make_link(port, device, cause);
    }
    if (r < 0) {
        pty_close(port);
        return r;
    }
    return GROBO_OK;
}

static void pty_discard_output(grobo_port *port)
{
    (void)tcflush(port->slave, TCIFLUSH);
}

static int pty_set_baud(grobo_port *port, int baud_bps, grobo_os_cause *cause)
{
    return grobo_i_posix_set_baud(port->slave, baud_bps, cause);
}

static int pty_set_low_latency(grobo_port *port, grobo_os_cause *cause)
{
    (void)port;
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED, "a pseudo-terminal");
}

const grobo_port_ops *grobo_port_pty_ops(void)
{
    static const grobo_port_ops ops = {
        .name = "pty",
        .size_bytes = sizeof(grobo_port),
        .open = pty_open,
        .close = pty_close,
        .ready = grobo_i_port_ready,
        .read = grobo_i_posix_read,
        .write = grobo_i_posix_write,
        .waiting = grobo_i_posix_waiting,
        .discard_output = pty_discard_output,
        .set_baud = pty_set_baud,
        .set_format = grobo_i_port_set_format,
        .set_low_latency = pty_set_low_latency,
        .socket = grobo_i_posix_socket,
        .handle = grobo_i_posix_handle,
    };

    return &ops;
}

int grobo_port_pty_path(const grobo_port *port, char *path, size_t path_bytes)
{
    return port == NULL || path == NULL ? GROBO_ERR_ARG
                                        : grobo_i_port_copy(path, path_bytes, port->path);
}

int grobo_port_pty_baud(const grobo_port *port)
{
    if (port == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_os_cause cause;
    int baud_bps = grobo_i_posix_get_baud(port->slave, &cause);

    return baud_bps > 0 ? baud_bps : 0;
}

/* A line that nobody else has open has hung up as soon as the port has let go of it. */
bool grobo_port_pty_in_use(grobo_port *port)
{
    if (port == NULL) {
        return false;
    }
    struct pollfd line = {.fd = port->fd};

    if (port->slave >= 0) {
        (void)ioctl(port->slave, TIOCNXCL); /* a program's, which would keep the port out */
        (void)close(port->slave);
    }
    (void)poll(&line, 1, 0);
    (void)hold_slave(port);
    return (line.revents & POLLHUP) == 0;
}
