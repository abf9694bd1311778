/* SPDX-License-Identifier: MIT */
/* A runner over the simulator whose on_svc a test can hold, and what its callbacks saw. */
#ifndef GROBO_TESTS_STOP_KIT_H
#define GROBO_TESTS_STOP_KIT_H

#include "tests/support/hold.h"
#include "tests/support/runner_kit.h"

/* A call gives up after SHORT_US; LONG_US is longer than a test; motions take STOP_US to stop. GOAL
 * and TORQUE are addresses of registers. */
enum { SHORT_US = 20000, LONG_US = 60000000, STOP_US = 1000000, GOAL = 0x1E, TORQUE = 0x24 };

/* What callbacks saw: `saw` belongs to the loop, `told` is the test's copy of it. */
struct saw {
    int estops, exits, trips; /* events */
    int exit_result, estop_result;
    int64_t stop_us; /* how long a motion took to stop */
    int goals;       /* frames sent */
    int first;       /* address of the first frame after `listen`, 0 none yet, -1 no such frame */
    bool listen;
};
extern struct saw saw, told;

/* Where on_svc is held. */
extern hold gate;

/* A lock of the program's, which on_svc takes too. */
extern grobo_mutex users;

/* What on_svc calls, once, when it is not held; and the result. Set while it is held. */
extern int (*in_callback)(grobo_runner *from);
extern int callback_result;

/* Makes the runner; starts its thread too, connects, and switches torque on; frees it. */
void stop_kit_make(grobo_runner_config config);
void stop_kit_start(grobo_runner_config config);
void stop_kit_end(void);

/* For grobo_runner_call(): copies `saw`; whether a stop is latched; sets `listen`. */
int copy_seen(void *arg, grobo_runner *from);
int tripped(void *arg, grobo_runner *from);
int begin_to_listen(void *arg, grobo_runner *from);

/* Return when a move, or a motion, is under way that lasts longer than any test. */
void move_for_long(void);
void play_for_long(void);

/* The stop is carried out and verified, and all joints are braked. */
void assert_stopped(int estops);

/* A call on a thread of its own. */
typedef struct caller {
    grobo_thread thread;
    int (*call)(grobo_runner *from);
    int result;
} caller;

/* Starts it, and returns when `slots` calls wait for the loop. */
void begin_call(caller *c, int (*call)(grobo_runner *from), int slots);

/* Waits for it. @return its result. */
int end_call(caller *c);

#endif
