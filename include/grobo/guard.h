/* SPDX-License-Identifier: MIT */
/**
 * @file guard.h
 * @brief A second process that stops the robot when the program dies.
 *
 * Servos continue to the goal they were sent last, whatever becomes of the program that sent it. A
 * guard is a process in a session of its own that has the open port too. It sends nothing while the
 * program lives. When the program dies without closing the port (SIGKILL, SIGSEGV, abort(), the
 * out-of-memory killer), it waits until the line is quiet, reads every joint, stops those that move
 * where they are, reads them again, and releases the port, all within GROBO_GUARD_BOUND_US. Torque
 * stays on, unless the exit policy of the moment is GROBO_EXIT_OFF: then it goes off after that.
 * GROBO_EXIT_SIT takes longer than a guard has, so the robot holds. A robot under an emergency stop
 * is stopped that way again.
 *
 * On Linux the guard also stops what moves when the program is stopped (SIGSTOP) for about 100 ms,
 * and when its loop has not turned for GROBO_GUARD_SILENCE_US: a callback that does not return, a
 * deadlock, a debugger. The session sends nothing more then, and reports GROBO_ERR_STALLED when the
 * program continues. Torque stays on, as the program may continue; where the policy is
 * GROBO_EXIT_OFF, it goes off if the program dies before another one has had the robot. While no
 * joint moves, a program may hold its loop up for as long as it likes.
 *
 * @code
 *   grobo_guard *guard = NULL;
 *   result = grobo_guard_new(NULL, &guard);   // first thing in main(): before threads and ports
 *   ...
 *   config.guard = guard;                     // grobo_session_config
 *   ...
 *   grobo_session_free(session);
 *   grobo_guard_free(guard);
 * @endcode
 *
 * The guard is spawned by posix_spawn(): the installed grctl, or a program of the caller's that
 * calls grobo_guard_run() (needed for a driver of one's own). It is a child of the program, whose
 * SIGCHLD and waitpid(-1) see its end. Its descriptors are closed on exec; a process that the
 * program forks without exec has no effect on it. A program that becomes a daemon by fork() does so
 * before grobo_guard_new().
 *
 * POSIX only. On Windows grobo_guard_new() returns GROBO_ERR_UNSUPPORTED: a program that is killed
 * there leaves the servos on their way.
 *
 * A guard belongs to the thread of the session that has it.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_GUARD_H
#define GROBO_GUARD_H

#include <grobo/core/driver.h>
#include <grobo/mem.h>

GROBO_BEGIN_DECLS

/** From the death of the program until the port is released, at most. */
#define GROBO_GUARD_BOUND_US INT64_C(2000000)

/** A program whose loop does not turn for so long while joints move has lost its robot. */
#define GROBO_GUARD_SILENCE_US INT64_C(1000000)

/** Most bytes of grobo_session_config.guard_data. */
#define GROBO_GUARD_DATA_BYTES 2048

/** A guard, seen from its program. */
typedef struct grobo_guard grobo_guard;

/** What a guard is made of. Zero means default. */
typedef struct grobo_guard_config {
    size_t size; /**< GROBO_GUARD_CONFIG_INIT */
    /** A path, or a name to be looked up in PATH; borrowed during the call. NULL: the grctl that
     *  was installed with the library. */
    const char *program;
    /** Of it, without its name, ended by NULL, 14 at most; borrowed during the call. NULL: "guard",
     *  which is grctl's word for it. */
    const char *const *arguments;
    const grobo_mem *mem; /**< borrowed allocator; NULL: the C library's */
} grobo_guard_config;
/** Begins an initializer of one. */
#define GROBO_GUARD_CONFIG_INIT GROBO_SIZED(grobo_guard_config)

/**
 * Starts a guard and waits until it is ready: some milliseconds, 2 s at most. Before threads,
 * event bases and ports are made, so that nothing of them is in it. NULL: all defaults.
 * @param[out] guard freed with grobo_guard_free().
 * @return GROBO_OK, GROBO_ERR_ARG (guard is NULL), GROBO_ERR_CAP (too many arguments),
 *   GROBO_ERR_NOENT (no such program), GROBO_ERR_PERM, GROBO_ERR_NOMEM, GROBO_ERR_MISMATCH (it is
 *   no guard, or one of another version), GROBO_ERR_TIMEOUT, GROBO_ERR_UNSUPPORTED (Windows),
 *   GROBO_ERR_IO.
 */
GROBO_API int grobo_guard_new(const grobo_guard_config *config, grobo_guard **guard);

/**
 * Ends the guard, after the session that has it was freed, and waits for that: a millisecond,
 * 1 s at most. In a process that the program forked it only frees. NULL is fine.
 */
GROBO_API void grobo_guard_free(grobo_guard *guard);

/** The process id of the guard, 0 once it is known to have ended. */
GROBO_API int grobo_guard_pid(const grobo_guard *guard);

/* ---- in the guard's own program ----------------------------------------------------------- */

/** Why a guard stopped the robot. */
typedef enum grobo_guard_cause {
    GROBO_GUARD_DIED,    /**< the program has died */
    GROBO_GUARD_STOPPED, /**< the program is stopped by a signal while joints move */
    GROBO_GUARD_ASKED,   /**< an emergency stop asked for it: the program had not obeyed */
    GROBO_GUARD_SILENT   /**< its loop does not turn while joints move */
} grobo_guard_cause;

/** What runs a guard. Zero means default. */
typedef struct grobo_guard_program {
    size_t size; /**< GROBO_GUARD_PROGRAM_INIT */
    /**
     * The driver of that name and wiring, or NULL: there is none, and the program is told.
     * `data` and `bytes` are grobo_session_config.guard_data; *driver_ctx is NULL when called and
     * what the driver's functions get. The result must last. NULL: grobo_gr001_driver() for "GR001"
     * without data.
     */
    const grobo_driver *(*driver)(void *ctx, const char *name, grobo_wiring wiring,
                                  const void *data, size_t bytes, void **driver_ctx);
    /**
     * The robot was stopped, and the port is released; `result` is GROBO_OK when every joint was
     * read and stands, else the first error. NULL: no report.
     */
    void (*on_stop)(void *ctx, grobo_guard_cause cause, int result);
    void *ctx; /**< borrowed, handed to these */
} grobo_guard_program;
/** Begins an initializer of one. */
#define GROBO_GUARD_PROGRAM_INIT GROBO_SIZED(grobo_guard_program)

/**
 * Is the guard, until the program that started it has ended or has freed it: the only call of a
 * program that grobo_guard_new() starts. Takes over standard input, ignores the signals that end
 * programs, and changes the working directory to the root.
 * @param program NULL: all defaults.
 * @return GROBO_OK, GROBO_ERR_ARG (not started by grobo_guard_new()), GROBO_ERR_NOMEM,
 *   GROBO_ERR_UNSUPPORTED (Windows), GROBO_ERR_IO.
 */
GROBO_API int grobo_guard_run(const grobo_guard_program *program);

GROBO_END_DECLS

#endif
