/* SPDX-License-Identifier: MIT */
/* What the statements of docs/guide/from-original.md are about; original.sh puts them behind it,
 * each into a function of its own. */
#include <string.h>

#include <grobo/classic/classic.h>

extern SerialCom *com;
extern RobotPosture *p, *q;
extern RobotMotion *m, *other;
extern SerialRobot *r;
extern GR001 *g;
extern grobo_driver driver_of_mine;
extern const grobo_driver *driver;
extern grobo_thread thread;
extern double angle, angles[20];
extern short degrees10[20];
extern int ids[2], number;
extern const char *names[2];
extern const char *line;
extern FILE *stream;
extern char bytes[256];
extern int n;
extern char text[256];
int function(void *arg);
int my_stabilizer(SerialRobot *robot, const RobotPosture *current, RobotPosture *target);
