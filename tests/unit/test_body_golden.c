/* SPDX-License-Identifier: MIT */
/* Agreement with the joint angles Choreonoid's own code computes, frame by frame: reference
 * material beside the checkout. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <grobo/body_motion.h>
#include <grobo/motion_io.h>

#include "files.h"

#define RATE_HZ 30.0

static const struct grobo_body_options plain = {.ik = GROBO_BODY_IK_NUMERIC, .rate_hz = RATE_HZ};
static const struct grobo_body_options plain_grobot = {.ik = GROBO_BODY_IK_EXACT,
                                                       .rate_hz = RATE_HZ};
static const struct grobo_body_options as_the_gui = {.ik = GROBO_BODY_IK_NUMERIC,
                                                     .step = GROBO_BODY_STEP_STEALTHY,
                                                     .zmp = GROBO_BODY_ZMP_AUTO,
                                                     .rate_hz = RATE_HZ};
static const struct grobo_body_options balancer = {.ik = GROBO_BODY_IK_NUMERIC,
                                                   .step = GROBO_BODY_STEP_STEALTHY,
                                                   .zmp = GROBO_BODY_ZMP_AUTO,
                                                   .balance = GROBO_BODY_BALANCE_ON,
                                                   .rate_hz = RATE_HZ};
static const struct grobo_body_options compat11 = {.ik = GROBO_BODY_IK_NUMERIC,
                                                   .zmp = GROBO_BODY_ZMP_AUTO,
                                                   .balance = GROBO_BODY_BALANCE_COMPAT11,
                                                   .rate_hz = RATE_HZ};

/* Largest difference to the frames of an open file; every frame must be there, none beyond. */
static double compare(grobo_body *body, FILE *golden)
{
    char line[4096];
    double q[GROBO_JOINTS_MAX];
    double worst = 0;
    int frame = 0;

    while (fgets(line, (int)sizeof line, golden) != NULL) {
        char *at = line;

        assert_int_equal(grobo_body_frame(body, frame++, q, NULL), 0);
        for (int j = 0; j < grobo_gr001_body.n_joints; j++) {
            const double difference = fabs(strtod(at, &at) - q[j]);

            assert_true(isfinite(difference));
            worst = fmax(worst, difference);
            at += *at == ',';
        }
    }
    assert_int_equal(frame, grobo_body_frame_count(body));
    return worst;
}

static void agree(const char *motion, const char *frames, const grobo_body_options *options,
                  double tolerance_rad)
{
    grobo_motion *keys = NULL;
    grobo_body *body = NULL;
    FILE *golden;
    double worst;

    golden = fopen(shared_file(frames), "r");
    assert_non_null(golden);
    assert_int_equal(grobo_motion_read_file(shared_file(motion), NULL, NULL, &keys), 0);
    assert_int_equal(grobo_body_new(&body, &grobo_gr001_body, keys, options, NULL), 0);
    grobo_motion_free(keys);
    worst = compare(body, golden);
    if (worst > tolerance_rad) {
        print_error("%s: %g rad\n", frames, worst);
    }
    assert_true(worst <= tolerance_rad);
    grobo_body_free(body);
    fclose(golden);
}

#define SAMPLE "data/choreonoid/GR001-SampleMotion1.pseq"

/* The analytic reference solves its offsets approximately: 9e-5 rad off the exact answer. */
static void exact_ik_agrees_with_the_analytic_reference(void **state)
{
    (void)state;
    agree(SAMPLE, "data/golden/SampleMotion1.r30.plain_grobot.csv", &plain_grobot, 1e-4);
    agree("data/golden/walk.pseq", "data/golden/walk.r30.plain_grobot.csv", &plain_grobot, 1e-4);
    agree("data/golden/misc.pseq", "data/golden/misc.r30.plain_grobot.csv", &plain_grobot, 1e-8);
    agree("data/golden/nowaist.pseq", "data/golden/nowaist.r30.plain_grobot.csv", &plain_grobot,
          1e-8);
}

static void exact_ik_leaves_unreachable_targets_alone(void **state)
{
    (void)state;
    agree("data/golden/unreachable.pseq", "data/golden/unreachable.r30.plain_grobot.csv",
          &plain_grobot, 1e-4);
}

/* The frames have nine digits: 5e-9 rad is their rounding. */
static void numeric_ik_agrees(void **state)
{
    (void)state;
    agree(SAMPLE, "data/golden/SampleMotion1.r30.plain.csv", &plain, 1e-8);
    agree("data/golden/walk.pseq", "data/golden/walk.r30.plain.csv", &plain, 1e-8);
    agree("data/golden/misc.pseq", "data/golden/misc.r30.plain.csv", &plain, 1e-8);
    agree("data/golden/nowaist.pseq", "data/golden/nowaist.r30.plain.csv", &plain, 1e-8);
}

static void numeric_ik_leaves_unreachable_targets_alone(void **state)
{
    (void)state;
    agree("data/golden/unreachable.pseq", "data/golden/unreachable.r30.plain.csv", &plain, 1e-8);
}

static void stealthy_step_and_automatic_zmp_agree(void **state)
{
    (void)state;
    agree(SAMPLE, "data/golden/SampleMotion1.r30.default.csv", &as_the_gui, 1e-8);
    agree("data/golden/walk.pseq", "data/golden/walk.r30.default.csv", &as_the_gui, 1e-8);
    agree("data/golden/misc.pseq", "data/golden/misc.r30.default.csv", &as_the_gui, 1e-8);
    agree("data/golden/nowaist.pseq", "data/golden/nowaist.r30.default.csv", &as_the_gui, 1e-8);
    agree("data/golden/unreachable.pseq", "data/golden/unreachable.r30.default.csv", &as_the_gui,
          1e-8);
}

static void the_balancer_agrees(void **state)
{
    (void)state;
    agree(SAMPLE, "data/golden/SampleMotion1.r30.balancer.csv", &balancer, 1e-7);
}

static void the_balancer_of_1_1_agrees(void **state)
{
    (void)state;
    agree(SAMPLE, "data/golden/SampleMotion1.r30.compat11.csv", &compat11, 1e-7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_ik_agrees_with_the_analytic_reference),
        cmocka_unit_test(exact_ik_leaves_unreachable_targets_alone),
        cmocka_unit_test(numeric_ik_agrees),
        cmocka_unit_test(numeric_ik_leaves_unreachable_targets_alone),
        cmocka_unit_test(stealthy_step_and_automatic_zmp_agree),
        cmocka_unit_test(the_balancer_agrees),
        cmocka_unit_test(the_balancer_of_1_1_agrees),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
