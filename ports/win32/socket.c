/* SPDX-License-Identifier: MIT */
/* Sockets: their start, pairs of them, what serial port and connection do alike. */
#include <winsock2.h>
#include <timeapi.h>

#include "ports/win32/win32.h"

static BOOL CALLBACK start_once(INIT_ONCE *once, void *arg, void **context)
{
    WSADATA data;

    (void)once;
    (void)arg;
    (void)context;
    /* For the life of the process: whoever uses sockets later is not harmed. */
    return WSAStartup(MAKEWORD(2, 2), &data) == 0;
}

int grobo_port_start(void)
{
    static INIT_ONCE once = INIT_ONCE_STATIC_INIT;

    return InitOnceExecuteOnce(&once, start_once, NULL, NULL) ? GROBO_OK : GROBO_ERR_IO;
}

void grobo_i_win32_tick(bool fast)
{
    /* Else every wait is rounded up to 15.6 ms, and a robot gets 50 frames a second late. */
    (void)(fast ? timeBeginPeriod(1) : timeEndPeriod(1));
}

int grobo_i_win32_prepare(SOCKET made, grobo_os_cause *cause)
{
    u_long on = 1;
    int one = 1;

    /* This makes it better and is no reason to fail. */
    (void)setsockopt(made, IPPROTO_TCP, TCP_NODELAY, (const char *)&one, sizeof one);
    (void)SetHandleInformation((HANDLE)made, HANDLE_FLAG_INHERIT, 0);
    if (ioctlsocket(made, (long)FIONBIO, &on) != 0) {
        return grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "ioctlsocket");
    }
    return GROBO_OK;
}

int grobo_i_win32_look_up(const char *device, bool numeric, struct addrinfo **found,
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
    r = grobo_port_start();
    if (r < 0) {
        return grobo_i_port_refuse(cause, r, "WSAStartup");
    }
    r = getaddrinfo(to.host, to.port, &hints, found);
    if (r != 0) {
        (void)grobo_i_win32_fail(cause, (DWORD)r, "getaddrinfo");
        return GROBO_ERR_NOENT;
    }
    return GROBO_OK;
}

int grobo_i_win32_make_socket(const struct addrinfo *to, SOCKET *made, grobo_os_cause *cause)
{
    int r;

    *made = socket(to->ai_family, SOCK_STREAM, 0);
    if (*made == INVALID_SOCKET) {
        return grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "socket");
    }
    r = grobo_i_win32_prepare(*made, cause);
    if (r < 0) {
        closesocket(*made);
    }
    return r;
}

int grobo_i_win32_waiting(grobo_port *port, grobo_os_cause *cause)
{
    u_long count = 0;

    if (ioctlsocket(port->socket, (long)FIONREAD, &count) != 0) {
        return grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "FIONREAD");
    }
    return (int)count;
}

grobo_socket grobo_i_win32_socket(const grobo_port *port)
{
    return (grobo_socket)port->socket;
}

/* ---- a pair ------------------------------------------------------------------------------- */

/* Small buffers: what waits in them was sent, as far as the caller knows. */
static void shrink_buffers(SOCKET of)
{
    int size = 4 * WIN32_PUMP_BYTES;

    (void)setsockopt(of, SOL_SOCKET, SO_SNDBUF, (const char *)&size, sizeof size);
    (void)setsockopt(of, SOL_SOCKET, SO_RCVBUF, (const char *)&size, sizeof size);
}

/* Takes the connection that we have made, not one that somebody else made in between. */
static SOCKET accept_own(SOCKET listener, SOCKET caller)
{
    struct sockaddr_in own = {0};
    struct sockaddr_in peer = {0};
    int own_size = sizeof own;
    int peer_size = sizeof peer;
    SOCKET made = accept(listener, (struct sockaddr *)&peer, &peer_size);

    if (made != INVALID_SOCKET &&
        (getsockname(caller, (struct sockaddr *)&own, &own_size) != 0 ||
         own.sin_port != peer.sin_port || own.sin_addr.s_addr != peer.sin_addr.s_addr)) {
        closesocket(made);
        WSASetLastError(WSAECONNABORTED);
        made = INVALID_SOCKET;
    }
    return made;
}

/* Joins caller to a new socket through a listener; INVALID_SOCKET on failure. */
static SOCKET join_through(SOCKET listener, SOCKET caller)
{
    struct sockaddr_in at = {.sin_family = AF_INET};
    int size = sizeof at;

    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    shrink_buffers(listener);
    shrink_buffers(caller);
    if (bind(listener, (const struct sockaddr *)&at, sizeof at) != 0 ||
        getsockname(listener, (struct sockaddr *)&at, &size) != 0 || listen(listener, 1) != 0 ||
        connect(caller, (const struct sockaddr *)&at, sizeof at) != 0) {
        return INVALID_SOCKET;
    }
    return accept_own(listener, caller);
}

int grobo_i_win32_socket_pair(SOCKET pair[2], grobo_os_cause *cause)
{
    SOCKET listener;
    int r = grobo_port_start();

    if (r < 0) {
        return grobo_i_port_refuse(cause, r, "WSAStartup");
    }
    listener = socket(AF_INET, SOCK_STREAM, 0);
    pair[0] = socket(AF_INET, SOCK_STREAM, 0);
    pair[1] = listener == INVALID_SOCKET || pair[0] == INVALID_SOCKET
                  ? INVALID_SOCKET
                  : join_through(listener, pair[0]);
    r = pair[1] != INVALID_SOCKET
            ? GROBO_OK
            : grobo_i_win32_fail(cause, (DWORD)WSAGetLastError(), "socket pair");
    closesocket(listener);
    for (int i = 0; i < 2 && r >= 0; i++) {
        r = grobo_i_win32_prepare(pair[i], cause);
    }
    if (r < 0) {
        closesocket(pair[0]);
        closesocket(pair[1]);
    }
    return r;
}
