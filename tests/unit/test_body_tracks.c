/* SPDX-License-Identifier: MIT */
/* What is made of an author's keys before anything is solved: curves, holds, steps, ZMP. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"
#include "tests/support/body_script.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/transforms.h"
#include "tests/support/zmp_cases.h"

#define NEAR 1e-12

/* A track of one or six values with room. */
struct shelf {
    struct grobo_i_track track;
    double t_s[16], from_s[16], v[16 * 6], slope[16 * 6];
    uint8_t flags[16];
};

static void open_shelf(struct shelf *shelf, int dim)
{
    memset(shelf, 0, sizeof *shelf);
    shelf->track = (struct grobo_i_track){.t_s = shelf->t_s,
                                          .from_s = shelf->from_s,
                                          .v = shelf->v,
                                          .slope = shelf->slope,
                                          .flags = shelf->flags,
                                          .dim = dim,
                                          .capacity = 16};
}

static void put(struct shelf *shelf, double t_s, double v)
{
    grobo_i_track_add(&shelf->track, t_s, &v, 0);
}

static double at(const struct shelf *shelf, double t_s)
{
    double v;

    grobo_i_track_value(&shelf->track, t_s, &v);
    return v;
}

TEST(slopes_are_mean_secants)
{
    struct shelf shelf;

    open_shelf(&shelf, 1);
    put(&shelf, 0, 0.098);
    put(&shelf, 1, 0.1);
    put(&shelf, 3, 0.5);    /* secants 0.002 and 0.2 at the key before */
    put(&shelf, 4, 0.5005); /* flat */
    put(&shelf, 5, 0.8);
    put(&shelf, 6, 0.2); /* back */
    put(&shelf, 7, 0.1);
    grobo_i_track_slopes(&shelf.track, 1);
    const double want[7] = {0, 0.101, 0, 0, 0, -0.35, 0};

    for (int i = 0; i < 7; i++) {
        assert_true(fabs(shelf.slope[i] - want[i]) < NEAR);
    }
    assert_true(fabs(at(&shelf, 0.5) - (0.099 - 0.125 * 0.101)) < NEAR);
    assert_true(fabs(at(&shelf, 2) - (0.3 + 0.125 * 0.101 * 2)) < NEAR);
    assert_true(fabs(at(&shelf, -1) - 0.098) < NEAR && fabs(at(&shelf, 9) - 0.1) < NEAR);
}

TEST(close_keys_jump)
{
    struct shelf shelf;

    open_shelf(&shelf, 1);
    put(&shelf, 0, 0);
    put(&shelf, 1, 0.1);
    put(&shelf, 1 + 0.5e-6, 0.7);
    put(&shelf, 2, 0.9);
    grobo_i_track_slopes(&shelf.track, 1);
    assert_true(fabs(at(&shelf, 1 + 0.2e-6) - 0.7) < NEAR);
    assert_true(at(&shelf, 0.999999) < 0.1 + 1e-9);
    assert_true(isfinite(at(&shelf, 1.5)) && at(&shelf, 1.5) > 0.7 && at(&shelf, 1.5) < 0.9);
}

/* The automatic ZMP inserts keys behind later ones: the time to such a one is negative. */
TEST(a_key_behind_a_later_one_has_its_secant_too)
{
    struct shelf shelf;
    const double t_s[4] = {0, 1, 0.98, 2}, v[4] = {0, 0.1, 0.04, 0.2};

    open_shelf(&shelf, 1);
    for (int i = 0; i < 4; i++) {
        grobo_i_track_insert(&shelf.track, i, t_s[i], &v[i], 0);
    }
    grobo_i_track_slopes(&shelf.track, 1);
    assert_true(fabs(shelf.slope[1]) < NEAR); /* it turns there */
    shelf.v[2] = 0.16;
    grobo_i_track_slopes(&shelf.track, 1);
    assert_true(fabs(shelf.slope[1] - 0.5 * (0.1 - 0.06 / 0.02)) < NEAR);
    assert_true(fabs(shelf.slope[2] - 0.5 * (-0.06 / 0.02 + 0.04 / 1.02)) < NEAR);
}

TEST(a_hold_repeats_a_key_and_levels_both)
{
    struct shelf shelf;

    open_shelf(&shelf, 1);
    put(&shelf, 0, 0);
    put(&shelf, 1, 0.2);
    shelf.flags[1] = TRACK_TOUCH;
    grobo_i_track_hold(&shelf.track, 2, 1.5, 0.5); /* exactly as long: none */
    assert_int_equal(shelf.track.n, 2);
    grobo_i_track_hold(&shelf.track, 2, 3, 0); /* none asked for */
    assert_int_equal(shelf.track.n, 2);
    grobo_i_track_hold(&shelf.track, 2, 3, 0.5);
    put(&shelf, 3, 0.6);
    put(&shelf, 4, 0.9);
    assert_int_equal(shelf.track.n, 5);
    assert_true(fabs(shelf.t_s[2] - 2.5) < NEAR && fabs(shelf.v[2] - 0.2) < NEAR);
    assert_int_equal(shelf.flags[1], TRACK_TOUCH | TRACK_END);
    assert_int_equal(shelf.flags[2], TRACK_TOUCH | TRACK_END);
    grobo_i_track_slopes(&shelf.track, 1);
    assert_true(fabs(shelf.slope[1]) < NEAR && fabs(shelf.slope[2]) < NEAR);
    assert_true(fabs(shelf.slope[3] - 0.55) < NEAR);
    assert_true(fabs(at(&shelf, 2.3) - 0.2) < NEAR);
}

TEST(a_full_track_says_so)
{
    struct shelf shelf;

    open_shelf(&shelf, 1);
    for (int i = 0; i < 16; i++) {
        put(&shelf, i, i);
    }
    assert_false(shelf.track.overflow);
    put(&shelf, 16, 16);
    assert_true(shelf.track.overflow);
    assert_int_equal(shelf.track.n, 16);
}

/* Angles take the short way round, positions do not. */
TEST(angles_are_unwrapped)
{
    const double a[6] = {9, 0, 0, 3, 0, -3}, b[6] = {-9, 0, 0, -3, 0, 3},
                 c[6] = {9, 0, 0, -2, 0, 2};
    struct shelf shelf;
    double v[6];

    open_shelf(&shelf, 6);
    grobo_i_track_add(&shelf.track, 0, a, 0);
    grobo_i_track_add(&shelf.track, 1, b, 0);
    grobo_i_track_add(&shelf.track, 2, c, 0);
    grobo_i_track_slopes(&shelf.track, 3);
    grobo_i_track_value(&shelf.track, 1, v);
    assert_true(fabs(v[0] + 9) < NEAR);
    assert_true(fabs(v[3] - (2 * BODY_PI - 3)) < NEAR && fabs(v[5] - (3 - 2 * BODY_PI)) < NEAR);
    grobo_i_track_value(&shelf.track, 2, v);
    assert_true(fabs(v[3] - (2 * BODY_PI - 2)) < NEAR);
}

/* ---- which link the tree is walked from ---- */

TEST(the_base_is_the_latest_that_says_so)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 10};
    struct script script;
    struct run run;
    grobo_body_report first, later;
    double q[JOINTS];

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_joint(&script, 2, 0.3);
    script_joint(&script, 8, -0.5);
    script_target(&script, RIGHT, 0, -0.02, 0.02)->base = true;
    script_target(&script, LEFT, 0, 0.02, 0.03);
    script_key(&script, 1); /* later, but it does not say so */
    script_target(&script, LEFT, 0, 0.02, 0.03);
    script_key(&script, 2); /* now it does, and is the later of two */
    script_target(&script, LEFT, 0, 0.02, 0.03)->base = true;
    script_key(&script, 3); /* the other no longer does, though it is later now */
    script_target(&script, RIGHT, 0, -0.02, 0.02);
    script_key(&script, 4); /* of two at the same time the last link wins */
    script_target(&script, RIGHT, 0, -0.02, 0.02)->base = true;
    script_target(&script, LEFT, 0, 0.02, 0.03)->base = true;
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame(run.body, 0, q, &first), 0);
    assert_int_equal(grobo_body_frame(run.body, 15, q, &later), 0);
    assert_memory_equal(&later.root, &first.root, sizeof first.root);
    assert_int_equal(grobo_body_frame(run.body, 20, q, &later), 0);
    assert_true(fabs(later.root.p_m[2] - first.root.p_m[2]) > 5e-3);
    first = later;
    assert_int_equal(grobo_body_frame(run.body, 30, q, &later), 0);
    assert_memory_equal(&later.root, &first.root, sizeof first.root);
    assert_int_equal(grobo_body_frame(run.body, 40, q, &later), 0);
    assert_memory_equal(&later.root, &first.root, sizeof first.root);
    run_finish(&run);
}

/* ---- slave feet ---- */

enum { P_SLAVE = 1, P_TOUCH = 2, N_SLAVE = 4, N_TOUCH = 8 };

/* The knee's weight of its own key at a time between two keys of its foot at 0 and 1 s. */
static double own_weight(unsigned how, double time_s)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const double own_rad = -0.2;
    double q[2][JOINTS];

    for (int free = 0; free < 2; free++) { /* with slaves, and as a foot that follows its target */
        struct script script;
        struct run run;

        memset(&script, 0, sizeof script);
        for (int i = 0; i < 2; i++) {
            grobo_body_target *foot;

            script_key(&script, i);
            script_joint(&script, 3, own_rad);
            script_target(&script, WAIST, 0, 0, 0.145);
            foot = script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z);
            foot->slave = free == 0 && (how & (i == 0 ? P_SLAVE : N_SLAVE)) != 0;
            foot->touching = (how & (i == 0 ? P_TOUCH : N_TOUCH)) != 0;
        }
        run_start(&run, &grobo_i_gr001_body, &script, &options);
        assert_int_equal(grobo_body_sample(run.body, time_s, q[free], NULL), 0);
        run_finish(&run);
    }
    return (q[0][3] - q[1][3]) / (own_rad - q[1][3]);
}

static double smooth(double r)
{
    return r * r * (3 - 2 * r);
}

TEST(slave_feet_are_blended)
{
    assert_true(fabs(own_weight(0, 0.25)) < NEAR);
    assert_true(fabs(own_weight(P_SLAVE | N_SLAVE, 0.25) - 1) < NEAR); /* ignored: own keys */
    assert_true(fabs(own_weight(P_SLAVE, 0.25) - smooth(0.75)) < NEAR);
    assert_true(fabs(own_weight(P_SLAVE | N_TOUCH, 0.25) - smooth(0.75)) < NEAR);
    assert_true(fabs(own_weight(N_SLAVE, 0.25) - smooth(0.25)) < NEAR);
    assert_true(fabs(own_weight(P_TOUCH | N_SLAVE, 0.25) - smooth(0.25)) < NEAR);
    /* who touches is no slave */
    assert_true(fabs(own_weight(P_SLAVE | P_TOUCH, 0.25)) < NEAR);
}

/* ---- stealthy step ---- */

/* Whether a landing is fast is told by its own two keys, not by the curve that goes on. */
TEST(a_landing_is_softened_by_its_own_two_keys)
{
    static const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT,
                                               .step = GROBO_BODY_STEP_STEALTHY, .rate_hz = 100};
    static const struct {
        double before_m, dt_s, at_m; /* height of the key before, way to the landing, from there */
        bool softened;
    } rows[] = {
        {0.075, 0.13, 0.053, true}, /* 0.305 m/s, and slower where the way before goes on */
        {0.053, 0.13, 0.053, true},
        {0.075, 0.13, 0.046, false}, /* 0.236 m/s */
        {0.075, 0.07, 0.053, false}, /* too short */
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct script script;
        struct run run;
        const double land_s = 1.04 + rows[i].dt_s;

        memset(&script, 0, sizeof script);
        script_key(&script, 0);
        script_stand(&script, 0, 0, 0.145);
        script_key(&script, 1);
        script_target(&script, RIGHT, FOOT_X, -FOOT_Y, rows[i].before_m);
        script_key(&script, 1.04);
        script_target(&script, RIGHT, FOOT_X, -FOOT_Y, rows[i].at_m);
        script_key(&script, land_s);
        script_target(&script, RIGHT, FOOT_X, -FOOT_Y, 0.022)->touching = true;
        run_start(&run, &grobo_i_gr001_body, &script, &options);
        const struct grobo_i_track *height = &run.body->height[0];
        assert_int_equal(height->n, rows[i].softened ? 5 : 4);
        assert_true(fabs(height->t_s[height->n - 1] - land_s) < NEAR);
        if (rows[i].softened) {
            assert_true(fabs(height->t_s[3] - (land_s - 0.04)) < NEAR);
            assert_true(fabs(height->v[3] - 0.027) < NEAR);
            assert_true(fabs(height->slope[3] + 0.25) < NEAR);
        }
        run_finish(&run);
    }
}

/* ---- automatic ZMP ---- */

/* Number of keys of a track at a time, and the flags of the last of them. */
static int keys_at(const struct grobo_i_track *track, double t_s, unsigned *flags)
{
    int n = 0;

    for (int i = 0; i < track->n; i++) {
        if (fabs(track->t_s[i] - t_s) < 1e-9) {
            *flags = track->flags[i];
            n++;
        }
    }
    return n;
}

static void zmp_is(struct run *run, double t_s, double x, double y)
{
    double v[3];

    grobo_i_track_value(&run->body->zmp, t_s, v);
    assert_true(fabs(v[0] - x) < 1e-9);
    assert_true(fabs(v[1] - y) < 1e-9);
}

static void zmp_key(struct script *script, double x, double y)
{
    grobo_body_key *key = &script->keys[script->n_keys - 1];

    key->has_zmp = true;
    key->zmp_m[0] = x;
    key->zmp_m[1] = y;
}

#define SOLE_X (FOOT_X - 0.005)
#define SOLE_Y (FOOT_Y + 0.01)

static const grobo_body_options automatic = {GROBO_BODY_OPTIONS_INIT,
                                             .step = GROBO_BODY_STEP_STEALTHY,
                                             .zmp = GROBO_BODY_ZMP_AUTO, .rate_hz = 100};

/* The author's ZMP comes too late before the lift, and too early after the landing: the foot
 * rests on the ground the longer. */
TEST(feet_wait_for_the_zmp)
{
    struct script script;
    struct run run;
    unsigned flags = 0;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_stand(&script, 0, 0, 0.145);
    zmp_key(&script, SOLE_X, 0);
    script_key(&script, 0.97);
    zmp_key(&script, SOLE_X, 0);
    script_key(&script, 1);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_key(&script, 1.4);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.02);
    script_key(&script, 1.8);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_key(&script, 1.83);
    zmp_key(&script, SOLE_X, 0);
    run_start(&run, &grobo_i_gr001_body, &script, &automatic);
    /* 0.97 + 0.1, before the middle of 1 and 1.4 */
    zmp_is(&run, 1.07, SOLE_X, SOLE_Y);
    assert_int_equal(keys_at(&run.body->target[GROBO_I_RIGHT], 1.07, &flags), 1);
    assert_int_equal(flags, TRACK_TOUCH | TRACK_END | TRACK_AUX);
    assert_int_equal(keys_at(&run.body->height[0], 1.07, &flags), 1);
    /* 1.83 - 0.1 */
    zmp_is(&run, 1.73, SOLE_X, SOLE_Y);
    assert_int_equal(keys_at(&run.body->target[GROBO_I_RIGHT], 1.73, &flags), 1);
    assert_true((flags & TRACK_AUX) != 0);
    zmp_is(&run, 1.83, SOLE_X, 0);
    run_finish(&run);
}

/* The first ZMP key of the author comes with the first key of the swing foot in the air. The foot
 * rests until half the way there. The key for the support is inserted behind the author's, which
 * is later: until that one the ZMP stays at its place, then it jumps to the sole. */
TEST(a_first_zmp_key_behind_the_lift)
{
    struct script script;
    struct run run;
    unsigned flags = 0;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_stand(&script, 0, 0, 0.145);
    script_key(&script, 1.2);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.02);
    zmp_key(&script, SOLE_X, 0);
    script_key(&script, 1.5);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.02);
    run_start(&run, &grobo_i_gr001_body, &script, &automatic);
    assert_int_equal(keys_at(&run.body->target[GROBO_I_RIGHT], 0.6, &flags), 1);
    assert_int_equal(flags, TRACK_TOUCH | TRACK_END | TRACK_AUX);
    zmp_is(&run, 0, SOLE_X, 0);
    zmp_is(&run, 0.6, SOLE_X, 0);
    zmp_is(&run, 1.199, SOLE_X, 0);
    zmp_is(&run, 1.2, SOLE_X, SOLE_Y);
    zmp_is(&run, 1.6, SOLE_X, SOLE_Y);
    run_finish(&run);
}

/* Two steps of the same foot: the ZMP visits the middle between them, the less of it the shorter
 * both feet stand. */
static void same_foot_twice(double stand_s, const grobo_body_options *options, struct run *run)
{
    struct script script;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_stand(&script, 0, 0, 0.145);
    script_key(&script, 1);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_key(&script, 1.3);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.02);
    script_key(&script, 1.6);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_key(&script, 1.6 + stand_s);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    script_key(&script, 2.2);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z + 0.02);
    script_key(&script, 2.5);
    script_target(&script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
    run_start(run, &grobo_i_gr001_body, &script, options);
}

TEST(the_zmp_visits_the_middle)
{
    struct run run;

    same_foot_twice(0.3, &automatic, &run); /* more than 0.2: it stays there from 0.1 to 0.1 */
    zmp_is(&run, 1.6, SOLE_X, SOLE_Y);
    zmp_is(&run, 1.7, SOLE_X, 0);
    zmp_is(&run, 1.8, SOLE_X, 0);
    zmp_is(&run, 1.9, SOLE_X, SOLE_Y);
    zmp_is(&run, 2.5, SOLE_X, SOLE_Y);
    zmp_is(&run, 2.6, SOLE_X, 0);
    run_finish(&run);
    same_foot_twice(0.18, &automatic, &run); /* one key in the middle */
    zmp_is(&run, 1.69, SOLE_X, 0);
    run_finish(&run);
    /* Weight 0.5 * 0.06 / 0.12 on the foot that swings; Choreonoid has the sole of each foot at the
     * other one there, nearer to the middle. */
    same_foot_twice(0.06, &automatic, &run);
    zmp_is(&run, 1.63, SOLE_X, 0.5 * (FOOT_Y - 0.01));
    run_finish(&run);
    same_foot_twice(0.02, &automatic, &run); /* too short for anything */
    zmp_is(&run, 1.61, SOLE_X, SOLE_Y);
    run_finish(&run);
}

static void add_case_key(struct script *script, const zmp_case_key *from)
{
    static const int links[2] = {RIGHT, LEFT};
    grobo_body_key *key = script_key(script, from->time_s);

    key->max_transition_s = from->max_transition_s;
    for (int foot = 0; foot < 2; foot++) {
        const zmp_case_foot *f = &from->foot[foot];
        if (f->there) {
            grobo_body_target *target = script_target(script, links[foot], f->x_m, f->y_m, f->z_m);
            target->touching = f->touches;
            script_turn(target, 0, 0, f->yaw_rad);
        }
    }
    if (from->has_zmp) {
        zmp_key(script, from->zmp_m[0], from->zmp_m[1]);
    }
}

/* Each key of the ZMP, and each moment of rest of a foot, is where Choreonoid has it. */
TEST_EACH(zmp_case, zmp_cases, the_zmp_is_choreonoid_s)
{
    static const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .zmp = GROBO_BODY_ZMP_AUTO,
                                               .rate_hz = 100};
    struct script script;
    struct run run;

    memset(&script, 0, sizeof script);
    for (int i = 0; i < row->n_keys; i++) {
        add_case_key(&script, &row->keys[i]);
    }
    run_start(&run, grobo_gr001_body(), &script, &options);
    const struct grobo_i_track *zmp = &run.body->zmp;
    assert_int_equal(zmp->n, row->n_zmp);
    for (int i = 0; i < zmp->n; i++) {
        assert_true(fabs(zmp->t_s[i] - row->zmp[i][0]) < 1e-9);
        assert_true(fabs(grobo_i_track_row(zmp, i)[0] - row->zmp[i][1]) < 1e-9);
        assert_true(fabs(grobo_i_track_row(zmp, i)[1] - row->zmp[i][2]) < 1e-9);
    }
    for (int foot = 0; foot < 2; foot++) {
        const struct grobo_i_track *track = &run.body->target[GROBO_I_RIGHT + foot];
        assert_int_equal(track->n, row->n_foot[foot]);
        for (int i = 0; i < track->n; i++) {
            assert_true(fabs(track->t_s[i] - row->foot_s[foot][i]) < 1e-9);
        }
    }
    run_finish(&run);
}

TEST(an_author_s_zmp_keys_are_held)
{
    struct script script;
    struct run run;
    unsigned flags = 0;

    script_step(&script);
    script.keys[0].has_zmp = true;
    script.keys[0].zmp_m[0] = SOLE_X;
    script.n_keys--;
    script_key(&script, 3)->max_transition_s = 0.25;
    zmp_key(&script, SOLE_X, 0.007);
    run_start(&run, &grobo_i_gr001_body, &script, &automatic);
    assert_int_equal(keys_at(&run.body->zmp, 2.75, &flags), 1);
    assert_true((flags & TRACK_END) != 0);
    zmp_is(&run, 3, SOLE_X, 0.007);
    run_finish(&run);
}

/* ---- a waist shifted beyond reach ---- */

TEST(a_leg_gives_up_the_least_of_a_shift)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const double shift[2] = {0.06, 0.08};
    struct script script;
    struct run run;
    grobo_body_report report;
    grobo_transform links[21], nearer;
    double q[6], given_up[2];

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_stand(&script, 0, 0, 0.148);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    grobo_i_solve(run.body, 0, shift, &report);
    assert_int_equal(report.unreachable, UINT64_C(1) << RIGHT | UINT64_C(1) << LEFT);
    assert_true(fabs(report.root.p_m[0] - 0.06) < NEAR && fabs(report.root.p_m[1] - 0.08) < NEAR);
    grobo_body_forward(&grobo_i_gr001_body, &report.root, run.body->q_rad, links);
    /* the right foot went along with the waist, in the direction of the shift only */
    given_up[0] = links[RIGHT].p_m[0] - FOOT_X;
    given_up[1] = links[RIGHT].p_m[1] + FOOT_Y;
    assert_true(fabs(links[RIGHT].p_m[2] - FOOT_Z) < 1e-9);
    assert_true(fabs(given_up[0] * 0.8 - given_up[1] * 0.6) < 1e-9);
    assert_true(hypot(given_up[0], given_up[1]) > 0.01);
    assert_true(hypot(given_up[0], given_up[1]) < 0.1);
    /* and a tenth of a millimetre less would not do */
    nearer = links[RIGHT];
    nearer.p_m[0] -= 1.01e-4 * 0.6 + 0.06;
    nearer.p_m[1] -= 1.01e-4 * 0.8 + 0.08;
    nearer.p_m[2] -= 0.148;
    assert_int_equal(grobo_body_leg_exact(&grobo_i_gr001_body, 0, &nearer, q),
                     GROBO_ERR_UNREACHABLE);
    run_finish(&run);
}

/* A foot between full contact and its joints' own keys follows the shift by its blending ratio. */
TEST(a_slave_foot_follows_the_shifted_waist)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const double shift[2] = {0.004, 0.006};
    struct script script;
    struct run run;
    grobo_body_report report;
    grobo_transform links[21];

    memset(&script, 0, sizeof script);
    for (int i = 0; i < 2; i++) {
        script_key(&script, i);
        script_stand(&script, 0, 0, 0.14);
        script.targets[i][1].touching = false;
        script.targets[i][1].slave = i == 1;
    }
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    for (int i = 0; i < 10; i++) {
        const double part = smooth(0.1 * i);

        grobo_i_solve(run.body, 0.1 * i, shift, &report);
        assert_int_equal(report.unreachable, 0);
        grobo_body_forward(&grobo_i_gr001_body, &report.root, run.body->q_rad, links);
        assert_true(fabs(links[RIGHT].p_m[0] - FOOT_X - part * shift[0]) < 1e-9);
        assert_true(fabs(links[RIGHT].p_m[1] + FOOT_Y - part * shift[1]) < 1e-9);
        assert_true(fabs(links[RIGHT].p_m[2] - FOOT_Z) < 1e-9);
        assert_true(fabs(links[LEFT].p_m[1] - FOOT_Y) < 1e-9);
    }
    run_finish(&run);
}

/* With a foot as base the waist is the goal. Where it is shifted beyond reach the leg stays as its
 * joints' keys have it, and the waist is where that leg puts it; the base foot does not move. */
TEST(a_waist_shifted_beyond_its_base_foot)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const double shift[2] = {0.06, 0.08};
    struct script script;
    struct run run;
    grobo_body_report report;
    grobo_transform links[21];

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    for (int j = 0; j < 12; j++) {
        script_joint(&script, j, 0.01 * j);
    }
    script_stand(&script, 0, 0, 0.148);
    script.targets[0][0].base = false;
    script.targets[0][2].base = true;
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    grobo_i_solve(run.body, 0, shift, &report);
    assert_true((report.unreachable & UINT64_C(1) << LEFT) != 0);
    for (int j = 6; j < 12; j++) {
        assert_true(fabs(run.body->q_rad[j] - 0.01 * j) < NEAR);
    }
    grobo_body_forward(&grobo_i_gr001_body, &report.root, run.body->q_rad, links);
    assert_true(transforms_apart(&links[LEFT], &script.targets[0][2].at) < NEAR);
    run_finish(&run);
}
