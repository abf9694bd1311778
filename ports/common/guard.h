/* SPDX-License-Identifier: MIT */
/*
 * A process beside the program, and the socket between them: what src/link/guard/guard.c asks of a
 * port. Systems without descriptors that can be passed on (Win32) answer GROBO_ERR_UNSUPPORTED.
 */
#ifndef GROBO_PORTS_GUARD_H
#define GROBO_PORTS_GUARD_H

#include <grobo/core/port.h>

/* ---- the program's side ------------------------------------------------------------------- */

/* The process, as the program that spawned it has it. */
typedef struct grobo_i_guard_process {
    grobo_socket socket; /* GROBO_SOCKET_NULL: ended */
    int pid;             /* 0: it has ended */
    int owner;           /* the process that spawned it */
} grobo_i_guard_process;

/* The grctl that is installed with the library. */
const char *grobo_i_guard_default(void);

/*
 * Spawns a program (a path, or a name to be looked up in PATH) with the socket as its standard
 * input, standard output closed to it, standard error inherited. The caller's ends are closed on
 * exec. `arguments` ends with NULL and does not hold the program's name.
 * @return GROBO_OK, GROBO_ERR_UNSUPPORTED, GROBO_ERR_NOENT, GROBO_ERR_PERM, GROBO_ERR_NOMEM,
 *   GROBO_ERR_IO.
 */
int grobo_i_guard_spawn(const char *program, const char *const *arguments,
                        grobo_i_guard_process *process);

/* False in a process that the owner forked: it has the same socket, but no business with it. */
bool grobo_i_guard_is_owner(const grobo_i_guard_process *process);

/* Kills it, if it has not ended; the socket stays, for whoever waits on it. */
void grobo_i_guard_kill(grobo_i_guard_process *process);

/* Closes the socket, waits for the process to end, at most so long, and then kills it. */
void grobo_i_guard_end(grobo_i_guard_process *process, int64_t patience_us);

/* ---- both sides --------------------------------------------------------------------------- */

/*
 * Sends all of the bytes or nothing that can be used, without waiting; with GROBO_HANDLE_NULL no
 * handle goes with them.
 * @return GROBO_OK, GROBO_ERR_FULL (the other side does not read), GROBO_ERR_CLOSED (it has
 *   ended), GROBO_ERR_IO (this is no such socket any more).
 */
int grobo_i_guard_send(grobo_socket socket, const void *bytes, size_t size, grobo_handle handle);

/*
 * Takes what has come, at most `size` bytes, without waiting. *handle is set when one came with
 * them, which the caller closes; `handle` may be NULL where none is expected.
 * @return count; 0 nothing now; GROBO_ERR_CLOSED: the other side has ended; GROBO_ERR_IO: this is
 *   no such socket any more.
 */
int grobo_i_guard_receive(grobo_socket socket, void *bytes, size_t size, grobo_handle *handle);

/* ---- the process's side ------------------------------------------------------------------- */

/*
 * Memory of so many bytes, zeroed, that two processes have: one makes it, and the other maps what
 * it got the handle of. The handle is not needed any more then.
 * @return GROBO_OK, GROBO_ERR_UNSUPPORTED (Linux only), GROBO_ERR_NOMEM, GROBO_ERR_IO.
 */
int grobo_i_guard_share(size_t size, void **at, grobo_handle *handle);
int grobo_i_guard_map(grobo_handle handle, size_t size, void **at);
void grobo_i_guard_unmap(void *at, size_t size);

/* What the process watches. */
typedef struct grobo_i_guard_watch {
    grobo_socket socket;
    int parent;    /* the program */
    int death;     /* descriptor that becomes readable at its death, -1: none */
    int state;     /* of Linux: its /proc/PID/stat, -1: none */
    int asked;     /* becomes readable when grobo_i_holder_end() asks for a stop, -1: none */
    int stillness; /* looks in a row that found it stopped */
} grobo_i_guard_watch;

/*
 * Makes the calling process a guard: a session of its own, signals that end it ignored, every
 * descriptor closed but the socket and standard error, known to the system as GROBO_GUARD_NAME.
 * @return GROBO_OK; GROBO_ERR_ARG: standard input is no such socket; GROBO_ERR_CLOSED: the
 *   program has died already; GROBO_ERR_UNSUPPORTED.
 */
int grobo_i_guard_begin(grobo_i_guard_watch *watch);

/* Closes what it watches with. */
void grobo_i_guard_cease(grobo_i_guard_watch *watch);

/* What grobo_i_guard_await() returns, a bit each. */
enum {
    GROBO_I_GUARD_NEWS = 1,    /* the socket is readable, or at its end */
    GROBO_I_GUARD_DEAD = 2,    /* the program is dead */
    GROBO_I_GUARD_STOPPED = 4, /* it is stopped (SIGSTOP), and has been for 100 ms */
    GROBO_I_GUARD_HUNG_UP = 8, /* the line's device is gone */
    GROBO_I_GUARD_ASKED = 16   /* an emergency stop asks for it; told once */
};

/*
 * Waits for one of these. `line` is GROBO_HANDLE_NULL where there is none; whether the program is
 * stopped is looked for only while `moves`, and then it returns 50 ms later with nothing found.
 */
unsigned grobo_i_guard_await(grobo_i_guard_watch *watch, grobo_handle line, bool moves);

/* Makes an open port of a handle that came over the socket; to be closed by the ops' close(). */
void grobo_i_port_adopt(grobo_port *port, grobo_handle handle);

/* Closes a handle that came. */
void grobo_i_guard_drop(grobo_handle handle);

/* Has the ops' close() leave the device as it is: the guard has it now, and releases it. */
void grobo_i_port_abandon(grobo_port *port);

/* Lets other programs have the device, which stays open here; a connection stays as it is. */
void grobo_i_port_lend(grobo_port *port);

/* Takes it back for this process alone. GROBO_OK; GROBO_ERR_BUSY: another program has it. */
int grobo_i_port_reclaim(grobo_port *port);

#endif
