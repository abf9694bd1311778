/* SPDX-License-Identifier: MIT */
/* Raw TCP to a serial server: "tcp:HOST:PORT". */
#include "ports/win32/win32.h"

/* A refused connection means: no such device; a lost one is another matter (error_of). */
static int fail_connect(int code, grobo_os_cause *cause)
{
    int r = grobo_i_win32_fail(cause, (DWORD)code, "connect");

    switch (code) {
    case WSAECONNREFUSED:
    case WSAEHOSTUNREACH:
    case WSAENETUNREACH:
    case WSAEADDRNOTAVAIL:
        return GROBO_ERR_NOENT;
    case WSAETIMEDOUT:
        return GROBO_ERR_TIMEOUT;
    default:
        return r;
    }
}

static int tcp_open(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause)
{
    struct addrinfo *found;
    SOCKET made = INVALID_SOCKET;
    int one = 1;
    int r = grobo_i_win32_look_up(device, true, &found, cause);

    (void)baud_bps;
    if (r < 0) {
        return r;
    }
    r = grobo_i_win32_make_socket(found, &made, cause);
    if (r >= 0) {
        (void)setsockopt(made, SOL_SOCKET, SO_KEEPALIVE, (const char *)&one, sizeof one);
    }
    if (r >= 0 && connect(made, found->ai_addr, (int)found->ai_addrlen) != 0 &&
        WSAGetLastError() != WSAEWOULDBLOCK) {
        r = fail_connect(WSAGetLastError(), cause);
        closesocket(made);
    }
    freeaddrinfo(found);
    if (r < 0) {
        return r;
    }
    port->socket = made;
    grobo_i_win32_tick(true);
    return GROBO_OK;
}

static void tcp_close(grobo_port *port)
{
    closesocket(port->socket);
    port->socket = INVALID_SOCKET;
    grobo_i_win32_tick(false);
}

static int tcp_ready(grobo_port *port, grobo_os_cause *cause)
{
    int error = 0;
    int size = sizeof error;

    if (grobo_port_wait((grobo_socket)port->socket, GROBO_PORT_WRITABLE, 0) == 0) {
        return 0;
    }
    if (getsockopt(port->socket, SOL_SOCKET, SO_ERROR, (char *)&error, &size) != 0) {
        error = WSAGetLastError();
    }
    return error == 0 ? 1 : fail_connect(error, cause);
}

static int tcp_read(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    int got = recv(port->socket, buf, size < INT32_MAX ? (int)size : INT32_MAX, 0);

    if (got > 0) {
        return got;
    }
    if (got == 0) {
        return grobo_i_port_refuse(cause, GROBO_ERR_UNPLUGGED, "hung up");
    }
    return WSAGetLastError() == WSAEWOULDBLOCK
               ? 0
               : grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "read");
}

static int tcp_write(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause)
{
    int put = send(port->socket, buf, size < INT32_MAX ? (int)size : INT32_MAX, 0);

    if (put >= 0) {
        return put;
    }
    return WSAGetLastError() == WSAEWOULDBLOCK
               ? 0
               : grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "write");
}

static grobo_handle tcp_handle(const grobo_port *port)
{
    return (grobo_handle)port->socket;
}

const grobo_port_ops *grobo_port_tcp_ops(void)
{
    static const grobo_port_ops ops = {
        .name = "tcp",
        .size_bytes = sizeof(grobo_port),
        .open = tcp_open,
        .close = tcp_close,
        .ready = tcp_ready,
        .read = tcp_read,
        .write = tcp_write,
        .waiting = grobo_i_win32_waiting,
        .discard_output = grobo_i_tcp_discard_output,
        .set_baud = grobo_i_tcp_set_baud,
        .set_format = grobo_i_port_set_format,
        .set_low_latency = grobo_i_tcp_set_low_latency,
        .socket = grobo_i_win32_socket,
        .handle = tcp_handle,
    };

    return &ops;
}

static int find_numeric(const char *device, grobo_i_tcp_name *at, grobo_os_cause *cause)
{
    struct addrinfo *found;
    int code;
    int r = grobo_i_win32_look_up(device, false, &found, cause);

    if (r < 0) {
        return r;
    }
    code = getnameinfo(found->ai_addr, (socklen_t)found->ai_addrlen, at->host, sizeof at->host,
                       at->port, sizeof at->port, NI_NUMERICHOST | NI_NUMERICSERV);
    freeaddrinfo(found);
    if (code != 0) {
        (void)grobo_i_win32_fail(cause, (DWORD)code, "getnameinfo");
        return GROBO_ERR_NOENT;
    }
    return GROBO_OK;
}

int grobo_port_resolve(const char *device, char *numeric, size_t numeric_bytes,
                       grobo_os_cause *cause)
{
    return device == NULL || numeric == NULL || cause == NULL
               ? GROBO_ERR_ARG
               : grobo_i_tcp_resolve(device, numeric, numeric_bytes, find_numeric, cause);
}
