/* SPDX-License-Identifier: MIT */
/* What the files of the Win32 port share. */
#ifndef GROBO_PORTS_WIN32_H
#define GROBO_PORTS_WIN32_H

/* Windows 7 has everything that is called here. */
#include <winsock2.h>
#include <windows.h>
#include <ws2tcpip.h>

#include "ports/common/common.h"

/* Bytes on their way between a serial port and its socket, each way. */
enum { WIN32_PUMP_BYTES = 1024 };

/* One direction of an overlapped port. */
typedef struct grobo_i_win32_way {
    OVERLAPPED io;
    bool busy; /* the system has it */
    DWORD at;  /* first byte that is still to go on */
    DWORD used;
    char bytes[WIN32_PUMP_BYTES];
} grobo_i_win32_way;

/* The thread that moves bytes between a serial port and the far socket of a pair. */
typedef struct grobo_i_win32_pump {
    HANDLE com;
    SOCKET far_socket;
    HANDLE moved;     /* something happened to far_socket */
    HANDLE stop;      /* asks to end at once */
    HANDLE discard;   /* asks to drop what has not left yet */
    HANDLE discarded; /* done */
    grobo_thread thread;
    volatile LONG failure; /* the error that ended it, 0 none */
    bool near_gone;        /* nothing more will come to be written */
    grobo_i_win32_way rx;
    grobo_i_win32_way tx;
} grobo_i_win32_pump;

/* An open byte port of any kind. */
struct grobo_port {
    SOCKET socket; /* what a loop waits on */
    /* of a serial port only */
    HANDLE com;
    HANDLE lock;
    grobo_line_format format;
    grobo_i_win32_pump pump;
};

/* ---- causes: cause.c ---------------------------------------------------------------------- */

/* Fills cause from GetLastError() or WSAGetLastError(); returns the GROBO_ERR_* for it. */
int grobo_i_win32_fail(grobo_os_cause *cause, DWORD code, const char *what);

/* ---- sockets: socket.c -------------------------------------------------------------------- */

/* Makes two sockets that are joined, neither of which waits. Returns GROBO_OK or GROBO_ERR_*. */
int grobo_i_win32_socket_pair(SOCKET pair[2], grobo_os_cause *cause);

/* Sets a socket non-blocking, not inherited, without Nagle's delay. */
int grobo_i_win32_prepare(SOCKET made, grobo_os_cause *cause);

/* Finds the address of "tcp:HOST:PORT", numeric or by its name; freed by freeaddrinfo(). */
int grobo_i_win32_look_up(const char *device, bool numeric, struct addrinfo **found,
                          grobo_os_cause *cause);

/* Makes a socket for an address; an error leaves none behind. */
int grobo_i_win32_make_socket(const struct addrinfo *to, SOCKET *made, grobo_os_cause *cause);

/* Bytes that a socket has received and nobody has read. */
int grobo_i_win32_waiting(grobo_port *port, grobo_os_cause *cause);

grobo_socket grobo_i_win32_socket(const grobo_port *port);

/* Has the system's timers tick each millisecond, or as they did; calls are counted. */
void grobo_i_win32_tick(bool fast);

/* ---- serial ports: pump.c, name.c, lock.c ------------------------------------------------- */

/* Starts to move bytes between port->com and port->socket. */
int grobo_i_win32_pump_start(grobo_port *port, grobo_os_cause *cause);

/* Writes what is under way, for half a second at most, then ends the thread. */
void grobo_i_win32_pump_stop(grobo_port *port);

/* Drops what was written and has not left yet. */
void grobo_i_win32_pump_discard(grobo_port *port);

/* The name that CreateFile() wants: \\.\COM10. GROBO_ERR_ARG, GROBO_ERR_SPACE. */
int grobo_i_win32_path(const char *device, char *path, size_t path_bytes);

/* The name that people use: COM10. GROBO_ERR_ARG, GROBO_ERR_SPACE. */
int grobo_i_win32_plain_name(const char *device, char *name, size_t name_bytes);

/* Takes the lock of a device; NULL when another program of this library has it. */
HANDLE grobo_i_win32_lock(const char *device);
void grobo_i_win32_unlock(HANDLE lock);

#endif
