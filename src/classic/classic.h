/* SPDX-License-Identifier: MIT */
/* The inside of the classic shelf. Its files use the exported functions of the main library alone:
 * it is a program for it. */
#ifndef GROBO_CLASSIC_I_H
#define GROBO_CLASSIC_I_H

#include <grobo/classic/classic.h>

#include "src/classic/view.h"

/* To whom a posture belongs. */
typedef enum posture_home {
    POSTURE_CALLERS = 0, /* storage of the caller's */
    POSTURE_FREE,        /* made here, to be deleted */
    POSTURE_IN_MOTION    /* deleted by its motion */
} posture_home;

/* What a SerialRobot does not show. */
struct serial_robot_inside {
    grobo_driver driver; /* a copy, with the stabilizer; self of its functions */
    SerialRobot *robot;
    grobo_runner *runner;
    classic_view view;
    SerialCom com;
    char device[GROBO_PATH_MAX_BYTES];
    RobotPosture init, current, target;
    RobotMotion motion, record;
    uint8_t joint_of[GROBO_JOINTS_MAX]; /* by id - 1 */
    int error;                          /* of the last call */
    int job;                            /* the last move or play, 0: none */
    grobo_motion *playing;              /* what the clip reads */
    grobo_clip clip;
    int64_t svc_us;                              /* when the field svc is called next */
    uint8_t received[4 * GROBO_REPLY_MAX_BYTES]; /* replies to sent commands; the loop's */
    size_t n_received;
    uint8_t sending[GROBO_FRAME_MAX_BYTES]; /* the command under way; the loop's */
    size_t n_sending;                       /* 0: none */
    bool recording;                         /* it is on the wire */
};

/* Radians of 0.1 degree. */
static inline double grobo_classic_rad(int ddeg)
{
    return grobo_rad_from_deg(ddeg / 10.0);
}

/* Keeps a result for SerialRobot_error(). @return -1 for an error, else `good`. */
static inline int grobo_classic_end(SerialRobot *robot, int result, int good)
{
    robot->inside->error = result < 0 ? result : GROBO_OK;
    return result < 0 ? -1 : good;
}

static inline const grobo_model *grobo_classic_model(const SerialRobot *robot)
{
    return robot->inside->driver.model;
}

static inline const grobo_protocol *grobo_classic_protocol(const SerialRobot *robot)
{
    return robot->inside->driver.protocol;
}

static inline grobo_robot *grobo_classic_engine(const SerialRobot *robot)
{
    return grobo_runner_robot(robot->inside->runner);
}

/* The joint of motor id (the id-th in the order of motors), or GROBO_ERR_NOTFOUND. */
int grobo_classic_joint(const SerialRobot *robot, int id);

/* A posture in joint order and radians, every joint set, of one in motor order; and back, where
 * only the joints that are set are changed. */
void grobo_classic_to_joints(const SerialRobot *robot, const RobotPosture *from, grobo_posture *to);
void grobo_classic_to_motors(const SerialRobot *robot, const grobo_posture *from, RobotPosture *to);

/* Time of a posture, 0: the default time. */
int64_t grobo_classic_time_us(double time_ms);

/* What a function that waits asks of the engine. */
typedef struct classic_request {
    SerialRobot *robot;
    int (*start)(struct classic_request *request, grobo_robot *engine); /* @return a job number */
    grobo_joint_mask joints;
    grobo_torque torque;
    grobo_stored_kind stored;
    int number;
    const char *text; /* a name, or the `size` bytes of a command */
    size_t size;
    int64_t end_us; /* when nobody waits any more */
} classic_request;

/* Makes a request behind those of other threads, and waits for its end. @return 0, -1 */
int grobo_classic_ask(SerialRobot *robot, classic_request request);

/* Switches torque, and waits. @return 0, -1 */
int grobo_classic_torque(SerialRobot *robot, grobo_joint_mask joints, char mode);

/* Takes over what was read. @return joints with an angle. */
int grobo_classic_refresh(SerialRobot *robot);

/* A grobo_motion of postures in motor order, as .m files are. */
int grobo_classic_to_motion(const RobotMotion *from, grobo_motion **to);

/* The same in the robot's joint order, as Choreonoid's files are. */
int grobo_classic_to_joint_motion(const SerialRobot *robot, const RobotMotion *from,
                                  grobo_motion **to);

/* Reads one of Choreonoid's files and replaces the motion. */
int grobo_classic_load(RobotMotion *motion, const char *path, grobo_motion_format format,
                       SerialRobot *robot);

/* Writes a motion; robot NULL for .m. */
int grobo_classic_save(const RobotMotion *motion, const char *path, grobo_motion_format format,
                       const SerialRobot *robot);

#endif
