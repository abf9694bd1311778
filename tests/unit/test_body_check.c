/* SPDX-License-Identifier: MIT */
/* Balance, and the lint that tells whether a motion falls. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/body/polygon.h"
#include "tests/support/body_script.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

struct watch {
    int frames;
    int findings[GROBO_BODY_FALL + 1];
    grobo_body_finding last[GROBO_BODY_FALL + 1];
    double worst_error_m; /* ZMP less desired ZMP, away from both ends */
    double least_margin_m;
    double end_s;
};

static void see_frame(void *ctx, const grobo_body_balance_frame *frame)
{
    struct watch *watch = ctx;

    watch->frames++;
    if (frame->time_s > 0.6 && frame->time_s < watch->end_s) {
        watch->worst_error_m =
            fmax(watch->worst_error_m, hypot(frame->zmp_m[0] - frame->desired_m[0],
                                             frame->zmp_m[1] - frame->desired_m[1]));
        watch->least_margin_m = fmin(watch->least_margin_m, frame->margin_m);
    }
}

static void see_finding(void *ctx, const grobo_body_finding *finding)
{
    struct watch *watch = ctx;

    watch->findings[finding->problem]++;
    watch->last[finding->problem] = *finding;
}

static int check(const struct script *script, const grobo_body_options *options,
                 struct watch *watch)
{
    struct run run;
    grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT, .robot = &grobo_i_gr001_model,
                                       .frame = see_frame, .finding = see_finding, .ctx = watch};
    int found;

    memset(watch, 0, sizeof *watch);
    watch->end_s = script->keys[script->n_keys - 1].time_s;
    watch->least_margin_m = 1;
    run_start(&run, &grobo_i_gr001_body, script, options);
    found = grobo_body_check(run.body, &checks);
    assert_int_equal(watch->frames, grobo_body_frame_count(run.body));
    run_finish(&run);
    return found;
}

/* A slow step, long enough for the balancer's ends. */
static void script_slow_step(struct script *script)
{
    script_step(script);
    for (size_t i = 0; i < script->n_keys; i++) {
        script->keys[i].time_s = 0.8 + 2 * script->keys[i].time_s;
        script->keys[i].max_transition_s = 0;
    }
    script->keys[0].time_s = 0;
}

TEST(the_balancer_brings_the_zmp_to_the_desired_one)
{
    grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .zmp = GROBO_BODY_ZMP_AUTO,
                                  .rate_hz = 100};
    struct script script;
    struct watch off, on;

    script_slow_step(&script);
    (void)check(&script, &options, &off);
    options.balance = GROBO_BODY_BALANCE_ON;
    (void)check(&script, &options, &on);
    assert_true(off.worst_error_m > 0.01);
    assert_true(on.worst_error_m < 0.25 * off.worst_error_m);
    assert_true(on.least_margin_m > 0.01);
}

/* It does so too with a foot as base, and where the base changes on the way: what the balancer sees
 * of the body's speeds must not depend on the link they are told from. */
TEST(the_balancer_works_from_any_base)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .zmp = GROBO_BODY_ZMP_AUTO,
                                        .balance = GROBO_BODY_BALANCE_ON, .rate_hz = 100};
    struct script script;
    struct run waist, foot;

    script_slow_step(&script);
    run_start(&waist, &grobo_i_gr001_body, &script, &options);
    for (int change = 0; change < 2; change++) {
        for (size_t i = 0; i < script.n_keys; i++) {
            script.targets[i][0].base = change && i == 2;
        }
        script.targets[0][2].base = true;
        run_start(&foot, &grobo_i_gr001_body, &script, &options);
        for (int i = 0; i < grobo_body_frame_count(waist.body); i++) {
            grobo_body_report one, other;
            double q[JOINTS];

            assert_int_equal(grobo_body_frame(waist.body, i, q, &one), 0);
            assert_int_equal(grobo_body_frame(foot.body, i, q, &other), 0);
            assert_int_equal(other.unreachable, 0);
            for (int k = 0; k < 3; k++) {
                assert_true(fabs(one.root.p_m[k] - other.root.p_m[k]) < 1e-3);
            }
        }
        run_finish(&foot);
    }
    run_finish(&waist);
}

/* A body that stands has its ZMP under its centre of mass; bent far over, it falls, and the lint
 * says when. */
TEST(the_lint_tells_a_fall)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    struct script script;
    struct watch watch;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_stand(&script, 0.01, 0, 0.145);
    script_key(&script, 2);
    script_target(&script, WAIST, 0.01, 0, 0.145);
    assert_int_equal(check(&script, &options, &watch), 0);
    assert_true(watch.least_margin_m > 0.015);
    script_key(&script, 4);
    script_target(&script, WAIST, -0.07, 0, 0.12);
    assert_int_equal(check(&script, &options, &watch), 1);
    assert_int_equal(watch.findings[GROBO_BODY_ZMP_MARGIN], 1);
    assert_true(watch.last[GROBO_BODY_ZMP_MARGIN].begin_s > 2);
    assert_true(watch.last[GROBO_BODY_ZMP_MARGIN].end_s > 3.99);
    assert_true(watch.last[GROBO_BODY_ZMP_MARGIN].worst < -0.005);
}

/* The same lean eight times as fast: inertia counts 64 times, and the servos hurry. */
TEST(the_lint_knows_the_speed)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const uint16_t speeds_pct[] = {0, 100, 800};
    int findings[3][2];
    struct script script;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_joint(&script, 14, -1);
    script_joint(&script, 17, 1);
    script_stand(&script, 0.01, 0, 0.145);
    script_key(&script, 0.8);
    script_joint(&script, 14, 1);
    script_joint(&script, 17, -1);
    script_target(&script, WAIST, 0.02, 0, 0.145);
    for (int i = 0; i < 3; i++) {
        struct watch watch;
        struct run run;
        grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT,
                                           .robot = &grobo_i_gr001_model, .finding = see_finding,
                                           .ctx = &watch, .speed_pct = speeds_pct[i]};

        memset(&watch, 0, sizeof watch);
        run_start(&run, &grobo_i_gr001_body, &script, &options);
        (void)grobo_body_check(run.body, &checks);
        run_finish(&run);
        findings[i][0] = watch.findings[GROBO_BODY_ZMP_MARGIN];
        findings[i][1] = watch.findings[GROBO_BODY_JOINT_SPEED];
        assert_true(watch.last[GROBO_BODY_JOINT_SPEED].end_s < 0.81);
    }
    assert_int_equal(findings[0][0] + findings[0][1] + findings[1][0] + findings[1][1], 0);
    assert_true(findings[2][0] > 0);
    assert_int_equal(findings[2][1], 2);
}

static void last_frame(void *ctx, const grobo_body_balance_frame *frame)
{
    *(grobo_body_balance_frame *)ctx = *frame;
}

/* Balance is judged with the chest where it is played: at its limit. */
TEST(the_lint_takes_slack)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const double chest_rad[] = {0, 0.01, 0.01, 0.03};
    const bool takes[] = {false, true, false, true};
    double com_m[4];

    for (int i = 0; i < 4; i++) {
        grobo_body_balance_frame frame;
        grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT,
                                           .robot = &grobo_i_gr001_model, .frame = last_frame,
                                           .takes_slack = takes[i], .ctx = &frame};
        struct script script;
        struct run run;

        memset(&script, 0, sizeof script);
        script_key(&script, 0);
        script_joint(&script, 12, chest_rad[i]);
        script_stand(&script, 0.01, 0, 0.145);
        run_start(&run, &grobo_i_gr001_body, &script, &options);
        assert_int_equal(grobo_body_check(run.body, &checks), i > 0);
        run_finish(&run);
        com_m[i] = frame.com_m[0];
    }
    assert_true(com_m[1] == com_m[0]);
    assert_true(fabs(com_m[2] - com_m[0]) > 1e-5);
    assert_true(fabs(com_m[3] - com_m[2]) > 1e-5);
}

TEST(the_lint_tells_what_else_is_wrong)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    struct script script;
    struct watch watch;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_joint(&script, 13, 0);
    script_joint(&script, 12, 0);
    script_stand(&script, 0.01, 0, 0.145);
    script_key(&script, 1);
    script_joint(&script, 12, 0.2); /* beyond its limit 0 */
    script_target(&script, RIGHT, FOOT_X + 0.004, -FOOT_Y, FOOT_Z)->touching = true; /* slides */
    script_key(&script, 1.02);
    script_joint(&script, 13, 0.8); /* 40 rad/s */
    script_target(&script, WAIST, 0.01, 0, 0.145);
    script_key(&script, 2);
    script_target(&script, WAIST, 0.01, 0, 0.19); /* too high */
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.03);
    script_target(&script, LEFT, FOOT_X, FOOT_Y, FOOT_Z)->touching = false;
    script.keys[2].max_transition_s = 0.02;
    (void)check(&script, &options, &watch);
    assert_int_equal(watch.findings[GROBO_BODY_FOOT_SLIP], 1);
    assert_int_equal(watch.last[GROBO_BODY_FOOT_SLIP].index, RIGHT);
    assert_true(fabs(watch.last[GROBO_BODY_FOOT_SLIP].worst - 0.004) < 1e-4);
    assert_int_equal(watch.findings[GROBO_BODY_JOINT_LIMIT], 1);
    assert_int_equal(watch.last[GROBO_BODY_JOINT_LIMIT].index, 12);
    assert_true(fabs(watch.last[GROBO_BODY_JOINT_LIMIT].worst - 0.2) < 1e-9);
    assert_true(watch.findings[GROBO_BODY_JOINT_SPEED] >= 1);
    assert_true(watch.findings[GROBO_BODY_NO_SUPPORT] == 1);
    assert_true(watch.last[GROBO_BODY_NO_SUPPORT].begin_s > 0.99);
    assert_true(watch.findings[GROBO_BODY_UNREACHABLE] >= 1);
    assert_string_equal(grobo_body_problem_name(GROBO_BODY_FOOT_SLIP), "foot-slip");
}

/* A unit square with a point inside and one on an edge. */
TEST(margins_of_a_hull)
{
    double points[6][2] = {{1, 1}, {0, 0}, {0.4, 0.3}, {1, 0}, {0, 1}, {0.5, 0}};
    double hull[13][2];
    const double inside[2] = {0.2, 0.5}, outside[2] = {2, 2}, beside[2] = {0.5, -0.25};
    const int n = grobo_i_convex_hull(points, 6, hull);

    assert_int_equal(n, 4);
    assert_true(fabs(grobo_i_polygon_margin(hull, n, inside) - 0.2) < 1e-15);
    assert_true(fabs(grobo_i_polygon_margin(hull, n, outside) + sqrt(2)) < 1e-15);
    assert_true(fabs(grobo_i_polygon_margin(hull, n, beside) + 0.25) < 1e-15);
}

/* The robot whose speeds count is that of the body. */
TEST(another_robot_is_refused)
{
    grobo_model other = grobo_i_gr001_model;
    grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT, .robot = &other};
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT};
    struct script script;
    struct run run;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_stand(&script, 0, 0, 0.145);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    other.n_joints--;
    assert_int_equal(grobo_body_check(run.body, &checks), GROBO_ERR_ARG);
    assert_int_equal(grobo_body_check(NULL, &checks), GROBO_ERR_ARG);
    assert_int_equal(grobo_body_check(run.body, NULL), GROBO_ERR_ARG);
    run_finish(&run);
}
