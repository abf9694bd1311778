/* SPDX-License-Identifier: MIT */
/*
 * A program that moves a joint under a guard and then dies, and that guard, in the executable of a
 * test: "program MODE DEVICE" and "guard". Its lines are a word and the guard's process: "up" each
 * time the line comes, "moving" before it does what the mode says, the name of the error where the
 * line is lost, "unguarded" or "refused".
 *
 * Modes: "kill" dies of SIGKILL; "off" too, with that exit policy; "estop" too, a moment after an
 * emergency stop; "fork" too, and leaves a child that has all its descriptors; "strange" too, with
 * a driver that the guard does not know; "stop" stops itself, with torque off as its exit policy;
 * "halt" too, and does not open a lost line again; "end" ends well; "watch" goes on; "close" closes
 * the port, says "closed", and goes on; "rest" moves for a short time, says "resting", and goes on;
 * "hang" holds its loop up until it gets SIGUSR1, and goes on; "deaf" closes every descriptor but
 * its output, and goes on while it has a loop, and "dumb" does so and hangs;
 * "ask" moves as in "rest", and hangs in the callback that tells it the end of the move.
 */
#ifndef GROBO_TESTS_GUARDED_H
#define GROBO_TESTS_GUARDED_H

#include <grobo/guard.h>

/* The joint, where it is and is sent in 20 s, and the line. */
enum { GUARDED_MOTOR = 5, GUARDED_FROM_DEG = -20, GUARDED_TO_DEG = -110, GUARDED_BPS = 1000000 };

/* For sh -c: runs an executable given as $0, also one for another machine. */
extern const char guarded_again[];

/* Of main(): the exit status of the program or the guard, or -1: it is the test. */
int guarded_main(int argc, char **argv);

/* grobo_guard_new() with this executable as the guard. */
int guarded_new(const char *self, grobo_guard **guard);

#endif
