/* SPDX-License-Identifier: MIT */
/* A pose on the ground, of which only the angles are known. */
#include <math.h>
#include <string.h>

#include <grobo/core/body.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

static const grobo_body_model *const gr001 = &grobo_i_gr001_body;

static double initial_rad[GROBO_JOINTS_MAX];

static int set_up(void)
{
    for (int j = 0; j < gr001->n_joints; j++) {
        initial_rad[j] = grobo_i_gr001_model.joints[j].init_rad;
    }
    return 0;
}

static int joint(const char *name)
{
    return grobo_model_find_joint(&grobo_i_gr001_model, name, strlen(name));
}

TEST(stands_on_both_feet)
{
    grobo_body_stand s;
    assert_int_equal(grobo_body_stand_pose(gr001, initial_rad, NULL, &s), 0);
    assert_true(s.standing[0] && s.standing[1]);
    assert_int_equal(s.n_support, 4); /* two soles side by side */
    for (int foot = 0; foot < 2; foot++) {
        for (int i = 0; i < 4; i++) {
            assert_true(fabs(s.sole_m[foot][i][2]) < 1e-9);
        }
    }
    assert_true(s.root.p_m[2] > 0.1 && s.root.p_m[2] < gr001->links[0].offset_m[2] + 1e-9);
    assert_true(grobo_body_stand_margin(&s, s.com_m) > 0.01);
}

/* The lifted foot is in the air, whichever it is; what carries is the sole of the other. */
TEST(stands_on_the_lower_foot)
{
    static const char *const knees[] = {"R_KNEE_P", "L_KNEE_P"};
    for (int lifted = 0; lifted < 2; lifted++) {
        double q_rad[GROBO_JOINTS_MAX];
        grobo_body_stand s;
        memcpy(q_rad, initial_rad, sizeof q_rad);
        q_rad[joint(knees[lifted])] *= 2;
        assert_int_equal(grobo_body_stand_pose(gr001, q_rad, NULL, &s), 0);
        assert_int_equal(s.foot, 1 - lifted);
        assert_true(s.standing[1 - lifted]);
        assert_false(s.standing[lifted]);
        assert_int_equal(s.n_support, 4);
        for (int i = 0; i < 4; i++) {
            assert_true(fabs(s.sole_m[1 - lifted][i][2]) < 1e-9);
            assert_true(s.sole_m[lifted][i][2] > -1e-6);
        }
    }
}

/* A leaning trunk leans, the foot does not: its attitude in the world is the ground's. */
TEST(the_foot_lies_flat)
{
    double q_rad[GROBO_JOINTS_MAX];
    grobo_body_stand s;
    grobo_transform links[GROBO_BODY_LINKS_MAX];
    memcpy(q_rad, initial_rad, sizeof q_rad);
    q_rad[joint("R_ANKLE_P")] += 0.2;
    q_rad[joint("L_ANKLE_P")] -= 0.2;
    assert_int_equal(grobo_body_stand_pose(gr001, q_rad, NULL, &s), 0);
    grobo_body_forward(gr001, &s.root, q_rad, links);
    const double *r = links[gr001->feet[s.foot].link].r;
    assert_true(fabs(r[0] - 1) < 1e-9 && fabs(r[4] - 1) < 1e-9 && fabs(r[8] - 1) < 1e-9);
    assert_true(fabs(s.root.r[2]) > 0.1); /* the trunk leans forward or back */
}

TEST(a_root_that_is_given_stays)
{
    const grobo_transform root = {{0.1, 0.2, 0.5}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    grobo_body_stand s;
    assert_int_equal(grobo_body_stand_pose(gr001, initial_rad, &root, &s), 0);
    assert_true(s.root.p_m[0] == 0.1 && s.root.p_m[2] == 0.5);
    assert_false(s.standing[0] || s.standing[1]);
    assert_int_equal(s.n_support, 0);
    assert_true(grobo_body_stand_margin(&s, s.com_m) == -INFINITY);
}

TEST(a_number_that_is_none_is_refused)
{
    double q_rad[GROBO_JOINTS_MAX];
    grobo_body_stand s = {.foot = 7};
    memcpy(q_rad, initial_rad, sizeof q_rad);
    q_rad[3] = NAN;
    assert_int_equal(grobo_body_stand_pose(gr001, q_rad, NULL, &s), GROBO_ERR_NAN);
    assert_int_equal(s.foot, 7);
}

/* At rest the ZMP lies below the centre of mass; a body pushed forward has it behind. */
TEST(the_zmp_is_that_of_the_motion)
{
    const double *const q_rad[3] = {initial_rad, initial_rad, initial_rad};
    const double dt_s = 0.02, push_m_s2 = 2;
    grobo_transform root[3];
    grobo_body_stand s;
    double still_m[3], pushed_m[3];
    assert_int_equal(grobo_body_stand_pose(gr001, initial_rad, NULL, &s), 0);
    for (int i = 0; i < 3; i++) {
        root[i] = s.root;
    }
    assert_int_equal(grobo_body_zmp_of_poses(gr001, root, q_rad, dt_s, still_m), 0);
    assert_true(fabs(still_m[0] - s.com_m[0]) < 1e-9 && fabs(still_m[1] - s.com_m[1]) < 1e-9);
    root[2].p_m[0] += push_m_s2 * dt_s * dt_s;
    assert_int_equal(grobo_body_zmp_of_poses(gr001, root, q_rad, dt_s, pushed_m), 0);
    assert_true(
        fabs(pushed_m[0] - (s.com_m[0] - s.com_m[2] * push_m_s2 / GROBO_BODY_GRAVITY_M_S2)) < 1e-3);
    assert_true(grobo_body_stand_margin(&s, still_m) > grobo_body_stand_margin(&s, pushed_m));
    assert_int_equal(grobo_body_zmp_of_poses(gr001, root, q_rad, 0, pushed_m), GROBO_ERR_ARG);
}

TESTS_BETWEEN(set_up, NULL)
