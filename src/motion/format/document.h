/* SPDX-License-Identifier: MIT */
/* A YAML motion file while it is read: key poses, increments or body motion. */
#ifndef GROBO_MOTION_DOCUMENT_H
#define GROBO_MOTION_DOCUMENT_H

#include "src/motion/format/fields.h"

/* What a component of a body motion may inherit from the top. 0 or false: not given. */
typedef struct grobo_i_frame_info {
    double rate_hz;
    long n_frames; /* -1: not given */
    long n_parts;  /* -1: not given */
    bool has_frame_time, gives_frame_time;
    grobo_i_place rate_place, n_frames_place, n_parts_place;
} grobo_i_frame_info;

/* Names of poses, for files that refer to a pose by its name: open addressing. */
typedef struct grobo_i_pose_names {
    struct grobo_i_pose_slot {
        uint64_t hash;
        size_t pose; /* number + 1, 0: free */
    } * slots;
    size_t count, room;
} grobo_i_pose_names;

typedef struct grobo_i_document {
    grobo_i_events events;
    grobo_i_reader *reader;
    /* what the top says */
    char *type, *content;
    grobo_i_place type_place, version_place, content_place;
    double version; /* 0: not given */
    grobo_i_frame_info top;
    /* key poses */
    grobo_i_pose_names names;
    grobo_motion_kind poses; /* what the refs are, once one or the type has told */
    bool poses_known;
    bool has_refs;
    /* body motion */
    bool has_components;
    bool has_joints; /* a component gave the frames */
    grobo_i_frame_info frames;
    grobo_i_place frames_place;
    size_t n_others; /* the other components' rates */
    struct {
        double rate_hz;
        grobo_i_place place;
    } others[GROBO_MOTION_COMPONENTS_MAX];
} grobo_i_document;

/* Values of keys at the top; target is the document. */
int grobo_i_read_refs(grobo_i_events *events, void *target);
int grobo_i_read_components(grobo_i_events *events, void *target);
int grobo_i_read_rate(grobo_i_events *events, grobo_i_frame_info *info);
int grobo_i_read_n_frames(grobo_i_events *events, grobo_i_frame_info *info);
int grobo_i_read_n_parts(grobo_i_events *events, grobo_i_frame_info *info);
int grobo_i_read_has_frame_time(grobo_i_events *events, grobo_i_frame_info *info);

/* When all is read: what a body motion's frames lack, and their rate. */
int grobo_i_finish_frames(grobo_i_document *document);
void grobo_i_pose_names_free(grobo_i_document *document);

#endif
