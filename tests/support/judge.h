/* SPDX-License-Identifier: MIT */
/*
 * The rules of safety, judged from outside the engine: by the requests and their answers, by the
 * frames that leave, and by what the simulated servos then do. The engine's own belief counts for
 * nothing here.
 *
 * A goal and a torque are judged twice. When the frame leaves, the rig looks at limits and speed
 * and the judge at what the caller asked for: nothing leaves after a stop. When the servo takes
 * it, the judge looks at where the shaft is: no goal is faster than its joint, no torque comes on
 * away from the goal. A joint is excused while a frame to it was lost (it is "parted" from where
 * the engine must take it to be), and from a hand for as far as the hand turned it unseen.
 *
 * A broken rule fails the test. The judge keeps the last frames and requests in its chronicle.
 */
#ifndef GROBO_TEST_JUDGE_H
#define GROBO_TEST_JUDGE_H

#include "tests/support/chronicle.h"
#include "tests/support/rig.h"

enum { JUDGE_JOBS = 64, JUDGE_RAWS = 64, JUDGE_FLYING = 16 };

/* A goal that left and that its servo has not taken yet. */
typedef struct judge_goal {
    int64_t left_us;
    int32_t ddeg;
    int32_t time_cs;   /* -1: the frame names none */
    double at_deg;     /* where the joint was when it left */
    double before_deg; /* where the joint is then if all that left before was taken */
    int64_t due_us;    /* when its servo takes it, if nothing holds it back */
} judge_goal;

typedef struct judge_axis {
    judge_goal flying[JUDGE_FLYING]; /* the oldest first */
    unsigned n_flying;
    bool sent;               /* since the line was last there */
    bool by_raw;             /* sent where it is going by a raw frame */
    bool halt_owed;          /* a stop was asked for while it moved: one goal may leave for that */
    int64_t halts_until_us;  /* and one for each stop that was asked for beside it, until then */
    bool parted;             /* a goal was lost, and the joint is not where it was sent */
    double from_deg, to_deg; /* the way that it was sent on last, */
    int64_t from_us, to_us;  /* taken to begin when the frame left */
    double goal_deg;         /* in the servo's register */
    double read_deg;         /* the last reading that the engine believed */
    int64_t turned_us;       /* a hand turns the joint until then */
} judge_axis;

/* A raw frame that a caller handed over. */
typedef struct judge_raw {
    int job;    /* its number; 0: refused */
    bool stale; /* refused, ended, or stopped: it must not leave any more */
    bool moves; /* it has a goal or switches torque on: a stop takes it back */
    size_t n;
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
} judge_raw;

typedef struct judge_job {
    int number;
    grobo_job_kind kind;
    int64_t asked_us;
    grobo_exit_policy policy; /* of an exit */
} judge_job;

typedef struct judge {
    grobo_test_rig *rig;
    chronicle notes;
    judge_axis axes[GROBO_JOINTS_MAX];
    judge_job jobs[JUDGE_JOBS]; /* those that have not ended */
    size_t n_jobs;
    judge_raw raws[JUDGE_RAWS]; /* ring */
    unsigned n_raws;
    bool leaves_raw;              /* the frame that leaves is one of these */
    int64_t wire_us;              /* how long it is on its way to the servos */
    bool latched;                 /* a latched stop, until its reset */
    bool by_estop;                /* an emergency stop among them */
    bool resting;                 /* stopped, and nobody asked for a motion since */
    bool smooth;                  /* that stop goes on a little */
    grobo_joint_mask rest_joints; /* the joints that it stops */
    bool made_up;                 /* the engine carries out an emergency stop that found no line */
    bool rest_looked;             /* it was looked at whether the joints stand still */
    int64_t rest_us;              /* since when */
    bool estop_waits;             /* its first frame has not left */
    int64_t estop_us;             /* when it was asked for, or the line came back */
    unsigned excused;             /* goals and torques of joints that were parted or misled */
    unsigned jobs_ended, rests, estops, exits, raws_void;
    int64_t estop_worst_us, exit_worst_us; /* longest, until their jobs ended */
} judge;

/* Begins with a rig just started; the hooks of the rig are the caller's and call the judge. */
void judge_start(judge *w, grobo_test_rig *rig);

/* ---- what the caller does: call with the answer to each request ------------------------------ */

/* A request was accepted as a job. */
void judge_job_began(judge *w, int number, grobo_job_kind kind);
/* Somebody asked for something that moves joints: a rest ends. */
void judge_motion_asked(judge *w);
/* A stop of these joints was asked for and accepted; a smooth one goes on a little. */
void judge_stop_asked(judge *w, grobo_joint_mask joints, bool smooth);
/* What moves is halted, by a request that ends no motion of others. */
void judge_halts_asked(judge *w);
/* Raw frames that wait must not leave any more: those that move, or all. */
void judge_raws_stopped(judge *w, bool all);
/* grobo_robot_raw() gave this result. */
void judge_raw_asked(judge *w, const uint8_t *bytes, size_t n, int result);
/* grobo_robot_estop() gave this result. */
void judge_estop_asked(judge *w, int result);
/* grobo_robot_exit() was accepted. */
void judge_exit_asked(judge *w, int number, grobo_exit_policy policy);
/* grobo_robot_reset() was accepted. */
void judge_reset_done(judge *w);
/* The host did nothing for this time. */
void judge_stalled(judge *w, int64_t us);
/* A hand turns a joint until then. */
void judge_turned(judge *w, int joint, int64_t until_us);

/* ---- what the rig tells ---------------------------------------------------------------------- */

void judge_frame(judge *w, const uint8_t *bytes, size_t n);
void judge_event(judge *w, const grobo_event *event);
void judge_sim(judge *w, const grobo_sim_event *event);
/* Looks at bounds; call at least every 20 ms. */
void judge_look(judge *w);
/* Nobody asked for anything for a while: fails where a job has not ended. */
void judge_end(judge *w);

/* ---- judge_servo.c --------------------------------------------------------------------------- */

/* A goal leaves for a joint. */
void judge_goal_left(judge *w, int joint, int32_t ddeg, int32_t time_cs);
/* By how much a goal may be away from the joint that it holds, in degrees. */
double judge_hold_deg(judge *w, int joint);
/* What a servo does. */
void judge_servo(judge *w, const grobo_sim_event *event);
/* True if the line explains what a joint does: a frame to it was lost or made up. */
bool judge_excused(judge *w, int joint);
/* What a line that has gone carried is lost. */
void judge_lost_all(judge *w);
/* Name of a joint of the rig's model. */
const char *judge_name(const judge *w, int joint);
grobo_sim_view judge_view(judge *w, int joint);

#endif
