/* SPDX-License-Identifier: MIT */
/*
 * A robot as far as something else tells it: a description for another program, or the servos that
 * were found on a line. It becomes the text of a robot's file; what is not known stands there as a
 * comment, to be filled in.
 */
#ifndef GRCTL_SKETCH_H
#define GRCTL_SKETCH_H

#include <grobo/robot_file.h>

#include "tools/grctl/cli/app.h"

enum {
    SKETCH_PARTS_MAX = 1024, /* of a description; a robot's file has fewer */
    SKETCH_TEXT_BYTES = 96,
    SKETCH_FILE_MAX_BYTES = 1 << 22
};

typedef enum sketch_motion {
    SKETCH_FIXED,
    SKETCH_TURNS,  /* a joint with a servo */
    SKETCH_WITHOUT /* it moves, but a robot's file does not have such joints: see note */
} sketch_motion;

/* A part, and the joint that carries it. */
typedef struct sketch_part {
    char name[SKETCH_TEXT_BYTES];
    char parent[SKETCH_TEXT_BYTES]; /* "": it is the first */
    char joint[SKETCH_TEXT_BYTES];  /* "": as the part is called */
    char note[SKETCH_TEXT_BYTES];   /* what is to be said of the joint, or "" */
    sketch_motion motion;
    int order; /* of joints: the smaller first; equal: as they were added */
    bool limited;
    double limits_rad[2];
    double mm_per_turn; /* a guess, of a joint that slides; else 0. Its angles are its servo's */
    double speed_rad_s; /* at most; 0: not told */
    double gear;        /* turns of the servo for one of the joint, below 0: the other way; 0: 1 */
    double origin_m[3], origin_rad[3], axis[3], mass_kg;
    double com_m[3]; /* its centre of mass, in its frame */
    double
        inertia_kgm2[6]; /* about that, along its axes: xx, yy, zz, xy, xz, yz; all 0: not told */
    char mirror[SKETCH_TEXT_BYTES]; /* part of the joint's partner in the mirror, or "": not told */
    int mirror_sign;                /* of the angle there */
    double stand_rad; /* its angle in the initial posture, as the description has it */
    /* of a joint, set by who knows */
    int id;
    bool turns; /* its servo counts several turns */
    const grobo_servo_model *servo;
    /* set by sketch_order() and sketch_fit() */
    int above;      /* index of its parent, -1 none */
    char shown[64]; /* its name in the file, and that of its joint: */
    char called[64];
    double init_rad;
    double zero_rad; /* of the servo, where its middle is not that of the joint */
} sketch_part;

/* A foot: its part, by the description's name, and the centre of its sole there. */
typedef struct sketch_foot {
    char link[SKETCH_TEXT_BYTES];
    double sole_m[3];
} sketch_foot;

typedef struct sketch {
    char name[SKETCH_TEXT_BYTES];
    char source[SKETCH_TEXT_BYTES]; /* what it was made of, for the first line */
    const grobo_robot_family *family;
    char usb[16];        /* its adapter, "1a86:55d3", or "" */
    int baud_bps;        /* 0: the factory's */
    bool guessed_servos; /* the command line does not give them */
    bool calibrated;     /* its servos keep a middle that was found by hand */
    bool as_listed;      /* joints of a URDF in its order, which is how Choreonoid numbers them */
    bool bare;           /* parts are joints alone, and have no geometry */
    int n, n_joints, n_feet;
    sketch_foot foot[2];          /* of a robot that stands on two */
    int along[SKETCH_PARTS_MAX];  /* parts, each behind its parent */
    int joints[SKETCH_PARTS_MAX]; /* parts that turn, in the order of joints */
    sketch_part part[SKETCH_PARTS_MAX];
} sketch;

/* A new part with an axis along x (URDF and Choreonoid have others), or NULL: there is no room. */
sketch_part *sketch_add(sketch *s);

/* Puts parts behind their parents and gives them names that a robot's file takes. False with one
 * line of complaint. */
bool sketch_order(sketch *s, char *complaint, size_t capacity);

/* After it: number of joints, and joint number i as the file has them, NULL behind the last. */
int sketch_joints(const sketch *s);
sketch_part *sketch_joint(sketch *s, int i);

/* Once joints have servos and ids: what each can reach. False with one line of complaint. */
bool sketch_fit(sketch *s, char *complaint, size_t capacity);

/* The file, to be freed; NULL: there is no memory. */
char *sketch_text(sketch *s);
/* That text as a robot: as of grobo_robot_def_read(). */
int sketch_read_back(const char *text, grobo_diagnostics *list, grobo_robot_def **def);

/* Turns an inertia from axes that are turned by roll, pitch and yaw. */
void sketch_turn_inertia(double inertia_kgm2[6], const double rpy_rad[3]);

/* Reads a URDF, or Choreonoid's body. False with one line of complaint: "FILE:LINE: ...". */
bool sketch_read_urdf(sketch *s, const char *path, const char *bytes, size_t size, char *complaint,
                      size_t capacity);
bool sketch_read_body(sketch *s, const char *path, const char *bytes, size_t size, char *complaint,
                      size_t capacity);

#endif
