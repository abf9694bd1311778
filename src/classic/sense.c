/* SPDX-License-Identifier: MIT */
/* SerialRobot of the classic shelf: its postures and motors, and what is read of them. */
#include <math.h>
#include <string.h>

#include "src/classic/classic.h"

/* ---- ids ---------------------------------------------------------------------------------- */

int SerialRobot_jointIdToMotorId(const SerialRobot *robot, int jid)
{
    int motor = SerialRobot_runner(robot) == NULL
                    ? -1
                    : grobo_model_motor_of_joint(grobo_classic_model(robot), jid);

    return motor < 0 ? -1 : motor;
}

int SerialRobot_motorIdToJointId(const SerialRobot *robot, int mid)
{
    int joint = SerialRobot_runner(robot) == NULL
                    ? -1
                    : grobo_model_joint_of_motor(grobo_classic_model(robot), mid);

    return joint < 0 ? -1 : joint;
}

int SerialRobot_numJoints(const SerialRobot *robot)
{
    return robot != NULL ? robot->joints : 0;
}

/* ---- reading ------------------------------------------------------------------------------ */

static int ask_full(classic_request *request, grobo_robot *engine)
{
    return grobo_robot_sense(engine, request->joints, GROBO_SENSE_FULL);
}

short SerialRobot_getAngle(SerialRobot *robot, unsigned char id)
{
    if (SerialRobot_runner(robot) == NULL) {
        return ROBOT_POSTURE_NO_ANGLE;
    }
    int joint = grobo_classic_joint(robot, id);
    int r = joint < 0
                ? grobo_classic_end(robot, joint, 0)
                : grobo_classic_ask(robot, (classic_request){.start = ask_full,
                                                             .joints = GROBO_JOINT_BIT(joint)});
    if (r < 0) {
        return ROBOT_POSTURE_NO_ANGLE;
    }
    (void)grobo_classic_refresh(robot);
    return (short)robot->inside->current.jointAngles[id - 1];
}

int SerialRobot_getPosture(SerialRobot *robot)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    grobo_posture sensed;
    /* Nineteen angles are read where the twentieth motor is silent. */
    int r = grobo_runner_read_posture(robot->inside->runner, &sensed, 0);

    (void)grobo_classic_refresh(robot);
    return grobo_classic_end(robot, r, 0);
}

RobotPosture *SerialRobot_getCurrentPosture(SerialRobot *robot)
{
    if (SerialRobot_runner(robot) == NULL) {
        return NULL;
    }
    (void)grobo_classic_refresh(robot);
    return robot->currentPosture;
}

char *SerialRobot_getServoState(SerialRobot *robot)
{
    if (SerialRobot_runner(robot) == NULL) {
        return NULL;
    }
    (void)grobo_classic_refresh(robot);
    return robot->servoState;
}

int SerialRobot_setServoState(SerialRobot *robot, int id, int state)
{
    if (robot != NULL && id > 0 && id <= robot->joints) {
        robot->servoState[id - 1] = (char)state;
    }
    return state;
}

/* ---- the target --------------------------------------------------------------------------- */

RobotPosture *SerialRobot_getTargetPosture(SerialRobot *robot)
{
    return robot != NULL ? robot->targetPosture : NULL;
}

int SerialRobot_setJoint(SerialRobot *robot, unsigned char id, short deg)
{
    if (robot == NULL) {
        return -1;
    }
    RobotPosture_setDegree(robot->targetPosture, id, deg);
    return 0;
}

int SerialRobot_setMotionTime(SerialRobot *robot, int tm)
{
    if (robot == NULL) {
        return -1;
    }
    (void)RobotPosture_setMotionTime(robot->targetPosture, tm);
    return 0;
}

int SerialRobot_setDefaultMotionTime(SerialRobot *robot, int sval)
{
    if (robot == NULL) {
        return -1;
    }
    robot->motionTime = sval > 0 && sval < 10000 ? sval : robot->motionTime;
    return robot->motionTime;
}

int SerialRobot_getDefaultMotionTime(const SerialRobot *robot)
{
    return robot != NULL ? robot->motionTime : -1;
}
