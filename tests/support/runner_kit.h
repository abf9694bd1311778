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

/* Postures of the current motion; a copy of it, freed by the caller; whether it is played. */
int runner_motion_size(grobo_runner *of);
grobo_motion *runner_motion(grobo_runner *of);
bool runner_plays(grobo_runner *of);

/* Whether anything moves or is about to. */
bool runner_moves(grobo_runner *of);

/* Requests to the robot, and their end. */
int runner_torque(grobo_runner *of, grobo_joint_mask joints, grobo_torque mode, int64_t timeout_us);
int runner_check(grobo_runner *of, int64_t timeout_us);

/* Torque of a joint as last known, or GROBO_ERR_EMPTY. */
int runner_torque_of(grobo_runner *of, int joint);

/* Has the elbow move; time_us 0: the default time. Nobody waits for it. @return a job's number. */
int runner_move_elbow(grobo_runner *of, double angle_deg, int64_t time_us);

/* Has all joints move to 0. */
int runner_go_to_zero(grobo_runner *of);

/* Reads the elbow's angle and compares. */
void runner_assert_elbow_at(double angle_deg);

#endif
