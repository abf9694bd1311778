/* SPDX-License-Identifier: MIT */
/* Agreement with the joint angles that Choreonoid's own code computes, frame by frame: reference
 * material beside the checkout. Each file NAME.rRATE.MODE.csv there is compared, so a file that is
 * added is a case more. */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/body_motion.h>
#include <grobo/motion_io.h>

#include "tests/support/files.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define GOLDEN "data/golden/"
#define SAMPLE "SampleMotion1" /* lies elsewhere: Choreonoid brings it along */

struct mode {
    const char *name; /* of the mode in the names of files */
    grobo_body_options options;
    double tolerance_rad;
};

static const struct mode modes[] = {
    /* The frames have nine digits or more: 5e-9 rad is their rounding. */
    {"plain", {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC}, 1e-8},
    /* The analytic reference solves its offsets approximately: 9e-5 rad off the exact answer. */
    {"plain_grobot", {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_EXACT}, 1e-4},
    /* As Choreonoid's window has them. */
    {"default",
     {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .step = GROBO_BODY_STEP_STEALTHY,
      .zmp = GROBO_BODY_ZMP_AUTO},
     1e-8},
    {"balancer",
     {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .step = GROBO_BODY_STEP_STEALTHY,
      .zmp = GROBO_BODY_ZMP_AUTO, .balance = GROBO_BODY_BALANCE_ON},
     1e-7},
    {"compat11",
     {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .zmp = GROBO_BODY_ZMP_AUTO,
      .balance = GROBO_BODY_BALANCE_COMPAT11},
     1e-7},
};

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
        for (int j = 0; j < grobo_i_gr001_body.n_joints; j++) {
            const double difference = fabs(strtod(at, &at) - q[j]);

            assert_true(isfinite(difference));
            worst = fmax(worst, difference);
            at += *at == ',';
        }
    }
    assert_int_equal(frame, grobo_body_frame_count(body));
    return worst;
}

/* One file; false if it does not agree. */
static bool agrees(const char *csv, const char *motion, double rate_hz, const struct mode *mode)
{
    grobo_body_options options = mode->options;
    grobo_motion *keys = NULL;
    grobo_body *body = NULL;
    char path[512];
    FILE *golden;
    double worst;

    (void)snprintf(path, sizeof path, GOLDEN "%s", csv);
    golden = fopen(shared_file(path), "r");
    assert_non_null(golden);
    options.rate_hz = rate_hz;
    assert_int_equal(grobo_motion_read_file(shared_file(motion), NULL, NULL, &keys), 0);
    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, keys, &options, NULL, &body), 0);
    grobo_motion_free(keys);
    worst = compare(body, golden);
    grobo_body_free(body);
    fclose(golden);
    print_message("%-36s %.2g rad\n", csv, worst);
    return worst <= mode->tolerance_rad;
}

/* Takes NAME.rRATE.MODE.csv apart; false if it is none of this mode. */
static bool of_mode(const char *csv, const struct mode *mode, char motion[256], double *rate_hz)
{
    const char *dot = strstr(csv, ".r");
    char rest[64];

    if (dot == NULL) {
        return false;
    }
    *rate_hz = strtod(dot + 2, NULL);
    (void)snprintf(rest, sizeof rest, ".r%g.%s.csv", *rate_hz, mode->name);
    if (strcmp(dot, rest) != 0) {
        return false;
    }
    if (strncmp(csv, SAMPLE, (size_t)(dot - csv)) == 0) {
        (void)snprintf(motion, 256, "data/choreonoid/GR001-" SAMPLE ".pseq");
    } else {
        (void)snprintf(motion, 256, GOLDEN "%.*s.pseq", (int)(dot - csv), csv);
    }
    return true;
}

/* Every file of a mode. */
TEST_EACH(struct mode, modes, all_agree)
{
    char path[4096];
    DIR *folder;
    const struct dirent *entry;
    int n = 0, n_wrong = 0;

    (void)snprintf(path, sizeof path, "%s", shared_file(GOLDEN "README.md"));
    *strrchr(path, '/') = '\0';
    folder = opendir(path);
    assert_non_null(folder);
    while ((entry = readdir(folder)) != NULL) {
        char motion[256];
        double rate_hz = 0;

        if (of_mode(entry->d_name, row, motion, &rate_hz)) {
            n++;
            n_wrong += !agrees(entry->d_name, motion, rate_hz, row);
        }
    }
    (void)closedir(folder);
    assert_int_equal(n_wrong, 0);
    assert_true(n > 0);
}
