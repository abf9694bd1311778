/* SPDX-License-Identifier: MIT */
/* A ref of .pseq and .mseq while it is read. */
#ifndef GROBO_MOTION_POSE_H
#define GROBO_MOTION_POSE_H

#include "src/motion/format/document.h"

typedef enum grobo_i_pose_type {
    GROBO_I_UNTYPED = 0,
    GROBO_I_POSE,       /* type: Pose */
    GROBO_I_INCREMENTS, /* type: Motion */
    GROBO_I_OTHER
} grobo_i_pose_type;

/* A list of joints or angles. */
typedef struct grobo_i_pose_list {
    grobo_i_place place;
    int count;
    bool given;
    double values[GROBO_JOINTS_MAX];
    grobo_i_place places[GROBO_JOINTS_MAX];
} grobo_i_pose_list;

/* One ref while it is read. */
typedef struct grobo_i_pose_ref {
    grobo_i_document *document;
    grobo_i_place place, refer_place;
    double time_s;
    grobo_key_info info;
    grobo_i_pose_type type;
    char type_text[32];
    uint8_t n_links;
    grobo_i_kept *kept;
    char *name;
    size_t same_as; /* number + 1 of the pose referred to by name */
    bool has_time, has_refer, failed;
    /* what is above is cleared for each ref; of what follows, counts say what is valid */
    grobo_i_pose_list joints, q;
    grobo_ik_link links[GROBO_IK_LINKS_MAX];
} grobo_i_pose_ref;

/* Number + 1 of the latest pose of this name, 0: none. */
size_t grobo_i_pose_named(const grobo_i_document *document, const char *name);
/* Remembers that pose n has the name it was given. */
int grobo_i_name_pose(grobo_i_document *document, const char *name, size_t n);

/* Read the value of `refer`, and an entry of `ikLinks`; target is the ref. */
int grobo_i_read_refer(grobo_i_events *events, void *target);
int grobo_i_read_link(grobo_i_events *events, void *target);

#endif
