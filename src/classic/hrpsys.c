/* SPDX-License-Identifier: MIT */
/* GR001 of the classic shelf in the manner of hrpsys, in motor order. */
#include <math.h>
#include <string.h>

#include "src/classic/classic.h"

bool GR001_servo(GR001 *robot, int jid, bool turnon)
{
    return SerialRobot_jointIdToMotorId(robot, jid) >= 0 &&
           grobo_classic_torque(robot, GROBO_JOINT_BIT(jid), turnon) == 0;
}

static int ask_servo_name(classic_request *request, grobo_robot *engine)
{
    (void)engine;
    return grobo_classic_servo_name(&request->robot->inside->view, request->text,
                                    request->torque == GROBO_TORQUE_ON);
}

bool GR001_servo_name(GR001 *robot, const char *jname, bool turnon)
{
    if (SerialRobot_runner(robot) == NULL || jname == NULL) {
        return false;
    }
    const classic_request request = {.start = ask_servo_name,
                                     .text = jname,
                                     .torque = turnon ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF};

    return grobo_classic_ask(robot, request) == 0;
}

void GR001_readJointAngles(GR001 *robot, double *o_angles)
{
    double angle_rad[GROBO_JOINTS_MAX];

    if (SerialRobot_runner(robot) == NULL || o_angles == NULL) {
        return;
    }
    (void)grobo_classic_refresh(robot);
    (void)grobo_classic_read_angles(&robot->inside->view, GROBO_NEVER_US, angle_rad,
                                    GROBO_JOINTS_MAX);
    for (int id = 1; id <= robot->joints; id++) {
        o_angles[id - 1] = angle_rad[grobo_classic_joint(robot, id)];
    }
}

void GR001_writeJointCommands(GR001 *robot, const double *i_commands)
{
    for (int id = 1; robot != NULL && i_commands != NULL && id <= robot->joints; id++) {
        RobotPosture_setRad(robot->targetPosture, id, i_commands[id - 1]);
    }
}

bool GR001_checkEmergency(GR001 *robot, char *o_reason, size_t room, int *o_id)
{
    char reason[VIEW_REASON_MAX_BYTES];
    int joint = -1;

    if (SerialRobot_runner(robot) == NULL ||
        grobo_classic_emergency(&robot->inside->view, reason, sizeof reason, &joint) != 1) {
        return false;
    }
    if (o_reason != NULL && room > 0) {
        size_t length = strlen(reason) < room ? strlen(reason) : room - 1;
        memcpy(o_reason, reason, length);
        o_reason[length] = '\0';
    }
    if (o_id != NULL) {
        *o_id = SerialRobot_jointIdToMotorId(robot, joint);
    }
    return true;
}

int GR001_oneStep(GR001 *robot)
{
    return SerialRobot_startMotion(robot);
}

bool GR001_addJointGroup(GR001 *robot, const char *gname, const char *const *jnames, size_t n)
{
    return SerialRobot_runner(robot) != NULL &&
           grobo_classic_end(robot, grobo_classic_add_group(&robot->inside->view, gname, jnames, n),
                             0) == 0;
}

bool GR001_names2ids(GR001 *robot, const char *const *i_names, size_t n, int *o_ids)
{
    return SerialRobot_runner(robot) != NULL &&
           grobo_classic_end(
               robot, grobo_classic_motors_of(&robot->inside->view, i_names, n, o_ids), 0) == 0;
}
