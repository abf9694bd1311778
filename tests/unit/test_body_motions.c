/* SPDX-License-Identifier: MIT */
/* The motions this project brings along stand by its own lint: within limits and speeds, no foot
 * slips, and the ZMP well inside the soles, however they are played. */

#include <grobo/core/body_motion.h>
#include <grobo/motion_io.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

#define MARGIN_M 0.015

static void say(void *ctx, const grobo_body_finding *finding)
{
    (void)ctx;
    print_error("%s %d: %.3f to %.3f s, at worst %g\n", grobo_body_problem_name(finding->problem),
                finding->index, finding->begin_s, finding->end_s, finding->worst);
}

static void stands(const char *path)
{
    static const grobo_body_options options[] = {
        {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100},
        {GROBO_BODY_OPTIONS_INIT, .step = GROBO_BODY_STEP_STEALTHY, .zmp = GROBO_BODY_ZMP_AUTO,
         .rate_hz = 50},
        {GROBO_BODY_OPTIONS_INIT, .balance = GROBO_BODY_BALANCE_ON, .rate_hz = 100},
    };
    const grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT,
                                             .robot = &grobo_i_gr001_model, .margin_m = MARGIN_M,
                                             .finding = say, .falls = true};
    grobo_motion *motion = NULL;

    assert_int_equal(grobo_motion_read_file(path, NULL, NULL, &motion), 0);
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        grobo_body *body = NULL;

        assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, &options[i], NULL, &body), 0);
        assert_int_equal(grobo_body_check(body, &checks), 0);
        grobo_body_free(body);
    }
    grobo_motion_free(motion);
}

TEST(a_step_in_place_stands)
{
    stands("motions/step.pseq");
}

TEST(a_bow_with_the_knees_stands)
{
    stands("motions/kneebow.pseq");
}
