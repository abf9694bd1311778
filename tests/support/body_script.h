/* SPDX-License-Identifier: MIT */
/* Key poses of GR001 written in a test, and a body solving them. */
#ifndef GROBO_TESTS_BODY_SCRIPT_H
#define GROBO_TESTS_BODY_SCRIPT_H

#include <grobo/core/body.h>

enum { WAIST = 0, RIGHT = 6, LEFT = 12, KEYS_MAX = 8, TARGETS_MAX = 3, JOINTS = 20 };

/* Where the feet stand: the place of the ankles over flat soles. */
#define FOOT_X 0.0252
#define FOOT_Y 0.0196
#define FOOT_Z 0.02115

/* A motion under construction: keys with room for what they point to. */
struct script {
    grobo_body_key keys[KEYS_MAX];
    grobo_body_target targets[KEYS_MAX][TARGETS_MAX];
    double q_rad[KEYS_MAX][JOINTS];
    size_t n_keys;
};

/* Adds a key; what follows is said of it. */
grobo_body_key *script_key(struct script *script, double time_s);
void script_joint(struct script *script, int joint, double angle_rad);
/* An upright target; the waist's is a base. */
grobo_body_target *script_target(struct script *script, int link, double x, double y, double z);
void script_turn(grobo_body_target *target, double roll, double pitch, double yaw);

/* Both feet on the ground and the waist, of the last key. */
void script_stand(struct script *script, double x, double y, double z);

/* Weight to the left, one step of the right foot, weight to the middle; arms and head swing. */
void script_step(struct script *script);

/* A body over a script. */
struct run {
    grobo_body *body;
    void *workspace;
};

void run_start(struct run *run, const grobo_body_model *model, const struct script *script,
               const grobo_body_options *options);
void run_finish(struct run *run);

#endif
