/* SPDX-License-Identifier: MIT */
/* Processor time of whole-body playback: our step in place, slowed down to ten seconds, at 100 Hz,
 * beside a plain resample of its joints. */
#include <stdbool.h>
#include <stdio.h>

#include <grobo/core/body_motion.h>
#include <grobo/core/motion.h>
#include <grobo/motion_io.h>

#include "tests/bench/bench.h"
#include "tests/support/tables.h"

#define MOTION "motions/step.pseq"
#define LENGTH_S 10.0
#define RATE_HZ 100.0
#define ROUNDS 7

struct row {
    const char *name;
    grobo_body_options options;
};

static const struct row rows[] = {
    {"exact IK", {GROBO_BODY_OPTIONS_INIT, .rate_hz = RATE_HZ}},
    {"numeric IK", {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .rate_hz = RATE_HZ}},
    {"exact IK, balancer",
     {GROBO_BODY_OPTIONS_INIT, .balance = GROBO_BODY_BALANCE_ON, .rate_hz = RATE_HZ}},
    {"numeric IK, balancer of 1.1",
     {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .balance = GROBO_BODY_BALANCE_COMPAT11,
      .rate_hz = RATE_HZ}},
};

static double now_ms(void)
{
    return bench_cpu_us() / 1000;
}

/* The same motion at a length. False: no memory. */
static bool stretch(grobo_motion *motion, double length_s)
{
    const size_t size = grobo_motion_size(motion);
    double last_s = 0, time_s = 0;

    (void)grobo_motion_time_s(motion, size - 1, &last_s);
    for (size_t i = size; i > 0; i--) {
        (void)grobo_motion_time_s(motion, i - 1, &time_s);
        if (grobo_motion_set_time_s(motion, i - 1, time_s * length_s / last_s) < 0) {
            return false;
        }
    }
    return true;
}

/* Solving all frames, the set-up included. Negative: failed. */
static double body_ms(const grobo_motion *motion, const grobo_body_options *options)
{
    double least_ms = -1;

    for (int round = 0; round < ROUNDS; round++) {
        const double begin_ms = now_ms();
        grobo_body *body = NULL;
        double q_rad[GROBO_JOINTS_MAX];

        if (grobo_body_new(&grobo_i_gr001_body, motion, options, NULL, &body) < 0) {
            return -1;
        }
        for (int i = 0; i < grobo_body_frame_count(body); i++) {
            (void)grobo_body_frame(body, i, q_rad, NULL);
        }
        grobo_body_free(body);
        const double took_ms = now_ms() - begin_ms;

        least_ms = least_ms < 0 || took_ms < least_ms ? took_ms : least_ms;
    }
    return least_ms;
}

static double resample_ms(const grobo_motion *motion)
{
    double least_ms = -1;

    for (int round = 0; round < ROUNDS; round++) {
        const double begin_ms = now_ms();
        grobo_clip clip;
        grobo_motion *frames = NULL;

        if (grobo_motion_clip(motion, NULL, &clip) < 0 ||
            grobo_motion_resample(&clip, RATE_HZ, NULL, &frames) < 0) {
            return -1;
        }
        grobo_motion_free(frames);
        grobo_motion_clip_free(&clip);
        const double took_ms = now_ms() - begin_ms;

        least_ms = least_ms < 0 || took_ms < least_ms ? took_ms : least_ms;
    }
    return least_ms;
}

int main(void)
{
    grobo_motion *motion = NULL;
    bool solved = true;

    if (grobo_motion_read_file(MOTION, NULL, NULL, &motion) < 0 || !stretch(motion, LENGTH_S)) {
        fprintf(stderr, "bench_body: cannot read %s; run it in the top folder\n", MOTION);
        return 1;
    }
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double took_ms = body_ms(motion, &rows[i].options);
        char measure[96];

        (void)snprintf(measure, sizeof measure, "a frame, %s, us", rows[i].name);
        bench_row("S15", measure, "grobo", took_ms * 1000 / (LENGTH_S * RATE_HZ));
        solved = solved && took_ms >= 0;
    }
    bench_row("S15", "a frame, joints alone resampled, us", "grobo",
              resample_ms(motion) * 1000 / (LENGTH_S * RATE_HZ));
    grobo_motion_free(motion);
    return solved ? 0 : 1;
}
