/* SPDX-License-Identifier: MIT */
/**
 * @file hrpsys.h
 * @brief A robot in the manner of hrpsys-base: servo, readJointAngles, writeJointCommands, oneStep.
 *
 * For programs that were written for hrpsys (members GR36..GR43 of the reference document). A view
 * on an engine (robot.h), so it works wherever the engine does. Nothing here waits; what takes
 * time is a job of the engine.
 * A control loop:
 * @code
 *   grobo_hrpsys_servo_name(&h, "all", true);          // a job: wait for its end
 *   for (each period) {
 *       grobo_hrpsys_read_joint_angles(&h, max_age_us, angle_rad, 20);
 *       ...
 *       grobo_hrpsys_write_joint_commands(&h, command_rad, 20);
 *       grobo_hrpsys_one_step(&h);
 *       if (grobo_hrpsys_check_emergency(&h, reason, sizeof reason, &joint) > 0) ...
 *   }
 * @endcode
 *
 * The names are hrpsys's; what callers stumbled over there is not:
 * - There -1 as joint id means all joints, so that a look-up by name that failed switches the
 *   whole robot. Here -1 is GROBO_ERR_ARG; all joints are called "all".
 * - There servo(name) turns the caller's text into capitals in place. Here no text is changed, and
 *   names are found in any case.
 * - There names that are not known are skipped, and the ids are not those of the names any more.
 *   Here one unknown name makes the call fail, and there are no ids.
 * - hrpsys-base counts joints from 0 in joint order, the GROBO library's names2ids gives motor
 *   numbers. Here each has a function of its own.
 * - There a joint that is switched on goes to what was written for it long ago. Here switching
 *   forgets what was written: a joint stays where it is until it is written again.
 * - There an angle that could not be read is the one read before. Here it is NaN.
 * - There a command is sent as it is. Here it passes the engine's safety like everything else.
 *
 * Angles are radians in joint order. One thread at a time, that of the engine.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_HRPSYS_H
#define GROBO_CORE_HRPSYS_H

#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/** Groups of joints that may be added. */
#define GROBO_HRPSYS_GROUPS 16

/** Room that every reason of an emergency fits into, with its NUL. */
#define GROBO_HRPSYS_REASON_MAX_BYTES 128

/** The state of the interface, in the caller's storage. Fields are private. */
typedef struct grobo_hrpsys {
    /* private */
    grobo_robot *robot;
    grobo_posture command;
    struct {
        char name[GROBO_NAME_MAX_BYTES];
        grobo_joint_mask joints;
    } groups[GROBO_HRPSYS_GROUPS];
    unsigned n_groups;
} grobo_hrpsys;

/** Begins with no groups but the model's and no command. @param robot borrowed. */
GROBO_API void grobo_hrpsys_init(grobo_hrpsys *hrpsys, grobo_robot *robot);

/* ---- names ---------------------------------------------------------------------------------- */

/**
 * Joints called so, in any case: "all", a joint ("R_KNEE_P"), a group of the model ("right_arm")
 * or one that was added. A bare number is no name.
 * @param[out] joints untouched on error.
 * @return number of joints, or GROBO_ERR_NOTFOUND.
 */
GROBO_API int grobo_hrpsys_find(const grobo_hrpsys *hrpsys, const char *name,
                                grobo_joint_mask *joints);

/**
 * addJointGroup: gives a name to some joints. Names are copied.
 * @param joints names of joints; groups stand for their joints.
 * @return number of joints in the group; GROBO_ERR_NOTFOUND (one of joints: no group is made),
 *         GROBO_ERR_EXISTS (the name is taken), GROBO_ERR_ARG (no name, a number, no joints),
 *         GROBO_ERR_CAP (name too long), GROBO_ERR_FULL
 */
GROBO_API int grobo_hrpsys_add_joint_group(grobo_hrpsys *hrpsys, const char *name,
                                           const char *const *joints, size_t n);

/**
 * names2ids: the joint ids of n names, one each: no groups.
 * @param[out] ids n of them; untouched on error.
 * @return n, or GROBO_ERR_NOTFOUND.
 */
GROBO_API int grobo_hrpsys_names_to_ids(const grobo_hrpsys *hrpsys, const char *const *names,
                                        size_t n, int *ids);
/** The same, but motor numbers, as the GROBO library's names2ids gives them. */
GROBO_API int grobo_hrpsys_names_to_motors(const grobo_hrpsys *hrpsys, const char *const *names,
                                           size_t n, int *motors);

/* ---- servo ---------------------------------------------------------------------------------- */

/**
 * servo(jid, turnon): switches the torque of one joint, safely.
 * @param joint 0..n-1; anything else, -1 too, is GROBO_ERR_ARG.
 * @return job number, or an error of grobo_robot_torque().
 */
GROBO_API int grobo_hrpsys_servo(grobo_hrpsys *hrpsys, int joint, bool on);

/**
 * servo(jname, turnon): of whatever grobo_hrpsys_find() finds.
 * @return job number, GROBO_ERR_NOTFOUND, or an error of grobo_robot_torque().
 */
GROBO_API int grobo_hrpsys_servo_name(grobo_hrpsys *hrpsys, const char *name, bool on);

/* ---- angles --------------------------------------------------------------------------------- */

/**
 * readJointAngles: the angles read last; NaN for joints not read within max_age_us.
 * @param max_age_us GROBO_NEVER_US: any age.
 * @return number of joints that have an angle, or GROBO_ERR_SPACE (capacity < joints).
 */
GROBO_API int grobo_hrpsys_read_joint_angles(const grobo_hrpsys *hrpsys, int64_t max_age_us,
                                             double *angle_rad, size_t capacity);

/**
 * writeJointCommands: the targets of the next oneStep. Nothing is sent.
 * @return GROBO_OK; GROBO_ERR_ARG (n is not the number of joints), GROBO_ERR_NAN: then the command
 *         is as it was.
 */
GROBO_API int grobo_hrpsys_write_joint_commands(grobo_hrpsys *hrpsys, const double *angle_rad,
                                                size_t n);

/** Time in which a oneStep is to be reached: the period of the caller's loop. Default 100 ms.
 *  @return GROBO_OK, or GROBO_ERR_ARG outside 1 us..163.83 s */
GROBO_API int grobo_hrpsys_set_period_us(grobo_hrpsys *hrpsys, int64_t period_us);

/**
 * oneStep: sends the command once, with grobo_robot_send() and its conditions; limits are kept or
 * refused as the engine is configured. Joints without torque are skipped.
 * @return GROBO_OK; GROBO_ERR_EMPTY (nothing written since the joints were switched),
 *         GROBO_ERR_STATE (no joint has torque), or an error of grobo_robot_send().
 */
GROBO_API int grobo_hrpsys_one_step(grobo_hrpsys *hrpsys);

/* ---- emergency ------------------------------------------------------------------------------ */

/**
 * checkEmergency: has the engine stopped for heat, current, low voltage, lost replies, lost torque
 * or on an emergency stop? grobo_robot_tripped() tells the same in numbers.
 * @param[out] reason "over-temperature: NECK_Y at 71 deg C", NUL-terminated;
 *             GROBO_HRPSYS_REASON_MAX_BYTES is always enough.
 * @param[out] joint which, or -1 where it is no single one; may be NULL. Both are untouched unless
 *             1 is returned.
 * @return 1 for an emergency (grobo_robot_reset() ends it), 0 for none, GROBO_ERR_SPACE.
 */
GROBO_API int grobo_hrpsys_check_emergency(const grobo_hrpsys *hrpsys, char *reason,
                                           size_t reason_bytes, int *joint);

GROBO_END_DECLS

#endif
