/* SPDX-License-Identifier: MIT */
/* Shakes its head three times: motor 2 is NECK_Y. */
#include <stdio.h>
#include <unistd.h>

#include <grobo/classic/classic.h>

static void turn_to(GR001 *robot, short angle)
{
    SerialRobot_setJoint(robot, 2, angle);
    SerialRobot_setMotionTime(robot, 300);
    SerialRobot_startMotion(robot);
    while (SerialRobot_isMoving(robot)) {
        usleep(10000);
    }
    printf("neck at %d\n", GR001_getAngle(robot, 2));
}

int main(int argc, char **argv)
{
    GR001 robot;
    GR001_init(&robot, argc > 1 ? argv[1] : "/dev/ttyUSB0");
    if (GR001_connect(&robot) < 0 || SerialRobot_startThread(&robot) == 0) {
        return 1;
    }
    GR001_setServo(&robot, 1, 0);
    RobotPosture_copyPosture(robot.targetPosture, robot.initPosture);
    for (int i = 0; i < 3; i++) {
        turn_to(&robot, 200);
        turn_to(&robot, -200);
    }
    turn_to(&robot, 0);
    GR001_setServo(&robot, 2, 0);
    GR001_deinit(&robot);
    return 0;
}
