/* SPDX-License-Identifier: MIT */
/* Keeps a posture each time that Enter is pressed, then saves them: learn DEVICE DIRECTORY NAME. */
#include <stdio.h>

#include <grobo/classic/classic.h>

int main(int argc, char **argv)
{
    if (argc != 4) {
        return 2;
    }
    GR001 robot;
    GR001_init(&robot, argv[1]);
    if (GR001_connect(&robot) < 0) {
        return 1;
    }
    SerialRobot_setMotionDir(&robot, argv[2]);
    GR001_setServo(&robot, 0, 0);
    SerialRobot_clearMotion(&robot);
    int key;
    while ((key = getchar()) != EOF) {
        if (key == '\n') {
            SerialRobot_getPosture(&robot);
            int size = SerialRobot_appendCurrentPosture_time(&robot, 500);
            printf("posture %d\n", size);
            RobotPosture_printPosture(robot.currentPosture);
        }
    }
    int saved = SerialRobot_saveMotionToM(&robot, argv[3]);
    printf("%d saved\n", saved);
    GR001_deinit(&robot);
    return 0;
}
