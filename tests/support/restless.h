/* SPDX-License-Identifier: MIT */
/*
 * A restless user of a robot: asks for everything that the engine offers at random moments, one
 * thing at a time or several at once, between pump calls and from within callbacks, and reports
 * each answer to the judge. A hand pushes and turns joints meanwhile.
 */
#ifndef GROBO_TEST_RESTLESS_H
#define GROBO_TEST_RESTLESS_H

#include "tests/support/judge.h"

/* What is asked for: X(name, weight). */
#define RESTLESS_LIST(X)                                                                           \
    X(move, 10)                                                                                    \
    X(play, 10)                                                                                    \
    X(enqueue, 8)                                                                                  \
    X(send, 3)                                                                                     \
    X(stream, 5)                                                                                   \
    X(torque, 6)                                                                                   \
    X(raw_goal, 12)                                                                                \
    X(raw_torque, 3)                                                                               \
    X(raw_other, 3)                                                                                \
    X(registers, 4)                                                                                \
    X(command, 2)                                                                                  \
    X(stored, 1)                                                                                   \
    X(sense, 2)                                                                                    \
    X(check, 1)                                                                                    \
    X(free, 4)                                                                                     \
    X(control, 8)                                                                                  \
    X(stop, 6)                                                                                     \
    X(cancel, 3)                                                                                   \
    X(estop, 2)                                                                                    \
    X(exit, 2)

enum {
#define RESTLESS_ENUM(name, weight) RESTLESS_##name,
    RESTLESS_LIST(RESTLESS_ENUM)
#undef RESTLESS_ENUM
        RESTLESS_KINDS
};

enum { RESTLESS_CLIPS = 3 };

typedef struct restless {
    grobo_test_rig *rig;
    judge judge;
    uint32_t random;
    rig_clip clips[RESTLESS_CLIPS];
    unsigned requests;      /* made in this run */
    bool asking;            /* a request is being made: callbacks within it make none */
    int asked_by;           /* kind of the request being made */
    grobo_joint_mask moved; /* by the last move */
    /* A control loop of the user's own, which sends a target every 20 ms. */
    int64_t stream_until_us;
    int stream_joint;
    double stream_deg, stream_dps;
    /* A hand at a joint. */
    int hand_joint; /* or -1 */
    int64_t hand_until_us;
    /* Of all runs. */
    unsigned asked[RESTLESS_KINDS], accepted[RESTLESS_KINDS], in_callbacks;
    unsigned moves, plays, trips; /* that ended well, and stops for safety */
} restless;

/* Name of a kind of request. */
const char *restless_name(int kind);
/* Takes over a rig just started: its hooks, its context. */
void restless_start(restless *u, grobo_test_rig *rig, uint32_t seed);
/* Lives for this time, or until the line has ruined the robot, and waits for all jobs to end.
 * @return how long it lived. */
int64_t restless_live(restless *u, int64_t length_us);

/* ---- between restless.c and restless_raw.c --------------------------------------------------- */

/* What an accepted request does to the robot. */
typedef enum restless_effect { RESTLESS_NOTHING, RESTLESS_MOVES } restless_effect;

/* A number below n. */
uint32_t restless_pick(restless *u, uint32_t n);
/* Somewhere in, and sometimes beyond, a joint's limits. */
double restless_angle_deg(restless *u, int joint);
/* Notes and reports an answer; kind NONE: the request is no job. */
void restless_told(restless *u, grobo_job_kind kind, int result, restless_effect effect);

void restless_raw_goal(restless *u);
void restless_raw_torque(restless *u);
void restless_raw_other(restless *u);
void restless_registers(restless *u);

#endif
