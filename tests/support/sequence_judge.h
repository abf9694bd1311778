/* SPDX-License-Identifier: MIT */
/*
 * Judges a sequence of requests and line events by the rules of docs/guide/safety.md, from what the
 * far side saw (far_side.h): no opinion of the engine or of the simulator counts. It is told what
 * was asked for and what the answer was; it knows from that which joints may be sent where, and
 * since when nothing but halts may leave. Plain data: a copy goes on where the other was.
 *
 *   - no goal is outside the limits of its joint, and none is faster than its joint;
 *   - no goal leads elsewhere than between where the joint is and where a request sent it;
 *   - none leaves for a joint that has not told its place since the line is there, and the first
 *     one is slow: since then, and behind an emergency stop;
 *   - an emergency stop that found no line is carried out when that is there;
 *   - behind a stop, a trip, an exit and a lost line goals are halts, until a request moves again:
 *     none sends a joint further than where it can come to rest, none wakes a joint, and what
 *     turned stands when its time is over;
 *   - the first frame of a stop leaves within a frame on the line and 10 ms;
 *   - torque comes on where the joint is, and never while a stop is latched;
 *   - what is said to stand stands; what is said to be off is off;
 *   - each job ends once, with an error that has a name.
 */
#ifndef GROBO_TESTS_SEQUENCE_JUDGE_H
#define GROBO_TESTS_SEQUENCE_JUDGE_H

#include "tests/support/halt_kit.h"

enum { SEQUENCE_NUMBERS = 256 };

/* Why a goal may lead from where a joint is not. It leads to where the joint ever was, or was sent,
 * all the same, and within its limits. */
typedef enum sequence_excuse {
    SEQUENCE_UNHEARD, /* a hand or another program turned it, or it restarted: no reply tells yet */
    SEQUENCE_DISTURBED, /* that was just now, of a servo that tells no speed */
    SEQUENCE_RESTARTED, /* its servo restarted, and has torque by a goal */
    SEQUENCE_LOST,      /* it missed a frame */
    SEQUENCE_EXCUSES
} sequence_excuse;

typedef struct sequence_joint {
    bool licensed;              /* a request moves it */
    bool soft;                  /* its next move is the first, and slow */
    double lo_deg, hi_deg;      /* where it may be sent: by that request, or as a halt */
    double least_deg, most_deg; /* where it ever was, or was sent by a request */
    bool
        unheard; /* a hand or another program turned it, or it restarted, and it told nothing yet */
    bool raw;    /* that request is a raw frame's: what ends a motion does not end it */
    bool raw_waits; /* that frame has not come yet: a pause does not take it back */
    double raw_deg;
    bool foreign, restarted;
    bool free;          /* a hand may move it: it brakes, and holds where it was left */
    int64_t missed_us;  /* until then it had missed a frame, and told nothing of that */
    int64_t foreign_us; /* when the last of this happened */
} sequence_joint;

typedef struct sequence_judge {
    sequence_joint joint[FAR_JOINTS];
    bool up, latched;
    bool wakes; /* torque was asked for */
    bool owed;  /* an emergency stop that was not carried out yet */
    int64_t up_us, latched_us, hot_us;
    int64_t still_by_us; /* nothing may turn then that no request moves; 0: nothing to judge */
    int64_t first_by_us; /* a frame must have left by then; 0: none must */
    int64_t halted_us;
    double soft_s;
    int exits_off; /* number of the exit that takes torque away */
    uint8_t asked[SEQUENCE_NUMBERS], ended[SEQUENCE_NUMBERS];
    int excused[SEQUENCE_EXCUSES], goals;
    char fault[200];
} sequence_judge;

extern sequence_judge sequence;

/* Behind halt_begin() or halt_new_engine(): from here on it hears the far side and the engine. */
void sequence_begin(void);
void sequence_listen(void);

/* A request was accepted that moves these joints of the model anywhere between lo and hi. */
void sequence_license(grobo_joint_mask joints, double lo_deg, double hi_deg);
void sequence_license_raw(grobo_joint_mask joints, double deg);
/* Those of which the raw frame has not come yet. */
grobo_joint_mask sequence_raw_waits(void);
/* The same, where they are: they get torque. */
void sequence_license_here(grobo_joint_mask joints);
/* From now on nothing but halts; soft_us: they may take so long. at_once: one must leave now. */
void sequence_halt(grobo_joint_mask joints, int64_t soft_us, bool at_once);
void sequence_latch(bool latched);
void sequence_away(int64_t us); /* the host did nothing for so long */
void sequence_line(bool up);
void sequence_asked(int number);
/* A servo was restarted, or turned by a hand, or by another program's goal. */
void sequence_disturbed(int servo, bool restarted, bool foreign);

/* Judges what time has shown by now. */
void sequence_look(void);
/* All is over: no job is left, nothing turns. */
void sequence_verdict(void);
void sequence_blame(const char *rule, int servo, double is, double may);

#endif
