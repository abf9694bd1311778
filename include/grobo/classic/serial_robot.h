/* SPDX-License-Identifier: MIT */
/**
 * @file serial_robot.h
 * @brief SerialRobot of the reference document: a robot, its postures and motion, and its thread.
 *
 * What the C++ class leaves to a subclass (checkConnection, getAngle, getPosture, postureToCommand,
 * jointIdToMotorId, motorIdToJointId) is the driver and model of the robot (driver.h, or a robot
 * file); `svc` and `stabilizer` are fields. Ids are motor ids, postures are in motor order and 0.1
 * degree (robot_posture.h), times are milliseconds.
 *
 * **What is different for safety**, here and in gr001.h. The original sends what it is told. Here:
 * - Every frame that moves a motor or switches torque is judged when it leaves: an angle outside a
 *   joint's limits is refused, and a move that is too fast for a joint is given more time.
 * - No joint moves that was not read: a first move reads it, and goes there at the approach speed.
 *   Torque comes on where the motor stands, and is read back.
 * - Heat, current, low voltage and lost replies stop the robot until SerialRobot_reset().
 * - Before the port closes the driver's exit policy is carried out.
 * So more frames leave than the original sends: readings, and goals before torque comes on.
 *
 * What the document returns for a success is returned; a failure is -1 where it says no other, and
 * SerialRobot_error() has the reason. Functions that are void there return 0 or -1 here. Functions
 * that read, switch or check wait for the robot; those that move do not: isMoving() says how long.
 * They work with and without the thread; without it nothing goes on between calls of svc().
 *
 * One thread at a time calls a robot. The control thread calls `svc` and `stabilizer`.
 * NULL where something must be gives the return value of a failure; nothing happens then.
 */
#ifndef GROBO_CLASSIC_SERIAL_ROBOT_H
#define GROBO_CLASSIC_SERIAL_ROBOT_H

#include <grobo/classic/robot_motion.h>
#include <grobo/runner.h>

GROBO_BEGIN_DECLS

/** Bytes of the command buffer. */
#define SERIAL_ROBOT_COMMAND_BYTES 128
/** servoState of a motor whose torque is not known. */
#define SERIAL_ROBOT_STATE_UNKNOWN ((char)0x7f)

struct serial_robot_inside;

/** A robot. Pointers of it are its own. */
typedef struct SerialRobot {
    const char *name;                  /**< the driver's */
    int joints;                        /**< number of joints */
    char servoState[GROBO_JOINTS_MAX]; /**< 0 off, 1 on, 2 brake, by id - 1; as of the last
                                            getServoState() */
    RobotPosture *initPosture;         /**< of initPosition(): all 0; of a GR001 it stands */
    RobotPosture *currentPosture;      /**< what was read last, as of the last function that reads,
                                            or getCurrentPosture() */
    RobotPosture *targetPosture;       /**< of startMotion(): all 0 at first, time 100 ms */
    char motionDir[GROBO_PATH_MAX_BYTES]; /**< "": the present directory */
    RobotMotion *motion;                  /**< the current motion */
    int motionTime;     /**< ms, of postures that have no time of their own: 300 */
    int senseTime;      /**< ms between two readings in the background; used when it is made */
    int timeout;        /**< ms between two calls of `svc`: 500 */
    int repeatCount;    /**< of setMotionCount() */
    int reverseFlag;    /**< 1: the motion is played in reverse */
    bool executeMotion; /**< a motion is played; as of the last isMoving() */
    int commandCount;   /**< postures not sent yet, or the one under way; as of isMoving() */
    char commandBuf[SERIAL_ROBOT_COMMAND_BYTES]; /**< of setCommand() */
    int commandSize;                             /**< bytes in it */
    SerialCom *com;      /**< the robot's port, to ask and to name: it sends and receives nothing */
    RobotMotion *record; /**< of a GR001: recordCurrentPosture() */
    unsigned short Volts[GROBO_JOINTS_MAX];    /**< 10 mV, by id - 1; 0: not read yet */
    unsigned short Currents[GROBO_JOINTS_MAX]; /**< mA, by id - 1; 0: not read yet */
    /** What an override of svc() was: called by the control thread each `timeout` ms; or NULL. */
    void (*svc)(struct SerialRobot *robot);
    /** What an override of stabilizer() was: corrects a target before it is judged and sent; or
     *  NULL. It gets copies, and calls nothing that waits. @return 0; else the motion ends. */
    int (*stabilizer)(struct SerialRobot *robot, const RobotPosture *current, RobotPosture *target);
    void *user; /**< the program's own */
    /* private */
    struct serial_robot_inside *inside;
} SerialRobot;

/* ---- not in the document --------------------------------------------------------------------- */

/** Why the last call failed: an error of error.h; 0 where it did not. */
GROBO_CLASSIC_API int SerialRobot_error(const SerialRobot *robot);
/** The same for people; of an angle that is refused with its motor, its joint and the limits, in
 *  degrees. @return length, cut to fit; -1 @param room of text, with its NUL */
GROBO_CLASSIC_API int SerialRobot_errorText(const SerialRobot *robot, char *text, size_t room);
/** The runner below: everything of runner.h, session.h and robot.h. */
GROBO_CLASSIC_API grobo_runner *SerialRobot_runner(const SerialRobot *robot);
/** Waits until nothing moves. @param timeout_ms 0: 5 s @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_wait(SerialRobot *robot, int timeout_ms);
/** Emergency stop, latched; safe in a signal handler. @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_estop(SerialRobot *robot);
/** Clears a latched stop. @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_reset(SerialRobot *robot);
/** Locks of mutex_com and mutex_motion: fn has port and motion to itself, on the loop; it must not
 *  wait. @return what it returns, or an error of grobo_runner_call(). */
GROBO_CLASSIC_API int SerialRobot_locked(SerialRobot *robot, int (*fn)(void *arg), void *arg);

/* ---- making ---------------------------------------------------------------------------------- */

/**
 * SerialRobot(devname, n): closed, without a thread.
 * @param devname copied; a port, "tcp:HOST:PORT", "sim" or "auto"; NULL: set by setDevice()
 * @param n the driver's number of joints, else it fails; 0: whatever that is
 * @param driver borrowed; what a subclass was. NULL: GR001 through its board
 * @return 0, -1
 */
GROBO_CLASSIC_API int SerialRobot_init(SerialRobot *robot, const char *devname, int n,
                                       const grobo_driver *driver);
/** ~SerialRobot(): stops the thread, carries out the exit policy, closes. */
GROBO_CLASSIC_API void SerialRobot_deinit(SerialRobot *robot);
/** new: as SerialRobot_init(). @return NULL where that fails. */
GROBO_CLASSIC_API SerialRobot *SerialRobot_new(const char *devname, int n,
                                               const grobo_driver *driver);
/** delete robot. NULL is fine. */
GROBO_CLASSIC_API void SerialRobot_delete(SerialRobot *robot);

/* ---- members --------------------------------------------------------------------------------- */

/** Opens the port; the robot is asked for by the loop. @return 0 (the document: the port's handle),
 *  -1 */
GROBO_CLASSIC_API int SerialRobot_openPort(SerialRobot *robot);
/** Carries out the exit policy, and closes. @return 0, -1: closed all the same */
GROBO_CLASSIC_API int SerialRobot_closePort(SerialRobot *robot);
/** Sets the device of the next open. @return 0, -1: it is open */
GROBO_CLASSIC_API int SerialRobot_setDevice(SerialRobot *robot, const char *devname);
/** Has all motors go to targetPosture in its time, and does not wait. A target under way is
 *  replaced. @return 0; -1: refused, as where a motion is played, or an angle is outside limits */
GROBO_CLASSIC_API int SerialRobot_startMotion(SerialRobot *robot);
/** Makes initPosture the target, and startMotion(). @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_initPosition(SerialRobot *robot);
/** Appends currentPosture with the default time. @return number of postures; -1: nothing was read
 *  yet */
GROBO_CLASSIC_API int SerialRobot_appendCurrentPosture(SerialRobot *robot);
/** appendCurrentPosture(mtime): the same with a time in ms. */
GROBO_CLASSIC_API int SerialRobot_appendCurrentPosture_time(SerialRobot *robot, double mtime);
/** Loads name.m, .yaml, .pseq or .mseq of motionDir, whichever is there first, or name itself where
 *  it has an extension. A name cannot lead out of the directory, and a motion of another robot is
 *  refused (the original moves the joints that a .m file lacks to 0). @return number of postures;
 *  -1, and the motion is empty */
GROBO_CLASSIC_API int SerialRobot_loadMotion(SerialRobot *robot, const char *name);
/** The same of one format; fname with or without its extension. */
GROBO_CLASSIC_API int SerialRobot_loadMotionFromM(SerialRobot *robot, const char *fname);
/** Choreonoid's body motion; as loadMotionFromM(). */
GROBO_CLASSIC_API int SerialRobot_loadMotionFromYaml(SerialRobot *robot, const char *fname);
/** Choreonoid's key poses; as loadMotionFromM(). */
GROBO_CLASSIC_API int SerialRobot_loadMotionFromPseq(SerialRobot *robot, const char *fname);
/** Increments; as loadMotionFromM(). */
GROBO_CLASSIC_API int SerialRobot_loadMotionFromMseq(SerialRobot *robot, const char *fname);
/** Saves the motion in motionDir; ".m" is added where fname has no extension. Only an older motion
 *  of the format is replaced. @param fname NULL: the first free Motion0.m, Motion1.m, ...
 *  @return number of postures, -1 */
GROBO_CLASSIC_API int SerialRobot_saveMotionToM(SerialRobot *robot, const char *fname);
/** The same as Choreonoid's body motion; the original cannot. */
GROBO_CLASSIC_API int SerialRobot_saveMotionToYaml(SerialRobot *robot, const char *fname);
/** The same as Choreonoid's key poses; the original cannot. */
GROBO_CLASSIC_API int SerialRobot_saveMotionToPseq(SerialRobot *robot, const char *fname);
/** Sets motor id of targetPosture to deg, 0.1 degree. @return 0 (no such id: nothing is set) */
GROBO_CLASSIC_API int SerialRobot_setJoint(SerialRobot *robot, unsigned char id, short deg);
/** Sets the time of targetPosture, ms. @return 0 */
GROBO_CLASSIC_API int SerialRobot_setMotionTime(SerialRobot *robot, int tm);
/** Empties the motion; one that is played goes on. */
GROBO_CLASSIC_API void SerialRobot_clearMotion(SerialRobot *robot);
/** Sets the default time, 1..9999 ms; others leave it. @return the default time */
GROBO_CLASSIC_API int SerialRobot_setDefaultMotionTime(SerialRobot *robot, int sval);
/** The default time, ms. */
GROBO_CLASSIC_API int SerialRobot_getDefaultMotionTime(const SerialRobot *robot);
/** Sets the time between two calls of `svc`, ms. @return val */
GROBO_CLASSIC_API int SerialRobot_setTimeout(SerialRobot *robot, int val);
/** That time. */
GROBO_CLASSIC_API int SerialRobot_getTimeout(const SerialRobot *robot);
/** Puts a packet into the command buffer. @return len; -1: it does not fit, and the buffer is as it
 *  was */
GROBO_CLASSIC_API int SerialRobot_setCommand(SerialRobot *robot, const char *packet, int len);
/** Takes exactly len bytes of what came in reply to sendCommand(). Where there are fewer, they are
 *  dropped. @return len, -1 */
GROBO_CLASSIC_API int SerialRobot_recieveData(SerialRobot *robot, char *data, int len);
/** Sends a frame, connecting first where closed, and waits for its reply. The frame is judged like
 *  any other: torque on for a motor that does not hold, unknown frames and such are refused.
 *  @return len, -1 */
GROBO_CLASSIC_API int SerialRobot_sendCommand(SerialRobot *robot, const char *data, int len);
/** Starts the control thread. @return 1; 0 on failure, as in the original */
GROBO_CLASSIC_API int SerialRobot_startThread(SerialRobot *robot);
/** Carries out the exit policy, ends the thread and waits for that. @return 0; 1: there is none, as
 *  in the original */
GROBO_CLASSIC_API int SerialRobot_stopThread(SerialRobot *robot);
/** Whether the thread runs: 1 or 0. */
GROBO_CLASSIC_API int SerialRobot_isActive(const SerialRobot *robot);
/** Posture n of the motion in playing direction, counted from 0. @return NULL: there is none */
GROBO_CLASSIC_API RobotPosture *SerialRobot_getNthPosture(SerialRobot *robot, int n);
/** Makes that posture the target, in the default time, and startMotion(). @return 0; -1, also where
 *  there is none */
GROBO_CLASSIC_API int SerialRobot_doNthMotion(SerialRobot *robot, int n);
/** targetPosture. */
GROBO_CLASSIC_API RobotPosture *SerialRobot_getTargetPosture(SerialRobot *robot);
/** currentPosture, with what the loop has read meanwhile. */
GROBO_CLASSIC_API RobotPosture *SerialRobot_getCurrentPosture(SerialRobot *robot);
/** The posture that is played first. @return NULL: the motion is empty */
GROBO_CLASSIC_API RobotPosture *SerialRobot_getFirstPosture(SerialRobot *robot);
/** The posture that is played last. @return NULL: the motion is empty */
GROBO_CLASSIC_API RobotPosture *SerialRobot_getLastPosture(SerialRobot *robot);
/** Whether postures are to be sent or under way: 1 or 0. The original says 0 when the last is sent;
 *  here it is reached then. */
GROBO_CLASSIC_API int SerialRobot_isMoving(SerialRobot *robot);
/** Plays the motion count times, in reverse where it is negative, as the original does (its
 *  document speaks of the number alone): to the first posture in the default time or as much longer
 *  as is safe, then each posture in its time. 0 ends a motion that is played.
 *  @return how often it is played; 0: the motion is empty; -1: refused, as while one is played */
GROBO_CLASSIC_API int SerialRobot_setMotionCount(SerialRobot *robot, int count);
/** Number of joints. */
GROBO_CLASSIC_API int SerialRobot_numJoints(const SerialRobot *robot);
/** servoState, with what the loop has read meanwhile. */
GROBO_CLASSIC_API char *SerialRobot_getServoState(SerialRobot *robot);
/** Notes the state of motor id in servoState, and switches nothing: GR001_setTorque() does.
 *  @return state */
GROBO_CLASSIC_API int SerialRobot_setServoState(SerialRobot *robot, int id, int state);
/** Asks the robot whether it is there. @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_checkConnection(SerialRobot *robot);
/** Reads motor id. @return 0.1 degree; ROBOT_POSTURE_NO_ANGLE on failure (the document: -1000) */
GROBO_CLASSIC_API short SerialRobot_getAngle(SerialRobot *robot, unsigned char id);
/** Opens the port unless it is open, and waits for the robot. @return 1, -1 */
GROBO_CLASSIC_API int SerialRobot_connect(SerialRobot *robot);
/** Reads all motors into currentPosture, servoState, Volts and Currents. Those that stay silent
 *  keep their values. @return 0; -1: none was read */
GROBO_CLASSIC_API int SerialRobot_getPosture(SerialRobot *robot);
/** One round of the control loop, for programs without the thread. @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_svc(SerialRobot *robot);
/** Puts the frame that takes all motors to pos into the command buffer; a robot that needs several
 *  has the first of them there. @return 0, -1 */
GROBO_CLASSIC_API int SerialRobot_postureToCommand(SerialRobot *robot, const RobotPosture *pos);
/** The motor of a joint; joints count from 0, in joint order: 1 of a GR001 is motor 11.
 *  @return -1: no such joint */
GROBO_CLASSIC_API int SerialRobot_jointIdToMotorId(const SerialRobot *robot, int jid);
/** The joint of a motor. @return -1: no such motor (the original: 0, which is a joint) */
GROBO_CLASSIC_API int SerialRobot_motorIdToJointId(const SerialRobot *robot, int mid);
/** Calls the field `stabilizer` for targetPosture. @return its result; 0 where there is none */
GROBO_CLASSIC_API int SerialRobot_stabilizer(SerialRobot *robot);
/** Sets motionDir. @return 0, -1: too long */
GROBO_CLASSIC_API int SerialRobot_setMotionDir(SerialRobot *robot, const char *dir);
/** hThread: the control thread's handle, which is not joined. @return 0, -1: there is none */
GROBO_CLASSIC_API int SerialRobot_hThread(SerialRobot *robot, grobo_thread *thread);

/** The body of the control thread, for programs that make their threads themselves: rounds until
 *  stopThread(). @param args a SerialRobot */
GROBO_CLASSIC_API GROBO_THREAD_FUNC thread_execution(void *args);

GROBO_END_DECLS

#endif
