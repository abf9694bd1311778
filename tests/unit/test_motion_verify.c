/* SPDX-License-Identifier: MIT */
/* Whatever is written plays what its source plays, and grobo_motion_verify() notices where not. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { KEYS = 6, TRIALS = 25 };
#define KEY_S 0.5 /* on a frame at GROBO_MOTION_RATE_HZ */

static double random_rad(uint32_t *seed)
{
    *seed = *seed * 1664525U + 1013904223U;
    return grobo_rad_from_deg((int)(*seed >> 16) % 200 / 10.0);
}

/* Key poses of some joints, what they mean put down in wanted. */
static grobo_motion *random_motion(grobo_motion_kind kind, grobo_joint_mask joints,
                                   double wanted[KEYS][GROBO_JOINTS_MAX], uint32_t *seed)
{
    grobo_motion *motion = NULL;
    int n_joints = 20;
    while ((joints & GROBO_JOINT_BIT(n_joints - 1)) == 0) {
        n_joints--;
    }
    assert_int_equal(grobo_motion_new(kind, n_joints, NULL, &motion), 0);
    for (int k = 0; k < KEYS; k++) {
        grobo_posture posture;
        (void)grobo_posture_init(&posture, n_joints);
        for (int j = 0; j < n_joints; j++) {
            if ((joints & GROBO_JOINT_BIT(j)) == 0) {
                continue;
            }
            double value = random_rad(seed);
            double before = k > 0 ? wanted[k - 1][j] : grobo_i_gr001_model.joints[j].init_rad;
            wanted[k][j] = kind == GROBO_MOTION_STEPS ? before + value : value;
            (void)grobo_posture_set_rad(&posture, j, value);
        }
        assert_int_equal(grobo_motion_append_at(motion, (k + 1) * KEY_S, &posture), 0);
    }
    if (kind == GROBO_MOTION_FRAMES) {
        assert_int_equal(grobo_motion_set_frame_rate(motion, 1 / KEY_S), 0);
    }
    return motion;
}

/* The largest difference of any joint at any key, by kind of source and by the formats it went
 * through. */
static double worst_rad[GROBO_MOTION_FRAMES + 1][GROBO_FORMAT_YAML + 1][GROBO_FORMAT_YAML + 1];

/* How far what a motion plays is from what is wanted, at the times of the keys. */
static double difference(grobo_motion *motion, grobo_joint_mask joints,
                         double wanted[KEYS][GROBO_JOINTS_MAX], double first_s)
{
    grobo_posture start, at;
    grobo_clip clip;
    double most_rad = 0;

    grobo_motion_start(motion, &grobo_i_gr001_model, &start);
    assert_int_equal(
        grobo_motion_clip(motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .start = &start},
                          &clip),
        0);
    for (int k = 0; k < KEYS; k++) {
        int64_t at_us = (int64_t)((first_s + k * KEY_S) * 1e6 + 0.5);
        assert_int_equal(clip.sample(clip.ctx, at_us, &at), 0);
        assert_int_equal(joints & ~at.set, 0);
        for (int j = 0; j < 20; j++) {
            if ((joints & GROBO_JOINT_BIT(j)) != 0) {
                most_rad = fmax(most_rad, fabs(at.angle_rad[j] - wanted[k][j]));
            }
        }
    }
    grobo_motion_clip_free(&clip);
    return most_rad;
}

static grobo_motion *through(grobo_motion *motion, grobo_motion_format format, bool exact)
{
    const grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model,
                                         .exact = exact};
    char *text = written_as(motion, format, &options, NULL);
    grobo_motion *copy = motion_of(text, format);
    assert_int_equal(grobo_motion_verify(motion, copy, &options, NULL), 0);
    free(text);
    return copy;
}

/* To each format, and from there to each. */
static void expect_lossless(grobo_motion *motion, grobo_joint_mask joints, bool exact,
                            double wanted[KEYS][GROBO_JOINTS_MAX])
{
    grobo_motion_kind kind = grobo_motion_get_kind(motion);
    double begin_s = kind == GROBO_MOTION_FRAMES ? 0 : KEY_S;

    for (grobo_motion_format by = GROBO_FORMAT_M; by <= GROBO_FORMAT_YAML; by++) {
        grobo_motion *copy = through(motion, by, exact);
        for (grobo_motion_format to = GROBO_FORMAT_M; to <= GROBO_FORMAT_YAML; to++) {
            grobo_motion *second = through(copy, to, exact);
            double rad = difference(second, joints, wanted, begin_s);
            /* Angles are multiples of 0.1 degrees, which all formats have. */
            assert_true(rad <= grobo_rad_from_deg(1e-7));
            worst_rad[kind][by][to] = fmax(worst_rad[kind][by][to], rad);
            grobo_motion_free(second);
        }
        grobo_motion_free(copy);
    }
}

/* Every pair of formats, with any joints, for any body that is this robot's. */
TEST(test_nothing_is_lost)
{
    static const char *const bodies[] = {"", "GR001", "SerialRobot"};
    static const char *const kinds[] = {"postures", "keys", "steps", "frames"};
    uint32_t seed = 1;

    for (int trial = 0; trial < TRIALS; trial++) {
        for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
            static double wanted[KEYS][GROBO_JOINTS_MAX];
            seed = seed * 1664525U + 1013904223U;
            grobo_joint_mask joints = (seed >> 8) & GROBO_JOINTS_ALL(1 + trial % 20);
            joints = joints != 0 ? joints : GROBO_JOINT_BIT(trial % 20);
            if (kind ==
                GROBO_MOTION_FRAMES) { /* as files of frames have them: all up to the last */
                joints = GROBO_JOINTS_ALL(1 + trial % 20);
            }
            grobo_motion *motion = random_motion((grobo_motion_kind)kind, joints, wanted, &seed);
            assert_int_equal(grobo_motion_set_target_body(motion, bodies[trial % 3]), 0);
            expect_lossless(motion, joints, trial % 2 == 0, wanted);
            grobo_motion_free(motion);
        }
    }
    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
        for (int by = GROBO_FORMAT_M; by <= GROBO_FORMAT_YAML; by++) {
            for (int to = GROBO_FORMAT_M; to <= GROBO_FORMAT_YAML; to++) {
                print_message("%-8s  %-4s then %-4s  %.2g deg\n", kinds[kind],
                              grobo_motion_format_name((grobo_motion_format)by),
                              grobo_motion_format_name((grobo_motion_format)to),
                              grobo_deg_from_rad(worst_rad[kind][by][to]));
            }
        }
    }
}

/* verify() notices whatever is lost. */
TEST(test_losses_are_noticed)
{
    static const char whole[] = "500  10 -20 30\n1000  40 50 60\n1500  0 0 0\n";
    static const struct {
        const char *text, *code;
    } copies[] = {
        {whole, NULL},
        {"500  10 -20\n1000  40 50\n1500  0 0\n", "angle-lost"},
        {"500  10 -20 30\n1000  40 51 60\n1500  0 0 0\n", "angle-lost"},
        {"500  10 -20 30\n1000  40 50 60\n1500  0 0 1\n", "angle-lost"},
        {"501  10 -20 30\n1000  40 50 60\n1500  0 0 0\n", "time-lost"},
        {"500  10 -20 30\n500  40 50 60\n1500  0 0 0\n", "time-lost"},
        {"500  10 -20 30\n1000  40 50 60\n", "posture-lost"},
        {"500  10 -20 30\n1000  40 50 60\n1500  0 0 0\n2000  0 0 0\n", "posture-lost"},
    };
    grobo_motion *motion = motion_of(whole, GROBO_FORMAT_M);

    for (size_t i = 0; i < sizeof copies / sizeof copies[0]; i++) {
        grobo_motion *copy = motion_of(copies[i].text, GROBO_FORMAT_M);
        grobo_diagnostics *list = NULL;
        assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
        int lost = grobo_motion_verify(motion, copy, NULL, list);
        assert_int_equal(lost, grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR));
        assert_int_equal(lost > 0, copies[i].code != NULL);
        grobo_diagnostic first;
        if (copies[i].code != NULL) {
            assert_int_equal(grobo_diagnostics_get(list, 0, &first), 0);
            assert_string_equal(first.code, copies[i].code);
        }
        grobo_diagnostics_free(list);
        grobo_motion_free(copy);
    }
    grobo_motion_free(motion);
}

static grobo_motion *frames_of(const grobo_motion *motion)
{
    grobo_motion *frames = NULL;

    assert_int_equal(grobo_motion_convert(motion, GROBO_MOTION_FRAMES, NULL, NULL, &frames), 0);
    return frames;
}

/* Frames: one that is wrong, and an end that is missing. */
TEST(test_losses_of_frames_are_noticed)
{
    grobo_motion *motion = motion_of("300  100\n600  0\n900  50\n", GROBO_FORMAT_M);
    grobo_diagnostics *list = NULL;
    grobo_motion *frames = frames_of(motion);
    grobo_posture posture;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(grobo_motion_verify(motion, frames, NULL, list), 0);
    assert_int_equal(grobo_motion_get(frames, 20, &posture), 0);
    posture.angle_rad[12] += 0.001; /* CHEST_P is motor 1 */
    assert_int_equal(grobo_motion_set(frames, 20, &posture), 0);
    assert_int_equal(grobo_motion_verify(motion, frames, NULL, list), 1);
    assert_true(has_diagnostic(list, "angle-lost", 0, 0));
    grobo_motion_free(frames);
    grobo_diagnostics_clear(list);
    frames = frames_of(motion);
    while (grobo_motion_size(frames) > 40) {
        assert_int_equal(grobo_motion_delete(frames, 40), 0);
    }
    assert_int_equal(grobo_motion_verify(motion, frames, NULL, list), 1);
    assert_true(has_diagnostic(list, "time-lost", 0, 0));
    grobo_motion_free(frames);
    grobo_motion_free(motion);
    grobo_diagnostics_free(list);
}
