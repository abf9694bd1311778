/* SPDX-License-Identifier: MIT */
/* A console: each line a letter and numbers, q to quit. */
#include <stdio.h>
#include <unistd.h>

#include <grobo/classic/classic.h>

static void wait_for(GR001 *robot)
{
    while (SerialRobot_isMoving(robot)) {
        usleep(10000);
    }
}

static void carry_out(GR001 *robot, char *line)
{
    int id;
    int angle;
    int time;
    int times = 1;
    char name[64];
    switch (line[0]) {
    case 'i': /* stand */
        SerialRobot_initPosition(robot);
        break;
    case 's': /* servos on or off: s 1 */
        if (sscanf(line, "s %d", &id) == 1) {
            GR001_setServo(robot, (char)id, 0);
        }
        break;
    case 'm': /* a motor: m ID ANGLE TIME */
        if (sscanf(line, "m %d %d %d", &id, &angle, &time) == 3) {
            GR001_moveJoint(robot, (unsigned char)id, (short)angle, (unsigned short)time);
        }
        break;
    case 'p': /* all motors: p TIME ANGLE... */
        GR001_setJointsFromString(robot, line + 1);
        SerialRobot_startMotion(robot);
        break;
    case 'l': /* load a motion: l NAME */
        if (sscanf(line, "l %63s", name) == 1) {
            printf("%d\n", SerialRobot_loadMotion(robot, name));
        }
        break;
    case 'r': /* play it: r TIMES */
        (void)sscanf(line, "r %d", &times);
        SerialRobot_setMotionCount(robot, times);
        break;
    case 'c': /* keep the posture, save all: c NAME */
        SerialRobot_getPosture(robot);
        SerialRobot_appendCurrentPosture(robot);
        if (sscanf(line, "c %63s", name) == 1) {
            SerialRobot_saveMotionToM(robot, name);
        }
        break;
    case 'a': /* an angle: a ID */
        if (sscanf(line, "a %d", &id) == 1) {
            printf("%d\n", GR001_getAngle(robot, (unsigned char)id));
        }
        break;
    }
    wait_for(robot);
}

int main(int argc, char **argv)
{
    char line[1024];
    GR001 *robot = GR001_new(argc > 1 ? argv[1] : "/dev/ttyUSB0");
    if (GR001_connect(robot) < 0 || SerialRobot_startThread(robot) == 0) {
        fprintf(stderr, "no robot\n");
        return 1;
    }
    SerialRobot_setMotionDir(robot, argc > 2 ? argv[2] : "motion");
    while (fgets(line, sizeof line, stdin) && line[0] != 'q') {
        carry_out(robot, line);
    }
    GR001_setServo(robot, 2, 0);
    GR001_delete(robot);
    return 0;
}
