/* SPDX-License-Identifier: MIT */
/**
 * @file robot.h
 * @brief The robot engine: bytes and the time go in, bytes and the next deadline come out.
 *
 * The engine has no descriptor, clock, thread or allocation. The owner of the line pumps it, when
 * bytes came, a request was made or the deadline is reached, always in this order:
 * @code
 *   grobo_robot_rx(&robot, bytes, n, now);                // what has arrived, first
 *   grobo_robot_step(&robot, now);                        // timeouts, frames that are due
 *   n = grobo_robot_tx(&robot, buf, sizeof buf, now);     // > 0: write buf, all of it
 *   wake_up_at(grobo_robot_deadline(&robot, now));        // <= now: again at once
 * @endcode
 * session.h does that on an event_base, a test in virtual time. Requests and questions take no
 * time: theirs is the pump's, or that of the clock that grobo_robot_set_host() brings.
 *
 * The engine is asked by requests, and reports by one callback, grobo_event. Requests
 * return at once. Most are jobs: each has a number > 0, and each ends with exactly one
 * GROBO_EVENT_JOB of that number. Jobs run side by side where they do not disturb each other:
 * - Moves of different joints run together. A new move of a joint takes it from the move before,
 *   which continues with its other joints and ends with GROBO_ERR_SUPERSEDED.
 * - Readings run beside everything but what has the robot for itself: the check, the preparation
 *   of a play, flash and restart, a stored motion, the exit, the emergency stop.
 * - Moves, readings and torque on that cannot begin yet wait in their order (GROBO_ROBOT_QUEUE of
 *   them, then GROBO_ERR_FULL) for GROBO_ROBOT_QUEUE_US at most (GROBO_ERR_STALE). A stop, a trip,
 *   a motion that fails, a lost line and free mode end what waits. Where a pump that is held up
 *   has 20 ends and other events to report, they are refused with GROBO_ERR_FULL too. Torque on
 *   waits for other torque and for a place alone.
 * - A robot may be asked joint by joint. A request joins a job that was asked for just before,
 *   where it is as if both had been asked for at once, and returns the number of that one: a
 *   reading of the same kind, torque on, off or brake, and a move of one joint that takes the same
 *   time; where no place is free, one of another time as well. The job ends once, for all of its
 *   joints. grobo_event_job.failed has those for which it failed: of a move that is joined, too,
 *   the others are done.
 * - Torque off and brake, stop, exit and the emergency stop take the place of what is in their way.
 * - All others are refused with GROBO_ERR_STATE while their joints are busy.
 * Playing is not a job: grobo_robot_play() prepares as a job, then the sequencer runs beside the
 * jobs until GROBO_EVENT_PLAY reports its end. A motion that fails stops what moves beside it, as
 * grobo_robot_stop() does.
 *
 * Safety, on every path, judged as the bytes leave, by grobo_robot_tx():
 * - Every target is finite and within the joint's limits (refused, or clamped if so configured).
 * - No joint is asked to move faster than its limit: times are stretched, and counted.
 * - Nothing moves a joint whose posture was not sensed; the first move from there is slow, and so
 *   is the first after torque came on: a hand may have moved the joint.
 * - Before torque comes on, the goal is set to the present angle, and torque is read back after.
 * - Heat, current, low voltage, lost replies, torque lost in motion: stop, latched until
 *   grobo_robot_reset().
 * - While anything moves, each joint is read at least every GROBO_WATCH_US: a rate of frames that
 *   leaves no time for that is refused, and a reading that has waited too long goes first.
 * - A stalled host skips what is late; after a long stall the motion ends (GROBO_TRIP_HOST_STALL).
 * - grobo_robot_estop() is ahead of everything, read back joint by joint, latched.
 *
 * One thread at a time per robot, unless its host brings a lock: then requests and questions come
 * from any thread (runner.h). Requests may be made from the callback.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_ROBOT_H
#define GROBO_ROBOT_H

#include <grobo/robot_config.h>
#include <grobo/robot_event.h>

GROBO_BEGIN_DECLS

/* ---- the engine ------------------------------------------------------------------------------ */

/** Jobs that run side by side, the last of them one that takes torque away. */
#define GROBO_ROBOT_JOBS 4
/** Moves and readings that wait for others to end. */
#define GROBO_ROBOT_QUEUE 4
/** How long they wait at most. */
#define GROBO_ROBOT_QUEUE_US 2000000

/** A robot engine. static.h completes it, for programs that keep it themselves. */
typedef struct grobo_robot grobo_robot;

/** Sets the callback of events; on_event may be NULL. */
GROBO_API void grobo_robot_on_event(grobo_robot *robot, grobo_event_fn on_event, void *ctx);

/* ---- requests --------------------------------------------------------------------------------
 * All return a job number > 0 or an error: GROBO_ERR_CLOSED (link down), GROBO_ERR_STATE (not
 * beside what runs, see above), GROBO_ERR_LATCHED (tripped, for what would move or switch torque
 * on), GROBO_ERR_UNSUPPORTED (not in the driver), and the errors of each. */

/** Reads joints; those that stay silent are in `failed`, the others are delivered. */
GROBO_API int grobo_robot_sense(grobo_robot *robot, grobo_joint_mask joints, grobo_sense_kind kind);

/**
 * Switches torque and reads it back. ON: senses first, sets goal := present, then switches; a
 * joint that cannot be sensed stays as it is and is in `failed`.
 */
GROBO_API int grobo_robot_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode);

/**
 * Moves the joints that `target` sets, in target->time_us (0 or less: the default time; more than
 * grobo_driver.time_max_us: that) or as much longer as is safe, then reads them. Ends when they are
 * there. Errors at once: GROBO_ERR_LIMIT, GROBO_ERR_NAN (see
 * grobo_robot_fault()), GROBO_ERR_ARG; later GROBO_ERR_SPEED: the wire has no time that is long
 * enough; also GROBO_ERR_STATE for a joint that the motion being played sets, and, of an arm,
 * GROBO_ERR_UNWATCHED: the line is too slow to tell all these joints their trajectories in time and
 * to read them (grobo_budget.pace_us); at once where the time asked for is longer than
 * GROBO_SEGMENT_US.
 */
GROBO_API int grobo_robot_move(grobo_robot *robot, const grobo_posture *target);

/**
 * Sends a target once: no job, no event, nothing read before or after. For a control
 * loop of the caller's own, which calls it once a period; a target that still waits for the line
 * is replaced. The first ones go there at the approach speed. Joints must have been sensed and
 * hold (a sense and a torque job, once). The target is checked and timed as any other.
 * @return 0, or an error: GROBO_ERR_STATE while something else moves the robot (such as a move
 *         from before the line was there), a joint has no torque or is in free mode,
 *         GROBO_ERR_STALE for a joint not sensed, and those of grobo_robot_move().
 */
GROBO_API int grobo_robot_send(grobo_robot *robot, const grobo_posture *target);

/**
 * Reads (data NULL) or writes registers of a servo. Goal and torque registers are refused, and id,
 * direction and limits where the servo would jump: GROBO_ERR_STATE for a joint that holds,
 * GROBO_ERR_STALE for one not sensed.
 */
GROBO_API int grobo_robot_registers(grobo_robot *robot, const grobo_register_io *io);

/**
 * What servos do when a program ends: stops a motion, carries the policy out and reads it back:
 * with GROBO_EXIT_HOLD until each joint with torque was read to stand (docs/guide/safety.md,
 * Standing). All is sent within exit_bound_us; where that is too short to read it back, the result
 * is GROBO_ERR_TIMEOUT. Takes the place of a job that runs (that one ends with
 * GROBO_ERR_CANCELED); where an exit of the same policy runs it returns the number of that one.
 * Works when tripped; then GROBO_EXIT_SIT is carried out as GROBO_EXIT_HOLD. With GROBO_EXIT_SIT
 * torque goes off only once the robot has sat down: who would need longer than exit_bound_us is not
 * sent down, and who is held up on the way is halted; both hold, with GROBO_ERR_TIMEOUT.
 * @param policy GROBO_EXIT_DEFAULT: the configuration's.
 */
GROBO_API int grobo_robot_exit(grobo_robot *robot, grobo_exit_policy policy);

/**
 * Emergency stop: drops everything that waits, sends torque off or brake ahead of all else, reads
 * every joint back and repeats what did not take, for at most 10 s. Where the driver has no
 * `torque`, or that fails, all joints are halted and hold instead. Latched until
 * grobo_robot_reset(). Never refused but for GROBO_ERR_CLOSED, where it is latched all the same,
 * and carried out as soon as the line is there: so is one that the line was lost under. Asked for
 * again while it is carried out, it returns the number of that job; its trip is reported once until
 * the reset. So a callback may answer each trip, or each job that fails, with it.
 */
GROBO_API int grobo_robot_estop(grobo_robot *robot);

/**
 * Clears a latched stop. Nothing moves; the next move or play senses first.
 * @return 0, or GROBO_ERR_STATE while the emergency stop is still being carried out.
 */
GROBO_API int grobo_robot_reset(grobo_robot *robot);

/**
 * Ends the jobs that run and wait with GROBO_ERR_CANCELED; moves stop where they are. An emergency
 * stop cannot be canceled. @return 0, or GROBO_ERR_STATE.
 */
GROBO_API int grobo_robot_cancel(grobo_robot *robot);

/* ---- playing --------------------------------------------------------------------------------- */

/**
 * Plays a clip: senses, switches torque on (unless manual_torque), goes softly to its first
 * posture, plays. The job GROBO_JOB_PLAY ends when the servos are known to be on their way there,
 * or could not be brought on it.
 * @param clip copied; what its ctx points to must live until GROBO_EVENT_PLAY reports the end.
 * @param options copied; NULL for all defaults. approach_deg_s 0 is the configuration's, rate_hz 0
 *        that of grobo_robot_budget(). A rate above watched_hz is refused with
 *        GROBO_ERR_UNWATCHED unless `unwatched`; then GROBO_EVENT_UNWATCHED comes when it begins.
 */
GROBO_API int grobo_robot_play(grobo_robot *robot, const grobo_clip *clip,
                               const grobo_play_options *options);

/**
 * Puts a clip behind the one being played; see grobo_sequencer_enqueue().
 * @return clips that wait, its errors, GROBO_ERR_UNWATCHED, or GROBO_ERR_STATE where the clip moves
 *         a joint that was not read or has no torque: name such joints in grobo_play_options.also
 *         of the first one.
 */
GROBO_API int grobo_robot_enqueue(grobo_robot *robot, const grobo_clip *clip,
                                  const grobo_play_options *options);

/** @name While playing: return 0, or GROBO_ERR_STATE if there is nothing to do that to. */
/**@{*/
/** Stops smoothly on the way, and holds. */
GROBO_API int grobo_robot_pause(grobo_robot *robot);
/** Continues a paused motion. */
GROBO_API int grobo_robot_resume(grobo_robot *robot);
/** Ends the motion: smoothly, or at the present posture at once. Also a move, what was only sent,
 *  and a raw frame that moves: their jobs end with GROBO_ERR_CANCELED. Returns at once; the joints
 *  that it stops are read back then, and GROBO_EVENT_HALTED says how that ended. */
GROBO_API int grobo_robot_stop(grobo_robot *robot, bool at_once);
/** Continues at another time of the clip, softly. @param clip_us from its beginning */
GROBO_API int grobo_robot_seek(grobo_robot *robot, int64_t clip_us);
/** Plays faster or slower from here on. @param speed_pct 1..1000 */
GROBO_API int grobo_robot_speed(grobo_robot *robot, int speed_pct);
/**@}*/

/* ---- free (teaching) mode ----------------------------------------------------------------------
 * A person moves the joints: after each reading a joint whose current is above its
 * grobo_joint.free_current_ma is braked, or one that turns at 8 deg/s and more while it holds and
 * is more than 2 degrees from its goal; one slower than 8 deg/s for 0.1 s holds again (protocol 5,
 * but for the second; there it is one reading, which for 20 joints is 0.15 s). Free joints are read
 * as often as the line allows, the others in sense_interval_us (a second where that is
 * GROBO_SENSE_NEVER), but not twice before a free one: their heat and voltage are watched. */

/**
 * Puts joints into free mode, or back: off is a job that makes them hold where they are.
 * @return 0 for on, a job number for off, or an error as for requests.
 */
GROBO_API int grobo_robot_free(grobo_robot *robot, grobo_joint_mask joints, bool on);

/* ---- queries ------------------------------------------------------------------------------- */

/** What is known of a joint. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_robot_joint(const grobo_robot *robot, int joint, grobo_joint_info *info);

/**
 * The posture sensed last; joints whose angle is older than max_age_us are not set.
 * @param max_age_us GROBO_NEVER_US: any age.
 * @return number of joints set.
 */
GROBO_API int grobo_robot_posture(const grobo_robot *robot, int64_t max_age_us,
                                  grobo_posture *posture);

/** The posture asked for last; joints never asked for are not set. @return joints set. */
GROBO_API int grobo_robot_target(const grobo_robot *robot, grobo_posture *posture);

/** True from the request that starts a motion until its last posture's time is over; of what was
 *  stopped, also until GROBO_EVENT_HALTED. */
GROBO_API bool grobo_robot_moving(const grobo_robot *robot);

/** Kind of a job that runs, the oldest in general; GROBO_JOB_NONE for none. */
GROBO_API grobo_job_kind grobo_robot_job(const grobo_robot *robot);

/** True while the job of this number runs or waits, or its end has not been reported. */
GROBO_API bool grobo_robot_is_pending(const grobo_robot *robot, int number);

/** The latched stop, or trip GROBO_TRIP_NONE. */
GROBO_API void grobo_robot_tripped(const grobo_robot *robot, grobo_trip_info *info);

/**
 * Joint and value that made the last request fail with LIMIT or NAN; with SPEED the joint;
 * with STATE the joint that moves though this program sent it nowhere. @return joint or -1.
 */
GROBO_API int grobo_robot_fault(const grobo_robot *robot, double *value_deg);

/**
 * Says why a request, its job or a motion failed, for people: grobo_error_text(), and behind it for
 * LIMIT the joint, what was asked for and what it can, in the unit in which people give that joint
 * (core/unit.h; deg/s of a wheel): "outside the joint's limits: motor 12 (elbow), 95.0 deg is not
 * within -90.0 to 90.0 deg"; for NAN and SPEED the joint, for STALE one that was not read, for
 * STATE one that another program moves; for LATCHED what was measured, and where.
 * @param result of a request, of grobo_runner_wait_job() or the like, asked about before the next
 *   request: joint and value are those of grobo_robot_fault().
 * @param[out] text cut where it does not fit.
 * @return bytes of it without the NUL, GROBO_ERR_ARG (NULL, no room).
 */
GROBO_API int grobo_robot_error_text(const grobo_robot *robot, int result, char *text, size_t room);

/** True while a motion is under way: approached, played, paused or being stopped. */
GROBO_API bool grobo_robot_is_playing(const grobo_robot *robot);

/** Where the motion is. */
GROBO_API void grobo_robot_progress(const grobo_robot *robot, grobo_play_progress *progress);

/** The driver, and through it the model. */
GROBO_API const grobo_driver *grobo_robot_driver(const grobo_robot *robot);

GROBO_END_DECLS

#endif
