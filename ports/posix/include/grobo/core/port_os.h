/* SPDX-License-Identifier: MIT */
/**
 * @file port_os.h
 * @brief The operating system's types behind grobo/core/port.h: POSIX.
 *
 * Each port brings a file of this name with the same names in it; the one of the port that the
 * library was built for is installed beside port.h.
 */
#ifndef GROBO_CORE_PORT_OS_H
#define GROBO_CORE_PORT_OS_H

#include <pthread.h>
#include <stddef.h>

/** What the operating system calls an open port: here a file descriptor. */
typedef int grobo_handle;
/** No handle: the value before open and after close. */
#define GROBO_HANDLE_NULL (-1)

/** The name of the serial port with a number, for printf(). */
#define GROBO_SERIAL_NAME_FORM "/dev/ttyS%d"

/** What an event loop waits on; the same type as libevent's evutil_socket_t. */
typedef int grobo_socket;
/** No socket. */
#define GROBO_SOCKET_NULL (-1)

/** A running thread, from grobo_thread_start() to grobo_thread_join(). */
typedef pthread_t grobo_thread;
/** The result type, with the calling convention, of a thread's function. */
#define GROBO_THREAD_FUNC void *
/** How a thread's function ends. */
#define GROBO_THREAD_RETURN return NULL

/** A lock, not recursive, from grobo_mutex_init() to grobo_mutex_deinit(). */
typedef pthread_mutex_t grobo_mutex;

/** A condition, from grobo_cond_init() to grobo_cond_deinit(). */
typedef pthread_cond_t grobo_cond;

#endif
