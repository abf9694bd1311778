/* SPDX-License-Identifier: MIT */
/*
 * The command under test ($GRCTL) as a child process, on a simulated robot behind a pty in this
 * process, which notes every frame that comes with its time. The frames are told apart by the
 * reference's table of the board, not by the library.
 */
#ifndef GROBO_TESTS_SPY_H
#define GROBO_TESTS_SPY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

#include <event2/event.h>

#include <grobo/sim_server.h>

enum { SPY_FRAMES = 8192, SPY_FRAME_BYTES = 2 + UINT8_MAX, SPY_POSE_BYTES = 110 };

typedef struct spy_frame {
    int64_t at_us;
    size_t size;
    uint8_t bytes[SPY_FRAME_BYTES];
} spy_frame;

typedef struct spy spy;
struct spy {
    struct event_base *base;
    grobo_sim_server *server;
    struct event *ended;
    spy_frame *poses; /* those of 110 bytes that set 20 goals */
    size_t n_poses;
    uint64_t bytes;         /* all that came */
    void (*on_pose)(spy *); /* after each, or NULL */
    uint8_t part[SPY_FRAME_BYTES];
    size_t part_size;
    pid_t child;
    bool running;
    int status;      /* exit status; 128 and the signal's number */
    char out[16384]; /* what it printed */
    FILE *file;
};

/* Starts the robot. sim: as of grobo_sim_server_config. False: it could not. */
bool spy_open(spy *s, const grobo_sim_config *sim);

/*
 * Runs "$GRCTL -d PTY ARGUMENTS..." (ended by NULL) until it ends; returns its exit status, or -1
 * when it could not be run, or did not end within limit_s and was killed.
 */
int spy_run(spy *s, const char *const *arguments, int limit_s);

void spy_close(spy *s);

/* Of a pose frame: the angle of a motor (1..20) in 0.1 degree, its time in 10 ms. */
int spy_angle_ddeg(const spy_frame *frame, int motor);
int spy_time_cs(const spy_frame *frame, int motor);

#endif
