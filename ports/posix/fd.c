/* SPDX-License-Identifier: MIT */
/* What serial port and connection do alike with their descriptor. */
#include <errno.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "ports/posix/posix.h"

static bool nothing_now(int code)
{
    return code == EAGAIN || code == EWOULDBLOCK || code == EINTR;
}

int grobo_i_posix_received(ssize_t got, grobo_os_cause *cause)
{
    if (got > 0) {
        return (int)got;
    }
    if (got == 0) {
        return grobo_i_port_refuse(cause, GROBO_ERR_UNPLUGGED, "hung up");
    }
    return nothing_now(errno) ? 0 : grobo_i_posix_fail(cause, errno, "read");
}

int grobo_i_posix_sent(ssize_t put, grobo_os_cause *cause)
{
    if (put >= 0) {
        return (int)put;
    }
    return nothing_now(errno) ? 0 : grobo_i_posix_fail(cause, errno, "write");
}

int grobo_i_posix_prepare(int fd, grobo_os_cause *cause)
{
    int flags = fcntl(fd, F_GETFL);

    if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0 ||
        fcntl(fd, F_SETFD, FD_CLOEXEC) != 0) {
        return grobo_i_posix_fail(cause, errno, "fcntl");
    }
    return GROBO_OK;
}

int grobo_i_posix_read(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    ssize_t got;

    do {
        got = read(port->fd, buf, size);
    } while (got < 0 && errno == EINTR);
    return grobo_i_posix_received(got, cause);
}

int grobo_i_posix_write(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause)
{
    ssize_t put;

    do {
        put = write(port->fd, buf, size);
    } while (put < 0 && errno == EINTR);
    return grobo_i_posix_sent(put, cause);
}

void grobo_i_posix_close(grobo_port *port)
{
    /* Not repeated on EINTR: the descriptor is gone then, or another thread's. */
    (void)close(port->fd);
    port->fd = GROBO_HANDLE_NULL;
}

int grobo_i_posix_waiting(grobo_port *port, grobo_os_cause *cause)
{
    int count = 0;

    if (ioctl(port->fd, FIONREAD, &count) != 0) {
        return grobo_i_posix_fail(cause, errno, "FIONREAD");
    }
    return count;
}

int grobo_i_posix_unsent(const grobo_port *port)
{
    int count = 0;

    return ioctl(port->fd, TIOCOUTQ, &count) == 0 ? count : 0;
}

grobo_socket grobo_i_posix_socket(const grobo_port *port)
{
    return port->fd;
}

grobo_handle grobo_i_posix_handle(const grobo_port *port)
{
    return port->fd;
}
