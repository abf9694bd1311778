/* SPDX-License-Identifier: MIT */
/* The listening side of "tcp:HOST:PORT". */
#include "ports/win32/win32.h"

/* Which TCP port a socket has. */
static int port_of(SOCKET of)
{
    struct sockaddr_storage address = {0};
    int size = sizeof address;

    if (getsockname(of, (struct sockaddr *)&address, &size) != 0) {
        return 0;
    }
    return ntohs(address.ss_family == AF_INET6 ? ((struct sockaddr_in6 *)&address)->sin6_port
                                               : ((struct sockaddr_in *)&address)->sin_port);
}

static int listen_on(SOCKET made, const struct addrinfo *at, grobo_os_cause *cause)
{
    int one = 1;

    /* SO_REUSEADDR would let two programs have one port here; this keeps others out. */
    (void)setsockopt(made, SOL_SOCKET, SO_EXCLUSIVEADDRUSE, (const char *)&one, sizeof one);
    if (bind(made, at->ai_addr, (int)at->ai_addrlen) != 0) {
        int code = WSAGetLastError();
        int r = grobo_i_win32_fail(cause, (DWORD)code, "bind");

        return code == WSAEADDRNOTAVAIL ? GROBO_ERR_NOENT : r;
    }
    return listen(made, 4) == 0 ? GROBO_OK
                                : grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "listen");
}

int grobo_port_listen(const char *device, grobo_socket *listener, int *tcp_port,
                      grobo_os_cause *cause)
{
    if (device == NULL || listener == NULL || tcp_port == NULL || cause == NULL) {
        return GROBO_ERR_ARG;
    }
    struct addrinfo *at;
    SOCKET made;
    int r = grobo_i_win32_look_up(device, true, &at, cause);

    if (r < 0) {
        return r;
    }
    r = grobo_i_win32_make_socket(at, &made, cause);
    if (r >= 0) {
        r = listen_on(made, at, cause);
        if (r < 0) {
            closesocket(made);
        }
    }
    freeaddrinfo(at);
    if (r < 0) {
        return r;
    }
    *listener = (grobo_socket)made;
    *tcp_port = port_of(made);
    return GROBO_OK;
}

void grobo_port_listen_close(grobo_socket listener)
{
    closesocket((SOCKET)listener);
}

int grobo_port_accept(grobo_socket listener, grobo_port *port, grobo_os_cause *cause)
{
    if (port == NULL || cause == NULL) {
        return GROBO_ERR_ARG;
    }
    SOCKET made = accept((SOCKET)listener, NULL, NULL);
    int r;

    if (made == INVALID_SOCKET) {
        int code = WSAGetLastError();

        /* A client that has left again is one that is not there. */
        return code == WSAEWOULDBLOCK || code == WSAECONNRESET || code == WSAECONNABORTED
                   ? GROBO_ERR_EMPTY
                   : grobo_i_win32_fail(cause, (DWORD)code, "accept");
    }
    r = grobo_i_win32_prepare(made, cause);
    if (r < 0) {
        closesocket(made);
        return r;
    }
    port->socket = made;
    grobo_i_win32_tick(true);
    return GROBO_OK;
}
