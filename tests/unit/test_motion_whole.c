/* SPDX-License-Identifier: MIT */
/* Editing and comparing whole motions. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/support/counted_mem.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static const char keys[] =
    "type: PoseSeq\nname: t\nrefs:\n"
    "- { time: 0, refer: { type: Pose, joints: [ 0, 1 ], q: [ 0, 0.5 ], zmp: [ 0, 0.25, 0 ] } }\n"
    "- { time: 1, refer: { type: Pose, joints: [ 0 ], q: [ 1 ], spJoints: [ 0 ] } }\n"
    "- { time: 4, maxTransitionTime: 1, refer: { type: Pose, joints: [ 0, 1 ], q: [ 2, 0 ],"
    " zmp: [ 0, 0, 0 ] } }\n";

static grobo_motion *frames_of(double rate_hz, int count, double first_rad)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_FRAMES, 1, NULL, &motion), 0);
    assert_int_equal(grobo_motion_set_frame_rate(motion, rate_hz), 0);
    (void)grobo_posture_init(&posture, 1);
    for (int i = 0; i < count; i++) {
        (void)grobo_posture_set_rad(&posture, 0, first_rad + i);
        assert_int_equal(grobo_motion_append(motion, &posture), 0);
    }
    return motion;
}

static double sample(const grobo_motion *motion, double t_s, int joint)
{
    grobo_clip clip;
    grobo_posture posture;
    double angle_rad = NAN;

    assert_int_equal(grobo_motion_clip(motion, NULL, &clip), 0);
    assert_int_equal(clip.sample(clip.ctx, llround(t_s * 1e6), &posture), 0);
    (void)grobo_posture_get_rad(&posture, joint, &angle_rad);
    grobo_motion_clip_free(&clip);
    return angle_rad;
}

TEST(test_equal_and_near)
{
    grobo_motion *a = motion_of(keys, GROBO_FORMAT_AUTO), *b = NULL;
    grobo_posture posture;

    assert_int_equal(grobo_motion_dup(a, &b), 0);
    assert_true(grobo_motion_equal(a, b));
    assert_int_equal(grobo_motion_get(b, 1, &posture), 0);
    posture.angle_rad[0] += 0.01;
    assert_int_equal(grobo_motion_set(b, 1, &posture), 0);
    assert_false(grobo_motion_equal(a, b));
    assert_true(grobo_motion_near(a, b, 0.011, 1e-6));
    assert_false(grobo_motion_near(a, b, 0.009, 1e-6));
    assert_int_equal(grobo_motion_set_time_s(b, 2, 4.1), 0);
    assert_false(grobo_motion_near(a, b, 0.011, 0.05));
    assert_true(grobo_motion_near(a, b, 0.011, 0.2));
    assert_int_equal(grobo_motion_delete(b, 2), 0);
    assert_false(grobo_motion_near(a, b, 1, 10));
    grobo_motion_free(a);
    grobo_motion_free(b);
}

TEST(test_append_motion)
{
    grobo_motion *motion = motion_of(keys, GROBO_FORMAT_AUTO);

    assert_int_equal(grobo_motion_append_motion(motion, motion), 0);
    assert_int_equal(grobo_motion_size(motion), 6);
    assert_true(time_of(motion, 5) == 8.0);
    assert_int_equal(grobo_motion_step_us(motion, 3), 0);
    assert_true(angle_of(motion, 5, 0) == 2.0);
    grobo_motion_free(motion);
}

/* Appends 0.2 to 0.6 s that end at 0.3, by increments 0.3 further than the motion did. */
static void append_and_look(grobo_motion *motion, const grobo_motion *other, bool concat)
{
    double end_s = (double)grobo_motion_length_us(motion, -1) / 1e6;
    size_t size = grobo_motion_size(motion);
    bool relative = grobo_motion_get_kind(other) == GROBO_MOTION_STEPS;
    double from_rad = angle_of(motion, size - 1, 0);
    int result = concat ? grobo_motion_concat(motion, other, 100000)
                        : grobo_motion_append_motion(motion, other);

    assert_int_equal(result, 0);
    assert_true(grobo_motion_size(motion) >= size + 2);
    end_s = (double)grobo_motion_length_us(motion, -1) / 1e6 - end_s;
    assert_true(end_s > 0.19 && end_s < 1.01);
    double to_rad = angle_of(motion, grobo_motion_size(motion) - 1, 0);
    assert_true(fabs(to_rad - (relative ? from_rad + 0.3 : 0.3)) < 1e-9);
}

static grobo_motion *any_of(grobo_motion_kind kind, double rate_hz)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;

    assert_int_equal(grobo_motion_new(kind, 2, NULL, &motion), 0);
    if (kind == GROBO_MOTION_FRAMES && rate_hz > 0) {
        assert_int_equal(grobo_motion_set_frame_rate(motion, rate_hz), 0);
    } else if (kind == GROBO_MOTION_FRAMES) {
        assert_int_equal(grobo_motion_set_frame_times(motion, true), 0);
        assert_int_equal(grobo_motion_set_frame_rate(motion, 10), 0);
    }
    for (int i = 1; i <= 3; i++) {
        (void)grobo_posture_init(&posture, 2);
        (void)grobo_posture_set_rad(&posture, 0, kind == GROBO_MOTION_STEPS ? 0.1 : 0.1 * i);
        posture.time_us = 200000;
        assert_int_equal(grobo_motion_append(motion, &posture), 0);
    }
    return motion;
}

TEST(test_append_another_kind)
{
    static const grobo_motion_kind kinds[] = {GROBO_MOTION_POSTURES, GROBO_MOTION_KEYS,
                                              GROBO_MOTION_FRAMES,   GROBO_MOTION_FRAMES,
                                              GROBO_MOTION_FRAMES,   GROBO_MOTION_STEPS};
    static const double rates_hz[] = {0, 0, 5, 10, 0, 0};

    for (int to = 0; to < 5; to++) {
        for (int from = 0; from < 6; from++) {
            for (int concat = 0; concat < 2; concat++) {
                grobo_motion *motion = any_of(kinds[to], rates_hz[to]);
                grobo_motion *other = any_of(kinds[from], rates_hz[from]);
                append_and_look(motion, other, concat != 0);
                assert_int_equal(grobo_motion_get_kind(motion), kinds[to]);
                /* The second joint is set by neither. */
                for (size_t n = 0; n < grobo_motion_size(motion); n++) {
                    grobo_posture posture;
                    assert_int_equal(grobo_motion_get(motion, n, &posture), 0);
                    assert_int_equal(posture.set, 1);
                }
                grobo_motion_free(motion);
                grobo_motion_free(other);
            }
        }
    }
}

/* What cannot be converted without a guess is refused, and nothing has changed. */
TEST(test_append_never_mixes)
{
    grobo_motion *steps = any_of(GROBO_MOTION_STEPS, 0);
    grobo_motion *before = NULL;
    grobo_motion *empty = NULL;
    grobo_motion *keys_of = any_of(GROBO_MOTION_KEYS, 0);
    grobo_motion *frames = NULL;

    assert_int_equal(grobo_motion_dup(steps, &before), 0);
    assert_int_equal(grobo_motion_append_motion(steps, keys_of), GROBO_ERR_TYPE);
    assert_int_equal(grobo_motion_concat(steps, keys_of, 0), GROBO_ERR_TYPE);
    assert_true(grobo_motion_equal(steps, before));
    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 2, NULL, &empty), 0);
    assert_int_equal(grobo_motion_append_motion(empty, steps), GROBO_ERR_TYPE);
    assert_int_equal(grobo_motion_size(empty), 0);
    assert_int_equal(grobo_motion_append_motion(empty, keys_of), 0);
    assert_int_equal(grobo_motion_append_motion(empty, steps), 0);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_FRAMES, 2, NULL, &frames), 0);
    assert_int_equal(grobo_motion_append_motion(frames, keys_of), GROBO_ERR_STATE);
    assert_int_equal(grobo_motion_set_joints(frames, 1), 1);
    assert_int_equal(grobo_motion_append_motion(frames, keys_of), GROBO_ERR_ARG);
    grobo_motion_free(steps);
    grobo_motion_free(before);
    grobo_motion_free(empty);
    grobo_motion_free(keys_of);
    grobo_motion_free(frames);
}

TEST(test_concat_keys)
{
    grobo_motion *motion = motion_of(keys, GROBO_FORMAT_AUTO);
    grobo_motion *other = NULL;

    assert_int_equal(grobo_motion_dup(motion, &other), 0);
    assert_int_equal(grobo_motion_concat(motion, other, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_concat(motion, other, 500000), 0);
    assert_int_equal(grobo_motion_size(motion), 6);
    assert_true(time_of(motion, 3) == 4.5);
    assert_true(time_of(motion, 5) == 8.5);
    grobo_motion_free(motion);
    grobo_motion_free(other);
}

TEST(test_concat_frames)
{
    grobo_motion *motion = frames_of(10, 2, 0), *other = frames_of(10, 2, 5);

    assert_int_equal(grobo_motion_concat(motion, other, 400000), 0);
    /* 0 1 | three between, eased | 5 6 */
    assert_int_equal(grobo_motion_size(motion), 7);
    assert_true(fabs(angle_of(motion, 3, 0) - 3) < 1e-12);
    assert_true(fabs(angle_of(motion, 2, 0) - (1 + 4 * 0.15625)) < 1e-12);
    assert_true(angle_of(motion, 5, 0) == 5.0);
    assert_true(time_of(motion, 5) == 0.5);
    assert_int_equal(grobo_motion_concat(other, other, 0), 0);
    assert_int_equal(grobo_motion_size(other), 4);
    grobo_motion_free(motion);
    grobo_motion_free(other);
}

TEST(test_concat_postures)
{
    grobo_motion *motion = motion_of("500 0\n900 1\n", GROBO_FORMAT_M);
    grobo_motion *other = motion_of("700 2\n1000 3\n", GROBO_FORMAT_M);

    assert_int_equal(grobo_motion_concat(motion, other, 250000), 0);
    assert_int_equal(grobo_motion_step_us(motion, 2), 250000);
    assert_int_equal(grobo_motion_step_us(motion, 3), 300000);
    grobo_motion_free(motion);
    grobo_motion_free(other);
}

TEST(test_mirror)
{
    grobo_motion *motion = NULL, *back = NULL;
    grobo_posture posture;
    grobo_ik_link links[2] = {{.index = 6,
                               .name = "R_ANKLE_R",
                               .translation_m = {0.1, -0.2, 0.3},
                               .rotation = {1, 2, 3, 4, 5, 6, 7, 8, 9}},
                              {.index = 0, .name = "WAIST", .is_base = true}};
    int right = grobo_model_find_joint(&grobo_i_gr001_model, "R_KNEE_P", 8);
    int left = grobo_model_find_joint(&grobo_i_gr001_model, "L_KNEE_P", 8);
    int neck = grobo_model_find_joint(&grobo_i_gr001_model, "NECK_Y", 6);
    size_t count;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, 20, NULL, &motion), 0);
    (void)grobo_posture_init(&posture, 20);
    (void)grobo_posture_set_rad(&posture, right, -0.5);
    (void)grobo_posture_set_rad(&posture, neck, 0.25);
    assert_int_equal(grobo_motion_append(motion, &posture), 0);
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, 2), 0);
    assert_int_equal(
        grobo_motion_set_key(motion, 0, &(grobo_key_info){.stationary = GROBO_JOINT_BIT(right)}),
        0);
    assert_int_equal(grobo_motion_dup(motion, &back), 0);
    assert_int_equal(grobo_motion_mirror(motion, &grobo_i_gr001_model), 0);
    assert_true(angle_of(motion, 0, left) == 0.5);
    assert_true(isnan(angle_of(motion, 0, right)));
    assert_true(angle_of(motion, 0, neck) == -0.25);
    const grobo_ik_link *mirrored = grobo_motion_ik_links(motion, 0, &count);
    static const double turned[9] = {1, -2, 3, -4, 5, -6, 7, -8, 9};
    assert_string_equal(mirrored[0].name, "L_ANKLE_R");
    assert_int_equal(mirrored[0].index, 12);
    assert_true(mirrored[0].translation_m[1] == 0.2);
    assert_memory_equal(mirrored[0].rotation, turned, sizeof turned);
    assert_string_equal(mirrored[1].name, "WAIST");
    assert_int_equal(mirrored[1].index, 0);
    grobo_key_info info;
    assert_int_equal(grobo_motion_get_key(motion, 0, &info), 0);
    assert_true(info.stationary == GROBO_JOINT_BIT(left));
    assert_int_equal(grobo_motion_mirror(motion, &grobo_i_gr001_model), 0);
    assert_true(grobo_motion_equal(motion, back));
    /* A side that no table knows. */
    memcpy(links[0].name, "R_TOE", 6);
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, 2), 0);
    assert_int_equal(grobo_motion_mirror(motion, &grobo_i_gr001_model), GROBO_ERR_NOTFOUND);
    assert_true(angle_of(motion, 0, right) == -0.5); /* untouched */
    /* The link of the last joint, and the first that there is not. */
    for (int behind = 0; behind < 2; behind++) {
        links[0] = (grobo_ik_link){.index = 20 + behind};
        assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, 1), 0);
        assert_int_equal(grobo_motion_mirror(motion, &grobo_i_gr001_model),
                         behind ? GROBO_ERR_NOTFOUND : 0);
    }
    grobo_motion_free(motion);
    grobo_motion_free(back);
}

/* Of a motion that has no length but its begin, too. */
TEST(no_time_is_scaled_without_bound)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;
    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, 20, NULL, &motion), 0);
    assert_int_equal(grobo_posture_init(&posture, 20), 0);
    assert_int_equal(grobo_posture_set_rad(&posture, 3, 0.1), 0);
    assert_int_equal(grobo_motion_append_at(motion, 0, &posture), 0);
    assert_int_equal(grobo_motion_scale_time(motion, (double)INFINITY), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_scale_time(motion, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_scale_time(motion, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_scale_time(motion, 2), 0);
    grobo_motion_free(motion);
}

/* Backwards the same curve is run, waits included, and twice backwards is the same again. */
TEST(test_reverse_keys)
{
    grobo_motion *motion = motion_of(keys, GROBO_FORMAT_AUTO), *forward = NULL;
    grobo_key_info info;

    assert_int_equal(grobo_motion_dup(motion, &forward), 0);
    assert_int_equal(grobo_motion_reverse(motion), 0);
    assert_int_equal(grobo_motion_size(motion), 4); /* and the wait */
    for (int i = 0; i <= 40; i++) {
        for (int j = 0; j < 2; j++) {
            assert_true(fabs(sample(forward, 0.1 * i, j) - sample(motion, 4 - 0.1 * i, j)) < 1e-9);
        }
    }
    assert_int_equal(grobo_motion_get_key(motion, 1, &info), 0);
    assert_true(info.has_zmp && info.zmp_stationary && info.zmp_m[1] == 0.25);
    assert_int_equal(grobo_motion_reverse(motion), 0);
    for (int i = 0; i <= 40; i++) {
        assert_true(fabs(sample(forward, 0.1 * i, 1) - sample(motion, 0.1 * i, 1)) < 1e-9);
    }
    grobo_motion_free(motion);
    grobo_motion_free(forward);
}

TEST(test_reverse_keys_with_links)
{
    grobo_motion *motion = motion_of(keys, GROBO_FORMAT_AUTO);
    grobo_ik_link link = {.index = 6, .name = "R_ANKLE_R", .translation_m = {1, 2, 3}};
    size_t count;

    assert_int_equal(grobo_motion_set_ik_links(motion, 0, &link, 1), 0);
    link.translation_m[0] = 9;
    assert_int_equal(grobo_motion_set_ik_links(motion, 2, &link, 1), 0);
    assert_int_equal(grobo_motion_reverse(motion), 0);
    const grobo_ik_link *held = grobo_motion_ik_links(motion, 1, &count);
    assert_int_equal(count, 1);
    assert_true(held->translation_m[0] == 1.0 && held->is_stationary);
    held = grobo_motion_ik_links(motion, 3, &count);
    assert_true(count == 1 && held->is_stationary);
    grobo_motion_free(motion);
}

TEST(test_reverse_postures_and_steps)
{
    grobo_motion *motion = motion_of("500 0\n900 1\n900 2\n1500 3\n", GROBO_FORMAT_M);
    static const int64_t steps_us[] = {500000, 600000, 0, 400000};
    int joint = grobo_model_joint_of_motor(&grobo_i_gr001_model, 1);

    assert_int_equal(grobo_motion_reverse(motion), 0);
    for (size_t n = 0; n < 4; n++) {
        assert_int_equal(grobo_motion_step_us(motion, n), steps_us[n]);
        assert_true(fabs(angle_of(motion, n, joint) - (3 - (double)n) * atan(1) / 450) < 1e-15);
    }
    grobo_motion_free(motion);
    motion = motion_of("type: MotionSeq\nname: t\nrefs:\n"
                       "- { time: 0.5, refer: { type: Motion, joints: [ 0 ], q: [ 1 ] } }\n"
                       "- { time: 0.75, refer: { type: Motion, joints: [ 0 ], q: [ 3 ] } }\n",
                       GROBO_FORMAT_AUTO);
    assert_int_equal(grobo_motion_reverse(motion), 0);
    assert_true(angle_of(motion, 0, 0) == -3.0 && angle_of(motion, 1, 0) == -1.0);
    assert_int_equal(grobo_motion_step_us(motion, 0), 250000);
    assert_int_equal(grobo_motion_step_us(motion, 1), 500000);
    grobo_motion_free(motion);
    motion = frames_of(10, 3, 0);
    assert_int_equal(grobo_motion_reverse(motion), 0);
    assert_true(angle_of(motion, 0, 0) == 2.0 && time_of(motion, 2) == 0.2);
    grobo_motion_free(motion);
}

TEST(test_scale_time)
{
    grobo_motion *motion = motion_of(keys, GROBO_FORMAT_AUTO);
    grobo_key_info info;

    assert_int_equal(grobo_motion_scale_time(motion, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_scale_time(motion, NAN), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_scale_time(motion, 1e9), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_scale_time(motion, 2), 0);
    assert_true(time_of(motion, 2) == 8.0);
    assert_int_equal(grobo_motion_get_key(motion, 2, &info), 0);
    assert_true(info.max_transition_s == 2.0);
    grobo_motion_free(motion);

    motion = motion_of("500 0\n900 1\n400 2\n9000 3\n", GROBO_FORMAT_M);
    assert_int_equal(grobo_motion_scale_time(motion, 2), GROBO_ERR_CAP);
    assert_int_equal(grobo_motion_scale_time(motion, 0.5), 0);
    assert_int_equal(grobo_motion_step_us(motion, 0), 250000);
    assert_int_equal(grobo_motion_step_us(motion, 1), 200000);
    assert_int_equal(grobo_motion_step_us(motion, 2), 0);
    assert_int_equal(grobo_motion_step_us(motion, 3), 4300000);
    grobo_motion_free(motion);

    motion = frames_of(10, 3, 0);
    assert_int_equal(grobo_motion_scale_time(motion, 4), 0);
    assert_true(grobo_motion_frame_rate(motion) == 2.5);
    grobo_motion_free(motion);
}

TEST(test_crop_keys)
{
    grobo_motion *motion = motion_of(keys, GROBO_FORMAT_AUTO), *whole = NULL;

    assert_int_equal(grobo_motion_dup(motion, &whole), 0);
    assert_int_equal(grobo_motion_crop(motion, -1, 5), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_crop(motion, 5, 4), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_crop(motion, 500000, 2000000), 0);
    assert_int_equal(grobo_motion_size(motion), 3);
    assert_true(time_of(motion, 1) == 0.5 && time_of(motion, 2) == 1.5);
    assert_true(fabs(angle_of(motion, 0, 0) - sample(whole, 0.5, 0)) < 1e-12);
    assert_true(angle_of(motion, 1, 0) == 1.0 && angle_of(motion, 2, 0) == 1.0);
    /* All of it; behind it; a single moment. */
    grobo_motion_free(motion);
    assert_int_equal(grobo_motion_dup(whole, &motion), 0);
    assert_int_equal(grobo_motion_crop(motion, 0, 99000000), 0);
    assert_true(grobo_motion_equal(motion, whole));
    assert_int_equal(grobo_motion_crop(motion, 4000000, 4000000), 0);
    assert_int_equal(grobo_motion_size(motion), 1);
    assert_true(angle_of(motion, 0, 0) == 2.0);
    assert_int_equal(grobo_motion_crop(whole, 50000000, 60000000), 0);
    assert_int_equal(grobo_motion_size(whole), 1);
    assert_true(time_of(whole, 0) == 0.0 && angle_of(whole, 0, 0) == 2.0);
    grobo_motion_free(motion);
    grobo_motion_free(whole);
}

TEST(test_crop_steps_and_frames)
{
    grobo_motion *motion =
        motion_of("type: MotionSeq\nname: t\nrefs:\n"
                  "- { time: 1, refer: { type: Motion, joints: [ 0 ], q: [ 1 ] } }\n"
                  "- { time: 2, refer: { type: Motion, joints: [ 0 ], q: [ 4 ] } }\n",
                  GROBO_FORMAT_AUTO);

    assert_int_equal(grobo_motion_crop(motion, 500000, 1250000), 0);
    assert_int_equal(grobo_motion_size(motion), 2);
    assert_true(angle_of(motion, 0, 0) == 0.5 && angle_of(motion, 1, 0) == 1.0);
    assert_true(time_of(motion, 0) == 0.5 && time_of(motion, 1) == 0.75);
    grobo_motion_free(motion);
    motion = frames_of(30, 10, 0);
    assert_int_equal(grobo_motion_crop(motion, 100000, 200000), 0);
    assert_int_equal(grobo_motion_size(motion), 4);
    assert_true(angle_of(motion, 0, 0) == 3.0 && angle_of(motion, 3, 0) == 6.0);
    grobo_motion_free(motion);
}

/* Whatever fails for want of memory leaves the motion as it was. */
static int edit(grobo_motion *motion, int what)
{
    switch (what) {
    case 0:
        return grobo_motion_reverse(motion);
    case 1:
        return grobo_motion_crop(motion, 500000, 3000000);
    case 2:
        return grobo_motion_concat(motion, motion, 100000);
    case 3:
        return grobo_motion_append_motion(motion, motion);
    default:
        return grobo_motion_mirror(motion, &grobo_i_gr001_model);
    }
}

TEST(test_allocations_fail)
{
    for (int what = 0; what < 5; what++) {
        int result = GROBO_ERR_NOMEM;
        for (size_t n = 1; result < 0; n++) {
            counted_mem counter = {0};
            grobo_mem mem = counted_mem_of(&counter);
            grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem};
            grobo_motion *motion = NULL, *before = NULL;
            assert_int_equal(grobo_motion_read_memory(keys, strlen(keys), &options, NULL, &motion),
                             0);
            assert_int_equal(grobo_motion_set_joints(motion, 20), 20);
            assert_int_equal(grobo_motion_dup(motion, &before), 0);
            counter.fail_at = counter.calls + n;
            result = edit(motion, what);
            assert_true(result == 0 || result == GROBO_ERR_NOMEM);
            assert_true(result == 0 || grobo_motion_equal(motion, before));
            grobo_motion_free(motion);
            grobo_motion_free(before);
            assert_int_equal(counter.bytes, 0);
        }
    }
}
