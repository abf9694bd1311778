/* SPDX-License-Identifier: MIT */
/**
 * @file core/runner.h
 * @brief The rest of a runner: what it keeps for a program, and single steps.
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

/* ---- exclusion ------------------------------------------------------------------------------ */

/** The serial port; as grobo_runner_session(). */
GROBO_API grobo_serial *grobo_runner_serial(grobo_runner *runner);

/* ---- facts and settings: at once unless stated otherwise ------------------------------------ */

/** Sets the folder of motion files (copied). @return GROBO_OK, _ARG, GROBO_ERR_CAP (too long). */
GROBO_API int grobo_runner_set_motion_dir(grobo_runner *runner, const char *dir);
/** Copies the folder's name. @return its length, GROBO_ERR_SPACE. */
GROBO_API int grobo_runner_get_motion_dir(grobo_runner *runner, char *dir, size_t dir_bytes);

/**
 * Sets the time of postures whose own is 0: 10 ms..GROBO_PLAY_TIME_MAX_US. Handed over.
 * @return GROBO_OK, GROBO_ERR_ARG.
 */
GROBO_API int grobo_runner_set_default_time_us(grobo_runner *runner, int64_t time_us);
/** Reads it; as long as none was set: the configuration's, else GROBO_POSTURE_TIME_US. */
GROBO_API int64_t grobo_runner_get_default_time_us(grobo_runner *runner);

/**
 * Sets how often the background reads each joint, > 0 or GROBO_SENSE_NEVER. Handed over.
 * @return GROBO_OK, GROBO_ERR_ARG.
 */
GROBO_API int grobo_runner_set_sense_interval_us(grobo_runner *runner, int64_t interval_us);
/** Reads it. */
GROBO_API int64_t grobo_runner_get_sense_interval_us(grobo_runner *runner);
/** Sets the period, 1000..1000000. At once. @return GROBO_OK, GROBO_ERR_ARG. */
GROBO_API int grobo_runner_set_period_us(grobo_runner *runner, int64_t period_us);
/** Reads it. */
GROBO_API int64_t grobo_runner_get_period_us(grobo_runner *runner);
/** Sets how often it is played: 0 and 1 once, n times, -n times in reverse. @return GROBO_OK. */
GROBO_API int grobo_runner_set_motion_count(grobo_runner *runner, int count);
/** Has the motion played from its end to its beginning. */
GROBO_API void grobo_runner_set_reverse(grobo_runner *runner, bool reverse);
/** True when it is played in reverse: so set, or by a negative count. */
GROBO_API bool grobo_runner_is_reverse(grobo_runner *runner);

/* ---- the line ------------------------------------------------------------------------------- */

/** Sets the device. Handed over. @return GROBO_OK, GROBO_ERR_STATE (open), _CAP, GROBO_ERR_ARG. */
GROBO_API int grobo_runner_set_device(grobo_runner *runner, const char *device);
/** Copies the name of the device in use. Handed over. @return its length, GROBO_ERR_SPACE. */
GROBO_API int grobo_runner_get_device(grobo_runner *runner, char *device, size_t device_bytes);
/** Opens the port; the loop then checks whether a robot answers. Handed over. @return as
 *  grobo_session_open(). */
GROBO_API int grobo_runner_open(grobo_runner *runner);
/** Asks whether the robot is there, by the driver's check. Waits. @return GROBO_OK or why not. */
GROBO_API int grobo_runner_check_connection(grobo_runner *runner, int64_t timeout_us);
/** The operating system's reason of the line's last failure. Handed over. @return GROBO_OK. */
GROBO_API int grobo_runner_get_cause(grobo_runner *runner, grobo_os_cause *cause);

/* ---- servos --------------------------------------------------------------------------------- */

/** Torque of a joint as last known. At once. @return a grobo_torque, GROBO_ERR_EMPTY (not
 *  known), GROBO_ERR_ARG. */
GROBO_API int grobo_runner_get_servo_state(grobo_runner *runner, int joint);
/** Torque of all joints: as grobo_runner_get_servo_state() for each. At once. @return
 *  number of joints, GROBO_ERR_SPACE. */
GROBO_API int grobo_runner_get_servo_states(grobo_runner *runner, int *states, size_t capacity);
/** Switches the torque of a joint, and reads it back. Waits. @return the state, or as
 *  grobo_robot_torque(). */
GROBO_API int grobo_runner_set_servo_state(grobo_runner *runner, int joint, grobo_torque state,
                                           int64_t timeout_us);
/** Switches the torque of several joints, and reads it back. Waits. @return GROBO_OK, or as
 *  grobo_robot_torque(). */
GROBO_API int grobo_runner_set_servo_states(grobo_runner *runner, grobo_joint_mask joints,
                                            grobo_torque state, int64_t timeout_us);

/* ---- postures ------------------------------------------------------------------------------- */

/** The posture sensed last; joints never sensed are not set. At once. @return joints set. */
GROBO_API int grobo_runner_get_current_posture(grobo_runner *runner, grobo_posture *posture);
/** Reads one joint. Waits. @return GROBO_OK, or an error and *angle_rad is as it was. */
GROBO_API int grobo_runner_read_angle(grobo_runner *runner, int joint, double *angle_rad,
                                      int64_t timeout_us);
/** Sets the initial posture (copied); before, each joint at 0 or at the limit nearest to it. At
 *  once. @return GROBO_OK, GROBO_ERR_LIMIT, GROBO_ERR_NAN, GROBO_ERR_ARG (other number of
 *  joints). */
GROBO_API int grobo_runner_set_init_posture(grobo_runner *runner, const grobo_posture *posture);
/** The initial posture. At once. */
GROBO_API void grobo_runner_get_init_posture(grobo_runner *runner, grobo_posture *posture);
/** Sets the target posture (copied); no joint is set before. At once. Errors as
 *  grobo_runner_set_init_posture(). */
GROBO_API int grobo_runner_set_target_posture(grobo_runner *runner, const grobo_posture *posture);
/** The target posture. At once. */
GROBO_API void grobo_runner_get_target_posture(grobo_runner *runner, grobo_posture *posture);
/** Sets one joint of the target posture. At once. Errors as grobo_runner_set_init_posture(). */
GROBO_API int grobo_runner_set_joint(grobo_runner *runner, int joint, double angle_rad);
/** Sets the time to reach the target posture; 0: the default time. At once. @return GROBO_OK,
 *  GROBO_ERR_ARG (negative, above GROBO_PLAY_TIME_MAX_US). */
GROBO_API int grobo_runner_set_motion_time_us(grobo_runner *runner, int64_t time_us);

/**
 * Has the robot move to the target posture: grobo_robot_retarget() of the move under way, so that a
 * program may set targets at its own rate, or where that has other joints grobo_robot_move(), which
 * waits behind what it cannot run beside. grobo_runner_wait() returns how it ends, and so does the
 * job event. At once.
 * @return GROBO_OK, GROBO_ERR_CLOSED, GROBO_ERR_EMPTY (no joint is set), or as grobo_robot_move():
 *   GROBO_ERR_STATE where a motion is played that sets these joints, GROBO_ERR_LATCHED.
 */
GROBO_API int grobo_runner_start_motion(grobo_runner *runner);
/** Postures still to be reached: 1 for a target, and those of the motion in this pass and the
 *  repetitions after it (at a rate: its frames). At once. @return the number, INT_MAX for more than
 *  that. */
GROBO_API int grobo_runner_command_count(grobo_runner *runner);
/** Whether postures are still to be sent or under way. At once. @return 1 or 0. */
GROBO_API int grobo_runner_is_moving(grobo_runner *runner);

/* ---- the current motion --------------------------------------------------------------------- */

/** A copy of the motion. At once. @param[out] motion owned by the caller. @return postures,
 *  GROBO_ERR_NOMEM. */
GROBO_API int grobo_runner_get_motion(grobo_runner *runner, grobo_motion **motion);
/** Makes it an empty motion of postures. What is being played continues. At once. */
GROBO_API void grobo_runner_clear_motion(grobo_runner *runner);
/** Whether a motion is played or about to be. At once. */
GROBO_API bool grobo_runner_is_playing(grobo_runner *runner);

/* ---- raw commands --------------------------------------------------------------------------- */

/** Copies a packet into the command buffer. At once. @return size, GROBO_ERR_CAP (more than
 *  GROBO_RUNNER_COMMAND_BYTES; the buffer is as it was). */
GROBO_API int grobo_runner_set_command(grobo_runner *runner, const void *packet, size_t size);
/** Copies the command buffer. At once. @return its size, GROBO_ERR_SPACE. */
GROBO_API int grobo_runner_get_command(grobo_runner *runner, void *packet, size_t capacity);

/**
 * Sends a packet as grobo_robot_raw() does, with all its checks, and waits for the reply it calls
 * for; what comes can be taken by grobo_runner_receive(). Connects first where closed. Waits: a
 * packet that still waits for the line after timeout_us is cancelled.
 * @param packet NULL: what is in the command buffer.
 * @return size, GROBO_ERR_EMPTY (nothing to send), GROBO_ERR_CAP, as grobo_runner_connect() and
 *   as grobo_robot_raw().
 */
GROBO_API int grobo_runner_send_command(grobo_runner *runner, const void *packet, size_t size,
                                        int64_t timeout_us);

/**
 * Takes exactly `size` of the bytes that came in reply to sent commands, as they were on the wire.
 * Waits for them GROBO_SILENCE_DEFAULT_MS in all; where fewer are there by then, they are dropped.
 * @return size, GROBO_ERR_TIMEOUT (nothing came), GROBO_ERR_SHORT (fewer came), GROBO_ERR_CAP
 *   (more than GROBO_RUNNER_RECEIVE_BYTES).
 */
GROBO_API int grobo_runner_receive(grobo_runner *runner, void *bytes, size_t size);

GROBO_END_DECLS

#endif
