/* SPDX-License-Identifier: MIT */
/* The container: storage, editing single postures, walking through. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>
#include <grobo/motion_io.h>

#include "tests/support/counted_mem.h"
#include "tests/support/motion_texts.h"
#include "tests/support/test.h"

static grobo_posture posture_of(int n_joints, double angle_rad, int64_t time_us)
{
    grobo_posture posture;

    assert_int_equal(grobo_posture_init(&posture, n_joints), 0);
    for (int j = 0; j < n_joints; j++) {
        assert_int_equal(grobo_posture_set_rad(&posture, j, angle_rad + j), 0);
    }
    posture.time_us = time_us;
    return posture;
}

/* Postures 0, 1, 2, ...: angle n, one second apart, the first at 0. */
static grobo_motion *counting(grobo_motion_kind kind, int n_joints, size_t size)
{
    grobo_motion *motion = NULL;

    assert_int_equal(grobo_motion_new(kind, n_joints, NULL, &motion), 0);
    for (size_t n = 0; n < size; n++) {
        grobo_posture posture = posture_of(n_joints, (double)n, n > 0 ? 1000000 : 0);
        assert_int_equal(grobo_motion_append(motion, &posture), 0);
    }
    return motion;
}

static double first_angle(const grobo_motion *motion, size_t n)
{
    grobo_posture posture;

    assert_int_equal(grobo_motion_get(motion, n, &posture), 0);
    return posture.angle_rad[0];
}

TEST(test_new_refuses)
{
    grobo_motion *motion = NULL;

    assert_int_equal(grobo_motion_new((grobo_motion_kind)9, 1, NULL, &motion), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, -1, NULL, &motion), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, GROBO_JOINTS_MAX + 1, NULL, &motion),
                     GROBO_ERR_CAP);
    assert_null(motion);
    grobo_motion_free(NULL);
    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
        assert_int_equal(grobo_motion_new((grobo_motion_kind)kind, 7, NULL, &motion), 0);
        assert_int_equal(grobo_motion_get_kind(motion), kind);
        assert_int_equal(grobo_motion_joints(motion), 7);
        assert_int_equal(grobo_motion_size(motion), 0);
        assert_int_equal(grobo_motion_current(motion), 0);
        assert_false(grobo_motion_is_reverse(motion));
        grobo_motion_free(motion);
    }
}

TEST(test_append_refuses)
{
    grobo_motion *motion = counting(GROBO_MOTION_POSTURES, 3, 1);
    grobo_posture posture = posture_of(4, 0, 1000);

    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_ERR_ARG);
    posture = posture_of(3, 0, -1);
    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_ERR_ARG);
    posture = posture_of(3, 0, GROBO_MOTION_STEP_MAX_US);
    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_ERR_ARG);
    posture = posture_of(3, 0, 1000);
    posture.angle_rad[2] = NAN;
    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_ERR_NAN);
    posture.angle_rad[2] = HUGE_VAL;
    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_ERR_NAN);
    posture.set &= ~GROBO_JOINT_BIT(2);
    posture.angle_rad[0] = 7;
    assert_int_equal(grobo_motion_append(motion, &posture), 0);
    assert_true(first_angle(motion, 0) == 0 && first_angle(motion, 1) == 7); /* behind the last */
    assert_int_equal(grobo_motion_append_at(motion, NAN, &posture), GROBO_ERR_NAN);
    assert_int_equal(grobo_motion_append_at(motion, 1e10, &posture), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_size(motion), 2);
    grobo_motion_free(motion);
}

TEST(test_get_and_rget)
{
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 2, 5);
    grobo_posture posture = {.n_joints = 7};

    assert_int_equal(grobo_motion_get(motion, 5, &posture), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_rget(motion, 0, &posture), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_rget(motion, 6, &posture), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_rget(motion, SIZE_MAX, &posture), GROBO_ERR_ARG);
    assert_int_equal(posture.n_joints, 7); /* untouched */
    assert_int_equal(grobo_motion_rget(motion, 1, &posture), 0);
    assert_int_equal(posture.n_joints, 2);
    assert_int_equal(posture.set, 3);
    assert_true(posture.angle_rad[1] == 5.0);
    assert_int_equal(posture.time_us, 1000000);
    assert_int_equal(grobo_motion_rget(motion, 5, &posture), 0);
    assert_true(posture.angle_rad[0] == 0.0);
    assert_int_equal(posture.time_us, 0);
    grobo_motion_free(motion);
}

/* Inserting and deleting at random places gives what an array gives. */
TEST(test_insert_delete_against_array)
{
    enum { OPERATIONS = 4000 };
    static double model[OPERATIONS];
    size_t size = 0;
    uint32_t seed = 1;
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 20, 0);

    for (int i = 0; i < OPERATIONS; i++) {
        seed = seed * 1664525 + 1013904223;
        size_t at = (seed >> 8) % (size + 1);
        if ((seed >> 28) < 11 || size == 0) {
            grobo_posture posture = posture_of(20, i, 1000);
            assert_int_equal(grobo_motion_insert(motion, at, &posture), 0);
            memmove(model + at + 1, model + at, (size - at) * sizeof *model);
            model[at] = i;
            size++;
        } else if (at < size) {
            assert_int_equal(grobo_motion_delete(motion, at), 0);
            memmove(model + at, model + at + 1, (size - at - 1) * sizeof *model);
            size--;
        }
    }
    assert_int_equal(grobo_motion_size(motion), size);
    for (size_t n = 0; n < size; n++) {
        assert_true(first_angle(motion, n) == model[n]);
        assert_int_equal(grobo_motion_step_us(motion, n), 1000);
    }
    while (size-- > 0) {
        assert_int_equal(grobo_motion_delete(motion, 0), 0);
    }
    assert_int_equal(grobo_motion_size(motion), 0);
    assert_int_equal(grobo_motion_delete(motion, 0), GROBO_ERR_ARG);
    grobo_motion_free(motion);
}

TEST(test_insert_keeps_durations)
{
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 1, 3);
    grobo_posture posture = posture_of(1, 9, 250000);

    assert_int_equal(grobo_motion_insert(motion, 4, &posture), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_insert(motion, 1, &posture), 0);
    assert_true(time_of(motion, 1) == 0.25);
    assert_true(time_of(motion, 2) == 1.25);
    assert_true(time_of(motion, 3) == 2.25);
    assert_int_equal(grobo_motion_length_us(motion, 0), 2250000);
    assert_int_equal(grobo_motion_delete(motion, 2), 0);
    assert_true(time_of(motion, 2) == 1.25);
    assert_int_equal(grobo_motion_delete_keep_times(motion, 0), 0);
    assert_true(time_of(motion, 0) == 0.25);
    assert_true(time_of(motion, 1) == 1.25);
    grobo_motion_free(motion);
}

TEST(test_insert_at_time)
{
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 1, 3);
    grobo_posture posture = posture_of(1, 9, 0);

    assert_int_equal(grobo_motion_insert_at(motion, 1.0, &posture), 2);
    assert_int_equal(grobo_motion_insert_at(motion, -1.0, &posture), 0);
    assert_int_equal(grobo_motion_insert_at(motion, 7.0, &posture), 5);
    assert_true(time_of(motion, 4) == 2.0);
    grobo_motion_free(motion);
    motion = counting(GROBO_MOTION_POSTURES, 1, 3);
    assert_int_equal(grobo_motion_insert_at(motion, 1.0, &posture), GROBO_ERR_TYPE);
    grobo_motion_free(motion);
}

/* What the times of each kind mean as durations. */
TEST(test_steps)
{
    static const double times_s[] = {0.5, 0.25, 0.25, 10.25, 20.2, -1};
    static const int64_t postures_us[] = {500000, 0, 0, 0, 9950000, 0};
    static const int64_t keys_us[] = {500000, 0, 0, 10000000, 9950000, 0};
    enum { N = sizeof times_s / sizeof times_s[0] };
    grobo_motion *motions[3];
    grobo_posture posture = posture_of(1, 0, 0);

    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_STEPS; kind++) {
        motions[kind] = counting((grobo_motion_kind)kind, 1, 0);
        for (int n = 0; n < N; n++) {
            assert_int_equal(grobo_motion_append_at(motions[kind], times_s[n], &posture), 0);
        }
    }
    for (size_t n = 0; n < N; n++) {
        assert_int_equal(grobo_motion_step_us(motions[GROBO_MOTION_POSTURES], n), postures_us[n]);
        assert_int_equal(grobo_motion_step_us(motions[GROBO_MOTION_STEPS], n), postures_us[n]);
        assert_int_equal(grobo_motion_step_us(motions[GROBO_MOTION_KEYS], n), keys_us[n]);
    }
    assert_int_equal(grobo_motion_step_us(motions[0], N), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_length_us(motions[GROBO_MOTION_POSTURES], 100),
                     500000 + 9950000 + 400);
    assert_int_equal(grobo_motion_length_us(motions[GROBO_MOTION_STEPS], -1),
                     500000 + 9950000 + 4 * GROBO_MOTION_DEFAULT_US);
    assert_true(grobo_motion_length_us(motions[GROBO_MOTION_STEPS], INT64_MAX / 2) == INT64_MAX);
    for (int kind = 0; kind < 3; kind++) {
        grobo_motion_free(motions[kind]);
    }
}

TEST(test_frames_at_a_rate)
{
    grobo_motion *motion = counting(GROBO_MOTION_FRAMES, 1, 4);

    assert_int_equal(grobo_motion_set_frame_rate(motion, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_frame_rate(motion, NAN), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_frame_rate(motion, 30), 0);
    assert_true(time_of(motion, 3) == 3.0 / 30.0);
    assert_int_equal(grobo_motion_step_us(motion, 1) + grobo_motion_step_us(motion, 2) +
                         grobo_motion_step_us(motion, 3),
                     100000);
    assert_int_equal(grobo_motion_set_time_s(motion, 1, 5), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_frame_times(motion, true), 0);
    assert_true(time_of(motion, 3) == 3.0 / 30.0);
    assert_int_equal(grobo_motion_set_time_s(motion, 1, 5), 0);
    assert_true(time_of(motion, 1) == 5.0);
    grobo_motion_free(motion);
    motion = counting(GROBO_MOTION_KEYS, 1, 1);
    assert_int_equal(grobo_motion_set_frame_rate(motion, 30), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_frame_times(motion, true), GROBO_ERR_ARG);
    grobo_motion_free(motion);
}

TEST(test_walk)
{
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 1, 3);
    grobo_posture posture;

    for (int n = 0; n < 3; n++) {
        assert_int_equal(grobo_motion_current(motion), n);
        assert_int_equal(grobo_motion_next(motion, &posture), 1);
        assert_true(posture.angle_rad[0] == n);
    }
    assert_int_equal(grobo_motion_next(motion, &posture), 0);
    assert_true(grobo_motion_set_reverse(motion, true));
    assert_true(grobo_motion_is_reverse(motion));
    grobo_motion_reset(motion);
    for (int n = 2; n >= 0; n--) {
        assert_int_equal(grobo_motion_next(motion, &posture), 1);
        assert_true(posture.angle_rad[0] == n);
    }
    assert_int_equal(grobo_motion_next(motion, &posture), 0);
    grobo_motion_clear(motion);
    assert_int_equal(grobo_motion_size(motion), 0);
    assert_int_equal(grobo_motion_current(motion), 0);
    grobo_motion_reset(motion);
    assert_int_equal(grobo_motion_next(motion, &posture), 0);
    grobo_motion_free(motion);
}

/* What is appended to an empty motion is absolute, whatever was in it. */
TEST(test_cleared_increments)
{
    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
        grobo_motion *motion = counting((grobo_motion_kind)kind, 1, 2);
        assert_int_equal(grobo_motion_set_name(motion, "wave"), 0);
        grobo_motion_clear(motion);
        assert_int_equal(grobo_motion_get_kind(motion),
                         kind == GROBO_MOTION_STEPS ? GROBO_MOTION_POSTURES : kind);
        assert_string_equal(grobo_motion_name(motion), "wave");
        grobo_motion_renew(motion, GROBO_MOTION_STEPS);
        assert_int_equal(grobo_motion_get_kind(motion), GROBO_MOTION_STEPS);
        grobo_motion_free(motion);
    }
}

TEST(test_joints_grow_and_shrink)
{
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 2, 40);
    grobo_posture posture = posture_of(5, 100, 0);

    assert_int_equal(grobo_motion_set_joints(motion, GROBO_JOINTS_MAX + 1), GROBO_ERR_CAP);
    assert_int_equal(grobo_motion_set_joints(motion, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_joints(motion, 5), 5);
    assert_int_equal(grobo_motion_joints(motion), 5);
    assert_int_equal(grobo_motion_set(motion, 3, &posture), 0);     /* in an old chunk */
    assert_int_equal(grobo_motion_append(motion, &posture), 0);     /* behind it */
    assert_int_equal(grobo_motion_insert(motion, 20, &posture), 0); /* splits one */
    assert_int_equal(grobo_motion_get(motion, 4, &posture), 0);
    assert_int_equal(posture.n_joints, 5);
    assert_int_equal(posture.set, 3);
    assert_int_equal(grobo_motion_get(motion, 3, &posture), 0);
    assert_int_equal(posture.set, 31);
    assert_true(posture.angle_rad[4] == 104.0);
    assert_int_equal(grobo_motion_set_joints(motion, 1), 1);
    assert_int_equal(grobo_motion_set_joints(motion, 5), 5);
    assert_int_equal(grobo_motion_get(motion, 3, &posture), 0);
    assert_int_equal(posture.set, 1);
    assert_true(first_angle(motion, 20) == 100.0 && first_angle(motion, 40) == 39.0);
    grobo_motion_free(motion);
}

TEST(test_names)
{
    grobo_motion *motion = counting(GROBO_MOTION_KEYS, 1, 1);

    assert_string_equal(grobo_motion_name(motion), "");
    assert_int_equal(grobo_motion_set_name(motion, "\xE6\xAD\xA9\xE3\x81\x8F"), 0);
    assert_int_equal(grobo_motion_set_name(motion, "\xC0\x80"), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_name(motion, "a\xE6\xAD"), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_name(motion, "\xED\xA0\x80"), GROBO_ERR_ARG);
    assert_string_equal(grobo_motion_name(motion), "\xE6\xAD\xA9\xE3\x81\x8F");
    assert_int_equal(grobo_motion_set_target_body(motion, "GR001"), 0);
    assert_string_equal(grobo_motion_target_body(motion), "GR001");
    assert_int_equal(grobo_motion_set_key_name(motion, 1, "x"), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_key_name(motion, 0, "bow"), 0);
    assert_string_equal(grobo_motion_key_name(motion, 0), "bow");
    assert_string_equal(grobo_motion_key_name(motion, 7), "");
    grobo_motion_free(motion);
}

static grobo_motion *rich(const grobo_mem *mem)
{
    grobo_motion *motion = NULL;
    grobo_posture posture = posture_of(20, 0.1, 500000);
    grobo_ik_link links[2] = {{.index = 0, .name = "WAIST", .is_base = true},
                              {.index = 6, .name = "R_ANKLE_R", .has_parting_direction = true}};
    grobo_key_info info = {.max_transition_s = 0.5, .stationary = 6, .has_zmp = true};

    if (grobo_motion_new(GROBO_MOTION_KEYS, 20, mem, &motion) < 0) {
        return NULL;
    }
    if (grobo_motion_set_name(motion, "rich") < 0 || grobo_motion_append(motion, &posture) < 0 ||
        grobo_motion_append(motion, &posture) < 0 ||
        grobo_motion_set_ik_links(motion, 0, links, 2) < 0 ||
        grobo_motion_set_key(motion, 0, &info) < 0 ||
        grobo_motion_set_key_name(motion, 0, "first") < 0 ||
        grobo_motion_keep(motion, 0, &(grobo_kept){"contactPoints", "[ ]", GROBO_KEPT_LINK, 1}) <
            0 ||
        grobo_motion_keep(motion, GROBO_MOTION_TOP,
                          &(grobo_kept){"author", "me", GROBO_KEPT_TOP, 0}) < 0) {
        grobo_motion_free(motion);
        return NULL;
    }
    return motion;
}

TEST(test_dup_is_deep_and_equal)
{
    grobo_motion *motion = rich(NULL);
    grobo_motion *copy = NULL;
    size_t count = 0;

    assert_non_null(motion);
    (void)grobo_motion_set_reverse(motion, true);
    grobo_motion_reset(motion);
    assert_int_equal(grobo_motion_dup(motion, &copy), 0);
    assert_true(grobo_motion_equal(motion, copy));
    assert_int_equal(grobo_motion_current(copy), 1);
    assert_true(grobo_motion_is_reverse(copy));
    assert_ptr_not_equal(grobo_motion_ik_links(motion, 0, &count),
                         grobo_motion_ik_links(copy, 0, &count));
    assert_int_equal(count, 2);
    grobo_motion_free(motion);
    assert_string_equal(grobo_motion_key_name(copy, 0), "first");
    assert_int_equal(grobo_motion_kept_count(copy, 0), 1);
    grobo_motion_free(copy);
}

TEST(test_kept_keys)
{
    grobo_motion *motion = rich(NULL);
    grobo_kept kept;

    assert_int_equal(grobo_motion_get_kept(motion, 0, 0, &kept), 0);
    assert_string_equal(kept.key, "contactPoints");
    assert_string_equal(kept.value, "[ ]");
    assert_int_equal(kept.link, 1);
    assert_int_equal(grobo_motion_keep(motion, 0, &kept), GROBO_ERR_EXISTS);
    kept.link = 2;
    assert_int_equal(grobo_motion_keep(motion, 0, &kept), GROBO_ERR_ARG);
    kept.level = GROBO_KEPT_TOP;
    assert_int_equal(grobo_motion_keep(motion, 0, &kept), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_get_kept(motion, 0, 1, &kept), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_get_kept(motion, 9, 0, &kept), GROBO_ERR_ARG);
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, NULL, 0), 0);
    assert_int_equal(grobo_motion_kept_count(motion, 0), 0);
    assert_int_equal(grobo_motion_kept_count(motion, GROBO_MOTION_TOP), 1);
    grobo_motion_free(motion);
}

TEST(test_links_refused)
{
    grobo_motion *motion = rich(NULL);
    grobo_ik_link links[GROBO_IK_LINKS_MAX + 1];

    memset(links, 0, sizeof links);
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, GROBO_IK_LINKS_MAX + 1),
                     GROBO_ERR_CAP);
    assert_int_equal(grobo_motion_set_ik_links(motion, 9, links, 1), GROBO_ERR_ARG);
    links[0].rotation[8] = NAN;
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, 1), GROBO_ERR_NAN);
    links[0].rotation[8] = 1;
    memset(links[0].name, 'x', sizeof links[0].name);
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, 1), GROBO_ERR_ARG);
    size_t count = 0;
    assert_string_equal(grobo_motion_ik_links(motion, 0, &count)[0].name, "WAIST");
    grobo_motion_free(motion);
}

/* 28 + 8 n bytes a posture, and little else: a million of 20 joints within 200 MB. */
TEST(test_memory_of_a_long_motion)
{
    enum { SIZE = 100000 };
    counted_mem counter = {0};
    grobo_mem mem = counted_mem_of(&counter);
    grobo_motion *motion = NULL;
    grobo_posture posture = posture_of(20, 0, 1000);

    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, 20, &mem, &motion), 0);
    for (int n = 0; n < SIZE; n++) {
        assert_int_equal(grobo_motion_append(motion, &posture), 0);
    }
    assert_true(counter.bytes_peak <= (size_t)SIZE * 200);
    /* Amortised constant: chunks and a doubling table, nothing that is copied as a whole. */
    assert_true(counter.calls < SIZE / 100);
    grobo_motion_free(motion);
    assert_int_equal(counter.bytes, 0);
}

/* Beside its source a conversion holds one posture for each that it makes, and its time. */
TEST(test_memory_of_a_conversion)
{
    static const struct {
        grobo_motion_kind from, to;
        int step_us;
    } cases[] = {
        {GROBO_MOTION_POSTURES, GROBO_MOTION_FRAMES, 20000},
        {GROBO_MOTION_POSTURES, GROBO_MOTION_FRAMES, 100000}, /* resampled */
        {GROBO_MOTION_POSTURES, GROBO_MOTION_KEYS, 100000},
        {GROBO_MOTION_KEYS, GROBO_MOTION_POSTURES, 100000},
        {GROBO_MOTION_FRAMES, GROBO_MOTION_POSTURES, 20000},
    };
    enum { SIZE = 10000 };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        counted_mem counter = {0};
        grobo_mem mem = counted_mem_of(&counter);
        grobo_motion *motion = NULL, *made = NULL;
        grobo_posture posture = posture_of(20, 0, cases[i].step_us);

        assert_int_equal(grobo_motion_new(cases[i].from, 20, &mem, &motion), 0);
        if (cases[i].from == GROBO_MOTION_FRAMES) {
            assert_int_equal(grobo_motion_set_frame_rate(motion, 1e6 / cases[i].step_us), 0);
        }
        for (int n = 0; n < SIZE; n++) {
            assert_int_equal(grobo_motion_append(motion, &posture), 0);
        }
        size_t held = counter.bytes;
        counter.bytes_peak = held;
        assert_int_equal(grobo_motion_convert(motion, cases[i].to, NULL, NULL, &made), 0);
        assert_true(counter.bytes_peak - held <= 200 * grobo_motion_size(made));
        grobo_motion_free(motion);
        grobo_motion_free(made);
        assert_int_equal(counter.bytes, 0);
    }
}

/* Every allocation fails in turn: an error, and nothing is lost or leaked. */
TEST(test_allocations_fail)
{
    bool done = false;

    for (size_t n = 1; !done; n++) {
        counted_mem counter = {.fail_at = n};
        grobo_mem mem = counted_mem_of(&counter);
        grobo_motion *motion = rich(&mem);
        grobo_motion *copy = NULL;
        if (motion != NULL) {
            size_t size = grobo_motion_size(motion);
            int result = grobo_motion_dup(motion, &copy);
            assert_true(result == 0 || (result == GROBO_ERR_NOMEM && copy == NULL));
            done = result == 0 && counter.calls < n;
            result = grobo_motion_append_motion(motion, motion);
            assert_true(result == 0 || grobo_motion_size(motion) == size);
            grobo_motion_free(copy);
            grobo_motion_free(motion);
        }
        assert_int_equal(counter.bytes, 0);
    }
}
