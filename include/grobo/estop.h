/* SPDX-License-Identifier: MIT */
/**
 * @file estop.h
 * @brief Emergency stops across programs: a mark that every session of the user obeys.
 *
 * A mark stands for a device, under every name that the device has. While it stands, no session
 * (session.h, runner.h) of this user moves that robot or switches its torque on: requests return
 * GROBO_ERR_LATCHED. A session that is open carries out an emergency stop within
 * GROBO_ESTOP_WATCH_US of the mark, or before the next frame leaves where its program was held up
 * for longer. A session that opens the device of a stop that has not reached the robot carries the
 * stop out before anything else; where it has, the session is latched and sends nothing for it.
 * grobo_robot_reset() and grobo_estop_clear() clear a mark.
 *
 * Marks are files in directories that the user owns and no other user may enter: "grobo" in
 * $XDG_RUNTIME_DIR, and "grobo-UID" in /tmp (Windows: in the local AppData). Directories or files
 * of other users, symbolic links, and directories open to others are not trusted. Marks last until
 * they are cleared or these directories are, as a rule when the machine is started again. The
 * programs of another user have other directories. Root's mark is set there too, with the rights of
 * that user, where a program of his has the device (a serial port; Linux): root's emergency stop
 * reaches everybody. A mark of anybody else does not reach the programs of another user.
 *
 * The simulator in the same process (GROBO_DEVICE_SIM) has no marks. All functions are thread safe;
 * they read and write small files, and do not wait for any program.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_ESTOP_H
#define GROBO_ESTOP_H

#include <grobo/core/port.h>

GROBO_BEGIN_DECLS

/** How soon a session whose loop turns notices a mark: at once where the system tells of it (Linux,
 * directories on a local file system), else it looks as often as this. */
#define GROBO_ESTOP_WATCH_US 50000

/** A mark that was set, to ask for its confirmation. Plain data. */
typedef struct grobo_estop {
    char id[32];     /**< of this mark, NUL-terminated */
    unsigned places; /**< private: the directories that have it */
} grobo_estop;

/** What the program that has the device did about a mark. */
typedef enum grobo_estop_answer {
    GROBO_ESTOP_NOBODY = 0, /**< no session of this user (root: of any) has the device */
    GROBO_ESTOP_SILENT,     /**< a session has it, and has not answered */
    GROBO_ESTOP_HEARD,      /**< latched: nothing else leaves. Not verified, or no line */
    GROBO_ESTOP_DONE,       /**< every joint was read back and is stopped */
    GROBO_ESTOP_FAILED      /**< sent, but not every joint is known to be stopped: see result */
} grobo_estop_answer;

/** The program that has a device, and its answer. */
typedef struct grobo_estop_holder {
    grobo_estop_answer answer;
    int pid;      /**< of the process, 0: none is registered */
    bool stopped; /**< it was stopped (SIGSTOP, Ctrl-Z) when it was asked */
    bool resumed; /**< and continues now */
    int result;   /**< GROBO_ESTOP_FAILED: why */
} grobo_estop_holder;

/**
 * Marks a device, whether it is there or not. A mark that stands is replaced, and the stop is
 * carried out again.
 * @param device as in grobo_session_config, but not GROBO_DEVICE_AUTO.
 * @param[out] stop for grobo_estop_ask(), or NULL. Valid also after an error.
 * @param[out] cause why the system refused, or NULL.
 * @return GROBO_OK; GROBO_ERR_ARG (no device, malformed name); GROBO_ERR_PERM (no directory can be
 *   trusted or written), GROBO_ERR_NOMEM, GROBO_ERR_IO: not every name of the device is marked.
 */
GROBO_API int grobo_estop_set(const char *device, grobo_estop *stop, grobo_os_cause *cause);

/**
 * Clears the marks of a device. Nothing moves by itself: a session that has obeyed the mark stays
 * latched until its own grobo_robot_reset().
 * @param[out] cause why the system refused, or NULL.
 * @return GROBO_OK, also where none stood; GROBO_ERR_ARG; GROBO_ERR_PERM or GROBO_ERR_IO: one
 *   still stands.
 */
GROBO_API int grobo_estop_clear(const char *device, grobo_os_cause *cause);

/** True while a mark stands for a device. */
GROBO_API bool grobo_estop_stands(const char *device);

/** How a program that does not obey a mark is kept from moving the robot. */
typedef enum grobo_estop_means {
    GROBO_ESTOP_BY_GUARD =
        0,                 /**< its guard (guard.h) takes the line, stops every joint and releases
                               *   the port; the program sends nothing more */
    GROBO_ESTOP_BY_SIGTERM /**< the program gets SIGTERM */
} grobo_estop_means;

/**
 * Turns to the programs that have a serial port and do not obey: they cannot read a mark, hang, or
 * are not of this library. Only to a process that the system shows to have this device open, with
 * its lock if one has that, and that is not stopped (SIGSTOP): no number in a file counts. What
 * becomes of it is seen when the port can be opened. Linux 5.3 or later.
 * @return how many processes were reached, 0: none has the device; GROBO_ERR_ARG; GROBO_ERR_PERM:
 *   it is another user's; GROBO_ERR_STATE: it is stopped; GROBO_ERR_NOENT: it has just released the
 *   device; GROBO_ERR_UNSUPPORTED; GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_estop_force(const char *device, grobo_estop_means means);

/**
 * Asks what the program that has a device did about a mark. A program is known by its number and
 * start time, which its session registers. One that is stopped is resumed, if it can read the mark:
 * it does so before it sends anything. Call again until the answer is final, or until time is up.
 * @param stop of grobo_estop_set(); NULL only finds the process that has the device.
 * @param[out] holder the answer.
 * @return GROBO_OK, GROBO_ERR_ARG.
 */
GROBO_API int grobo_estop_ask(const char *device, const grobo_estop *stop,
                              grobo_estop_holder *holder);

GROBO_END_DECLS

#endif
