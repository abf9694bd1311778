/* SPDX-License-Identifier: MIT */
/**
 * @file core/robot.h
 * @brief The rest of the robot engine: for protocols, tools and firmware.
 *
 * grobo/robot.h has the requests and questions of a program, and the rules that all of these keep.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_ROBOT_H
#define GROBO_CORE_ROBOT_H

#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/* ---- the engine ----------------------------------------------------------------------------- */

/**
 * Changes the configuration (copied; NULL: all defaults); what is under way continues under the new
 * one, and the line's physics stay as they are.
 * @return 0 or GROBO_ERR_ARG, then nothing changed.
 */
GROBO_API int grobo_robot_configure(grobo_robot *robot, const grobo_robot_config *config);

/* ---- requests ------------------------------------------------------------------------------- */

/** Asks whether the robot is there. Result GROBO_ERR_TIMEOUT if nothing answers. */
GROBO_API int grobo_robot_check(grobo_robot *robot);

/**
 * Gives the move under way another target, which leaves next: the job ends when the joints are at
 * the target given last. For targets that come one after the other, each before the one before is
 * reached. What this target sets must include what the one before set (of several moves the first
 * of which that is true), but of moves of single joints that share a job: there the other joints
 * go on to their own targets. Joints that it sets besides must have been sensed and hold, as for
 * grobo_robot_send(); a move that has them loses them.
 * @return the number of that job, or an error, and then the move is as it was: GROBO_ERR_STATE
 *         where no move is under way, or none that may be redirected yet: its first target waits to
 *         leave, or is the slow first one and was not read back; or where a motion or another job
 *         has one of the joints besides. Others as grobo_robot_move().
 */
GROBO_API int grobo_robot_retarget(grobo_robot *robot, const grobo_posture *target);

/**
 * Sends a frame of the caller's as it is and waits for the reply it calls for, if any. The driver
 * reads its meaning first and it is checked as any other target, now and again when it leaves: by
 * then the job may end with GROBO_ERR_SPEED, _STALE, _STATE or _LATCHED, and nothing was sent. One
 * that was not answered is not tried again where another frame has told its joints something since
 * (GROBO_ERR_SUPERSEDED). A stop ends it with GROBO_ERR_CANCELED, if it moves. A joint in free mode
 * is refused (GROBO_ERR_STATE). Torque comes on only for a joint that holds already:
 * GROBO_ERR_STATE where it does not, GROBO_ERR_STALE where that was read more than 2 s ago. What
 * the driver cannot read is refused with GROBO_ERR_UNSUPPORTED unless accept_unknown_raw: other
 * motors than the model's, ids, directions, limits, flash and restarts, motions of the board's own.
 * After one that was accepted all joints must be read anew.
 */
GROBO_API int grobo_robot_raw(grobo_robot *robot, const uint8_t *frame, size_t size);

/**
 * The same with a deadline, until_us: no attempt leaves after that; the job ends with
 * GROBO_ERR_STALE then.
 */
GROBO_API int grobo_robot_raw_until(grobo_robot *robot, const uint8_t *frame, size_t size,
                                    int64_t until_us);

/**
 * Flash, reboot or factory reset of one servo, with the silence it needs afterwards: nothing is
 * read in the background, and GROBO_ERR_STATE while anything moves.
 */
GROBO_API int grobo_robot_command(grobo_robot *robot, int id, grobo_servo_command command);

/** Starts a motion kept in the robot. Its targets are the robot's own: nothing checks them. Ends
 *  free mode; GROBO_ERR_STATE while anything moves. */
GROBO_API int grobo_robot_stored(grobo_robot *robot, grobo_stored_kind kind, int number);

/**
 * Latches as grobo_robot_estop() does, and sends nothing but the halts that wait for the line, as
 * behind grobo_robot_stop(): for a robot that another program has stopped.
 * @return 0, or GROBO_ERR_STATE while a move or a motion runs.
 */
GROBO_API int grobo_robot_latch(grobo_robot *robot);

/* ---- playing -------------------------------------------------------------------------------- */

/**
 * Sets when a motion with GROBO_START_LATER (sequencer.h) begins, which has approached and waits
 * (grobo_play_progress.ready), on the clock of grobo_play_options.start_us.
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_STATE (it is not ready), GROBO_ERR_LATCHED, or
 *         GROBO_ERR_STALE: that time is over, and it keeps waiting.
 */
GROBO_API int grobo_robot_start_at(grobo_robot *robot, int64_t start_us);

/* ---- queries -------------------------------------------------------------------------------- */

/**
 * True from a motion's end until its last posture has been read back, and repeated where it was
 * lost. Any request ends that: wait for it where the robot has to be where it was sent.
 */
GROBO_API bool grobo_robot_settling(const grobo_robot *robot);

/** The engine's counters. Borrowed, lives with the robot; for the thread that pumps it. */
GROBO_API const grobo_robot_counters *grobo_robot_get_counters(const grobo_robot *robot);

/** The wire's counters. Borrowed, lives with the robot; for the thread that pumps it. */
GROBO_API const grobo_bus_stats *grobo_robot_get_bus_stats(const grobo_robot *robot);

/** State of the sequencer. */
GROBO_API grobo_sequencer_state grobo_robot_play_state(const grobo_robot *robot);

/** True when no frame waits for the line and no reply is awaited. */
GROBO_API bool grobo_robot_is_quiet(const grobo_robot *robot);

/** The budget of its line. @return 0, or an error of the driver. */
GROBO_API int grobo_robot_budget(const grobo_robot *robot, grobo_budget *budget);

/** Lateness of motion frames since the last play began. */
GROBO_API void grobo_robot_jitter(const grobo_robot *robot, grobo_jitter *jitter);

GROBO_END_DECLS

#endif
