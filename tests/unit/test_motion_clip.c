/* SPDX-License-Identifier: MIT */
/* Playing motions: keys and samples of every kind, by values worked out by hand. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/support/counted_mem.h"
#include "tests/support/files.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static void assert_near(double value, double expected, double delta)
{
    if (!(fabs(value - expected) <= delta)) {
        fail_msg("%.12g is not %.12g", value, expected);
    }
}

static grobo_clip clip_of(const grobo_motion *motion, const grobo_clip_options *options)
{
    grobo_clip clip;

    assert_int_equal(grobo_motion_clip(motion, options, &clip), 0);
    return clip;
}

static double sample(const grobo_clip *clip, double t_s, int joint)
{
    grobo_posture posture;
    double angle_rad = NAN;

    assert_int_equal(clip->sample(clip->ctx, llround(t_s * 1e6), &posture), 0);
    (void)grobo_posture_get_rad(&posture, joint, &angle_rad);
    return angle_rad;
}

/* One joint: slope 1.5 at t = 1, a reversal at 2, a flat end; another one with a long wait. */
static const char curve[] =
    "type: PoseSeq\nname: t\nrefs:\n"
    "- { time: 0, refer: { type: Pose, joints: [ 0, 1 ], q: [ 0, 0 ] } }\n"
    "- { time: 1, refer: { type: Pose, joints: [ 0 ], q: [ 1 ] } }\n"
    "- { time: 2, refer: { type: Pose, joints: [ 0 ], q: [ 3 ] } }\n"
    "- { time: 3, refer: { type: Pose, joints: [ 0 ], q: [ 2 ] } }\n"
    "- { time: 4, maxTransitionTime: 1, refer: { type: Pose, joints: [ 0, 1, 2 ],"
    " q: [ 2.0005, 1, 7 ] } }\n";

TEST(test_spline)
{
    grobo_motion *motion = motion_of(curve, GROBO_FORMAT_AUTO);
    grobo_clip clip = clip_of(motion, NULL);

    assert_int_equal(clip.n_keys, 5);
    assert_int_equal(clip.length_us, 4000000);
    assert_false(clip.relative);
    /* Slopes 0, 1.5, 0, 0, 0. Hermite at the middle: (a + b) / 2 + (slope a - slope b) / 8. */
    assert_near(sample(&clip, 0.5, 0), 0.5 - 1.5 / 8, 1e-12);
    assert_near(sample(&clip, 1.0, 0), 1, 0);
    assert_near(sample(&clip, 1.5, 0), 2 + 1.5 / 8, 1e-12);
    assert_near(sample(&clip, 2.5, 0), 2.5, 1e-12);
    assert_near(sample(&clip, 3.5, 0), (2 + 2.0005) / 2, 1e-12);
    /* Joint 1 waits until 3, joint 2 has one key and holds it. */
    assert_near(sample(&clip, 3.0, 1), 0, 0);
    assert_near(sample(&clip, 3.25, 1), 0.15625, 1e-12);
    assert_near(sample(&clip, 3.5, 1), 0.5, 1e-12);
    assert_near(sample(&clip, 0, 2), 7, 0);
    assert_near(sample(&clip, 9, 0), 2.0005, 0);
    assert_near(sample(&clip, -1, 0), 0, 0);
    grobo_motion_clip_free(&clip);
    assert_null(clip.ctx);
    grobo_motion_free(motion);
}

TEST(test_keys)
{
    grobo_motion *motion = motion_of(curve, GROBO_FORMAT_AUTO);
    grobo_clip clip = clip_of(motion, NULL);
    grobo_posture posture;
    int64_t at_us = -1;

    assert_int_equal(clip.key(clip.ctx, 0, &posture, &at_us), 0);
    assert_int_equal(at_us, 0);
    assert_int_equal(posture.time_us, 0);
    assert_int_equal(posture.set, 3);
    assert_int_equal(clip.key(clip.ctx, 4, &posture, &at_us), 0);
    assert_int_equal(at_us, 4000000);
    assert_int_equal(posture.time_us, 1000000);
    assert_int_equal(posture.set, 7);
    assert_true(posture.angle_rad[2] == 7.0);
    at_us = -1;
    assert_int_equal(clip.key(clip.ctx, 5, &posture, &at_us), GROBO_ERR_ARG);
    assert_int_equal(at_us, -1);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

/* The seed: a posture is a copy of the one before, and the servos go straight. */
TEST(test_seed_style)
{
    grobo_motion *motion = motion_of(curve, GROBO_FORMAT_AUTO);
    grobo_clip clip =
        clip_of(motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .style = GROBO_STYLE_SEED});

    assert_near(sample(&clip, 0.5, 0), 0.5, 1e-12);
    assert_near(sample(&clip, 2.25, 0), 2.75, 1e-12);
    assert_near(sample(&clip, 3.0, 1), 0, 1e-12);
    assert_near(sample(&clip, 3.25, 1), 0.25, 1e-12);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

TEST(test_unsorted_keys)
{
    grobo_motion *motion =
        motion_of("type: PoseSeq\nname: t\nrefs:\n"
                  "- { time: 2, refer: { type: Pose, joints: [ 0 ], q: [ 2 ] } }\n"
                  "- { time: 0, refer: { type: Pose, joints: [ 0 ], q: [ 0 ] } }\n"
                  "- { time: 2, refer: { type: Pose, joints: [ 0 ], q: [ 5 ] } }\n",
                  GROBO_FORMAT_AUTO);
    grobo_clip clip = clip_of(motion, NULL);
    static const double angles_rad[] = {0, 2, 5};

    for (size_t i = 0; i < 3; i++) {
        grobo_posture posture;
        int64_t at_us;
        assert_int_equal(clip.key(clip.ctx, i, &posture, &at_us), 0);
        assert_int_equal(at_us, i == 0 ? 0 : 2000000);
        assert_true(posture.angle_rad[0] == angles_rad[i]);
    }
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

/* .m: cumulated milliseconds; the third line restarts and takes the default time. */
TEST(test_postures)
{
    grobo_motion *motion =
        motion_of("500 0 100\n1000 10 100\n500 20 100\n700 40 100\n", GROBO_FORMAT_M);
    grobo_clip clip =
        clip_of(motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .default_us = 300000});
    double ddeg = atan(1) / 450;
    grobo_posture posture;
    int64_t at_us;

    assert_int_equal(clip.length_us, 1500000);
    assert_int_equal(clip.key(clip.ctx, 2, &posture, &at_us), 0);
    assert_int_equal(at_us, 1300000);
    assert_int_equal(posture.time_us, 300000);
    int joint = grobo_model_joint_of_motor(&grobo_i_gr001_model, 1);
    assert_near(sample(&clip, 0.2, joint), 0, 0);
    assert_near(sample(&clip, 0.75, joint), 5 * ddeg, 1e-12);
    assert_near(sample(&clip, 1.15, joint), 15 * ddeg, 1e-9);
    assert_near(sample(&clip, 1.4, joint), 30 * ddeg, 1e-9);
    assert_near(sample(&clip, 5, joint), 40 * ddeg, 1e-12);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

static const char steps[] = "type: MotionSeq\nname:\nrefs:\n"
                            "- { time: 0.5, refer: { type: Motion, joints: [ 0 ], q: [ 0.1 ] } }\n"
                            "- { time: 0.5, refer: { type: Motion, joints: [ 1 ], q: [ 0.2 ] } }\n"
                            "- { time: 1, refer: { type: Motion, joints: [ 0 ], q: [ 0.3 ] } }\n";

TEST(test_increments)
{
    grobo_motion *motion = motion_of(steps, GROBO_FORMAT_AUTO);
    grobo_posture start, posture;
    int64_t at_us;
    grobo_clip clip = clip_of(motion, NULL);

    assert_true(clip.relative);
    assert_null(clip.sample);
    assert_int_equal(clip.key(clip.ctx, 2, &posture, &at_us), 0);
    assert_near(posture.angle_rad[0], 0.3, 0);
    assert_int_equal(at_us, 500000 + GROBO_MOTION_DEFAULT_US + 500000);
    grobo_motion_clip_free(&clip);

    (void)grobo_posture_init(&start, 2);
    assert_int_equal(
        grobo_motion_clip(motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .start = &start},
                          &clip),
        GROBO_ERR_ARG);
    (void)grobo_posture_set_rad(&start, 0, 1);
    (void)grobo_posture_set_rad(&start, 1, -1);
    clip = clip_of(motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .start = &start});
    assert_false(clip.relative);
    assert_int_equal(clip.key(clip.ctx, 2, &posture, &at_us), 0);
    assert_near(posture.angle_rad[0], 1.4, 1e-15);
    assert_near(sample(&clip, 0, 0), 1, 0);
    assert_near(sample(&clip, 0.25, 0), 1.05, 1e-12);
    assert_near(sample(&clip, 0.5, 1), -1, 1e-12);
    assert_near(sample(&clip, 0.625, 1), -0.9, 1e-12);
    assert_near(sample(&clip, 1.25, 0), 1.4, 1e-12);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

TEST(test_frames)
{
    grobo_motion *motion =
        motion_of("type: BodyMotion\ncomponents:\n- { type: MultiValueSeq, purpose: JointPosition,"
                  " frameRate: 10, numParts: 1, frames: [ [ 0 ], [ 1 ], [ 4 ] ] }\n",
                  GROBO_FORMAT_AUTO);
    grobo_clip clip = clip_of(motion, NULL);

    assert_int_equal(clip.length_us, 200000);
    assert_near(sample(&clip, 0.1, 0), 1, 0);
    assert_near(sample(&clip, 0.15, 0), 2.5, 1e-12);
    assert_near(sample(&clip, 1, 0), 4, 0);
    grobo_motion_clip_free(&clip);
    /* Times of their own. */
    assert_int_equal(grobo_motion_set_frame_times(motion, true), 0);
    assert_int_equal(grobo_motion_set_time_s(motion, 2, 1.1), 0);
    clip = clip_of(motion, NULL);
    assert_near(sample(&clip, 0.6, 0), 2.5, 1e-12);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

TEST(test_frames_without_rate)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;
    grobo_clip clip;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_FRAMES, 1, NULL, &motion), 0);
    (void)grobo_posture_init(&posture, 1);
    assert_int_equal(grobo_motion_append(motion, &posture), 0);
    assert_int_equal(grobo_motion_clip(motion, NULL, &clip), GROBO_ERR_STATE);
    grobo_motion_free(motion);
}

TEST(test_resample)
{
    grobo_motion *motion = motion_of(curve, GROBO_FORMAT_AUTO);
    grobo_clip clip = clip_of(motion, NULL);
    grobo_motion *frames = NULL;

    assert_int_equal(grobo_motion_resample(&clip, NAN, NULL, &frames), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_resample(&clip, 0, NULL, &frames), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_resample(&clip, 1e9, NULL, &frames), GROBO_ERR_CAP);
    assert_null(frames);
    assert_int_equal(grobo_motion_resample(&clip, 2, NULL, &frames), 0);
    assert_int_equal(grobo_motion_size(frames), 9);
    assert_true(grobo_motion_frame_rate(frames) == 2.0);
    assert_near(angle_of(frames, 1, 0), 0.5 - 1.5 / 8, 1e-12);
    assert_near(angle_of(frames, 8, 0), 2.0005, 0);
    grobo_motion_free(frames);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

/* Frames resampled at their own rate are themselves, to the bit. */
TEST(test_resample_is_exact_on_frames)
{
    grobo_motion *motion = NULL, *frames = NULL;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_FRAMES, 1, NULL, &motion), 0);
    assert_int_equal(grobo_motion_set_frame_rate(motion, 30), 0);
    (void)grobo_posture_init(&posture, 1);
    for (int i = 0; i < 2000; i++) {
        (void)grobo_posture_set_rad(&posture, 0, (i * 7919) % 10000 / 10000.0);
        assert_int_equal(grobo_motion_append(motion, &posture), 0);
    }
    grobo_clip clip = clip_of(motion, NULL);

    assert_int_equal(grobo_motion_resample(&clip, 30, NULL, &frames), 0);
    assert_true(grobo_motion_equal(motion, frames));
    grobo_motion_free(frames);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}

/* Playing allocates nothing, and preparing takes failures. */
TEST(test_allocations)
{
    counted_mem counter = {0};
    grobo_mem mem = counted_mem_of(&counter);
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem};
    grobo_motion *motion = NULL;
    grobo_clip clip;

    assert_int_equal(grobo_motion_read_memory(curve, strlen(curve), &options, NULL, &motion), 0);
    size_t bytes = counter.bytes;
    for (size_t n = 1;; n++) {
        counter.fail_at = counter.calls + n;
        int result = grobo_motion_clip(motion, NULL, &clip);
        counter.fail_at = 0;
        if (result == 0) {
            break;
        }
        assert_int_equal(result, GROBO_ERR_NOMEM);
        assert_int_equal(counter.bytes, bytes);
    }
    size_t calls = counter.calls;
    for (int i = 0; i < 100; i++) {
        (void)sample(&clip, 0.05 * i, 0);
    }
    assert_int_equal(counter.calls, calls);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
    assert_int_equal(counter.bytes, 0);
}

/* Choreonoid's own frames: the joints that inverse kinematics leaves alone. */
static void compare_golden(const char *motion_name, const char *frames_name)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s", shared_file(motion_name));
    grobo_motion *motion = NULL, *frames = NULL;
    assert_int_equal(grobo_motion_read_file(path, NULL, NULL, &motion), 0);
    FILE *golden = fopen(shared_file(frames_name), "r");
    grobo_clip clip = clip_of(motion, NULL);
    assert_int_equal(grobo_motion_resample(&clip, 30, NULL, &frames), 0);
    char line[4096];
    size_t n = 0;

    while (fgets(line, sizeof line, golden) != NULL) {
        char *p = line;
        for (int j = 0; j < 20; j++) {
            double expected = strtod(p, &p);
            p += *p == ',';
            if (j >= 12) {
                assert_near(angle_of(frames, n, j), expected, 1e-6);
            }
        }
        n++;
    }
    assert_true(n > 0);
    assert_int_equal(grobo_motion_size(frames), n);
    fclose(golden);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(frames);
    grobo_motion_free(motion);
}

TEST(test_golden_sample)
{
    compare_golden("data/choreonoid/GR001-SampleMotion1.pseq",
                   "data/golden/SampleMotion1.r30.plain.csv");
}

TEST(test_golden_misc)
{
    compare_golden("data/golden/misc.pseq", "data/golden/misc.r30.plain.csv");
}

TEST(test_golden_walk)
{
    compare_golden("data/golden/walk.pseq", "data/golden/walk.r30.plain.csv");
}
