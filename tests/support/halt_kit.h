/* SPDX-License-Identifier: MIT */
/*
 * An engine at a far side (far_side.h), in virtual time, and a judge of stops that knows only what
 * the far side saw. A world is plain data: test_halt_matrix.c keeps one and goes on from it in
 * hundreds of ways.
 */
#ifndef GROBO_TESTS_HALT_KIT_H
#define GROBO_TESTS_HALT_KIT_H

#include <grobo/core/driver.h>
#include <grobo/core/registers.h>
#include <grobo/core/static.h>

#include "tests/support/far_side.h"

enum { HALT_MS = 1000, HALT_S = 1000000, HALT_KEYS = 3, HALT_FAMILIES = 14 };

/* A robot of one family: its joint `moved` is the one that moves, `other` one beside it. */
typedef struct halt_robot {
    const char *name; /* the family's, and what is special */
    const far_family *far;
    int baud_bps;
    grobo_driver driver;
    grobo_model model;
    grobo_joint joints[GROBO_JOINTS_MAX];
    int n_joints, moved, other;
    int64_t frame_us;   /* the longest that may be on the line: a frame, or a question and reply */
    int64_t reading_us; /* all joints in full */
    bool no_rate;       /* its line does not carry a motion at a rate and readings: refused */
} halt_robot;

/* Where a joint was when a stop was asked for, and when the first halt reached it. */
typedef struct halt_base {
    double asked_deg, asked_dps;
    double begins_deg;          /* where it was when the last frame before the stop came */
    double from_deg, to_deg;    /* where its first halt may bring it to rest, slack left out */
    bool rested;                /* it hung in its load */
    double hangs_deg, held_deg; /* where it would hang in the goal that it had */
    bool turned, halted;
    bool begins;          /* its goal came just before: its engine takes it to turn */
    bool missed;          /* it had missed a frame when the stop was asked for */
    bool excused;         /* it had missed a frame when its halt came */
    int64_t halt_left_us; /* when its first halt left the host, FAR_NEVER: none did */
    int64_t left_us;      /* it would have turned for so long */
    double done_deg, done_dps;
} halt_base;

typedef struct halt_world {
    grobo_robot robot;
    far_side far;
    int64_t now_us;
    const halt_robot *of;
    /* Jobs: the one that is awaited. */
    int awaited, result;
    bool over;
    grobo_trip trip;
    int64_t trip_us, trip_soft_us;
    bool judges_trip; /* the stop is asked for by the engine, when it trips */
    /* The stop. */
    bool judged;
    int64_t asked_us, done_us;
    int64_t ends_us; /* by what it was told since, each joint is there */
    bool streamed;   /* ways end a little before the next begins */
    bool blind;      /* the engine that stops did not send them */
    double lag_deg;  /* a joint that missed a frame may be behind by so much */
    int64_t soft_us; /* a soft stop may take so long */
    halt_base base[FAR_JOINTS];
    bool weighs; /* its joints carry a weight */
    int excused; /* broken rules that a lost frame explains */
    int judged_goals;
    double worst_deg; /* by what a joint came to rest beside where it may */
    char fault[200];  /* the first broken rule; empty: none */
} halt_world;

extern halt_world halt;
extern bool halt_traced; /* prints what is on the wire once a stop is judged */
/* Joints of worlds that begin from here on carry a weight (far_side.h), and hold it with torque. A
 * halt may keep the error that carries it, a joint at rest stays where it is, and no weight is
 * taken for a wall. */
extern bool halt_weighs;

/* Robots by their numbers; NULL behind the last. First one of each family, small and with the rate
 * of its far side; from HALT_FAMILIES on larger ones, and other rates. */
const halt_robot *halt_robot_of(int number);
const halt_robot *halt_robot_named(const char *name);
/* Whether two of its servos share a shaft: `moved` and the joint behind it. */
bool halt_is_paired(const halt_robot *robot);

/* Makes a robot of a family, by the name of one of those above, with n joints on a line of that
 * rate; it must outlive its engine, and the next one made is in its place. */
void halt_robot_make(halt_robot *robot, const char *of, int n_joints, int baud_bps);

/* An engine that has just got its line, shafts limp: `moved` at deg, all others at 0. With a weight
 * they hold, and hang below. */
void halt_begin(const halt_robot *robot, double deg);
/* The same far side gets another program's engine. */
void halt_new_engine(const grobo_robot_config *config);
void halt_run(int64_t us);
/* All joints hold, `moved` at deg; the slow first move is over. */
void halt_make_ready(double deg);
/* Lets time pass until a job is over, at most so long: its result, or GROBO_ERR_TIMEOUT. */
int halt_wait(int number, int64_t us);
/* `moved` to deg, and all other joints to 0 where asked so. */
grobo_posture halt_posture(double deg, int64_t time_us, bool whole);
int halt_joint_of(int servo); /* of the model */

/* A stop is asked for now: from here on the judge looks. */
void halt_judge(int64_t soft_us);
/* The stop was reported done. */
void halt_done(void);
/* Judges where joints came to rest, and how soon the first frame left: within bound_us. */
void halt_verdict(int64_t bound_us);
/* The most that a joint at rest may move. */
double halt_stays_deg(const far_joint *joint);
void halt_blame(const char *rule, int joint, double is, double may);

#endif
