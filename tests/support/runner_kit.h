/* SPDX-License-Identifier: MIT */
/* A runner over the simulator for tests, with or without its thread, and a folder for motions. */
#ifndef GROBO_TESTS_RUNNER_KIT_H
#define GROBO_TESTS_RUNNER_KIT_H

#include <grobo/core/runner.h>

#include "tests/support/test.h"

#define ELBOW 13
#define EVERY_JOINT GROBO_JOINTS_ALL(20)

/* What the set-ups make; its motions are in the folder of folder.h. */
extern grobo_runner *runner;

int runner_set_up(void);
int runner_set_up_threaded(void);
int runner_tear_down(void);

/* A runner without a thread, and one with it. */
extern const test_fixture with_and_without_thread[2];

/* Connects. */
void runner_come_up(void);

/* A motion of .m's kind: the elbow at 2, 4, 6... degrees, each 40 ms after the one before. */
void runner_have_motion(int n);

/* Postures of the current motion. */
int runner_motion_size(grobo_runner *of);

/* Reads the elbow's angle and compares. */
void runner_assert_elbow_at(double angle_deg);

#endif
