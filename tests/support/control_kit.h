/* SPDX-License-Identifier: MIT */
/* A control over the simulator for tests, with or without its thread, and a folder for motions. */
#ifndef GROBO_TESTS_CONTROL_KIT_H
#define GROBO_TESTS_CONTROL_KIT_H

#include <grobo/thread.h>

#define ELBOW 13
#define EVERY_JOINT GROBO_JOINTS_ALL(20)

/* What the set-ups make; its motions are in the folder of folder.h. */
extern grobo_control *control;

/* cmocka's set-ups and tear-down: a control without a thread, and one with it. */
int control_set_up(void **state);
int control_set_up_threaded(void **state);
int control_tear_down(void **state);

/* Both of them, as entries of a table of tests. */
#define WITH_AND_WITHOUT_THREAD(test)                                                              \
    cmocka_unit_test_setup_teardown(test, control_set_up, control_tear_down),                      \
    {                                                                                              \
        "threaded: " #test, test, control_set_up_threaded, control_tear_down, NULL                 \
    }

/* Connects. */
void control_come_up(void);

/* A motion of .m's kind: the elbow at 2, 4, 6... degrees, each 40 ms after the one before. */
void control_have_motion(int n);

/* Postures of the current motion. */
int control_motion_size(grobo_control *of);

/* Reads the elbow's angle and compares. */
void control_assert_elbow_at(double angle_deg);

#endif
