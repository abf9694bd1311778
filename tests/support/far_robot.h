/* SPDX-License-Identifier: MIT */
/* A simulated robot behind a pseudo-terminal, served by a thread of its own. */
#ifndef GROBO_TESTS_FAR_ROBOT_H
#define GROBO_TESTS_FAR_ROBOT_H

#include <grobo/core/port.h>
#include <grobo/sim_server.h>

/* Its line: the fastest that an emulator of another machine passes on. */
enum { FAR_ROBOT_BPS = 460800 };

typedef struct far_robot {
    char link[128]; /* the device to open */
    grobo_thread thread;
    int ours, its; /* ends of a socket: orders and their answers */
    struct event_base *base;
    grobo_sim_server *server;
} far_robot;

/* Starts it; fails the test where that does not work. */
void far_robot_start(far_robot *robot, const char *link);

/* Takes the cable out, or puts it back. */
void far_robot_plug(far_robot *robot, bool in);

/* Number of its servos whose torque is on. */
int far_robot_torqued(far_robot *robot);

/* Ends it. */
void far_robot_end(far_robot *robot);

#endif
