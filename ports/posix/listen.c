/* SPDX-License-Identifier: MIT */
/* The listening side of "tcp:HOST:PORT". */
#include <errno.h>
#include <netdb.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "ports/posix/posix.h"

/* Which TCP port a socket has. */
static int port_of(int fd)
{
    struct sockaddr_storage address;
    socklen_t size = sizeof address;
    char port[8];

    if (getsockname(fd, (struct sockaddr *)&address, &size) != 0 ||
        getnameinfo((struct sockaddr *)&address, size, NULL, 0, port, sizeof port,
                    NI_NUMERICSERV) != 0) {
        return 0;
    }
    return (int)strtol(port, NULL, 10);
}

static int listen_on(int fd, const struct addrinfo *at, grobo_os_cause *cause)
{
    int one = 1;

    (void)setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    if (bind(fd, at->ai_addr, at->ai_addrlen) != 0) {
        int error = errno;
        int r = grobo_i_posix_fail(cause, error, "bind");

        return error == EADDRINUSE ? GROBO_ERR_BUSY : r;
    }
    return listen(fd, 4) == 0 ? GROBO_OK : grobo_i_posix_fail(cause, errno, "listen");
}

int grobo_port_listen(const char *device, grobo_socket *listener, int *tcp_port,
                      grobo_os_cause *cause)
{
    if (device == NULL || listener == NULL || tcp_port == NULL || cause == NULL) {
        return GROBO_ERR_ARG;
    }
    struct addrinfo *at;
    int fd;
    int r = grobo_i_posix_look_up(device, true, &at, cause);

    if (r < 0) {
        return r;
    }
    fd = grobo_i_posix_make_socket(at, cause);
    r = fd < 0 ? fd : listen_on(fd, at, cause);
    freeaddrinfo(at);
    if (r < 0) {
        if (fd >= 0) {
            (void)close(fd);
        }
        return r;
    }
    *listener = fd;
    *tcp_port = port_of(fd);
    return GROBO_OK;
}

void grobo_port_listen_close(grobo_socket listener)
{
    (void)close(listener);
}

int grobo_port_accept(grobo_socket listener, grobo_port *port, grobo_os_cause *cause)
{
    if (cause == NULL || port == NULL) {
        return GROBO_ERR_ARG;
    }
    int fd = accept(listener, NULL, NULL);
    int r;

    if (fd < 0) {
        /* A client that has left again (ECONNABORTED) is one that is not there. */
        return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ECONNABORTED
                   ? GROBO_ERR_EMPTY
                   : grobo_i_posix_fail(cause, errno, "accept");
    }
    r = grobo_i_posix_prepare_tcp(fd, cause);
    if (r < 0) {
        (void)close(fd);
        return r;
    }
    port->fd = fd;
    return GROBO_OK;
}
