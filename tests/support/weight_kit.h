/* SPDX-License-Identifier: MIT */
/*
 * The engine and a simulated robot that has weight, in virtual time: an arm that holds itself, at
 * the gains of its servos, and commands that come and leave.
 *
 * Environment: GROBO_PLANT="IN,OUT": the links are in another process, behind these descriptors
 * (tests/physics/mujoco_plant.py).
 */
#ifndef GROBO_TEST_WEIGHT_KIT_H
#define GROBO_TEST_WEIGHT_KIT_H

#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/robot_file.h>

enum { WEIGHT_MS = 1000, WEIGHT_S = 1000000 };

typedef struct weight_world {
    grobo_sim sim;
    grobo_robot robot;
    grobo_driver driver;
    const grobo_robot_def *def;
    grobo_sim_physics *physics;
    grobo_robot_sim setting;
    int64_t now_us;
    int ended, result; /* the job that ended last */
    int64_t ended_us;
    grobo_trip tripped; /* since weight_new_engine() */
    int tripped_joint;
    int64_t tripped_us;
    unsigned lose; /* so many of the next frames do not arrive */
} weight_world;

extern weight_world weight;

/* A robot of the library that holds itself at its initial posture, and stands; P of its servos is
 * `gain` where they have such a register, 0: what they come with. An engine that knows nothing of
 * it is linked. */
void weight_begin(const char *robot, int gain);
/* The same of a robot of a file, borrowed. */
void weight_begin_def(const grobo_robot_def *def, int gain);
void weight_finish(void);
/* Lets time pass. */
void weight_run(int64_t us);
/* Lets time pass until a job ends, 60 s at most. @return its result */
int weight_wait(int job);
/* The same of one that may have been refused, or be none: then no time passes. */
void weight_wait_if(int job);
/* As a new command meets the robot: an engine that knows nothing of it. */
void weight_new_engine(void);
/* Where the joint's servo is, as the simulator has it. */
double weight_angle_deg(int joint);
/* The goal in its registers; of servos of 4096 steps a turn, the middle at 2048. */
double weight_goal_deg(int joint);
/* The torque of its links on it, Nm. */
double weight_load_nm(int joint);
/* A target of one joint. */
grobo_posture weight_target(int joint, double deg, int ms);
/* Moves it and waits for the end. @return the job's result, or why it was refused */
int weight_move(int joint, double deg, int ms);
/* What leaves an arm at rest where it is: a new engine, torque where it is on, a command that is
 * refused and leaves. @return its name */
enum { WEIGHT_NOTHINGS = 3 };
const char *weight_do_nothing(unsigned which);
/* The torque of all. @return the job's result */
int weight_torque(grobo_torque mode);

#endif
