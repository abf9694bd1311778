/* SPDX-License-Identifier: MIT */
/**
 * @file core/runner.h
 * @brief The rest of a runner: its thread and its line, step by step.
 *
 * grobo/runner.h has the runner, and says of what kind (at once, handed over, waits) a call is.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_RUNNER_H
#define GROBO_CORE_RUNNER_H

#include <grobo/runner.h>

GROBO_BEGIN_DECLS

/* ---- the runner's thread -------------------------------------------------------------------- */

/** True from a start of the thread until it is asked to stop. At once. */
GROBO_API bool grobo_runner_is_active(grobo_runner *runner);

/**
 * The handle of the runner's thread, to compare or to set its priority; it must not be joined. At
 * once. @return GROBO_OK, GROBO_ERR_STATE (no thread, or one of the caller's that runs
 * grobo_runner_run()).
 */
GROBO_API int grobo_runner_thread(grobo_runner *runner, grobo_thread *thread);

/**
 * One round of the loop: waits for the next event, at most until the period is
 * over, and does what is due. What the runner's thread does all the time; for a program that has
 * a loop of its own. Any thread; when another one runs the loop, waits for a period instead.
 * @return 1, or 0 when another thread ran the loop; GROBO_ERR_STATE in a callback.
 */
GROBO_API int grobo_runner_svc(grobo_runner *runner);

/* ---- the line ------------------------------------------------------------------------------- */

/** Sets the device. Handed over. @return GROBO_OK, GROBO_ERR_STATE (open), _CAP, GROBO_ERR_ARG. */
GROBO_API int grobo_runner_set_device(grobo_runner *runner, const char *device);
/** Copies the name of the device in use. Handed over. @return its length, GROBO_ERR_SPACE. */
GROBO_API int grobo_runner_get_device(grobo_runner *runner, char *device, size_t device_bytes);
/** Opens the port; the loop then checks whether a robot answers. Handed over. @return as
 *  grobo_session_open(). */
GROBO_API int grobo_runner_open(grobo_runner *runner);
/** The operating system's reason of the line's last failure. Handed over. @return GROBO_OK. */
GROBO_API int grobo_runner_get_cause(grobo_runner *runner, grobo_os_cause *cause);

/* ---- readings ------------------------------------------------------------------------------- */

/** Reads one joint. Waits. @return GROBO_OK, or an error and *angle_rad is as it was. */
GROBO_API int grobo_runner_read_angle(grobo_runner *runner, int joint, double *angle_rad,
                                      int64_t timeout_us);

/* ---- requests of several threads ------------------------------------------------------------ */

/**
 * Makes a request of the robot behind those of other threads, and waits for its end. A request of
 * robot.h that is made beside another one may be refused (GROBO_ERR_STATE, GROBO_ERR_FULL); this
 * one is made again when that has ended, in the order of the calls. Waits.
 * @param fn makes the request, of grobo_runner_robot(), and returns its job number or its error;
 *   other results end the call with that result. Called on the loop, as often as it is refused
 *   beside what runs; it must not wait.
 * @return the job's result, or the error of the request; GROBO_ERR_TIMEOUT: it has not ended in the
 *   time given, and continues where it has begun.
 */
GROBO_API int grobo_runner_request(grobo_runner *runner, grobo_runner_fn fn, void *arg,
                                   int64_t timeout_us);

/** Switches torque as grobo_robot_torque() does, by grobo_runner_request(). Waits.
 *  @return GROBO_OK, or as these. */
GROBO_API int grobo_runner_torque(grobo_runner *runner, grobo_joint_mask joints,
                                  grobo_torque torque, int64_t timeout_us);

GROBO_END_DECLS

#endif
