/* SPDX-License-Identifier: MIT */
/* The rigid-body tree and leg IK, from first principles: no data but the table. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"
#include "tests/support/body_scaled.h"
#include "tests/support/next_random.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/transforms.h"

static uint32_t seed;

/* Even in low..high, the same numbers in every run. */
static double random_in(double low, double high)
{
    return low + (high - low) * (double)next_random(&seed) / 16777216.0;
}

static void random_pose(double *q_rad, grobo_transform *root)
{
    const double rpy[3] = {random_in(-1, 1), random_in(-1, 1), random_in(-3, 3)};

    for (int j = 0; j < 20; j++) {
        const grobo_joint *joint = &grobo_i_gr001_model.joints[j];

        q_rad[j] = random_in(joint->min_rad, joint->max_rad);
    }
    for (int k = 0; k < 3; k++) {
        root->p_m[k] = random_in(-0.2, 0.2);
    }
    grobo_i_rotation_of_rpy(root->r, rpy);
}

static void in_frame_of(const grobo_transform *frame, const grobo_transform *at,
                        grobo_transform *local)
{
    double way[3];

    vec_add_scaled(way, at->p_m, -1, frame->p_m);
    mat_t_vec(local->p_m, frame->r, way);
    mat_t_mul(local->r, frame->r, at->r);
}

TEST(gr001_is_a_model)
{
    assert_int_equal(grobo_body_model_check(&grobo_i_gr001_body), 0);
    assert_int_equal(grobo_i_gr001_body.n_joints, grobo_i_gr001_model.n_joints);
    for (int i = 1; i < grobo_i_gr001_body.n_links; i++) {
        const grobo_body_link *link = &grobo_i_gr001_body.links[i];

        assert_string_equal(link->name, grobo_i_gr001_model.joints[link->joint].name);
    }
}

TEST(broken_models_are_refused)
{
    struct body_scaled scaled;

    assert_int_equal(grobo_body_model_check(NULL), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.links[3].parent = 3;
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.links[3].joint = 1;
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.links[20].axis[0] = 1;
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.links[7].mass_kg = NAN;
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.links[4].offset_m[1] = 0.001; /* a knee beside the hip's plane: no such leg */
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.model.feet[0].link = 13; /* a chest is no foot */
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
    body_scaled_init(&scaled, 1, 1);
    scaled.model.feet[1].link = scaled.model.feet[0].link;
    assert_int_equal(grobo_body_model_check(&scaled.model), GROBO_ERR_ARG);
}

/* Without angles a link stands at the sum of the offsets above it, and the centre of mass is the
 * sum of what is written in the table. */
TEST(straight_pose_is_a_sum_of_offsets)
{
    const double q[20] = {0};
    grobo_transform links[21];
    double sum[3] = {0}, com[3], mass = 0;

    grobo_body_forward(&grobo_i_gr001_body, NULL, q, links);
    for (int i = 0; i < 21; i++) {
        double at[3] = {0};

        for (int k = i; k >= 0; k = grobo_i_gr001_body.links[k].parent) {
            vec_add_scaled(at, at, 1, grobo_i_gr001_body.links[k].offset_m);
        }
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(links[i].p_m[k] - at[k]) < 1e-15);
            sum[k] += grobo_i_gr001_body.links[i].mass_kg *
                      (at[k] + grobo_i_gr001_body.links[i].com_m[k]);
        }
        mass += grobo_i_gr001_body.links[i].mass_kg;
    }
    /* by hand: 0.1605 - 0.028 - 0.005 - 0.048 - 0.059 + 0.0005; -0.0221 + 0.0025 */
    assert_true(fabs(links[6].p_m[0] - 0.029) < 1e-15);
    assert_true(fabs(links[6].p_m[1] + 0.0196) < 1e-15);
    assert_true(fabs(links[6].p_m[2] - 0.021) < 1e-15);
    assert_true(fabs(grobo_body_com(&grobo_i_gr001_body, links, com) - 0.88475) < 1e-12);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(com[k] - sum[k] / mass) < 1e-15);
    }
}

/* A quarter turn of one joint, by hand: the chest bows forward about -Y. */
TEST(one_joint_turns_what_hangs_on_it)
{
    double q[20] = {0};
    grobo_transform links[21];

    q[12] = -BODY_PI / 2;
    grobo_body_forward(&grobo_i_gr001_body, NULL, q, links);
    /* the neck, (-0.012, 0, 0.056) above the chest, comes to (0.056, 0, 0.012) */
    assert_true(fabs(links[14].p_m[0] - (0.044 + 0.056)) < 1e-15);
    assert_true(fabs(links[14].p_m[1]) < 1e-15);
    assert_true(fabs(links[14].p_m[2] - (0.1605 + 0.02 + 0.012)) < 1e-15);
}

/* Momentum against differences of positions: P = m dc/dt, L = sum c x m dc/dt + R I R^T w. */
TEST(momentum_is_what_moves)
{
    const double dt = 1e-6;

    seed = 1;
    for (int round = 0; round < 20; round++) {
        const double linear[3] = {random_in(-1, 1), random_in(-1, 1), random_in(-1, 1)};
        const double angular[3] = {random_in(-1, 1), random_in(-1, 1), random_in(-1, 1)};
        double q[20], speed[20], late[20], want_p[3] = {0}, want_l[3] = {0};
        grobo_transform root, root_late, links[21], links_late[21];
        grobo_momentum got;

        random_pose(q, &root);
        for (int j = 0; j < 20; j++) {
            speed[j] = random_in(-3, 3);
            late[j] = q[j] + dt * speed[j];
        }
        const double size = sqrt(vec_dot(angular, angular));
        const double axis[3] = {angular[0] / size, angular[1] / size, angular[2] / size};
        double turn[9];

        mat_axis_angle(turn, axis, size * dt);
        mat_mul(root_late.r, turn, root.r);
        vec_add_scaled(root_late.p_m, root.p_m, dt, linear);
        grobo_body_forward(&grobo_i_gr001_body, &root, q, links);
        grobo_body_forward(&grobo_i_gr001_body, &root_late, late, links_late);
        for (int i = 0; i < 21; i++) {
            const grobo_body_link *link = &grobo_i_gr001_body.links[i];
            double c[3], c_late[3], v[3], cross[3], w[3], local[3], spin[3], world[3];

            mat_vec(c, links[i].r, link->com_m);
            vec_add_scaled(c, c, 1, links[i].p_m);
            mat_vec(c_late, links_late[i].r, link->com_m);
            vec_add_scaled(c_late, c_late, 1, links_late[i].p_m);
            vec_add_scaled(v, c_late, -1, c);
            vec_cross(cross, c, v);
            vec_add_scaled(want_p, want_p, link->mass_kg / dt, v);
            vec_add_scaled(want_l, want_l, link->mass_kg / dt, cross);
            mat_t_mul(turn, links[i].r, links_late[i].r);
            grobo_i_rotation_vector(w, turn);
            mat_vec(local, link->inertia_kgm2, w);
            mat_vec(world, links[i].r, local);
            for (int k = 0; k < 3; k++) {
                spin[k] = world[k] / dt;
            }
            vec_add_scaled(want_l, want_l, 1, spin);
        }
        const grobo_body_velocity velocity = {
            {linear[0], linear[1], linear[2]}, {angular[0], angular[1], angular[2]}, speed};

        grobo_body_momentum(&grobo_i_gr001_body, links, &velocity, &got);
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(got.p_kgm_s[k] - want_p[k]) < 1e-5);
            assert_true(fabs(got.l_kgm2_s[k] - want_l[k]) < 1e-5);
        }
    }
}

/* A body at rest has its ZMP below its centre of mass; one pushed forward, behind it by
 * c_z a / g, as a point mass on a massless leg has. */
TEST(zmp_of_rest_and_of_a_push)
{
    const double com[3] = {0.01, -0.02, 0.15}, mass = 0.9, push = 0.7;
    const grobo_momentum rest = {{0, 0, 0}, {0, 0, 0}};
    const grobo_momentum pushed = {{mass * push, 0, 0},
                                   {0, com[2] * mass * push, -com[1] * mass * push}};
    double zmp[3] = {0, 0, 0};

    grobo_body_zmp(com, mass, &rest, zmp);
    assert_true(fabs(zmp[0] - com[0]) < 1e-15 && fabs(zmp[1] - com[1]) < 1e-15);
    grobo_body_zmp(com, mass, &pushed, zmp);
    assert_true(fabs(zmp[0] - (com[0] - com[2] * push / GROBO_BODY_GRAVITY_M_S2)) < 1e-15);
    assert_true(fabs(zmp[1] - com[1]) < 1e-15);
    const grobo_momentum fall = {{push, 0, -mass * GROBO_BODY_GRAVITY_M_S2}, {0, 0, 0}};

    grobo_body_zmp(com, mass, &fall, zmp); /* no force, no point: far away, but a number */
    assert_true(isfinite(zmp[0]) && isfinite(zmp[1]) && hypot(zmp[0], zmp[1]) > 1);
    zmp[2] = 0.05; /* a plane above the ground: the lever is shorter */
    grobo_body_zmp(com, mass, &pushed, zmp);
    assert_true(fabs(zmp[0] - (com[0] - 0.1 * push / GROBO_BODY_GRAVITY_M_S2)) < 1e-15);
}

/* Poses of a model within GR001's limits: the foot that forward kinematics gives is solved, and
 * forward kinematics of the answer hits it. */
static void hit_targets(const grobo_body_model *model, double tolerance_m)
{
    seed = 2;
    for (int round = 0; round < 2000; round++) {
        double q[20], answer[6];
        grobo_transform root, links[21], target;

        random_pose(q, &root);
        grobo_body_forward(model, &root, q, links);
        for (int foot = 0; foot < 2; foot++) {
            double again[20];
            grobo_transform hit[21];

            in_frame_of(&links[0], &links[model->feet[foot].link], &target);
            assert_int_equal(grobo_body_leg_exact(model, foot, &target, answer), 0);
            memcpy(again, q, sizeof again);
            memcpy(again + 6 * foot, answer, sizeof answer);
            grobo_body_forward(model, &root, again, hit);
            assert_true(transforms_apart(&hit[model->feet[foot].link],
                                         &links[model->feet[foot].link]) < tolerance_m);
        }
    }
}

TEST(exact_ik_hits_the_target)
{
    hit_targets(&grobo_i_gr001_body, 1e-9);
}

TEST(exact_ik_hits_the_target_of_a_larger_robot)
{
    struct body_scaled scaled;

    body_scaled_init(&scaled, 3.7, 40);
    assert_int_equal(grobo_body_model_check(&scaled.model), 0);
    hit_targets(&scaled.model, 3.7e-9);
}

/* With a foot no steeper than a walker's the answer is the pose itself, not another one. */
TEST(exact_ik_finds_the_pose_again)
{
    seed = 3;
    for (int round = 0; round < 2000; round++) {
        double q[20] = {0}, answer[6];
        grobo_transform links[21], target;

        for (int foot = 0; foot < 2; foot++) {
            const double side = foot == 0 ? 1 : -1;
            double *leg = q + 6 * foot;

            leg[0] = random_in(-0.7, 0.7);
            leg[1] = random_in(-0.6, 0.6);
            leg[2] = side * random_in(-0.3, 1.2);
            leg[3] = side * random_in(-2, -0.05);
            leg[4] = leg[2] + leg[3] + side * random_in(-0.8, 0.8);
            leg[5] = random_in(-0.6, 0.6);
            grobo_body_forward(&grobo_i_gr001_body, NULL, q, links);
            in_frame_of(&links[0], &links[foot == 0 ? 6 : 12], &target);
            assert_int_equal(grobo_body_leg_exact(&grobo_i_gr001_body, foot, &target, answer), 0);
            for (int i = 0; i < 6; i++) {
                assert_true(fabs(answer[i] - leg[i]) < 1e-7);
            }
        }
    }
}

/* Beside a straight knee, where a small error of the ankle's place is a large one of the knee. */
TEST(exact_ik_is_exact_beside_a_straight_knee)
{
    for (double knee = 0.1; knee > 1e-5; knee *= 0.7) {
        for (int foot = 0; foot < 2; foot++) {
            const double side = foot == 0 ? 1 : -1;
            double q[20] = {0}, answer[6];
            double *leg = q + 6 * foot;
            grobo_transform links[21], hit[21], target;

            leg[0] = 0.1;
            leg[1] = side * 0.05;
            leg[2] = side * 0.3;
            leg[3] = -side * knee;
            leg[4] = side * 0.25;
            grobo_body_forward(&grobo_i_gr001_body, NULL, q, links);
            in_frame_of(&links[0], &links[foot == 0 ? 6 : 12], &target);
            assert_int_equal(grobo_body_leg_exact(&grobo_i_gr001_body, foot, &target, answer), 0);
            assert_true(fabs(answer[3] - leg[3]) * knee < 1e-13); /* the rounding of a cosine */
            memcpy(leg, answer, sizeof answer);
            grobo_body_forward(&grobo_i_gr001_body, NULL, q, hit);
            assert_true(transforms_apart(&hit[foot == 0 ? 6 : 12], &links[foot == 0 ? 6 : 12]) <
                        1e-9);
        }
    }
}

TEST(far_targets_are_unreachable)
{
    const double q[20] = {0};
    double answer[6] = {9, 9, 9, 9, 9, 9};
    grobo_transform links[21], target;

    grobo_body_forward(&grobo_i_gr001_body, NULL, q, links);
    in_frame_of(&links[0], &links[6], &target);
    assert_int_equal(grobo_body_leg_exact(&grobo_i_gr001_body, 0, &target, answer), 0);
    for (int i = 0; i < 6; i++) {
        assert_true(fabs(answer[i]) < 1e-6); /* stretched: the last pose in reach */
        answer[i] = 9;
    }
    target.p_m[2] -= 1e-4;
    assert_int_equal(grobo_body_leg_exact(&grobo_i_gr001_body, 0, &target, answer),
                     GROBO_ERR_UNREACHABLE);
    assert_true(answer[0] > 8 && answer[5] > 8);
    assert_int_equal(grobo_body_leg_exact(&grobo_i_gr001_body, 2, &target, answer), GROBO_ERR_ARG);
}

/* The numeric loop comes to the exact answer but for its tolerance: 1.4e-3 rad of attitude. */
TEST(numeric_ik_comes_near_the_exact_answer)
{
    seed = 4;
    for (int round = 0; round < 200; round++) {
        double want[20] = {0}, q[6];
        grobo_transform links[21];
        struct grobo_i_leg leg;
        const bool compat11 = round % 2 == 1;

        assert_int_equal(grobo_i_leg_find(&grobo_i_gr001_body, 0, &leg), 0);
        want[0] = random_in(-0.5, 0.2);
        want[1] = random_in(-0.3, 0.3);
        want[2] = random_in(0, 1);
        want[3] = random_in(-1.5, -0.3);
        want[4] = random_in(-0.6, 0.3);
        want[5] = random_in(-0.3, 0.3);
        grobo_body_forward(&grobo_i_gr001_body, NULL, want, links);
        for (int up = 0; up < 2; up++) {
            const struct grobo_i_numeric problem = {&grobo_i_gr001_body, &leg, up == 1, compat11};

            for (int i = 0; i < 6; i++) {
                q[i] = want[i] + random_in(-0.1, 0.1);
            }
            assert_true(grobo_i_leg_numeric(&problem, &links[up ? 6 : 0], &links[up ? 0 : 6], q));
            for (int i = 0; i < 6; i++) {
                assert_true(fabs(q[i] - want[i]) < 5e-3);
            }
        }
    }
}

/* The Jacobian against differences, walked down from the waist and up from the foot. */
TEST(jacobian_is_the_derivative)
{
    const double step = 1e-6;

    seed = 5;
    for (int round = 0; round < 20; round++) {
        double q[20];
        grobo_transform root, links[21], end, moved;
        struct grobo_i_leg leg;

        random_pose(q, &root);
        assert_int_equal(grobo_i_leg_find(&grobo_i_gr001_body, 1, &leg), 0);
        grobo_body_forward(&grobo_i_gr001_body, &root, q, links);
        for (int up = 0; up < 2; up++) {
            const struct grobo_i_numeric problem = {&grobo_i_gr001_body, &leg, up == 1, false};
            const grobo_transform *start = &links[up ? 12 : 0];
            double jacobian[6][6], unused[6][6], turn[9], w[3], world[3];

            grobo_i_leg_jacobian(&problem, start, q + 6, jacobian, &end);
            assert_true(transforms_apart(&end, &links[up ? 0 : 12]) < 1e-12);
            for (int i = 0; i < 6; i++) {
                double other[6];

                memcpy(other, q + 6, sizeof other);
                other[i] += step;
                grobo_i_leg_jacobian(&problem, start, other, unused, &moved);
                mat_t_mul(turn, end.r, moved.r);
                grobo_i_rotation_vector(w, turn);
                mat_vec(world, end.r, w);
                for (int k = 0; k < 3; k++) {
                    assert_true(fabs((moved.p_m[k] - end.p_m[k]) / step - jacobian[k][i]) < 1e-5);
                    assert_true(fabs(world[k] / step - jacobian[3 + k][i]) < 1e-5);
                }
            }
        }
    }
}

TEST(roll_pitch_yaw_come_back)
{
    seed = 6;
    for (int round = 0; round < 1000; round++) {
        const double rpy[3] = {random_in(-3.1, 3.1), random_in(-1.5, 1.5), random_in(-3.1, 3.1)};
        double r[9], back[3], again[9];

        grobo_i_rotation_of_rpy(r, rpy);
        grobo_i_rpy_of_rotation(back, r);
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(back[k] - rpy[k]) < 1e-9);
        }
        /* near to it they are still told apart */
        const double steep[3] = {rpy[0], BODY_PI / 2 - 1e-4, rpy[2]};

        grobo_i_rotation_of_rpy(r, steep);
        grobo_i_rpy_of_rotation(back, r);
        assert_true(fabs(back[0] - rpy[0]) < 1e-6 && fabs(back[2] - rpy[2]) < 1e-6);
        /* straight up: roll and yaw are one turn, which goes to roll */
        const double up[3] = {rpy[0], BODY_PI / 2, rpy[2]};

        grobo_i_rotation_of_rpy(r, up);
        grobo_i_rpy_of_rotation(back, r);
        assert_true(fabs(back[2]) < 1e-15);
        grobo_i_rotation_of_rpy(again, back);
        for (int k = 0; k < 9; k++) {
            assert_true(fabs(again[k] - r[k]) < 1e-6);
        }
    }
}

/* w(R) is the rotation vector, and nothing below 1.4e-3 rad. */
TEST(omega_has_a_dead_zone)
{
    const double axis[3] = {0.6, 0, -0.8};
    double r[9], w[3];

    mat_axis_angle(r, axis, 0.3);
    grobo_i_omega(w, r);
    assert_true(fabs(w[0] - 0.18) < 1e-12 && fabs(w[1]) < 1e-12 && fabs(w[2] + 0.24) < 1e-12);
    mat_axis_angle(r, axis, 1.42e-3);
    grobo_i_omega(w, r);
    assert_true(fabs(w[2] + 0.8 * 1.42e-3) < 1e-9);
    mat_axis_angle(r, axis, 1.41e-3);
    grobo_i_omega(w, r);
    assert_true(w[0] == 0 && w[1] == 0 && w[2] == 0);
}
