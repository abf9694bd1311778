/* SPDX-License-Identifier: MIT */
/* What the statements of docs/guide/from-original.md are about; original.sh puts them behind it,
 * each into a function of its own. */
#include <string.h>

#include <grobo/grobo.h>

extern grobo_serial *serial;
extern grobo_serial_config serial_config;
extern grobo_posture posture, other;
extern grobo_motion *motion, *copy;
extern grobo_clip clip;
extern grobo_runner *runner;
extern grobo_runner_config config;
extern grobo_session *session;
extern grobo_session_config session_config;
extern grobo_robot *robot;
extern grobo_driver driver;
extern const grobo_driver *other_driver;
extern const grobo_model *model;
extern grobo_hrpsys hrpsys;
extern grobo_rs30x_goal goal, goals[20];
extern grobo_thread thread;
extern double angle, angles[20];
extern int16_t degrees10[20];
extern int32_t millivolts[20], milliamperes[20];
extern int states[20], ids[2], tenths, number;
extern const char *names[2];
extern const char *line;
extern FILE *stream;
extern uint8_t bytes[256];
extern size_t n;
extern char text[256];
int function(void *arg, grobo_runner *of);
