/* SPDX-License-Identifier: MIT */
/**
 * @file hrpsys.h
 * @brief The members of GR001 in the manner of hrpsys-base.
 *
 * The document calls them not verified, and most of them do not work in the original: servo(jid)
 * there switches a group of that number, names are never found, writeJointCommands() reads behind
 * its array and sets the angle of another motor to a tenth. They do here what the document says.
 * **Angles are radians in motor order**, in both directions, so that a program may write what it
 * read.
 */
#ifndef GROBO_CLASSIC_HRPSYS_H
#define GROBO_CLASSIC_HRPSYS_H

#include <grobo/classic/gr001.h>

GROBO_BEGIN_DECLS

/** servo(jid, turnon): switches the torque of joint jid, which counts from 0 in joint order: motor
 *  jointIdToMotorId(jid). Waits. @return false: no such joint, or it failed */
GROBO_CLASSIC_API bool GR001_servo(GR001 *robot, int jid, bool turnon);
/** servo(jname, turnon): of a joint, a group or "all". Waits. @return false: no such name, or it
 *  failed */
GROBO_CLASSIC_API bool GR001_servo_name(GR001 *robot, const char *jname, bool turnon);
/** The angles read last. @param o_angles numJoints of them: radians, motor order; of motors never
 *  read NaN. (The original's are ten times as large.) */
GROBO_CLASSIC_API void GR001_readJointAngles(GR001 *robot, double *o_angles);
/** Sets targetPosture; nothing is sent. @param i_commands numJoints: radians, motor order */
GROBO_CLASSIC_API void GR001_writeJointCommands(GR001 *robot, const double *i_commands);
/** Whether the robot has stopped for heat, current, low voltage, lost replies or an emergency stop.
 *  @param[out] o_reason "over-temperature: NECK_Y at 71 deg C", cut at room bytes; or NULL
 *  @param[out] o_id the motor, -1: no single one; or NULL. Both are untouched where it is false. */
GROBO_CLASSIC_API bool GR001_checkEmergency(GR001 *robot, char *o_reason, size_t room, int *o_id);
/** startMotion(): goes to targetPosture. @return 0, -1 */
GROBO_CLASSIC_API int GR001_oneStep(GR001 *robot);
/** Gives a name to n joints. @return false: a name that is not known, or taken, and no group is
 *  made */
GROBO_CLASSIC_API bool GR001_addJointGroup(GR001 *robot, const char *gname,
                                           const char *const *jnames, size_t n);
/** The motors of n names. @param[out] o_ids n of them; untouched where one is not known
 *  @return false: one is not known */
GROBO_CLASSIC_API bool GR001_names2ids(GR001 *robot, const char *const *i_names, size_t n,
                                       int *o_ids);

GROBO_END_DECLS

#endif
