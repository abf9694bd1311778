/* SPDX-License-Identifier: MIT */
/* What must hold of any motion that a reader accepts, for the fuzz targets of the readers. */
#ifndef TESTS_FUZZ_MOTION_TARGET_H
#define TESTS_FUZZ_MOTION_TARGET_H

#include <math.h>

#include <grobo/core/motion.h>
#include <grobo/core/motion_io.h>

#include "tests/fuzz/target.h"
#include "tests/support/tables.h"

/* Angles and times are numbers, links too, and of no more joints than the motion has. */
static inline void check_numbers(const grobo_motion *motion)
{
    for (size_t n = 0; n < grobo_motion_size(motion); n++) {
        grobo_posture posture;
        double time_s = NAN;
        size_t count;
        MUST(grobo_motion_get(motion, n, &posture) == 0);
        MUST(grobo_motion_time_s(motion, n, &time_s) == 0 && isfinite(time_s));
        MUST(grobo_motion_step_us(motion, n) >= 0);
        MUST((posture.set & ~GROBO_JOINTS_ALL(grobo_motion_joints(motion))) == 0);
        for (int j = 0; j < posture.n_joints; j++) {
            MUST((posture.set & GROBO_JOINT_BIT(j)) == 0 || isfinite(posture.angle_rad[j]));
        }
        const grobo_ik_link *links = grobo_motion_ik_links(motion, n, &count);
        for (size_t i = 0; i < count; i++) {
            MUST(isfinite(links[i].translation_m[0]) && isfinite(links[i].rotation[8]));
        }
    }
}

/* It can be played and checked. */
static inline void check_play(const grobo_motion *motion)
{
    grobo_diagnostics *list = NULL;
    grobo_posture posture;
    grobo_clip clip;

    MUST(grobo_diagnostics_new(NULL, &list) == 0);
    MUST(grobo_motion_check(motion, &grobo_i_gr001_model, NULL, list) >= 0);
    grobo_diagnostics_free(list);
    MUST(grobo_motion_clip(motion, NULL, &clip) == 0);
    for (int i = 0; i <= 8 && clip.sample != NULL; i++) {
        MUST(clip.sample(clip.ctx, clip.length_us / 8 * i, &posture) == 0);
    }
    for (size_t i = 0; i < clip.n_keys; i++) {
        int64_t at_us = -1;
        MUST(clip.key(clip.ctx, i, &posture, &at_us) == 0 && at_us >= 0);
    }
    grobo_motion_clip_free(&clip);
}

/* Reads bytes as a format; an error has a place and leaves nothing. */
static inline grobo_motion *read_bytes(const uint8_t *data, size_t size, grobo_motion_format format,
                                       bool keep_going)
{
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = format,
                                  .model = &grobo_i_gr001_model, .keep_going = keep_going,
                                  .keep_positions = keep_going};
    grobo_motion *motion = NULL;
    grobo_diagnostics *list = NULL;

    MUST(grobo_diagnostics_new(NULL, &list) == 0);
    int result = grobo_motion_read_memory(data, size, &options, list, &motion);
    MUST((result == 0) == (motion != NULL));
    MUST(result == 0 || grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR) > 0);
    grobo_diagnostics_free(list);
    return motion;
}

/* All of it, for one reader. */
static inline int run_reader(const uint8_t *data, size_t size, grobo_motion_format format)
{
    grobo_motion *motion = read_bytes(data, size, format, false);
    grobo_motion *going = read_bytes(data, size, format, true);

    /* Going on after an error makes no file good, and no good file bad. */
    MUST((motion == NULL) == (going == NULL));
    if (motion != NULL) {
        MUST(grobo_motion_equal(motion, going));
        check_numbers(motion);
        check_play(motion);
    }
    grobo_motion_free(going);
    grobo_motion_free(motion);
    return 0;
}

#endif
