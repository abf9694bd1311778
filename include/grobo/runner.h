/* SPDX-License-Identifier: MIT */
/**
 * @file runner.h
 * @brief A runner: a robot with a session of its own that any thread may call.
 *
 * A grobo_runner owns a session and the event_base it runs on, and beside them the motion that is
 * to be played. Moves, torque and readings are requests to its robot (grobo_runner_robot(),
 * robot.h), whose end grobo_runner_wait_job() waits for. grobo_runner_start() starts a thread that
 * runs the loop; until then, and after grobo_runner_stop(), a call that needs the loop runs it
 * itself for as long as it waits. So everything works with and without the thread; only what
 * happens between calls (background reading, playing, coming back after a loss) needs it, or the
 * caller's own rounds of grobo_runner_svc().
 *
 * Every function may be called from any thread at any time, grobo_runner_free() being the
 * exception. Each is of one of three kinds:
 * - **At once**: kept under a lock for a few instructions. Also in callbacks.
 * - **Handed over**: done by the thread that runs the loop, between two of its events; the caller
 *   waits for that, at most the configured timeout_us: then GROBO_ERR_TIMEOUT, and nothing was
 *   done. Also in callbacks, where it is done at once.
 * - **Waits**: handed over, then waits for the robot's answer, at most the timeout given (0:
 *   timeout_us, GROBO_NEVER_US: for ever). GROBO_ERR_TIMEOUT of such a call gives
 *   up waiting; what the robot has begun continues. Requests of several threads that need the
 *   robot's attention queue and are served in the order of their calls. In a callback waiting
 *   would be for ever: GROBO_ERR_STATE, and nothing is done.
 *
 * Stopping does not depend on a turn: grobo_runner_estop(), grobo_runner_post_stop() and
 * grobo_runner_post_exit() are safe in signal handlers and leave a request that is kept until it
 * has been carried out; grobo_runner_exit() leaves it where it cannot wait. What delays it is a
 * callback, or a function of grobo_runner_call() or grobo_runner_post(), that does not return:
 * while it holds the loop, nothing is read, nothing is watched and nothing is sent, so joints
 * continue to the posture they were sent to last, and a motion that is late by stall_us ends. A
 * callback must not wait for a lock whose owner calls here and waits. One that takes longer than
 * GROBO_CALLBACK_SLOW_US is reported by the event GROBO_EVENT_SLOW_CALLBACK.
 *
 * Besides their own errors, handed-over and waiting calls may return GROBO_ERR_FULL
 * (GROBO_RUNNER_CALLS_MAX are under way; some more for a stop or an exit), GROBO_ERR_CLOSED
 * (the robot is not connected) and GROBO_ERR_UNPLUGGED (the line was lost while the call waited:
 * no call waits for a robot that is gone). Callbacks run on the thread that runs the loop, without
 * any lock held. The functions of a driver and of a clip run with the robot's lock, on whatever
 * thread asks for it: they may call at-once functions of other robots, which do not call back.
 *
 * Joints count from 0 in joint order. The exit policy of the robot's configuration is carried out,
 * within its bound, before the loop is left alone: at the end of the runner's thread, by
 * grobo_runner_close() and by grobo_runner_free(), unless skip_exit. The library installs
 * no atexit() or signal handler: a program calls grobo_runner_free() on its way out (it may be
 * called by the program's own atexit() handler). Where the thread that owns the robot may die
 * without that, owner_timeout_us is the dead-man's handle; for the death of the whole process there
 * is session.guard (guard.h).
 * A process that the program forked calls nothing here, not even grobo_runner_free(): port and
 * loop are its parent's.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_RUNNER_H
#define GROBO_RUNNER_H

#include <grobo/core/port.h>
#include <grobo/motion_io.h>
#include <grobo/session.h>

GROBO_BEGIN_DECLS

/** Calls that may wait for the loop at a time. */
#define GROBO_RUNNER_CALLS_MAX 32
/** Ends of jobs that a runner remembers. */
#define GROBO_RUNNER_ENDS 32
/** Timeout where none is given or configured. */
#define GROBO_RUNNER_TIMEOUT_US INT64_C(5000000)
/** Period where none is given. */
#define GROBO_RUNNER_PERIOD_US 10000
/** Events that a runner keeps at most. */
#define GROBO_RUNNER_EVENTS_MAX 4096

/** A robot that any thread may call. */
typedef struct grobo_runner grobo_runner;

/** Something to be done on the loop. @return what grobo_runner_call() shall return. */
typedef int (*grobo_runner_fn)(void *arg, grobo_runner *runner);

/** What a runner is made of. Zero means default. */
typedef struct grobo_runner_config {
    size_t size; /**< GROBO_RUNNER_CONFIG_INIT */
    /** The session, needed, copied; its `device` is needed, `base` must be NULL. Its callbacks are
     *  called on the thread that runs the loop; its allocator must be safe to call from every
     *  thread. */
    const grobo_session_config *session;
    const char *name;         /**< copied; NULL: the driver's */
    const char *motion_dir;   /**< copied; NULL: "." */
    int64_t period_us;        /**< 1000..1000000; 0: GROBO_RUNNER_PERIOD_US */
    int64_t owner_timeout_us; /**< > 0: when no thread but the loop's own has called for so long,
                                    the exit policy is carried out, once until the next call */
    bool skip_exit;           /**< leave the robot as it is */
    grobo_runner_fn on_svc;   /**< called once each period while the loop runs, arg being
                                    session->ctx; its result is ignored; or NULL */
    int64_t timeout_us;       /**< of calls that are given none, and of those handed over; 0:
                                    GROBO_RUNNER_TIMEOUT_US */
    size_t events;            /**< events kept for grobo_runner_next_event(), at most
                                    GROBO_RUNNER_EVENTS_MAX; each takes some 2.5 kB; 0: none */
    grobo_realtime realtime;  /**< of the thread that runs the loop for good: the runner's, or
                                    the one in grobo_runner_run(), which keeps it (port.h) */
} grobo_runner_config;
/** Begins an initializer of one. */
#define GROBO_RUNNER_CONFIG_INIT GROBO_SIZED(grobo_runner_config)

/* ---- making and freeing ------------------------------------------------------------------- */

/**
 * Makes a runner, closed, without a thread, with an empty motion. Any thread.
 * @param[out] runner freed with grobo_runner_free().
 * @return GROBO_OK, GROBO_ERR_ARG (base given, a number out of range), GROBO_ERR_CAP (a name too
 *   long), GROBO_ERR_NOMEM, or as grobo_session_new().
 */
GROBO_API int grobo_runner_new(const grobo_runner_config *config, grobo_runner **runner);

/**
 * Stops the thread, carries out the exit policy, closes, frees; NULL is fine. Waits for the exit.
 * What was posted is done before. No other thread and no signal handler may be in a call, or call
 * later.
 * @return GROBO_OK; GROBO_ERR_STATE in a callback: then nothing was done.
 */
GROBO_API int grobo_runner_free(grobo_runner *runner);

/* ---- the runner's thread ------------------------------------------------------------------- */

/**
 * Starts the runner's thread: grobo_runner_run() on a thread of the port layer. At once, but for
 * a `realtime` that is configured: then it has been granted when this returns.
 * @return GROBO_OK, GROBO_ERR_STATE (there is one), GROBO_ERR_NOMEM, or as grobo_thread_realtime():
 *   then no thread runs.
 */
GROBO_API int grobo_runner_start(grobo_runner *runner);

/**
 * Ends the runner's thread and waits for that: it carries out the exit policy first. The port
 * stays open. In a callback: the thread ends after it, without being waited for.
 * @return GROBO_OK, GROBO_ERR_STATE (none runs).
 */
GROBO_API int grobo_runner_stop(grobo_runner *runner);

/**
 * Rounds until grobo_runner_stop() is called: the body of the runner's thread, for a
 * program that makes its threads itself. Carries out the exit policy at the end.
 * @return GROBO_OK, GROBO_ERR_STATE (a runner's thread runs; in a callback), or as
 *   grobo_thread_realtime(): then nothing has run.
 */
GROBO_API int grobo_runner_run(grobo_runner *runner);

/* ---- exclusion ---------------------------------------------------------------------------- */

/**
 * Calls fn on the loop and gives back its result: nothing else happens to the port, the session
 * or the motion meanwhile. It must not wait. For several steps that belong together, and for all
 * that session.h and robot.h can do beyond this header. Handed over.
 */
GROBO_API int grobo_runner_call(grobo_runner *runner, grobo_runner_fn fn, void *arg);

/**
 * Has fn called on the loop, and returns at once. It is called exactly once, at the latest by
 * grobo_runner_free(). At once.
 * @return GROBO_OK, GROBO_ERR_FULL, GROBO_ERR_ARG, GROBO_ERR_CLOSED (of a function that
 *   grobo_runner_free() calls as its last: no thread would call another).
 */
GROBO_API int grobo_runner_post(grobo_runner *runner, grobo_runner_fn fn, void *arg);

/**
 * The robot: any thread may make every request and ask every question of robot.h, which takes a
 * lock for as long as that takes, and never waits for the loop. What goes with it (pumping,
 * grobo_robot_on_event() and the like) is the runner's. grobo_robot_reset() is for callbacks;
 * other threads have grobo_runner_reset(). Valid as long as the runner.
 */
GROBO_API grobo_robot *grobo_runner_robot(grobo_runner *runner);

/**
 * Waits for the end of a job of grobo_runner_robot(). Waits.
 * @param job what the request returned; an error of it is returned at once.
 * @return the job's result; GROBO_ERR_PENDING (it has not ended in the time given);
 *   GROBO_ERR_NOTFOUND of a job that is forgotten: of those that
 *   have ended the last GROBO_RUNNER_ENDS are known.
 */
GROBO_API int grobo_runner_wait_job(grobo_runner *runner, int job, int64_t timeout_us);

/** The session. It belongs to the loop: use it in callbacks and in grobo_runner_call() only. */
GROBO_API grobo_session *grobo_runner_session(grobo_runner *runner);

/* ---- looking on ------------------------------------------------------------------------------
 * For programs that want no code of theirs on the loop: other languages, event loops of their own.
 * Events are kept in a ring, and a descriptor is readable while some are; a snapshot has all that
 * is known. */

/** An event as it is kept. */
typedef struct grobo_runner_event {
    size_t size;              /**< GROBO_RUNNER_EVENT_INIT */
    uint64_t lost;            /**< events lost between the one taken before and this one */
    bool of_line;             /**< true: `line` and `error`; false: `event` */
    grobo_session_event line; /**< of the line: as grobo_session_event_fn gets it */
    int error;                /**< of the line */
    grobo_event event;        /**< of the engine; job.data is in `data` below */
    uint8_t data[GROBO_FRAME_MAX_BYTES]; /**< job.size bytes of it are set */
} grobo_runner_event;
/** Begins an initializer of one. */
#define GROBO_RUNNER_EVENT_INIT GROBO_SIZED(grobo_runner_event)

/**
 * Takes the oldest event. `grobo_runner_config.events` are kept of jobs, plays, trips and the
 * line, and as many readings and rounds besides; where either is full its oldest is dropped and
 * counted, so that a flood of readings displaces nothing else, and the newest are always there.
 * What happened before a close can be taken until grobo_runner_free(). At once.
 * @param[in,out] event its `size` is set; job.data points into it.
 * @return 1; 0 where there is none; GROBO_ERR_ARG (NULL, size), GROBO_ERR_STATE (none are kept).
 */
GROBO_API int grobo_runner_next_event(grobo_runner *runner, grobo_runner_event *event);

/**
 * A descriptor that is readable while there are events, for poll(), epoll or a loop; on Win32 a
 * SOCKET, for select() and WSAPoll(). Only waited on: it is read, and closed, by the runner. A
 * forked child does not use it; a program that is executed does not get it. At once.
 * @return GROBO_SOCKET_NULL where no events are kept. Valid as long as the runner.
 */
GROBO_API grobo_socket grobo_runner_event_socket(const grobo_runner *runner);

/** What is known of the robot, all at one moment. */
typedef struct grobo_snapshot {
    size_t size;                   /**< GROBO_SNAPSHOT_INIT */
    int64_t now_us;                /**< when, by grobo_now_us() */
    bool connected;                /**< as grobo_runner_is_connected() */
    bool latched;                  /**< as grobo_runner_is_latched() */
    bool moving;                   /**< as grobo_robot_moving() */
    bool settling;                 /**< as grobo_robot_settling() */
    grobo_job_kind job;            /**< as grobo_robot_job() */
    grobo_trip_info trip;          /**< as grobo_robot_tripped() */
    grobo_play_progress play;      /**< as grobo_robot_progress() */
    grobo_robot_counters counters; /**< as grobo_robot_get_counters() */
    int n_joints;
    grobo_joint_info joints[GROBO_JOINTS_MAX]; /**< as grobo_robot_joint(): angle, goal, torque,
                                                    temperature..., and the ages of readings */
} grobo_snapshot;
/** Begins an initializer of one. */
#define GROBO_SNAPSHOT_INIT GROBO_SIZED(grobo_snapshot)

/**
 * Takes a snapshot, without waiting for the loop. At once.
 * @param[in,out] snapshot its `size` is set.
 * @return number of joints, GROBO_ERR_ARG (NULL, size).
 */
GROBO_API int grobo_runner_snapshot(grobo_runner *runner, grobo_snapshot *snapshot);

/* ---- facts and settings: at once unless stated otherwise  ---------------------------------- */

/** The robot's name. Valid as long as the runner. */
GROBO_API const char *grobo_runner_name(const grobo_runner *runner);
/** Number of joints. */
GROBO_API int grobo_runner_joints(const grobo_runner *runner);

/* ---- the line ------------------------------------------------------------------------------- */

/**
 * Carries out the exit policy where a robot is connected, then closes. Waits.
 * @return GROBO_OK (also when closed already), or how the exit failed: closed all the same. Where
 *   the loop had no turn in that time (GROBO_ERR_TIMEOUT, GROBO_ERR_FULL), the port is still open,
 *   and the exit policy is carried out once the loop turns.
 */
GROBO_API int grobo_runner_close(grobo_runner *runner, int64_t timeout_us);
/** Opens the port unless it is open, and waits until the robot has answered. Waits. @return
 *  GROBO_OK, or as grobo_session_open() and GROBO_SESSION_EVENT_FAILED. */
GROBO_API int grobo_runner_connect(grobo_runner *runner, int64_t timeout_us);
/** True while a robot is connected. At once. */
GROBO_API bool grobo_runner_is_connected(grobo_runner *runner);

/* ---- postures ------------------------------------------------------------------------------- */

/** Reads all joints. Those that stay silent are not set. Waits. @return joints read; when none
 *  was, why. */
GROBO_API int grobo_runner_read_posture(grobo_runner *runner, grobo_posture *posture,
                                        int64_t timeout_us);

/** Waits until nothing moves, nothing is asked of the robot, and the last posture of a motion has
 *  been read back. @return how the last move or motion ended: GROBO_OK, GROBO_ERR_CANCELED
 *  (stopped), or why it failed; GROBO_ERR_PENDING: it has not ended in the time given. */
GROBO_API int grobo_runner_wait(grobo_runner *runner, int64_t timeout_us);

/* ---- the current motion --------------------------------------------------------------------- */

/*
 * The motion holds absolute postures: one of increments (.mseq) is resolved when it becomes the
 * current one. Its increments count from the posture sensed last, and from the model's initial
 * posture for joints that were not sensed.
 */

/** Replaces the motion by a copy. At once. @return postures, GROBO_ERR_ARG (a motion of another
 *  robot: grobo_motion_is_for()), GROBO_ERR_NOMEM. */
GROBO_API int grobo_runner_set_motion(grobo_runner *runner, const grobo_motion *motion);
/**
 * Loads a motion of the motion folder: NAME.m, .yaml, .pseq, .mseq, whichever is there first, or
 * NAME itself where it has an extension. At once but for the reading, which is the caller's time.
 * @param list diagnostics of the file are added to it, or NULL.
 * @return postures; or, and then the motion is empty, as grobo_motion_find() and
 *   grobo_motion_read_file(), GROBO_ERR_ARG (a motion of another robot: grobo_motion_is_for()).
 */
GROBO_API int grobo_runner_load_motion(grobo_runner *runner, const char *name,
                                       grobo_diagnostics *list);
/**
 * Has the motion as it is now played. How it ends is returned by grobo_runner_wait() and reported
 * by events. At once.
 * @param options mode, rate, speed, repeat, direction, ..., copied; NULL: by keys, once, as it is.
 *   Where `default_time_us` is 0 it is that of the robot's configuration.
 * @return GROBO_OK, GROBO_ERR_CLOSED, GROBO_ERR_EMPTY (no posture), GROBO_ERR_NOMEM, or as
 *   grobo_motion_clip() and grobo_robot_play(): GROBO_ERR_STATE where a motion is played or a move
 *   under way (grobo_runner_wait() before), GROBO_ERR_UNWATCHED.
 */
GROBO_API int grobo_runner_play_motion(grobo_runner *runner, const grobo_play_options *options);

/* ---- safety --------------------------------------------------------------------------------- */

/**
 * Emergency stop, ahead of everything: see grobo_session_post_estop() and grobo_robot_estop(). Safe
 * in a signal handler: it takes no lock, no memory and no descriptor, keeps errno, and never waits.
 * The stop is latched from its return on, and the next frame on the wire once the loop turns, or
 * once the line is there. What was asked for before and has not begun is canceled. Where no thread
 * runs the loop, the next call that does carries the stop out before anything else, so
 * grobo_runner_wait() belongs behind it there; with and without a thread that waits until the stop
 * is verified.
 * @return GROBO_OK, GROBO_ERR_ARG (NULL).
 */
GROBO_API int grobo_runner_estop(grobo_runner *runner);
/**
 * Whether a stop is latched: see grobo_session_is_latched(). True from the return of
 * grobo_runner_estop() on, before the loop has turned. Safe in a signal handler.
 */
GROBO_API bool grobo_runner_is_latched(const grobo_runner *runner);
/** Clears a latched stop, and the mark of an emergency stop (estop.h): see grobo_robot_reset() and
 *  session.h. Handed over. @return GROBO_OK, GROBO_ERR_STATE (the stop is still being carried out,
 *  or another one came after the call), GROBO_ERR_PERM, GROBO_ERR_IO. */
GROBO_API int grobo_runner_reset(grobo_runner *runner);
/**
 * Carries out an exit policy now. Waits. The request is never dropped: where its end cannot be
 * awaited, it is carried out as grobo_runner_post_exit() says.
 * @return GROBO_OK, or as grobo_robot_exit(); GROBO_ERR_TIMEOUT, GROBO_ERR_FULL, and in a callback
 *   GROBO_ERR_STATE: its end was not awaited.
 */
GROBO_API int grobo_runner_exit(grobo_runner *runner, grobo_exit_policy policy, int64_t timeout_us);
/** The exit alone, without waiting: see grobo_session_post_exit(). Safe in a signal handler.
 *  @return GROBO_OK, GROBO_ERR_ARG. */
GROBO_API int grobo_runner_post_exit(grobo_runner *runner, grobo_exit_policy policy);
/** Stops what moves, as grobo_robot_stop(), without waiting: see grobo_session_post_stop().
 *  Safe in a signal handler. @return GROBO_OK, GROBO_ERR_ARG. */
GROBO_API int grobo_runner_post_stop(grobo_runner *runner, bool at_once);

GROBO_END_DECLS

#endif
