/* SPDX-License-Identifier: MIT */
/* What the files of the classic shelf share: ids and orders, waiting, what was read. */
#include <math.h>
#include <stddef.h>

#include <grobo/core/runner.h>

#include "src/classic/classic.h"

/* ---- the runner --------------------------------------------------------------------------- */

int SerialRobot_error(const SerialRobot *robot)
{
    return robot != NULL && robot->inside != NULL ? robot->inside->error : GROBO_ERR_ARG;
}

int SerialRobot_errorText(const SerialRobot *robot, char *text, size_t room)
{
    int n =
        SerialRobot_runner(robot) != NULL
            ? grobo_robot_error_text(grobo_classic_engine(robot), robot->inside->error, text, room)
            : -1;

    return n < 0 ? -1 : n;
}

grobo_runner *SerialRobot_runner(const SerialRobot *robot)
{
    return robot != NULL && robot->inside != NULL ? robot->inside->runner : NULL;
}

typedef struct locked_call {
    int (*fn)(void *arg);
    void *arg;
} locked_call;

static int call_locked(void *arg, grobo_runner *runner)
{
    const locked_call *call = arg;

    (void)runner;
    return call->fn(call->arg);
}

int SerialRobot_locked(SerialRobot *robot, int (*fn)(void *arg), void *arg)
{
    locked_call call = {fn, arg};

    return fn == NULL ? GROBO_ERR_ARG
                      : grobo_runner_call(SerialRobot_runner(robot), call_locked, &call);
}

/* ---- ids and orders ----------------------------------------------------------------------- */

int grobo_classic_joint(const SerialRobot *robot, int id)
{
    return id > 0 && id <= robot->joints ? robot->inside->joint_of[id - 1] : GROBO_ERR_NOTFOUND;
}

void grobo_classic_to_joints(const SerialRobot *robot, const RobotPosture *from, grobo_posture *to)
{
    (void)grobo_posture_init(to, robot->joints);
    for (int id = 1; id <= robot->joints && id <= from->numJoints; id++) {
        int joint = robot->inside->joint_of[id - 1];
        (void)grobo_posture_set_rad(to, joint, grobo_classic_rad(from->jointAngles[id - 1]));
    }
    to->time_us = grobo_classic_time_us(from->motionTime);
}

void grobo_classic_to_motors(const SerialRobot *robot, const grobo_posture *from, RobotPosture *to)
{
    for (int id = 1; id <= robot->joints; id++) {
        int joint = robot->inside->joint_of[id - 1];
        if ((from->set & GROBO_JOINT_BIT(joint)) != 0) {
            RobotPosture_setRad(to, id, from->angle_rad[joint]);
        }
    }
}

int64_t grobo_classic_time_us(double time_ms)
{
    return time_ms >= 1 && time_ms < 10000 ? llround(time_ms * 1000) : 0;
}

/* ---- waiting, reading --------------------------------------------------------------------- */

static int start(void *arg, grobo_runner *runner)
{
    classic_request *request = arg;

    return request->start(request, grobo_runner_robot(runner));
}

int grobo_classic_ask(SerialRobot *robot, classic_request request)
{
    request.robot = robot;
    request.end_us = grobo_now_us() + GROBO_RUNNER_TIMEOUT_US;
    return grobo_classic_end(
        robot,
        grobo_runner_request(robot->inside->runner, start, &request, GROBO_RUNNER_TIMEOUT_US), 0);
}

static unsigned short bounded(int32_t value)
{
    return (unsigned short)(value < 0 ? 0 : value < UINT16_MAX ? value : UINT16_MAX);
}

int grobo_classic_refresh(SerialRobot *robot)
{
    const grobo_robot *engine = grobo_classic_engine(robot);
    grobo_posture sensed;
    int n = grobo_robot_posture(engine, GROBO_NEVER_US, &sensed);

    grobo_classic_to_motors(robot, &sensed, &robot->inside->current);
    for (int id = 1; id <= robot->joints; id++) {
        grobo_joint_info info;
        if (grobo_robot_joint(engine, robot->inside->joint_of[id - 1], &info) < 0) {
            continue;
        }
        if (info.torque_known) {
            robot->servoState[id - 1] = (char)info.state.torque;
        }
        if ((info.state.valid & GROBO_FIELD_VOLTAGE) != 0) {
            robot->Volts[id - 1] = bounded(info.state.voltage_mv / 10);
        }
        if ((info.state.valid & GROBO_FIELD_CURRENT) != 0) {
            robot->Currents[id - 1] = bounded(info.state.current_ma);
        }
    }
    return n;
}
