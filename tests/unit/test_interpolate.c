/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/interpolate.h>

#include "tests/support/files.h"
#include "tests/support/next_random.h"
#include "tests/support/test.h"

#define NEAR 1e-6

/* cmocka 1.1 compares in float only. */
#define assert_near(a, b, delta) assert_true(fabs((a) - (b)) <= (delta))

enum { ROOM = 64 };

typedef struct pose {
    double t_s, value, max_transition_s;
    bool stationary;
} pose;

typedef struct fixture {
    grobo_spline_key room[ROOM];
    grobo_spline_track track;
} fixture;

static void build(fixture *f, const pose *poses, size_t n)
{
    f->track = (grobo_spline_track){.keys = f->room, .capacity = ROOM};
    for (size_t i = 0; i < n; i++) {
        assert_true(grobo_spline_append(&f->track, poses[i].t_s, poses[i].value,
                                        poses[i].max_transition_s, poses[i].stationary) > 0);
    }
    grobo_spline_prepare(f->track.keys, f->track.n);
}

static double at(const fixture *f, double t_s)
{
    return grobo_spline_at(f->track.keys, f->track.n, t_s, NULL);
}

/*
 * Right elbow of the published GR001 motion: 0.349 rad at 0 s, then -0.802851456 at 1.5 s with a
 * transition of at most 0.541666667 s. By hand: the gap 1.5 exceeds it, so a hold key with the
 * first value stands at 1.5 - 0.541666667 = 0.958333333 s. Between the two all slopes are 0
 * (the hold key is stationary, the last key is the end), and the cubic is
 * a + d (3 s^2 - 2 s^3) with d = -0.802851456 + 0.34906585 = -0.453785606:
 *   1.1 s: s = 0.141666667 / 0.541666667 = 0.261538461, s^2 = 0.068402367, s^3 = 0.017889850,
 *          3 s^2 - 2 s^3 = 0.169427401, q = -0.34906585 - 0.076883716 = -0.425949566
 *   1.2291666665 s (half way): q = -0.34906585 - 0.226892803 = -0.575958653
 */
TEST(a_maximum_transition_time_holds_the_value_before)
{
    fixture f;
    const pose poses[] = {{0.0, -0.34906585, 0, false}, {1.5, -0.802851456, 0.541666667, false}};
    build(&f, poses, 2);
    assert_int_equal(f.track.n, 3);
    assert_near(f.track.keys[1].t_s, 0.958333333, 1e-12);
    assert_int_equal(f.track.keys[1].flags, GROBO_SPLINE_STATIONARY | GROBO_SPLINE_HOLD);
    assert_int_equal(f.track.keys[0].flags, GROBO_SPLINE_STATIONARY);
    assert_near(at(&f, 0.5), -0.34906585, NEAR);
    assert_near(at(&f, 0.958333333), -0.34906585, NEAR);
    assert_near(at(&f, 1.1), -0.425949566, NEAR);
    assert_near(at(&f, 1.2291666665), -0.575958653, NEAR);
    assert_near(at(&f, 1.5), -0.802851456, NEAR);
}

/*
 * Without limits, keys (0, 0), (1, 0.5), (2, 1.5), (3, 1.0). Slopes by hand: ends 0; at 1 s the
 * mean of 0.5 and 1.0 = 0.75; at 2 s a reversal (1.0 then -0.5): 0. Hermite at the middle of a
 * segment of 1 s is (a + b)/2 + (m_a - m_b)/8:
 *   0.5 s: 0.25 + (0 - 0.75)/8 = 0.15625    1.5 s: 1.0 + (0.75 - 0)/8 = 1.09375
 *   2.5 s: 1.25
 * and at a quarter, h00 = 0.84375, h10 = 0.140625, h01 = 0.15625, h11 = -0.046875:
 *   1.25 s: 0.84375*0.5 + 0.140625*0.75 + 0.15625*1.5 = 0.421875 + 0.10546875 + 0.234375
 *         = 0.76171875
 */
TEST(a_reversal_has_no_slope_and_others_the_mean)
{
    fixture f;
    const pose poses[] = {
        {0, 0, 0, false}, {1, 0.5, 0, false}, {2, 1.5, 0, false}, {3, 1, 0, false}};
    build(&f, poses, 4);
    assert_near(f.track.keys[1].slope, 0.75, NEAR);
    assert_near(f.track.keys[2].slope, 0.0, 0.0);
    assert_near(at(&f, 0.5), 0.15625, NEAR);
    assert_near(at(&f, 1.25), 0.76171875, NEAR);
    assert_near(at(&f, 1.5), 1.09375, NEAR);
    assert_near(at(&f, 2.5), 1.25, NEAR);
}

/*
 * The same with the key at 1 s in spJoints: all slopes 0, so a segment is a + d (3 s^2 - 2 s^3):
 *   0.25 s: 0.5 * 0.15625 = 0.078125    1.25 s: 0.5 + 1.0 * 0.15625 = 0.65625
 */
TEST(a_stationary_key_has_no_slope)
{
    fixture f;
    const pose poses[] = {
        {0, 0, 0, false}, {1, 0.5, 0, true}, {2, 1.5, 0, false}, {3, 1, 0, false}};
    build(&f, poses, 4);
    assert_near(f.track.keys[1].slope, 0.0, 0.0);
    assert_near(at(&f, 0.25), 0.078125, NEAR);
    assert_near(at(&f, 1.25), 0.65625, NEAR);
}

TEST(nearly_flat_neighbours_have_no_slope)
{
    fixture f;
    const pose poses[] = {{0, 0, 0, false},   {1, 0.000999, 0, false}, {2, 0.5, 0, false},
                          {3, 1.0, 0, false}, {4, 1.000999, 0, false}, {5, 2.0, 0, false}};
    build(&f, poses, 6);
    assert_near(f.track.keys[1].slope, 0.0, 0.0);
    assert_near(f.track.keys[2].slope, (0.499001 + 0.5) / 2, NEAR);
    assert_near(f.track.keys[3].slope, 0.0, 0.0);
    const pose exact[] = {{0, 0, 0, false}, {1, 0.001, 0, false}, {2, 0.003, 0, false}};
    build(&f, exact, 3); /* 1e-3 itself is not below it */
    assert_near(f.track.keys[1].slope, 0.0015, NEAR);
}

TEST(outside_the_keys_the_ends_hold)
{
    fixture f;
    const pose poses[] = {{1, 0.5, 0, false}, {2, 0.7, 0, false}};
    build(&f, poses, 2);
    assert_near(at(&f, -3.0), 0.5, 0.0);
    assert_near(at(&f, 0.999), 0.5, 0.0);
    assert_near(at(&f, 2.0), 0.7, 0.0);
    assert_near(at(&f, 99.0), 0.7, 0.0);
    assert_near(grobo_spline_at(NULL, 0, 1.0, NULL), 0.0, 0.0);
}

TEST(keys_at_one_time_jump_to_the_later)
{
    fixture f;
    const pose poses[] = {{0, 0, 0, false}, {1, 1, 0, false}, {1, 2, 0, false}, {2, 3, 0, false}};
    build(&f, poses, 4);
    assert_near(at(&f, 0.5), 0.5, NEAR);
    assert_near(at(&f, 1.0 - 1e-9), 1.0, NEAR);
    assert_near(at(&f, 1.0), 2.0, 0.0);
    assert_near(at(&f, 1.5), 2.5, NEAR);
}

TEST(a_gap_of_just_the_transition_time_needs_no_hold)
{
    fixture f;
    const pose poses[] = {{0, 0, 0, false}, {0.5, 1, 0.5, false}, {1, 2, -1.0, false}};
    build(&f, poses, 3);
    assert_int_equal(f.track.n, 3);
    assert_near(f.track.keys[1].slope, 2.0, NEAR);
}

TEST(appending_refuses_what_it_cannot_take)
{
    grobo_spline_key room[2];
    grobo_spline_track track = {.keys = room, .capacity = 2};
    assert_int_equal(grobo_spline_append(&track, (double)NAN, 0, 0, false), GROBO_ERR_NAN);
    assert_int_equal(grobo_spline_append(&track, 0, (double)INFINITY, 0, false), GROBO_ERR_NAN);
    assert_int_equal(grobo_spline_append(&track, 0, 0, (double)NAN, false), GROBO_ERR_NAN);
    assert_int_equal(grobo_spline_append(&track, 1.0, 0.1, 0, false), 1);
    assert_int_equal(grobo_spline_append(&track, 0.9, 0.1, 0, false), GROBO_ERR_ARG);
    /* Two keys would be needed where one has room: nothing is added, nothing marked. */
    assert_int_equal(grobo_spline_append(&track, 2.0, 0.2, 0.5, false), GROBO_ERR_SPACE);
    assert_int_equal(track.n, 1);
    assert_int_equal(room[0].flags, 0);
    assert_int_equal(grobo_spline_append(&track, 2.0, 0.2, 1.0, false), 1);
    assert_int_equal(grobo_spline_append(&track, 3.0, 0.2, 0, false), GROBO_ERR_SPACE);
}

TEST(poses_come_by_time_and_equal_ones_backwards)
{
    static const double t_s[] = {0, 1, 0.5, 1, 3, 1, 2, 0};
    static const size_t expected[] = {7, 0, 2, 5, 3, 1, 6, 4};
    size_t order[8];
    grobo_spline_order(t_s, 8, order);
    for (size_t i = 0; i < 8; i++) {
        assert_int_equal(order[i], expected[i]);
    }
    grobo_spline_order(t_s, 0, order);
    grobo_spline_order(t_s, 1, order);
    assert_int_equal(order[0], 0);
}

/* In 0..1. */
static double next_part(uint32_t *seed)
{
    return next_random(seed) / 16777216.0;
}

TEST(a_cursor_changes_nothing_but_the_effort)
{
    fixture f;
    pose poses[24];
    uint32_t seed = 1;
    double t_s = 0;
    for (size_t i = 0; i < 24; i++) {
        t_s += i % 5 == 4 ? 0.0 : 0.01 + next_part(&seed);
        poses[i] = (pose){t_s, next_part(&seed), i % 3 == 0 ? 0.3 : 0.0, i % 7 == 0};
    }
    build(&f, poses, 24);
    size_t cursor = 0;
    for (double t = -1.0; t < t_s + 1.0; t += 0.003) {
        assert_true(grobo_spline_at(f.track.keys, f.track.n, t, &cursor) == at(&f, t));
    }
    for (int i = 0; i < 2000; i++) {
        double t = next_part(&seed) * (t_s + 2.0) - 1.0;
        assert_true(grobo_spline_at(f.track.keys, f.track.n, t, &cursor) == at(&f, t));
    }
    for (size_t i = 0; i < f.track.n; i++) {
        double t = f.track.keys[i].t_s;
        assert_true(grobo_spline_at(f.track.keys, f.track.n, t, &cursor) == at(&f, t));
    }
}

/* ---- against Choreonoid's own output, where the reference material is there ---- */

enum { POSES_MAX = 64, JOINTS = 20, FIRST = 12 };

typedef struct key_pose {
    double t_s, max_transition_s;
    double joints[JOINTS], q[JOINTS], stationary[JOINTS];
    size_t n_joints, n_q, n_stationary;
} key_pose;

/* The numbers of "[ 1, 2 ]" after p, over lines. */
static size_t read_list(const char *p, double *out)
{
    size_t n = 0;
    p = strchr(p, '[') + 1;
    for (;;) {
        p += strspn(p, " \r\n,");
        if (*p == ']' || n == JOINTS) {
            return n;
        }
        char *end;
        out[n++] = strtod(p, &end);
        p = end;
    }
}

/* Just enough of the format for files known to be good. */
static size_t scan_poses(const char *text, key_pose *poses)
{
    size_t n = 0;
    for (const char *line = text; line != NULL; line = strchr(line, '\n')) {
        line += strspn(line, " \r\n");
        if (strncmp(line, "time:", 5) == 0) {
            assert_true(n < POSES_MAX);
            memset(&poses[n], 0, sizeof poses[n]);
            poses[n++].t_s = strtod(line + 5, NULL);
        } else if (strncmp(line, "maxTransitionTime:", 18) == 0) {
            poses[n - 1].max_transition_s = strtod(line + 18, NULL);
        } else if (strncmp(line, "joints:", 7) == 0) {
            poses[n - 1].n_joints = read_list(line, poses[n - 1].joints);
        } else if (strncmp(line, "q:", 2) == 0) {
            poses[n - 1].n_q = read_list(line, poses[n - 1].q);
        } else if (strncmp(line, "spJoints:", 9) == 0) {
            poses[n - 1].n_stationary = read_list(line, poses[n - 1].stationary);
        }
    }
    return n;
}

static void add_pose(fixture *tracks, const key_pose *p)
{
    assert_int_equal(p->n_joints, p->n_q);
    for (size_t k = 0; k < p->n_joints; k++) {
        bool stationary = false;
        for (size_t s = 0; s < p->n_stationary; s++) {
            stationary = stationary || p->stationary[s] == p->joints[k];
        }
        int joint = (int)p->joints[k];
        assert_true(grobo_spline_append(&tracks[joint].track, p->t_s, p->q[k], p->max_transition_s,
                                        stationary) > 0);
    }
}

static void compare_upper_body(const char *pseq, const char *csv)
{
    static key_pose poses[POSES_MAX];
    static fixture tracks[JOINTS];
    double t_s[POSES_MAX];
    size_t order[POSES_MAX];
    double worst = 0.0;
    int frames = 0;

    char *text = file_text(shared_file(pseq), NULL);
    size_t n = scan_poses(text, poses);
    free(text);
    for (size_t i = 0; i < n; i++) {
        t_s[i] = poses[i].t_s;
    }
    grobo_spline_order(t_s, n, order);
    for (int j = 0; j < JOINTS; j++) {
        tracks[j].track = (grobo_spline_track){.keys = tracks[j].room, .capacity = ROOM};
    }
    for (size_t i = 0; i < n; i++) {
        add_pose(tracks, &poses[order[i]]);
    }
    for (int j = 0; j < JOINTS; j++) {
        grobo_spline_prepare(tracks[j].track.keys, tracks[j].track.n);
    }
    text = file_text(shared_file(csv), NULL);
    for (char *line = text; *line != '\0'; frames++) {
        for (int j = 0; j < JOINTS; j++) {
            double expected = strtod(line, &line);
            double error = at(&tracks[j], frames / 30.0) - expected;
            worst = j >= FIRST && error * error > worst * worst ? error : worst;
            line += strspn(line, ",");
        }
        line += strspn(line, "\r\n");
    }
    free(text);
    assert_int_equal(frames, (int)(30.0 * t_s[order[n - 1]]) + 1);
    print_message("%s: %d frames, worst error %.3g rad\n", pseq, frames, worst);
    assert_near(worst, 0.0, NEAR);
}

TEST(the_upper_body_follows_choreonoid_in_sample_motion_1)
{
    compare_upper_body("data/choreonoid/GR001-SampleMotion1.pseq",
                       "data/golden/SampleMotion1.r30.plain.csv");
}

TEST(the_upper_body_follows_choreonoid_in_odd_cases)
{
    compare_upper_body("data/golden/misc.pseq", "data/golden/misc.r30.plain.csv");
}
