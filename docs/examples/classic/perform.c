/* SPDX-License-Identifier: MIT */
/* Plays a motion: perform DEVICE DIRECTORY NAME TIMES; negative times in reverse. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <grobo/classic/classic.h>

int main(int argc, char **argv)
{
    if (argc != 5) {
        return 2;
    }
    GR001 *robot = GR001_new(argv[1]);
    if (GR001_connect(robot) < 0) {
        fprintf(stderr, "no robot\n");
        return 1;
    }
    SerialRobot_startThread(robot);
    SerialRobot_setMotionDir(robot, argv[2]);
    GR001_setServo(robot, 1, 0);
    int postures = SerialRobot_loadMotion(robot, argv[3]);
    if (postures < 0) {
        fprintf(stderr, "no motion\n");
        GR001_delete(robot);
        return 1;
    }
    printf("%d postures\n", postures);
    SerialRobot_setMotionCount(robot, (int)strtol(argv[4], NULL, 10));
    while (SerialRobot_isMoving(robot)) {
        usleep(10000);
    }
    SerialRobot_initPosition(robot);
    while (SerialRobot_isMoving(robot)) {
        usleep(10000);
    }
    GR001_delete(robot);
    return 0;
}
