/* SPDX-License-Identifier: MIT */
/* An event loop run for a bounded time, and a robot on it. */
#ifndef TESTS_SUPPORT_LOOP_H
#define TESTS_SUPPORT_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include <grobo/sim_server.h>

/* Runs the loop until a callback breaks it; true when span_us passed instead. */
bool loop_run(struct event_base *base, int64_t span_us);

/* Lets time pass, whatever breaks the loop meanwhile. */
void loop_run_for(struct event_base *base, int64_t span_us);

/* Runs it until callbacks have counted so far; fails the test where that takes 20 s. */
void loop_run_until(struct event_base *base, const int *count, int wanted);

/* Serves a simulated robot on it. */
grobo_sim_server *loop_serve(struct event_base *base, grobo_sim_server_config config);

#endif
