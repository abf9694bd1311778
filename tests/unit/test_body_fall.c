/* SPDX-License-Identifier: MIT */
/* GROBO_BODY_FALL: motions by angles alone on a body that can fall. MuJoCo judges the same in
 * tests/physics/balance.py; here are cases that leave no doubt, and their mirror images. */
#include <math.h>
#include <string.h>

#include "tests/support/body_script.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define DEG (3.14159265358979323846 / 180)

/* Joints of GR001, and how they move a robot that stands. */
enum {
    R_HIP_P = 2,
    R_KNEE_P = 3,
    R_ANKLE_P = 4,
    R_ANKLE_R = 5,
    L_HIP_P = 8,
    L_KNEE_P = 9,
    L_ANKLE_P = 10,
    L_ANKLE_R = 11,
    CHEST_P = 12
};

static grobo_body_finding seen;
static int n_seen;

static void see(void *ctx, const grobo_body_finding *finding)
{
    (void)ctx;
    if (finding->problem == GROBO_BODY_FALL) {
        seen = *finding;
        n_seen++;
    }
}

/* A key of all joints: the initial posture with some of them elsewhere. */
struct away {
    int joint;
    double deg; /* more than in the initial posture */
};

static void script_pose(struct script *script, double time_s, const struct away *away)
{
    script_key(script, time_s);
    for (int j = 0; j < JOINTS; j++) {
        double rad = grobo_i_gr001_model.joints[j].init_rad;

        for (int i = 0; i < 4 && away != NULL; i++) {
            rad += away[i].joint == j ? away[i].deg * DEG : 0;
        }
        script_joint(script, j, rad);
    }
    if (script->n_keys == 1) {
        script_target(script, RIGHT, FOOT_X, -FOOT_Y, FOOT_Z)->touching = true;
        script_target(script, LEFT, FOOT_X, FOOT_Y, FOOT_Z)->touching = true;
    }
}

/* Plays a script from its first key to its last. The number of falls. */
static int fall_of_script(const struct script *script, uint16_t speed_pct)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 100};
    const grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT,
                                             .robot = &grobo_i_gr001_model, .finding = see,
                                             .speed_pct = speed_pct, .falls = true};
    struct run run;

    memset(&seen, 0, sizeof seen);
    n_seen = 0;
    run_start(&run, &grobo_i_gr001_body, script, &options);
    assert_true(grobo_body_check(run.body, &checks) >= n_seen);
    run_finish(&run);
    return n_seen;
}

/* Goes there in go_s, and stays for 2 s. */
static int fall_of(const struct away *away, double go_s, uint16_t speed_pct)
{
    struct script script;

    memset(&script, 0, sizeof script);
    script_pose(&script, 0, NULL);
    script_pose(&script, go_s, away);
    script_pose(&script, go_s + 2, away);
    return fall_of_script(&script, speed_pct);
}

TEST(a_lean_falls_to_its_side)
{
    static const struct {
        struct away away[4];
        int side;
    } cases[] = {
        {{{R_ANKLE_P, 24}, {L_ANKLE_P, -24}, {-1, 0}, {-1, 0}}, GROBO_BODY_BACK},
        {{{R_ANKLE_P, -24}, {L_ANKLE_P, 24}, {-1, 0}, {-1, 0}}, GROBO_BODY_AHEAD},
        {{{R_ANKLE_R, 30}, {L_ANKLE_R, 30}, {-1, 0}, {-1, 0}}, GROBO_BODY_LEFT},
        {{{R_ANKLE_R, -30}, {L_ANKLE_R, -30}, {-1, 0}, {-1, 0}}, GROBO_BODY_RIGHT},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(fall_of(cases[i].away, 1, 100), 1);
        assert_int_equal(seen.index, cases[i].side);
        assert_true(seen.worst == 0);
        assert_true(seen.begin_s > 0.2 && seen.begin_s < seen.worst_s);
        assert_true(seen.worst_s < 3.01 && seen.end_s == seen.worst_s);
    }
}

/* One knee bends: that leg is shorter, whatever says that both feet stand. */
TEST(a_shorter_leg_is_where_it_falls)
{
    const struct away right[] = {{R_HIP_P, 38}, {R_KNEE_P, -76}, {R_ANKLE_P, -38}, {-1, 0}};
    const struct away left[] = {{L_HIP_P, -38}, {L_KNEE_P, 76}, {L_ANKLE_P, 38}, {-1, 0}};
    double fallen_s;

    assert_int_equal(fall_of(right, 0.4, 100), 1);
    assert_int_equal(seen.index, GROBO_BODY_RIGHT);
    fallen_s = seen.worst_s;
    assert_int_equal(fall_of(left, 0.4, 100), 1);
    assert_int_equal(seen.index, GROBO_BODY_LEFT);
    assert_true(fabs(seen.worst_s - fallen_s) < 0.1); /* the arms and the waist are not the same */
}

/* From upright to far over: it stands, then it is in doubt, then it falls on level floor. */
TEST(between_standing_and_falling_there_is_doubt)
{
    double doubt_deg = 0, falls_deg = 0;

    for (double deg = 10; deg < 26; deg += 0.5) {
        const struct away back[4] = {{R_ANKLE_P, deg}, {L_ANKLE_P, -deg}, {-1, 0}, {-1, 0}};
        const int falls = fall_of(back, 1, 100);

        assert_true(falls || doubt_deg == 0); /* once it falls it does not stand further over */
        doubt_deg = falls && doubt_deg == 0 ? deg : doubt_deg;
        falls_deg = falls && falls_deg == 0 && seen.worst == 0 ? deg : falls_deg;
        assert_true(!falls || seen.worst == 0 || fabs(seen.worst - 1.5 * DEG) < 1e-12);
        assert_true(!falls || seen.index == GROBO_BODY_BACK);
        assert_true(falls_deg == 0 || seen.worst == 0);
    }

    assert_true(doubt_deg > 12 && doubt_deg < falls_deg);
    assert_true(falls_deg - doubt_deg < 3);
}

/* What stands slowly falls fast: the weight is thrown. */
TEST(speed_throws_it)
{
    const struct away back[4] = {{R_ANKLE_P, 12}, {L_ANKLE_P, -12}, {-1, 0}, {-1, 0}};

    assert_int_equal(fall_of(back, 1, 0), 0);
    assert_int_equal(fall_of(back, 1, 100), 0);
    assert_int_equal(fall_of(back, 1, 600), 1);
    assert_true(seen.worst_s > 1); /* in the motion's own time, which is at its end */
}

/* Nothing but the floor's friction and the soles hold it: a robot that is not moved stands. */
/* Hips swung back and forth: MuJoCo's GR001 falls by it, */
TEST(a_swing_that_comes_back_throws_it)
{
    static const struct away swung[4] = {
        {R_HIP_P, -36.7}, {L_HIP_P, 36.7}, {CHEST_P, -9.56}, {-1, 0}};
    struct script script;

    memset(&script, 0, sizeof script);
    script_pose(&script, 0, NULL);
    script_pose(&script, 0.317, swung);
    script_pose(&script, 0.345, swung);
    script_pose(&script, 0.997, NULL);
    assert_int_equal(fall_of_script(&script, 100), 1);
    assert_int_equal(fall_of_script(&script, 30), 0);
}

TEST(it_stands)
{
    const struct away none[4] = {{-1, 0}, {-1, 0}, {-1, 0}, {-1, 0}};

    assert_int_equal(fall_of(none, 1, 100), 0);
    assert_int_equal(fall_of(none, 8, 100), 0);
}

/* What the constants of servos and floor come to, so that none changes unseen: how far it may lean
 * to each side, within half a degree, and when it lies. */
TEST(how_far_it_may_lean)
{
    static const struct {
        int joint[2];
        double sign[2];
        double stands_deg, doubt_deg, falls_deg; /* the next half degree up is another answer */
        double lies_s;                           /* at falls_deg */
    } sides[] = {
        {{R_ANKLE_P, L_ANKLE_P}, {1, -1}, 11.5, 12, 13.5, 1.076},
        {{R_ANKLE_P, L_ANKLE_P}, {-1, 1}, 12, 12.5, 14, 1.06},
        {{R_ANKLE_R, L_ANKLE_R}, {1, 1}, 16, 16.5, 18, 1.146},
    };

    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        const double deg[] = {sides[i].stands_deg, sides[i].doubt_deg, sides[i].falls_deg - 0.5,
                              sides[i].falls_deg};

        for (int k = 0; k < 4; k++) {
            const struct away away[4] = {{sides[i].joint[0], sides[i].sign[0] * deg[k]},
                                         {sides[i].joint[1], sides[i].sign[1] * deg[k]},
                                         {-1, 0},
                                         {-1, 0}};

            assert_int_equal(fall_of(away, 0.5, 100), k > 0);
            assert_int_equal(seen.worst > 0, k == 1 || k == 2);
        }
        assert_true(fabs(seen.worst_s - sides[i].lies_s) < 0.004);
    }
}
