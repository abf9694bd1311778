/* SPDX-License-Identifier: MIT */
/**
 * @file robot_posture.h
 * @brief RobotPosture of the reference document: the angles of all motors and a time.
 *
 * What stands here was measured at the original library, where its document says less or else:
 * - **The id of a posture is a motor's number**, 1..numJoints: element id - 1 belongs to motor id.
 *   (Robots whose motors are not 1..n: the id-th motor in the order of their numbers.)
 * - **An angle is 0.1 degree**: the original sends `jointAngles` as they are, so that 200 is 20.0
 *   degrees. Its document writes degree. Whole degrees would turn a motor ten times as far.
 * - Radians are those of the same angle. The original's are ten times as large, because it converts
 *   0.1 degree as if it was degree, and its setRad() moves nothing.
 *
 * A posture is plain data of one thread. One that RobotPosture_new() or RobotPosture_dupPosture()
 * made belongs to the motion that it was appended to, from then on.
 * NULL where something must be gives the return value of a failure; nothing happens then.
 */
#ifndef GROBO_CLASSIC_ROBOT_POSTURE_H
#define GROBO_CLASSIC_ROBOT_POSTURE_H

#include <stdio.h>

#include <grobo/classic/serial_com.h>
#include <grobo/posture.h>

GROBO_BEGIN_DECLS

/** What stands for an angle where there is none, as in the original: no joint reaches it. The
 *  document's -1000 and -254 are angles. */
#define ROBOT_POSTURE_NO_ANGLE (-10000)

/** A posture. The angles of a frame come from `jointAngles`. */
typedef struct RobotPosture {
    int numJoints;                           /**< 0..GROBO_JOINTS_MAX */
    int jointAngles[GROBO_JOINTS_MAX];       /**< 0.1 degree, by id - 1 */
    double jointAnglesRad[GROBO_JOINTS_MAX]; /**< radians, as of the last function called */
    double motionTime;                       /**< ms to reach it; below 1, and from 10000 on: the
                                                  robot's default time */
    /* private */
    int home;
} RobotPosture;

/** rad2deg: 0.1 degree have their own functions. @return whole degrees, cut off, as in the
 *  original; 0 for what is no angle, the nearest short for what does not fit. */
GROBO_CLASSIC_API short rad2deg(double d);
/** deg2rad: radians of whole degrees. */
GROBO_CLASSIC_API double deg2rad(short d);

/** RobotPosture(n): n joints at 0, motionTime 100 ms, as the document has it (the original: 250).
 *  @return 0, or -1: n is not 0..GROBO_JOINTS_MAX. */
GROBO_CLASSIC_API int RobotPosture_init(RobotPosture *posture, int n);
/** ~RobotPosture(): no joints are left; nothing is to be freed. */
GROBO_CLASSIC_API void RobotPosture_deinit(RobotPosture *posture);
/** new RobotPosture(n). @return NULL where n is out of range or there is no memory. */
GROBO_CLASSIC_API RobotPosture *RobotPosture_new(int n);
/** delete posture: one that was made with _new or _dupPosture. NULL is fine, and one that belongs
 *  to a motion stays. */
GROBO_CLASSIC_API void RobotPosture_delete(RobotPosture *posture);

/** An independent copy. @return NULL: no memory. */
GROBO_CLASSIC_API RobotPosture *RobotPosture_dupPosture(const RobotPosture *posture);
/** Sets motionTime. @param n ms @return n; NaN leaves it as it was. */
GROBO_CLASSIC_API double RobotPosture_setMotionTime(RobotPosture *posture, double n);
/** The angle of motor id in 0.1 degree. @return ROBOT_POSTURE_NO_ANGLE: no such id. */
GROBO_CLASSIC_API int RobotPosture_getDegree(const RobotPosture *posture, int id);
/** The angle of motor id in radians. @return ROBOT_POSTURE_NO_ANGLE: no such id. */
GROBO_CLASSIC_API double RobotPosture_getRad(const RobotPosture *posture, int id);
/** Sets the angle of motor id, in 0.1 degree. No such id: nothing happens. */
GROBO_CLASSIC_API void RobotPosture_setDegree(RobotPosture *posture, int id, int deg);
/** Sets the angle of motor id, in radians, rounded to 0.1 degree. What is no number, or beyond any
 *  joint, is not set. */
GROBO_CLASSIC_API void RobotPosture_setRad(RobotPosture *posture, int id, double rad);
/** Prints the angles in 0.1 degree, one line on standard error. */
GROBO_CLASSIC_API void RobotPosture_printPosture(const RobotPosture *posture);
/** printPosture(stream): the same line into a stream. */
GROBO_CLASSIC_API void RobotPosture_printPosture_stream(const RobotPosture *posture, FILE *stream);
/** copyPosture(p): takes time and angles over FROM p, as the original does and its programs mean it
 *  (`targetPosture->copyPosture(initPosture)`); the document says it the other way round. */
GROBO_CLASSIC_API void RobotPosture_copyPosture(RobotPosture *posture, const RobotPosture *p);
/** copyPosture(p, offset): p's first angle goes to element `offset`, and so on, as far as both
 *  reach; numJoints stays. An offset out of range: nothing happens. */
GROBO_CLASSIC_API void RobotPosture_copyPosture_offset(RobotPosture *posture, const RobotPosture *p,
                                                       int offset);
/** All angles, numJoints of them, in 0.1 degree and motor order: the posture's own array. */
GROBO_CLASSIC_API int *RobotPosture_getJointAngles(RobotPosture *posture);
/** The same in radians, computed anew. */
GROBO_CLASSIC_API double *RobotPosture_getJointAnglesRad(RobotPosture *posture);
/** Whether all angles are the same; times are not compared. False for another number of joints. */
GROBO_CLASSIC_API bool RobotPosture_equalTo(const RobotPosture *posture, const RobotPosture *pos);
/** Whether all angles differ by less than delta, 0.1 degree. (The original also takes the
 *  difference of exactly delta.) */
GROBO_CLASSIC_API bool RobotPosture_nearTo(const RobotPosture *posture, const RobotPosture *pos,
                                           int delta);

GROBO_END_DECLS

#endif
