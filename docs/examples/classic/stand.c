/* SPDX-License-Identifier: MIT */
/* Has the robot stand, tells where it is, and lets it go. */
#include <stdio.h>
#include <unistd.h>

#include <grobo/classic/classic.h>

int main(int argc, char **argv)
{
    GR001 *robot = GR001_new(argc > 1 ? argv[1] : "/dev/ttyUSB0");
    if (GR001_connect(robot) < 0) {
        fprintf(stderr, "no robot\n");
        return 1;
    }
    SerialRobot_startThread(robot);
    GR001_setServo(robot, 1, 0);
    RobotPosture_setMotionTime(robot->initPosture, 1000);
    SerialRobot_initPosition(robot);
    while (SerialRobot_isMoving(robot)) {
        usleep(10000);
    }
    SerialRobot_getPosture(robot);
    GR001_printPosture(robot);
    GR001_printVolts(robot, 0);
    GR001_setServo(robot, 2, 0);
    GR001_delete(robot);
    return 0;
}
