/* SPDX-License-Identifier: MIT */
/**
 * @file gr001.h
 * @brief GR001 of the reference document: HPI's humanoid, a SerialRobot.
 *
 * Every function of serial_robot.h takes a GR001. Ids are motor ids 1..20, angles 0.1 degree; times
 * of single motors are in 10 ms (`cs`). What is different for safety stands in serial_robot.h.
 */
#ifndef GROBO_CLASSIC_GR001_H
#define GROBO_CLASSIC_GR001_H

#include <grobo/classic/serial_robot.h>
#include <grobo/motion.h>

GROBO_BEGIN_DECLS

/** A GR001. */
typedef SerialRobot GR001;

/** GR001(devname): initPosture is the standing posture. @return 0, -1 */
GROBO_CLASSIC_API int GR001_init(GR001 *robot, const char *devname);
/** ~GR001(): as SerialRobot_deinit(). */
GROBO_CLASSIC_API void GR001_deinit(GR001 *robot);
/** new GR001(devname). @return NULL where GR001_init() fails */
GROBO_CLASSIC_API GR001 *GR001_new(const char *devname);
/** delete robot. NULL is fine. */
GROBO_CLASSIC_API void GR001_delete(GR001 *robot);

/** connect(n): 0 tries all serial ports, USB adapters first, and keeps the first that a robot
 *  answers on; n > 0 is /dev/ttySn (Windows: COMn). @return 0, -1 */
GROBO_CLASSIC_API int GR001_connect_port(GR001 *robot, int n);
/** connect(): the device that is set. @return 1, -1, as SerialRobot_connect() */
GROBO_CLASSIC_API int GR001_connect(GR001 *robot);
/** Sends 41 00, which the board answers with 07. @return 0, -1 */
GROBO_CLASSIC_API int GR001_checkConnection(GR001 *robot);
/** The mean of Volts that were read; prints each on standard error where flag is not 0. @return in
 *  10 mV; 0 where none was read. (The original returns the sum.) */
GROBO_CLASSIC_API int GR001_printVolts(GR001 *robot, int flag);
/** Prints Currents, in mA, on standard error. (The document names a flag that the original has
 *  not.) */
GROBO_CLASSIC_API void GR001_printCurrents(GR001 *robot, int flag);
/** Prints currentPosture on standard error, each motor where it sits in the body. */
GROBO_CLASSIC_API void GR001_printPosture(GR001 *robot);
/** Switches torque of motor id: 1 on, 0 off, 2 brake; waits until it is read back. On goes on where
 *  the motor stands. @return 0, -1 */
GROBO_CLASSIC_API int GR001_setTorque(GR001 *robot, unsigned char id, char val);
/** Switches torque of a group: 0 all, 1 head and trunk, 2 right arm, 3 left arm, 4 arms, 5 right
 *  leg, 6 left leg, 7 legs. (The original takes any other number for all; here it is refused.)
 *  @return 0, -1 */
GROBO_CLASSIC_API int GR001_setServo(GR001 *robot, char on, int c);
/** Reads motor id. @return 0.1 degree; ROBOT_POSTURE_NO_ANGLE on failure (the document's -254 is an
 *  angle) */
GROBO_CLASSIC_API short GR001_getAngle(GR001 *robot, unsigned char id);
/** Puts angle (0.1 degree) and time (10 ms) into 4 bytes of a packet. 90 degrees in 100 ms are 900
 *  and 10; the 1000 of the document's example are 10 s. @return 1; -1: out of range */
GROBO_CLASSIC_API int GR001_setDegMs(const GR001 *robot, char *data, short deg, unsigned short cs);
/** Has motor id go to deg (0.1 degree) in cs (10 ms), and does not wait. @return 0, -1 */
GROBO_CLASSIC_API int GR001_moveJoint(GR001 *robot, unsigned char id, short deg, unsigned short cs);
/** Sets targetPosture: as many angles as joints, 0.1 degree, and the time, 10 ms; below 1 the
 *  default time. @return 0, -1 */
GROBO_CLASSIC_API int GR001_setJoints(GR001 *robot, const short *deg, int cs);
/** Sets targetPosture of "time a1 .. a20": the time in 10 ms, 1..999, others are 500 ms, as the
 *  original takes it; angles in 0.1 degree; fewer set fewer motors. (The original takes the time
 *  for motor 1's angle as well, and each angle for the motor behind.) @return 0; -1, and nothing is
 *  set: what is no number, too many */
GROBO_CLASSIC_API int GR001_setJointsFromString(GR001 *robot, const char *str);
/** Starts a motion that is kept in the board: nothing checks its targets. @return 1, -1 */
GROBO_CLASSIC_API int GR001_activateMotionSlot(GR001 *robot, unsigned char id);
/** Starts a scenario that is kept in the board. @return 1, -1 */
GROBO_CLASSIC_API int GR001_activateSenario(GR001 *robot, unsigned char id);
/** Puts the 110-byte frame of pos into the command buffer, its time being that of pos. @return 0,
 *  -1 */
GROBO_CLASSIC_API int GR001_postureToCommand(GR001 *robot, const RobotPosture *pos);
/** Reads all motors. @return their angles in radians, in motor order: the robot's own array; NULL
 *  where none was read. (The original reads nothing, and its radians are ten times as large.) */
GROBO_CLASSIC_API double *GR001_getCurrentJointAngles(GR001 *robot);
/** Sets targetPosture, radians in motor order, and startMotion(). (The original takes whole degrees
 *  for 0.1 degree, and each angle for the motor before.) @return 0, -1 */
GROBO_CLASSIC_API int GR001_setTargetJointAngles(GR001 *robot, const double *rad);
/** As SerialRobot_jointIdToMotorId(). */
GROBO_CLASSIC_API int GR001_jointIdToMotorId(const GR001 *robot, int jid);
/** As SerialRobot_motorIdToJointId(). */
GROBO_CLASSIC_API int GR001_motorIdToJointId(const GR001 *robot, int mid);
/** As SerialRobot_stabilizer(). */
GROBO_CLASSIC_API int GR001_stabilizer(GR001 *robot);
/** Empties the record. @return 0 */
GROBO_CLASSIC_API int GR001_clearRecord(GR001 *robot);
/** Appends currentPosture to the record, with its time, 100 ms. @return 0; -1: nothing was read */
GROBO_CLASSIC_API int GR001_recordCurrentPosture(GR001 *robot);
/** Makes the record the motion, and plays it once. @return 0, -1 */
GROBO_CLASSIC_API int GR001_doRecord(GR001 *robot);
/**
 * Free mode, which the original has and its document has not: 1 lets a person move all joints,
 * which are braked where they are pushed and hold where they rest (grobo_robot_free()); another
 * number ends it: they hold where they are. @return x, -1
 */
GROBO_CLASSIC_API int GR001_setFreeMotion(GR001 *robot, int x);

/* ---- packets, which the document keeps as templates ---------------------------------------- */

/** MoveJointPacket: the 14 bytes of moveJoint(). @return their number, -1: it does not fit */
GROBO_CLASSIC_API int GR001_MoveJointPacket(const GR001 *robot, unsigned char id, short deg,
                                            unsigned short cs, char *data, int room);
/** PosturePacket: the 110 bytes of a posture. @return as above */
GROBO_CLASSIC_API int GR001_PosturePacket(const GR001 *robot, const RobotPosture *pos, char *data,
                                          int room);
/** MotorInfoPacket: the 11 bytes that ask motor id for its state. @return as above */
GROBO_CLASSIC_API int GR001_MotorInfoPacket(const GR001 *robot, unsigned char id, char *data,
                                            int room);
/** ServoPacket: the 11 bytes of setTorque(). @return as above */
GROBO_CLASSIC_API int GR001_ServoPacket(const GR001 *robot, unsigned char id, char val, char *data,
                                        int room);

GROBO_END_DECLS

#endif
