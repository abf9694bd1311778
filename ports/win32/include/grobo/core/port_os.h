/* SPDX-License-Identifier: MIT */
/**
 * @file port_os.h
 * @brief The operating system's types behind grobo/core/port.h: Win32.
 *
 * Each port brings a file of this name with the same names in it; the one of the port that the
 * library was built for is installed beside port.h. It does without <windows.h>, whose names would
 * come with every header of the library.
 */
#ifndef GROBO_CORE_PORT_OS_H
#define GROBO_CORE_PORT_OS_H

#include <stddef.h>
#include <stdint.h>

/** What the operating system calls an open port: a HANDLE; of a connection its SOCKET. */
typedef void *grobo_handle;
/** No handle: the value before open and after close (INVALID_HANDLE_VALUE). */
#define GROBO_HANDLE_NULL ((grobo_handle)(intptr_t)-1)

/** The name of the serial port with a number, for printf(). */
#define GROBO_SERIAL_NAME_FORM "COM%d"

/** What an event loop waits on: a SOCKET, in the same type as libevent's evutil_socket_t. */
typedef intptr_t grobo_socket;
/** No socket (INVALID_SOCKET). */
#define GROBO_SOCKET_NULL ((grobo_socket)-1)

/** A running thread (a HANDLE), from grobo_thread_start() to grobo_thread_join(). */
typedef void *grobo_thread;
/** The result type, with the calling convention, of a thread's function. */
#define GROBO_THREAD_FUNC void
/** How a thread's function ends. */
#define GROBO_THREAD_RETURN return

/** A lock, not recursive, from grobo_mutex_init() to grobo_mutex_deinit(): an SRWLOCK. */
typedef struct grobo_mutex {
    /* private */
    void *lock;
} grobo_mutex;

/** A condition, from grobo_cond_init() to grobo_cond_deinit(): a CONDITION_VARIABLE. */
typedef struct grobo_cond {
    /* private */
    void *cond;
} grobo_cond;

#endif
