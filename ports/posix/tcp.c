/* SPDX-License-Identifier: MIT */
/* Raw TCP to a serial server: "tcp:HOST:PORT". */
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "ports/posix/posix.h"

/* Systems without it have SO_NOSIGPIPE, set where a socket is made. */
#ifndef MSG_NOSIGNAL
#define MSG_NOSIGNAL 0
#endif

int grobo_i_posix_look_up(const char *device, bool numeric, struct addrinfo **found,
                          grobo_os_cause *cause)
{
    const struct addrinfo hints = {.ai_flags = AI_NUMERICSERV | (numeric ? AI_NUMERICHOST : 0),
                                   .ai_family = AF_UNSPEC,
                                   .ai_socktype = SOCK_STREAM};
    grobo_i_tcp_name to;
    int r = grobo_i_tcp_split(device, numeric, &to, cause);

    if (r < 0) {
        return r;
    }
    r = getaddrinfo(to.host, to.port, &hints, found);
    return r == 0 ? GROBO_OK : grobo_i_port_refuse(cause, GROBO_ERR_NOENT, gai_strerror(r));
}

int grobo_i_posix_prepare_tcp(int fd, grobo_os_cause *cause)
{
    int one = 1;

    /* These make it better and are no reason to fail. */
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    (void)setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &one, sizeof one);
#ifdef SO_NOSIGPIPE
    (void)setsockopt(fd, SOL_SOCKET, SO_NOSIGPIPE, &one, sizeof one);
#endif
    return grobo_i_posix_prepare(fd, cause);
}

int grobo_i_posix_make_socket(const struct addrinfo *to, grobo_os_cause *cause)
{
    int fd = socket(to->ai_family, SOCK_STREAM, 0);
    int r;

    if (fd < 0) {
        return grobo_i_posix_fail(cause, errno, "socket");
    }
    r = grobo_i_posix_prepare_tcp(fd, cause);
    if (r < 0) {
        (void)close(fd);
        return r;
    }
    return fd;
}

/* A refused connection means: no such device; a lost one is another matter (error_of). */
static int fail_connect(int code, grobo_os_cause *cause)
{
    int r = grobo_i_posix_fail(cause, code, "connect");

    switch (code) {
    case ECONNREFUSED:
    case EHOSTUNREACH:
    case ENETUNREACH:
    case EADDRNOTAVAIL:
        return GROBO_ERR_NOENT;
    case ETIMEDOUT:
        return GROBO_ERR_TIMEOUT;
    default:
        return r;
    }
}

static int tcp_open(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause)
{
    struct addrinfo *found;
    int fd;
    int r = grobo_i_posix_look_up(device, true, &found, cause);

    (void)baud_bps;
    if (r < 0) {
        return r;
    }
    fd = grobo_i_posix_make_socket(found, cause);
    if (fd >= 0 && connect(fd, found->ai_addr, found->ai_addrlen) != 0 && errno != EINPROGRESS &&
        errno != EINTR) {
        r = fail_connect(errno, cause);
        (void)close(fd);
        fd = r;
    }
    freeaddrinfo(found);
    if (fd < 0) {
        return fd;
    }
    port->fd = fd;
    return GROBO_OK;
}

static int tcp_ready(grobo_port *port, grobo_os_cause *cause)
{
    struct pollfd one = {.fd = port->fd, .events = POLLOUT};
    int error = 0;
    socklen_t size = sizeof error;

    if (poll(&one, 1, 0) <= 0) {
        return 0;
    }
    if (getsockopt(port->fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0) {
        error = errno;
    }
    return error == 0 ? 1 : fail_connect(error, cause);
}

static int tcp_read(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    ssize_t got;

    do {
        got = recv(port->fd, buf, size, 0);
    } while (got < 0 && errno == EINTR);
    return grobo_i_posix_received(got, cause);
}

static int tcp_write(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause)
{
    ssize_t put;

    do {
        put = send(port->fd, buf, size, MSG_NOSIGNAL);
    } while (put < 0 && errno == EINTR);
    return grobo_i_posix_sent(put, cause);
}

/*
 * A receiver may acknowledge every second segment only: so much is on its way on a sound line. What
 * is more was lost, or waits behind it, and all of it would come at once when the line is back.
 */
#define ON_ITS_WAY_BYTES (2 * GROBO_FRAME_MAX_BYTES)

/* Linux counts what was not acknowledged; other systems have no such question. */
static int tcp_unsent(const grobo_port *port)
{
    int count = grobo_i_posix_unsent(port);

    return count > ON_ITS_WAY_BYTES ? count - ON_ITS_WAY_BYTES : 0;
}

const grobo_port_ops *grobo_port_tcp_ops(void)
{
    static const grobo_port_ops ops = {
        .name = "tcp",
        .size_bytes = sizeof(grobo_port),
        .open = tcp_open,
        .close = grobo_i_posix_close,
        .ready = tcp_ready,
        .read = tcp_read,
        .write = tcp_write,
        .waiting = grobo_i_posix_waiting,
        .discard_output = grobo_i_tcp_discard_output,
        .set_baud = grobo_i_tcp_set_baud,
        .set_format = grobo_i_port_set_format,
        .set_low_latency = grobo_i_tcp_set_low_latency,
        .socket = grobo_i_posix_socket,
        .handle = grobo_i_posix_handle,
        .unsent = tcp_unsent,
    };

    return &ops;
}

static int find_numeric(const char *device, grobo_i_tcp_name *at, grobo_os_cause *cause)
{
    struct addrinfo *found;
    int r = grobo_i_posix_look_up(device, false, &found, cause);

    if (r < 0) {
        return r;
    }
    r = getnameinfo(found->ai_addr, found->ai_addrlen, at->host, sizeof at->host, at->port,
                    sizeof at->port, NI_NUMERICHOST | NI_NUMERICSERV);
    freeaddrinfo(found);
    return r == 0 ? GROBO_OK : grobo_i_port_refuse(cause, GROBO_ERR_NOENT, gai_strerror(r));
}

int grobo_port_resolve(const char *device, char *numeric, size_t numeric_bytes,
                       grobo_os_cause *cause)
{
    return device == NULL || numeric == NULL || cause == NULL
               ? GROBO_ERR_ARG
               : grobo_i_tcp_resolve(device, numeric, numeric_bytes, find_numeric, cause);
}
