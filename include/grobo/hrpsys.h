/* SPDX-License-Identifier: MIT */
/**
 * @file hrpsys.h
 * @brief A robot in the manner of hrpsys-base: servo, readJointAngles, writeJointCommands, oneStep.
 *
 * For programs that were written for hrpsys (members GR36..GR43 of the reference document). The
 * names are hrpsys's, the traps of the original are not: -1 is no joint and never means all of
 * them, a caller's text is never changed, a joint that was not read gives NaN and not 0, and what
 * is sent passes the engine's safety like everything else.
 *
 * Nothing here waits. What takes time is a job of the engine (robot.h); a program that wants to
 * wait for it does so as for any other job. Angles are radians in joint order. One thread at a
 * time, that of the robot.
 */
#ifndef GROBO_HRPSYS_H
#define GROBO_HRPSYS_H

#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/** Groups of joints that may be added. */
#define GROBO_HRPSYS_GROUPS 16

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

/**
 * servo(jid, turnon): switches the torque of one joint, safely.
 * @param joint 0..n-1; anything else, -1 too, is GROBO_ERR_ARG.
 * @return job number, or an error of grobo_robot_torque().
 */
GROBO_API int grobo_hrpsys_servo(grobo_hrpsys *hrpsys, int joint, bool on, int64_t now_us);

/**
 * servo(jname, turnon): of a joint by name ("R_KNEE_P"), a group, added ones too, or "all".
 * @return job number, GROBO_ERR_NOTFOUND, or an error of grobo_robot_torque().
 */
GROBO_API int grobo_hrpsys_servo_name(grobo_hrpsys *hrpsys, const char *name, bool on,
                                      int64_t now_us);

/**
 * readJointAngles: the angles read last, of whatever age; NaN for joints never read.
 * @return number of joints that have an angle, or GROBO_ERR_SPACE (capacity < joints).
 */
GROBO_API int grobo_hrpsys_read_joint_angles(const grobo_hrpsys *hrpsys, double *angle_rad,
                                             size_t capacity, int64_t now_us);

/**
 * writeJointCommands: the targets of the next oneStep. Nothing is sent.
 * @return GROBO_OK; GROBO_ERR_ARG (n is not the number of joints), GROBO_ERR_NAN, GROBO_ERR_LIMIT:
 *         then the command is as it was.
 */
GROBO_API int grobo_hrpsys_write_joint_commands(grobo_hrpsys *hrpsys, const double *angle_rad,
                                                size_t n);

/** Time in which a oneStep is to be reached: the period of the caller's loop. Default 100 ms.
 *  @return GROBO_OK, or GROBO_ERR_ARG outside 1 us..163.83 s */
GROBO_API int grobo_hrpsys_set_period_us(grobo_hrpsys *hrpsys, int64_t period_us);

/**
 * oneStep: sends the command once, with grobo_robot_send() and its conditions.
 * @return GROBO_OK, GROBO_ERR_EMPTY without a command, or an error of grobo_robot_send().
 */
GROBO_API int grobo_hrpsys_one_step(grobo_hrpsys *hrpsys, int64_t now_us);

/**
 * checkEmergency: heat, current, voltage, lost replies, lost torque, an emergency stop.
 * @param[out] reason why, which joint and what value; may be NULL; untouched if all is well.
 * @return 1 for an emergency (grobo_robot_reset() ends it), 0 for none.
 */
GROBO_API int grobo_hrpsys_check_emergency(const grobo_hrpsys *hrpsys, grobo_trip_info *reason);

/**
 * addJointGroup: gives a name to some joints. Names are copied.
 * @return GROBO_OK; GROBO_ERR_NOTFOUND (no such joint), GROBO_ERR_EXISTS (the name is taken),
 *         GROBO_ERR_ARG (no name, no joints), GROBO_ERR_CAP (name too long), GROBO_ERR_FULL
 */
GROBO_API int grobo_hrpsys_add_joint_group(grobo_hrpsys *hrpsys, const char *name,
                                           const char *const *joints, size_t n);

/**
 * names2ids: the joint ids of n names.
 * @param[out] ids n of them; untouched on error.
 * @return n, or GROBO_ERR_NOTFOUND.
 */
GROBO_API int grobo_hrpsys_names_to_ids(const grobo_hrpsys *hrpsys, const char *const *names,
                                        size_t n, int *ids);

GROBO_END_DECLS

#endif
