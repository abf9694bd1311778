/* SPDX-License-Identifier: MIT */
/*
 * The far side of a servo line, written from the protocols' texts, with no code of the library and
 * none of its simulator: what it says of a stop is a second opinion. It takes bytes and the time,
 * turns shafts and answers. Families: RS30x (on a bus, and behind GR001's board), DYNAMIXEL
 * protocol 2 (X, P, PRO, XL-320) and 1 (AX, MX), Feetech STS, SM, HLS and SCS, KRS (ICS 3.6) and
 * LX-16A.
 *
 * A servo's set point goes straight to its goal in the time or at the speed that its registers
 * hold, with the ramps of servos that have them, after the dead time of its servo. The shaft is at
 * its set point, unless it carries a weight (far_weigh(), far_weight.c): then a position loop pulls
 * it there, and it lags, sags, swings, and falls without torque. Angles are the servo's, in
 * degrees; 0 is the middle of its range. Plain data: a copy of a far_side is a far side.
 */
#ifndef GROBO_TESTS_FAR_SIDE_H
#define GROBO_TESTS_FAR_SIDE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    FAR_JOINTS = 64,
    FAR_REGISTERS = 160,
    FAR_FRAME_BYTES = 1024,
    FAR_REPLY_BYTES = 260,
    FAR_FRAMES = 16,
    FAR_REPLIES = 80,
    FAR_TELLS_US = 200000, /* after a lost goal a reading shows that the shaft is elsewhere */
    FAR_NEVER = -1
};

typedef struct far_family far_family;
typedef struct far_side far_side;

/* One servo and the joint that it turns. */
typedef struct far_joint {
    const far_family *family;
    int id;
    int torque;              /* 0 off, 1 on, 2 brake (RS30x) */
    double at_deg, dps;      /* of the shaft */
    double set_deg, set_dps; /* of the set point: the same where the shaft carries no weight */
    double sag_deg;          /* its weight stretched out at 0, as an error of its loop; 0: none */
    double last_dps;         /* of the set point's last way, which ended then */
    int64_t last_us;
    double goal_deg, cruise_dps, accel_dps2; /* 0: no ramps */
    double top_dps;                          /* the servo's own speed */
    int64_t at_us;                           /* time of at_deg */
    int64_t begun_us;                        /* of the way to goal_deg */
    bool waits;                              /* a goal came, its dead time is not over */
    int64_t wakes_us;
    int64_t heard_us; /* of the watchdog */
    bool deaf;        /* it answers, and obeys nothing */
    bool missed; /* a goal or torque for it was lost, and it told nothing since that shows it */
    int celsius;
    bool wheel; /* it turns on and on with torque, so fast: Feetech and DYNAMIXEL X, P, PRO */
    double wheel_dps;
    bool leaps; /* torque came on: it goes to its goal as fast as it can */
    uint8_t reg[FAR_REGISTERS];
} far_joint;

/* What a servo was told: reported as the servo takes it. */
typedef struct far_news {
    int joint;
    bool is_goal;    /* else its torque was set */
    double goal_deg; /* of a goal */
    double ask_dps;  /* speed that it asks for from where the shaft is; 0: as fast as it can */
    int torque;      /* of torque */
    bool missed;     /* it had missed a frame, and told nothing since when this one left */
    double left_deg; /* where the shaft was when the frame left the host */
    int64_t left_us; /* and when that was */
    int64_t now_us;
} far_news;

typedef struct far_frame {
    int64_t due_us, left_us;
    int n;
    uint8_t bytes[FAR_FRAME_BYTES];
    double left_deg[FAR_JOINTS];
} far_frame;

typedef struct far_reply {
    int64_t due_us;
    int n;
    uint8_t bytes[FAR_REPLY_BYTES];
} far_reply;

/* The loop of a servo and the weight that it carries, by the error between set point and shaft. */
typedef struct far_loop {
    double rad_s,
        damping;         /* of the swing that a set point causes: its frequency, and its damping */
    double friction_deg; /* the error below which a shaft that stands does not turn */
    double most_deg;     /* the error from which on the torque does not rise */
    double weight_deg; /* the error that carries what robots of these servos have, stretched out */
} far_loop;

struct far_family {
    const char *name;
    far_loop loop;
    int baud_bps, bits_a_byte; /* as sold, or as robots have it */
    bool echo;                 /* the host hears itself */
    int64_t dead_us;           /* from a goal to the first turn */
    int64_t think_us;
    double top_dps;
    double step_deg;  /* of a goal on the wire */
    double count_dps; /* of a speed on the wire, which hosts round up; 0: it has times */
    /* Bytes of the first frame in n; 0: more must come; -1: the first byte begins no frame. */
    int (*measure)(const uint8_t *bytes, int n);
    bool (*sound)(const uint8_t *frame, int n);
    bool (*moves)(const uint8_t *frame, int n); /* a goal or a torque */
    int64_t (*relay_us)(const far_side *far, const uint8_t *frame,
                        int n); /* on the way behind the line; NULL: none */
    void (*obey)(far_side *far, const uint8_t *frame, int n);
    void (*begin)(far_joint *joint); /* registers at power-on */
    /* Cruise and ramps of the way to the goal that the registers hold; *ask_dps: what they ask. */
    void (*plan)(const far_joint *joint, double *goal_deg, double *cruise_dps, double *accel_dps2);
    /* Writes a goal into the registers, as another program did: dps 0 is where it stands. */
    void (*hold)(far_joint *joint, double deg, double dps, int64_t now_us);
    /* What a servo does by itself once it was not spoken to; NULL: nothing. */
    void (*watch)(far_joint *joint, int64_t now_us);
};

extern const far_family far_board, far_bus, far_dxl2, far_p, far_pro, far_xl320, far_dxl1, far_mx,
    far_sts, far_sm, far_hls, far_scs, far_ics, far_lx16a;

struct far_side {
    const far_family *family;
    int baud_bps; /* of the line; the family's, unless it is changed behind far_begin() */
    int n_joints;
    far_joint joint[FAR_JOINTS];
    uint8_t in[FAR_FRAME_BYTES];
    int n_in;
    int64_t free_us; /* the line is busy until then */
    int64_t now_us;
    far_frame frame[FAR_FRAMES];
    int n_frames;
    far_frame *obeyed; /* the frame that is being obeyed */
    bool loses;        /* it is being lost; */
    uint64_t missed;   /* by these joints */
    far_reply reply[FAR_REPLIES];
    int n_replies;
    int lose_motor;  /* motor frames until one is lost; FAR_NEVER */
    int lose_reply;  /* replies until one is lost; FAR_NEVER */
    int64_t late_us; /* the next reply is so much later */
    /* When the servo of a joint told where it is for the first time since this was FAR_NEVER. */
    int64_t told_us[FAR_JOINTS];
    bool mute; /* nobody answers */
    int frames, motor_frames, broken_frames, lost_frames;
    int64_t lost_us; /* when the last frame or reply was lost */
    /* When the first frame, and the first motor frame, left since these were FAR_NEVER. */
    int64_t first_left_us, motor_left_us;
    void (*hear)(void *ctx, const far_news *news);
    void *ctx;
};

/* ids 1 to n, shafts at 0 and limp. */
void far_begin(far_side *far, const far_family *family, int n_joints, int64_t now_us);
void far_take(far_side *far, const uint8_t *bytes, int n, int64_t now_us); /* from the host */
int far_give(far_side *far, uint8_t *bytes, int cap, int64_t now_us);      /* to the host */
int64_t far_next_us(const far_side *far); /* when it has something to do, INT64_MAX: nothing */
void far_step(far_side *far, int64_t now_us);
double far_angle(far_side *far, int joint, int64_t now_us);
/* True while the shaft turns, or will. */
bool far_turns(far_side *far, int joint, int64_t now_us);
/* Joints carry their weight from now on, which draws them to smaller angles. */
void far_weigh(far_side *far, int64_t now_us);
/* Where a joint that carries a weight hangs in a set point, friction left out; and the error that
 * carries it at an angle. */
double far_hangs_deg(const far_joint *joint, double set_deg);
double far_carries_deg(const far_joint *joint, double deg);
/* Another program's doing: where a shaft is and holds; a goal with torque, at a speed. */
void far_put(far_side *far, int joint, double deg, bool holds, int64_t now_us);
void far_foreign(far_side *far, int joint, double deg, double dps, int64_t now_us);
/* Microseconds of so many bytes. */
int64_t far_wire_us(const far_side *far, int bytes);

/* ---- for families ---------------------------------------------------------------------------- */

far_joint *far_find(far_side *far, int id);
void far_turn_to(far_joint *joint, int64_t now_us); /* brings the shaft to now */
void far_pull(far_joint *joint, double seconds);    /* of one that carries a weight, a short time */
bool far_is_moving(const far_joint *joint);         /* as its servo reports */
void far_goal(far_side *far, far_joint *joint);     /* its registers hold a new goal */
void far_torque(far_side *far, far_joint *joint, int torque);
/* Answers behind the replies that are due already; told: whose place that tells, or NULL. */
void far_answer(far_side *far, far_joint *told, const uint8_t *bytes, int n);
void far_put16(uint8_t *to, int value);
int far_get16(const uint8_t *from);
int far_signed16(const uint8_t *from);

#endif
