/* SPDX-License-Identifier: MIT */
/* Key poses to frames, from first principles: a step made here, no data. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"
#include "tests/support/body_scaled.h"
#include "tests/support/body_script.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/transforms.h"

/* Where a foot is in a frame that was solved. */
static void foot_of(const grobo_body_model *model, const double *q_rad,
                    const grobo_body_report *report, int link, grobo_transform *foot)
{
    grobo_transform links[GROBO_BODY_LINKS_MAX];

    grobo_body_forward(model, &report->root, q_rad, links);
    *foot = links[link];
}

TEST(a_foot_without_new_keys_does_not_move)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    struct script script;
    struct run run;

    script_step(&script);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame_count(run.body), 201);
    for (int i = 0; i < 201; i++) {
        double q[JOINTS];
        grobo_body_report report;
        grobo_transform foot;

        assert_int_equal(grobo_body_frame(run.body, i, q, &report), 0);
        assert_int_equal(report.unreachable, 0);
        assert_true(report.touching[1]);
        assert_int_equal(report.touching[0], i < 60 || i >= 140);
        foot_of(&grobo_i_gr001_body, q, &report, LEFT, &foot);
        assert_true(transforms_apart(&foot, &script.targets[0][2].at) < 1e-9);
        foot_of(&grobo_i_gr001_body, q, &report, RIGHT, &foot);
        if (i <= 60) {
            assert_true(transforms_apart(&foot, &script.targets[0][1].at) < 1e-9);
        }
        if (i == 100) {
            assert_true(transforms_apart(&foot, &script.targets[2][1].at) < 1e-9);
        }
        if (i >= 140) {
            assert_true(transforms_apart(&foot, &script.targets[3][1].at) < 1e-9);
        }
        assert_true(i != 100 || transforms_apart(&report.root, &script.targets[2][0].at) < 1e-9);
    }
    run_finish(&run);
}

/* Left and right exchanged, y, roll and yaw turned over. */
static void mirror_script(const struct script *from, struct script *to)
{
    *to = *from;
    for (size_t i = 0; i < from->n_keys; i++) {
        to->keys[i].q_rad = to->q_rad[i];
        to->keys[i].targets = to->targets[i];
        to->keys[i].zmp_m[1] = -from->keys[i].zmp_m[1];
        to->keys[i].joints = 0;
        for (int j = 0; j < JOINTS; j++) {
            const grobo_joint *joint = &grobo_i_gr001_model.joints[j];

            to->q_rad[i][joint->mirror] = joint->mirror_sign * from->q_rad[i][j];
            if ((from->keys[i].joints & GROBO_JOINT_BIT(j)) != 0) {
                to->keys[i].joints |= GROBO_JOINT_BIT(joint->mirror);
            }
        }
        for (size_t k = 0; k < from->keys[i].n_targets; k++) {
            grobo_body_target *target = &to->targets[i][k];

            target->link = target->link == RIGHT ? LEFT : target->link == LEFT ? RIGHT : WAIST;
            target->at.p_m[1] = -target->at.p_m[1];
            target->at.r[1] = -target->at.r[1];
            target->at.r[3] = -target->at.r[3];
            target->at.r[5] = -target->at.r[5];
            target->at.r[7] = -target->at.r[7];
        }
    }
}

static void mirrored(const grobo_body_options *options)
{
    struct script script, other;
    struct run run, opposite;

    script_step(&script);
    mirror_script(&script, &other);
    run_start(&run, &grobo_i_gr001_body, &script, options);
    run_start(&opposite, &grobo_i_gr001_body, &other, options);
    for (int i = 0; i < grobo_body_frame_count(run.body); i++) {
        double q[JOINTS], m[JOINTS];

        assert_int_equal(grobo_body_frame(run.body, i, q, NULL), 0);
        assert_int_equal(grobo_body_frame(opposite.body, i, m, NULL), 0);
        for (int j = 0; j < JOINTS; j++) {
            const grobo_joint *joint = &grobo_i_gr001_model.joints[j];

            assert_true(fabs(m[joint->mirror] - joint->mirror_sign * q[j]) < 1e-9);
        }
    }
    run_finish(&run);
    run_finish(&opposite);
}

TEST(mirrored_input_gives_mirrored_output)
{
    const grobo_body_options exact = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 50};
    const grobo_body_options numeric = {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC,
                                        .step = GROBO_BODY_STEP_STEALTHY,
                                        .zmp = GROBO_BODY_ZMP_AUTO, .rate_hz = 50};

    mirrored(&exact);
    mirrored(&numeric);
}

/* Nothing but the table names GR001: three times as large, the same angles. */
TEST(a_larger_robot_does_the_same)
{
    /* at keys: between them a change below 1e-3 m is none, which does not scale */
    const int frames[] = {0, 30, 50, 70, 100};
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 50};
    struct body_scaled scaled;
    struct script script, large;
    struct run run, other;

    body_scaled_init(&scaled, 3, 20);
    script_step(&script);
    script_step(&large);
    for (size_t i = 0; i < large.n_keys; i++) {
        for (size_t k = 0; k < large.keys[i].n_targets; k++) {
            for (int c = 0; c < 3; c++) {
                large.targets[i][k].at.p_m[c] *= 3;
            }
        }
    }
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    run_start(&other, &scaled.model, &large, &options);
    for (int i = 0; i < 5; i++) {
        double q[JOINTS], p[JOINTS];

        assert_int_equal(grobo_body_frame(run.body, frames[i], q, NULL), 0);
        assert_int_equal(grobo_body_frame(other.body, frames[i], p, NULL), 0);
        for (int j = 0; j < JOINTS; j++) {
            assert_true(fabs(p[j] - q[j]) < 1e-9);
        }
    }
    run_finish(&run);
    run_finish(&other);
}

/* A waist too high for the legs: they keep their own keys' angles, and it is reported. */
TEST(unreachable_targets_are_told)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 20};
    struct script script;
    struct run run;
    int missed = 0;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    for (int j = 0; j < 12; j++) {
        script_joint(&script, j, 0.01 * j);
    }
    script_stand(&script, 0, 0, 0.145);
    script_key(&script, 1);
    script_target(&script, WAIST, 0, 0, 0.18);
    script_target(&script, LEFT, FOOT_X, FOOT_Y, FOOT_Z + 0.035)->touching = true;
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    for (int i = 0; i <= 20; i++) {
        double q[JOINTS];
        grobo_body_report report;

        assert_int_equal(grobo_body_frame(run.body, i, q, &report), 0);
        assert_true(fabs(report.time_s - 0.05 * i) < 1e-12);
        assert_int_equal(report.unreachable & ~(UINT64_C(1) << RIGHT), 0);
        for (int j = 0; j < 6 && report.unreachable != 0; j++) {
            assert_true(fabs(q[j] - 0.01 * j) < 1e-15);
        }
        missed += report.unreachable != 0;
    }
    assert_in_range(missed, 5, 15);
    run_finish(&run);
}

/* With a foot as base the waist is solved from it, and the other foot from the waist. */
TEST(a_foot_can_be_the_base)
{
    for (int ik = GROBO_BODY_IK_EXACT; ik <= GROBO_BODY_IK_NUMERIC; ik++) {
        const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .ik = (grobo_body_ik)ik,
                                            .rate_hz = 50};
        struct script script, from_foot;
        struct run run, other;

        script_step(&script);
        script_step(&from_foot);
        for (size_t i = 0; i < script.n_keys; i++) {
            from_foot.targets[i][0].base = false;
        }
        from_foot.targets[0][2].base = true;
        run_start(&run, &grobo_i_gr001_body, &script, &options);
        run_start(&other, &grobo_i_gr001_body, &from_foot, &options);
        for (int i = 0; i <= 100; i++) {
            double q[JOINTS], p[JOINTS];
            grobo_body_report report;

            assert_int_equal(grobo_body_frame(run.body, i, q, NULL), 0);
            assert_int_equal(grobo_body_frame(other.body, i, p, &report), 0);
            for (int j = 0; j < JOINTS; j++) {
                assert_true(fabs(p[j] - q[j]) < (ik == GROBO_BODY_IK_EXACT ? 1e-9 : 5e-3));
            }
        }
        run_finish(&run);
        run_finish(&other);
    }
}

/* Without a waist target the waist follows from the base foot. */
TEST(the_waist_is_told_without_a_target)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 50};
    struct script script;
    struct run run;
    double q[JOINTS];
    grobo_body_report report;
    grobo_transform foot;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_joint(&script, 2, 0.4);
    script_joint(&script, 3, -0.9);
    script_joint(&script, 4, -0.5);
    script_target(&script, RIGHT, 0.1, 0.2, FOOT_Z)->base = true;
    script_turn(&script.targets[0][0], 0, 0, 0.7);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame(run.body, 0, q, &report), 0);
    foot_of(&grobo_i_gr001_body, q, &report, RIGHT, &foot);
    assert_true(transforms_apart(&foot, &script.targets[0][0].at) < 1e-12);
    run_finish(&run);
}

/* What waits for its first key is at that key's place: a foot stands there. */
TEST(a_foot_stands_before_its_first_key)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 10};
    struct script script;
    struct run run;
    double q[JOINTS];
    grobo_body_report report;

    memset(&script, 0, sizeof script);
    script_key(&script, 0.5);
    script_stand(&script, 0, 0, 0.145);
    script.targets[0][1].touching = false;
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    for (int i = 0; i <= 5; i++) {
        assert_int_equal(grobo_body_frame(run.body, i, q, &report), 0);
        assert_false(report.touching[0]);
        assert_true(report.touching[1]);
    }
    run_finish(&run);
}

/* A slave foot follows the joints' own keys while both its keys are slaves, and comes to its
 * target where one is not. */
TEST(a_slave_foot_follows_its_joints)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 50};
    struct script script;
    struct run run;
    double q[JOINTS];
    grobo_body_report report;
    grobo_transform foot;

    memset(&script, 0, sizeof script);
    for (int i = 0; i < 3; i++) {
        script_key(&script, 0.5 * i);
        script_target(&script, WAIST, 0, 0, 0.145);
        script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.005)->slave = i < 2;
        for (int j = 0; j < 6; j++) {
            script_joint(&script, j, 0.1 * i);
        }
    }
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame(run.body, 10, q, &report), 0);
    for (int j = 1; j < 6; j++) {
        assert_true(fabs(q[j] - q[0]) < 1e-15 && q[0] > 0.01 && q[0] < 0.1);
    }
    assert_int_equal(grobo_body_frame(run.body, 25, q, &report), 0);
    assert_true(fabs(q[0] - 0.1) < 1e-12 && fabs(q[5] - 0.1) < 1e-12);
    assert_int_equal(grobo_body_frame(run.body, 37, q, &report), 0);
    assert_true(fabs(q[3] - q[0]) > 1e-3); /* between: a mixture */
    assert_int_equal(grobo_body_frame(run.body, 50, q, &report), 0);
    foot_of(&grobo_i_gr001_body, q, &report, RIGHT, &foot);
    assert_true(transforms_apart(&foot, &script.targets[2][1].at) < 1e-9);
    run_finish(&run);
}

/* The stealthy step: in the lowest 5 mm the foot goes straight up and comes straight down, and it
 * touches down slower than the cubic alone would. */
TEST(a_stealthy_step_does_not_slide)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .step = GROBO_BODY_STEP_STEALTHY,
                                        .rate_hz = 1000};
    struct script script;
    struct run run;
    double top_m = 0, before_m = 0, fastest_m_s = 0;

    script_step(&script);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    for (int i = 0; i <= 2000; i++) {
        double q[JOINTS];
        grobo_body_report report;
        grobo_transform foot;

        assert_int_equal(grobo_body_frame(run.body, i, q, &report), 0);
        foot_of(&grobo_i_gr001_body, q, &report, RIGHT, &foot);
        const double height_m = foot.p_m[2] - FOOT_Z;

        top_m = fmax(top_m, height_m);
        if (i <= 733) { /* 0.6 + 0.4 * 5/15 s */
            assert_true(fabs(foot.p_m[0] - FOOT_X) < 1e-9);
        }
        if (i >= 1300) { /* held until 1.1; 1.4 - 0.3 * 5/15 s */
            assert_true(fabs(foot.p_m[0] - FOOT_X - 0.02) < 1e-9);
        }
        if (i > 1370 && i < 1400) {
            fastest_m_s = fmax(fastest_m_s, (before_m - height_m) * 1000);
        }
        before_m = height_m;
    }
    assert_true(fabs(top_m - 0.015) < 1e-4);
    assert_true(fastest_m_s < 2 * 0.005 / 0.04 + 1e-3);
    run_finish(&run);
}

/* The desired ZMP lies under the standing foot while the other swings. */
TEST(automatic_zmp_is_under_the_standing_foot)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .zmp = GROBO_BODY_ZMP_AUTO,
                                        .rate_hz = 50};
    struct script script;
    struct run run;
    double q[JOINTS];
    grobo_body_report report;

    script_step(&script);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame(run.body, 0, q, &report), 0);
    assert_true(report.has_zmp);
    assert_true(fabs(report.zmp_m[0] - (FOOT_X - 0.005)) < 1e-12);
    assert_true(fabs(report.zmp_m[1]) < 1e-12);
    for (int i = 30; i <= 70; i += 10) {
        assert_int_equal(grobo_body_frame(run.body, i, q, &report), 0);
        assert_true(fabs(report.zmp_m[0] - (FOOT_X - 0.005)) < 1e-12);
        assert_true(fabs(report.zmp_m[1] - (FOOT_Y + 0.01)) < 1e-12);
    }
    /* and comes back between the soles 0.1 s after the step */
    assert_int_equal(grobo_body_frame(run.body, 76, q, &report), 0);
    assert_true(fabs(report.zmp_m[0] - (FOOT_X + 0.01 - 0.005)) < 1e-3);
    assert_true(fabs(report.zmp_m[1]) < 2e-3);
    run_finish(&run);
}

/* Angles of joints alone follow the rules of every key-pose player: stationary where asked, held
 * where the transition is short, constant outside. */
TEST(joints_keep_their_own_keys)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    struct script script;
    struct run run;
    double q[JOINTS];

    memset(&script, 0, sizeof script);
    script_key(&script, 0.5);
    script_joint(&script, 13, 0.1);
    script_key(&script, 1.5)->max_transition_s = 0.2;
    script_joint(&script, 13, 0.3);
    script_key(&script, 2);
    script_joint(&script, 13, 0.4);
    script_key(&script, 2); /* the same time: goes before the one above, which then holds */
    script_joint(&script, 13, 0.9);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_sample(run.body, -1, q, NULL), 0);
    assert_true(fabs(q[13] - 0.1) < 1e-15 && q[12] == 0);
    assert_int_equal(grobo_body_frame(run.body, 129, q, NULL), 0);
    assert_true(fabs(q[13] - 0.1) < 1e-15);
    assert_int_equal(grobo_body_frame(run.body, 140, q, NULL), 0);
    assert_true(q[13] > 0.12 && q[13] < 0.25);
    assert_int_equal(grobo_body_sample(run.body, 1.999999, q, NULL), 0);
    assert_true(fabs(q[13] - 0.9) < 1e-4);
    assert_int_equal(grobo_body_sample(run.body, 3, q, NULL), 0);
    assert_true(fabs(q[13] - 0.4) < 1e-15);
    assert_int_equal(grobo_body_sample(run.body, NAN, q, NULL), GROBO_ERR_NAN);
    assert_int_equal(grobo_body_frame(run.body, 201, q, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_body_frame(run.body, -1, q, NULL), GROBO_ERR_ARG);
    run_finish(&run);
}

/* A frame is the same whichever was asked for before it. */
TEST(frames_come_in_any_order)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .step = GROBO_BODY_STEP_STEALTHY,
                                        .zmp = GROBO_BODY_ZMP_AUTO,
                                        .balance = GROBO_BODY_BALANCE_ON, .rate_hz = 50};
    struct script script;
    struct run run;
    double forward[151][JOINTS], q[JOINTS];

    script_step(&script);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame_count(run.body), 151);
    for (int i = 0; i <= 150; i++) {
        assert_int_equal(grobo_body_frame(run.body, i, forward[i], NULL), 0);
    }
    for (int i = 150; i >= 0; i--) {
        assert_int_equal(grobo_body_frame(run.body, i, q, NULL), 0);
        assert_memory_equal(q, forward[i], sizeof q);
        assert_int_equal(grobo_body_sample(run.body, i / 50.0, q, NULL), 0);
        for (int j = 0; j < JOINTS; j++) {
            assert_true(fabs(q[j] - forward[i][j]) < 1e-9);
        }
    }
    run_finish(&run);
}

TEST(ik_can_be_off)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_OFF,
                                        .rate_hz = 50};
    struct script script;
    struct run run;
    double q[JOINTS];
    grobo_body_report report;

    script_step(&script);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame(run.body, 50, q, &report), 0);
    for (int j = 0; j < 12; j++) {
        assert_true(fabs(q[j] - grobo_i_gr001_model.joints[j].init_rad) < 1e-15);
    }
    assert_true(fabs(report.root.p_m[2] - 0.1605) < 1e-15);
    assert_int_equal(report.unreachable, 0);
    run_finish(&run);
}

TEST(bad_setups_are_refused)
{
    struct script script;
    grobo_body_setup setup = {&grobo_i_gr001_body, script.keys, 0, {.rate_hz = 50}};
    grobo_body *body = NULL;
    size_t bytes = 77;
    char *workspace;

    script_step(&script);
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_ARG);
    setup.n_keys = script.n_keys;
    setup.options.rate_hz = -1;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_ARG);
    setup.options.rate_hz = NAN;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_ARG);
    setup.options.rate_hz = 50;
    setup.options.ik = GROBO_BODY_IK_OFF;
    setup.options.balance = GROBO_BODY_BALANCE_ON;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_ARG);
    setup.options.ik = GROBO_BODY_IK_EXACT;
    script.keys[1].time_s = INFINITY;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_NAN);
    script.keys[1].time_s = 1e9;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_CAP);
    script.keys[1].time_s = 0.6;
    script.q_rad[0][7] = NAN;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_NAN);
    script.q_rad[0][7] = 0;
    script.q_rad[0][7] = 2e6;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_ARG);
    script.q_rad[0][7] = 0;
    script.targets[3][1].at.r[4] = NAN;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_NAN);
    script.targets[3][1].at.r[4] = 1;
    setup.model = NULL;
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), GROBO_ERR_ARG);
    setup.model = &grobo_i_gr001_body;
    assert_int_equal(bytes, 77);
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), 0);
    workspace = malloc(bytes);
    assert_int_equal(grobo_body_init(&setup, workspace, bytes - 1, &body), GROBO_ERR_SPACE);
    assert_int_equal(grobo_body_init(&setup, workspace + 1, bytes, &body), GROBO_ERR_ARG);
    assert_null(body);
    assert_int_equal(grobo_body_init(&setup, workspace, bytes, &body), 0);
    assert_non_null(body);
    free(workspace);
}

/* Leaves ones where the next call has its variables. */
static unsigned dirty_the_stack(void)
{
    volatile uint8_t dirt[8192];
    unsigned sum = 0;
    for (size_t i = 0; i < sizeof dirt; i++) {
        dirt[i] = 0xFF;
        sum += dirt[i];
    }
    return sum;
}

/* Seen once under ThreadSanitizer: GROBO_ERR_CAP out of what was on the stack. */
TEST(what_was_on_the_stack_does_not_matter)
{
    struct script script;
    grobo_body *body = NULL;
    size_t bytes = 0;

    script_step(&script);
    grobo_body_setup setup = {&grobo_i_gr001_body, script.keys, script.n_keys, {.rate_hz = 50}};
    assert_int_equal(grobo_body_workspace_bytes(&setup, &bytes), 0);
    void *workspace = malloc(bytes);
    assert_true(dirty_the_stack() > 0);
    assert_int_equal(grobo_body_init(&setup, workspace, bytes, &body), 0);
    free(workspace);
}
