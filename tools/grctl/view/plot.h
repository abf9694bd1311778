/* SPDX-License-Identifier: MIT */
/* The picture of a motion: angle over time for each joint, as small multiples. */
#ifndef GRCTL_PLOT_H
#define GRCTL_PLOT_H

#include <grobo/core/motion.h>

#include "tools/grctl/view/balance.h"
#include "tools/grctl/view/svg.h"

typedef struct plot_point {
    double t_s, angle_deg;
} plot_point;

typedef struct plot_span {
    double from_s, to_s;
} plot_span;

/* What one joint does: no more points than the picture can show. */
typedef struct plot_curve {
    int joint;
    const grobo_joint *limits; /* NULL: no model knows the joint */
    const grobo_model *model;  /* the same */
    char name[GROBO_NAME_MAX_BYTES];
    bool set; /* false: no posture of the motion gives it; the rest means nothing then */
    double min_deg, max_deg, peak_speed_dps;
    plot_point *points;
    size_t n_points;
    plot_span *fast; /* faster than the servo */
    size_t n_fast;
} plot_curve;

/* A motion and what plays it: borrowed. */
typedef struct plot_subject {
    const grobo_motion *motion;
    const grobo_model *model;    /* NULL: the motion is none of its */
    const grobo_clip *clip;      /* of the motion's own keys, unless joints are solved */
    grobo_joint_mask solved;     /* joints that inverse kinematics moves: 0 for none */
    const plot_balance *balance; /* NULL: not asked for */
} plot_subject;

typedef struct plot_data {
    plot_subject of;
    double length_s;
    int n_curves;
    plot_curve curves[GROBO_JOINTS_MAX];
} plot_data;

typedef struct plot_options {
    grobo_joint_mask joints;
    int columns;    /* how many places along the time the picture can tell apart */
    double rate_hz; /* samples a second; 0: as many as the curve needs */
} plot_options;

/* Follows every joint through the motion. Returns 0 or a library error. */
int plot_collect(plot_data *data, const plot_subject *subject, const plot_options *options);
void plot_free(plot_data *data);

/* Number of postures, as the file has them. */
size_t plot_keys(const plot_data *data);
/* Posture i of them as it is played, and when. Joints it sets are those it is a key of. */
int plot_key(const plot_data *data, size_t i, grobo_posture *posture, double *t_s);

/* True if the angle is outside the joint's limits when it is rounded to the wire's 0.1 degree. */
bool plot_beyond(const plot_curve *curve);
/* An angle as people read it, in degrees or the joint's unit; and what stands behind the number. */
double plot_value(const plot_curve *curve, double angle_deg);
const char *plot_unit(const plot_curve *curve);
/* How many places along the time a picture of these joints can tell apart. */
int plot_columns(grobo_joint_mask joints);

/* Draws it. file: what the picture is of. Returns false if memory ran out. */
bool plot_draw(svg *s, const plot_data *data, const char *file);

#endif
