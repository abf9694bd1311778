/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "src/body/body.h"
#include "tests/support/body_script.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

grobo_body_key *script_key(struct script *script, double time_s)
{
    grobo_body_key *key = &script->keys[script->n_keys];

    memset(key, 0, sizeof *key);
    key->time_s = time_s;
    key->q_rad = script->q_rad[script->n_keys];
    key->targets = script->targets[script->n_keys];
    script->n_keys++;
    return key;
}

grobo_body_target *script_target(struct script *script, int link, double x, double y, double z)
{
    grobo_body_key *key = &script->keys[script->n_keys - 1];
    grobo_body_target *target = &script->targets[script->n_keys - 1][key->n_targets++];
    static const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

    memset(target, 0, sizeof *target);
    target->link = link;
    target->at.p_m[0] = x;
    target->at.p_m[1] = y;
    target->at.p_m[2] = z;
    memcpy(target->at.r, upright, sizeof upright);
    target->base = link == WAIST;
    return target;
}

void script_joint(struct script *script, int joint, double angle_rad)
{
    script->keys[script->n_keys - 1].joints |= GROBO_JOINT_BIT(joint);
    script->q_rad[script->n_keys - 1][joint] = angle_rad;
}

void script_turn(grobo_body_target *target, double roll, double pitch, double yaw)
{
    const double rpy[3] = {roll, pitch, yaw};

    grobo_i_rotation_of_rpy(target->at.r, rpy);
}

void script_stand(struct script *script, double x, double y, double z)
{
    script_target(script, WAIST, x, y, z);
    script_target(script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_target(script, LEFT, FOOT_X, FOOT_Y, FOOT_Z)->touching = true;
}

void script_step(struct script *script)
{
    memset(script, 0, sizeof *script);
    script_key(script, 0);
    for (int j = 0; j < JOINTS; j++) {
        script_joint(script, j, grobo_i_gr001_model.joints[j].init_rad);
    }
    script_stand(script, 0, 0, 0.145);
    script_key(script, 0.6);
    script_joint(script, 13, 0.3);
    script_joint(script, 14, 0.5);
    script_turn(script_target(script, WAIST, 0.002, 0.025, 0.143), 0.03, 0.05, 0.02);
    script_target(script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_key(script, 1.0);
    script_turn(script_target(script, WAIST, 0.005, 0.027, 0.144), 0.05, 0.06, 0.1);
    script_turn(script_target(script, RIGHT, FOOT_X + 0.01, -FOOT_Y - 0.004, FOOT_Z + 0.015), 0,
                0.1, -0.1);
    script_key(script, 1.4)->max_transition_s = 0.3;
    script_joint(script, 13, -0.2);
    script_turn(script_target(script, WAIST, 0.01, 0.02, 0.145), 0, 0, 0.05);
    script_turn(script_target(script, RIGHT, FOOT_X + 0.02, -FOOT_Y - 0.002, FOOT_Z), 0, 0, -0.05);
    script->targets[3][1].touching = true;
    script_key(script, 2.0);
    script_joint(script, 14, 0.2);
    script_target(script, WAIST, 0.012, 0, 0.148);
}

void run_start(struct run *run, const grobo_body_model *model, const struct script *script,
               const grobo_body_options *options)
{
    const grobo_body_setup setup = {model, script->keys, script->n_keys, *options};
    size_t bytes = 0;

    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), 0);
    run->workspace = malloc(bytes);
    assert_int_equal(grobo_body_init(&setup, run->workspace, bytes, &run->body), 0);
}

void run_finish(struct run *run)
{
    free(run->workspace);
}
