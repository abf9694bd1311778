/* SPDX-License-Identifier: MIT */
/**
 * @file gr001.h
 * @brief HPI's GR001 as programs for the GROBO library know it: by motor number, in the wire's
 * units, in motor order; the table of its body for people; the record.
 *
 * The rest of this library counts joints from 0 and has radians. What is here takes motors 1..20,
 * 0.1 degree and 10 ms, and does the same things through the same engine, with the same checks:
 * what moves or switches is a job of robot.h. A session sends it at once; a program that pumps its
 * engine itself does so afterwards.
 * It works for every model; arrays in motor order are sorted by motor number.
 *
 * One thread at a time per engine.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_GR001_H
#define GROBO_CORE_GR001_H

#include <stdio.h>

#include <grobo/motion.h>
#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/** Groups of grobo_gr001_servo(): the numbers of GR001::setServo (protocol 5). */
typedef enum grobo_gr001_group {
    GROBO_GR001_ALL = 0,       /**< motors 1..20 */
    GROBO_GR001_BODY = 1,      /**< head and trunk: 1, 2 */
    GROBO_GR001_RIGHT_ARM = 2, /**< 3..5 */
    GROBO_GR001_LEFT_ARM = 3,  /**< 6..8 */
    GROBO_GR001_ARMS = 4,      /**< 3..8 */
    GROBO_GR001_RIGHT_LEG = 5, /**< 9..14 */
    GROBO_GR001_LEFT_LEG = 6,  /**< 15..20 */
    GROBO_GR001_LEGS = 7       /**< 9..20 */
} grobo_gr001_group;

/* ---- one motor, a group of motors ------------------------------------------------------------ */

/**
 * Switches torque of one motor: grobo_robot_torque().
 * @return a job number > 0, GROBO_ERR_NOTFOUND (no such motor), or its errors.
 */
GROBO_API int grobo_gr001_torque(grobo_robot *robot, int motor, grobo_torque mode);

/** Switches torque of a group; otherwise as grobo_gr001_torque(). */
GROBO_API int grobo_gr001_servo(grobo_robot *robot, grobo_gr001_group group, grobo_torque mode);

/**
 * Moves one motor at once: grobo_robot_move() of one joint, a short packet.
 * @param angle_ddeg 0.1 degree; outside the joint's limits it is refused.
 * @param time_cs 10 ms, 0..16383; 0 is as fast as the joint is allowed to be.
 * @return a job number > 0, GROBO_ERR_NOTFOUND (no such motor), GROBO_ERR_ARG (time), or the errors
 *   of grobo_robot_move().
 */
GROBO_API int grobo_gr001_move(grobo_robot *robot, int motor, int angle_ddeg, int time_cs);

/** Reads one motor: grobo_robot_sense(). @return a job number > 0, GROBO_ERR_NOTFOUND, or its. */
GROBO_API int grobo_gr001_sense(grobo_robot *robot, int motor);

/**
 * The angle of a motor as it was read last. No number stands for a failure.
 * @param max_age_us how old it may be; GROBO_NEVER_US: any age.
 * @param[out] angle_ddeg untouched on error.
 * @return 0, GROBO_ERR_NOTFOUND (no such motor), GROBO_ERR_STALE (never read, or longer ago).
 */
GROBO_API int grobo_gr001_angle(const grobo_robot *robot, int motor, int64_t max_age_us,
                                int *angle_ddeg);

/**
 * Goal and time as they stand in a packet (registers No.30-33, little endian): what setDegMs puts
 * there. 90 degrees in 100 ms is 900 and 10.
 * @return 4, GROBO_ERR_LIMIT (outside -1500..1500 or 0..16383), GROBO_ERR_SPACE.
 */
GROBO_API int grobo_gr001_pack_goal(int angle_ddeg, int time_cs, uint8_t *data, size_t cap);

/* ---- all motors, in motor order -------------------------------------------------------------- */

/**
 * Makes a posture of targets in motor order.
 * @param n 0..n_joints; fewer set fewer joints.
 * @param time_cs 10 ms, 0..16383; 0 is the robot's default time.
 * @param[out] posture untouched on error.
 * @return n, GROBO_ERR_CAP (more than joints), GROBO_ERR_ARG (time).
 */
GROBO_API int grobo_gr001_posture(const grobo_model *model, const int16_t *angle_ddeg, size_t n,
                                  int time_cs, grobo_posture *posture);

/**
 * Moves all motors there: grobo_robot_move().
 * @param angle_rad n of them in motor order, n the number of joints.
 * @param time_us as grobo_posture.time_us.
 * @return a job number > 0, GROBO_ERR_ARG (another n), or its errors.
 */
GROBO_API int grobo_gr001_set_angles(grobo_robot *robot, const double *angle_rad, size_t n,
                                     int64_t time_us);

/**
 * The angles read last, in motor order; NaN for those older than max_age_us.
 * @return number of motors that have an angle; GROBO_ERR_SPACE (capacity below the joints).
 */
GROBO_API int grobo_gr001_get_angles(const grobo_robot *robot, int64_t max_age_us,
                                     double *angle_rad, size_t capacity);

/**
 * Supply voltages read last, in motor order; -1 for those older than max_age_us or never read.
 * @return number of motors that have one; GROBO_ERR_SPACE (capacity below the joints).
 */
GROBO_API int grobo_gr001_voltages(const grobo_robot *robot, int64_t max_age_us,
                                   int32_t *voltage_mv, size_t capacity);
/** Motor currents read last; otherwise as grobo_gr001_voltages(). */
GROBO_API int grobo_gr001_currents(const grobo_robot *robot, int64_t max_age_us,
                                   int32_t *current_ma, size_t capacity);
/**
 * Mean of the voltages that are not older than max_age_us, rounded.
 * @return mV, or GROBO_ERR_STALE where there is none.
 */
GROBO_API int grobo_gr001_mean_voltage_mv(const grobo_robot *robot, int64_t max_age_us);

/* ---- for people ------------------------------------------------------------------------------ */

/**
 * Prints the voltage of each motor that was ever read, a line each, and their mean.
 * @param stream the caller's. @return 0 or GROBO_ERR_IO.
 */
GROBO_API int grobo_gr001_print_voltages(const grobo_robot *robot, FILE *stream);
/** Prints the current of each motor that was ever read. @return 0 or GROBO_ERR_IO. */
GROBO_API int grobo_gr001_print_currents(const grobo_robot *robot, FILE *stream);
/**
 * Prints a posture of GR001 in degrees, each joint where it sits in the body as seen from the
 * front: its right side at the left. "-" for joints not set.
 * @return 0, GROBO_ERR_ARG (not 20 joints), GROBO_ERR_IO.
 */
GROBO_API int grobo_gr001_print_posture(const grobo_posture *posture, FILE *stream);

/* ---- the record ------------------------------------------------------------------------------
 * A motion that is made by hand: put the joints into free mode, bend the robot, append, again.
 * grobo_motion_clear() empties it. */

/** An angle older than this is not recorded: read first, or let the engine read faster. */
#define GROBO_GR001_RECORD_AGE_US 2000000

/**
 * Appends the posture read last, as a whole, to a motion. An empty one of increments or frames
 * becomes one of postures.
 * @param time_us time to reach it; 0: the default time.
 * @return number of postures then; GROBO_ERR_STALE (a joint was not read lately), GROBO_ERR_TYPE
 *   (increments, or frames at a rate: it has no place for where a joint is, or for its time), or
 *   the errors of grobo_motion_append().
 */
GROBO_API int grobo_gr001_record(grobo_motion *record, const grobo_robot *robot, int64_t time_us);

/**
 * Plays a motion by keys: grobo_motion_clip(), then grobo_robot_play().
 * @param options copied; NULL: all defaults.
 * @param[out] clip what is played: grobo_motion_clip_free() when GROBO_EVENT_PLAY has told the end;
 *   the motion must live unchanged until then. Nothing to free on error.
 * @return a job number > 0, GROBO_ERR_EMPTY, or the errors of both.
 */
GROBO_API int grobo_gr001_play_record(const grobo_motion *record, grobo_robot *robot,
                                      const grobo_play_options *options, grobo_clip *clip);

GROBO_END_DECLS

#endif
