/* SPDX-License-Identifier: MIT */
/* A robot's description as a body whose legs can be solved: GR001's is that of its table. */
#include <math.h>
#include <string.h>

#include <grobo/robot_file.h>

#include "tests/support/test.h"

/* As many digits as GR001's description has. */
#define NEARLY 1e-9

static void assert_near(double a, double b)
{
    if (!(fabs(a - b) <= NEARLY)) {
        fail_msg("%.12g is not %.12g", a, b);
    }
}

static void assert_all_near(const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++) {
        assert_near(a[i], b[i]);
    }
}

static void assert_is_gr001(const grobo_body_model *body)
{
    const grobo_body_model *table = grobo_gr001_body();
    assert_int_equal(body->n_links, table->n_links);
    assert_int_equal(body->n_joints, table->n_joints);
    for (int i = 0; i < body->n_links; i++) {
        const grobo_body_link *a = &body->links[i], *b = &table->links[i];
        assert_string_equal(a->name, b->name);
        assert_int_equal(a->parent, b->parent);
        assert_int_equal(a->joint, b->joint);
        assert_near(a->mass_kg, b->mass_kg);
        assert_all_near(a->com_m, b->com_m, 3);
        assert_all_near(a->inertia_kgm2, b->inertia_kgm2, 9);
        if (i > 0) { /* where the waist is in the world is no matter of its description */
            assert_all_near(a->axis, b->axis, 3);
            assert_all_near(a->offset_m, b->offset_m, 3);
        }
    }
    for (int foot = 0; foot < 2; foot++) {
        assert_int_equal(body->feet[foot].link, table->feet[foot].link);
        assert_all_near(body->feet[foot].sole_m, table->feet[foot].sole_m, 3);
        assert_all_near(body->feet[foot].half_m, table->feet[foot].half_m, 2);
    }
}

TEST(gr001_has_the_body_of_its_table)
{
    static grobo_robot_body body;
    assert_int_equal(grobo_robot_def_body(grobo_robot_def_at(0), &body), 0);
    assert_is_gr001(&body.model);
}

TEST(the_feet_may_come_in_either_order)
{
    static grobo_robot_body body;
    grobo_robot_def def = *grobo_robot_def_at(0);
    const grobo_robot_foot right = def.feet[0];
    def.feet[0] = def.feet[1];
    def.feet[1] = right;
    assert_int_equal(grobo_robot_def_body(&def, &body), 0);
    assert_is_gr001(&body.model);
}

/* A part that is fixed, turned by 90 degrees about z, and elsewhere, with the mass of another. */
static void carry(const grobo_robot_link *from, int parent, grobo_robot_link *to)
{
    static const double at_m[3] = {0.01, -0.02, 0.03};
    const double *i = from->inertia_kgm2;
    const double d[3] = {from->com_m[0] - at_m[0], from->com_m[1] - at_m[1],
                         from->com_m[2] - at_m[2]};
    *to = (grobo_robot_link){.name = "mass",
                             .parent = (int8_t)parent,
                             .joint = -1,
                             .origin_m = {at_m[0], at_m[1], at_m[2]},
                             .origin_rad = {0, 0, acos(-1) / 2},
                             .mass_kg = from->mass_kg,
                             .com_m = {d[1], -d[0], d[2]},
                             .inertia_kgm2 = {i[1], i[0], i[2], -i[3], i[5], -i[4]}};
}

TEST(fixed_parts_are_joined_to_what_carries_them)
{
    static grobo_robot_body body;
    static grobo_robot_link links[GROBO_ROBOT_LINKS_MAX];
    grobo_robot_def def = *grobo_robot_def_at(0);
    for (int i = 0; i < def.n_links; i++) {
        links[2 * i] = def.links[i];
        links[2 * i].parent = (int8_t)(def.links[i].parent < 0 ? -1 : 2 * def.links[i].parent);
        links[2 * i].mass_kg = 0;
        carry(&def.links[i], 2 * i, &links[2 * i + 1]);
    }
    def.links = links;
    def.n_links = (uint8_t)(2 * def.n_links);
    for (int foot = 0; foot < 2; foot++) { /* the sole is a part of its own, too */
        grobo_robot_foot *f = &def.feet[foot];
        f->link = (int8_t)(2 * f->link + 1);
        const double d[3] = {f->sole_m[0] - 0.01, f->sole_m[1] + 0.02, f->sole_m[2] - 0.03};
        f->sole_m[0] = d[1];
        f->sole_m[1] = -d[0];
        f->sole_m[2] = d[2];
    }
    assert_int_equal(grobo_robot_def_body(&def, &body), 0);
    assert_is_gr001(&body.model);
}

TEST(half_of_a_mass_is_joined_to_the_other_half)
{
    static grobo_robot_body body;
    static grobo_robot_link links[GROBO_ROBOT_LINKS_MAX];
    grobo_robot_def def = *grobo_robot_def_at(0);
    memcpy(links, def.links, def.n_links * sizeof links[0]);
    grobo_robot_link *first = &links[0], *second = &links[def.n_links];
    /* Two halves 2 cm apart: about their middle they have m (1 cm)^2 more, across that way. */
    *second = *first;
    second->parent = 0;
    second->name = "half";
    first->mass_kg = second->mass_kg = first->mass_kg / 2;
    for (int k = 0; k < 6; k++) {
        first->inertia_kgm2[k] = second->inertia_kgm2[k] = def.links[0].inertia_kgm2[k] / 2;
    }
    const double more_kgm2 = def.links[0].mass_kg * 0.01 * 0.01;
    first->inertia_kgm2[1] -= more_kgm2;
    first->inertia_kgm2[2] -= more_kgm2;
    first->com_m[0] -= 0.01;
    second->com_m[0] += 0.01;
    def.links = links;
    def.n_links++;
    assert_int_equal(grobo_robot_def_body(&def, &body), 0);
    assert_is_gr001(&body.model);
}

TEST(others_have_none)
{
    static grobo_robot_body body;
    grobo_robot_def def = *grobo_robot_def_at(0);
    assert_int_equal(grobo_robot_def_body(grobo_robot_def_at(1), &body), GROBO_ERR_UNSUPPORTED);
    def.feet[1] = def.feet[0]; /* one foot twice */
    assert_int_equal(grobo_robot_def_body(&def, &body), GROBO_ERR_UNSUPPORTED);
    def = *grobo_robot_def_at(0);
    def.feet[0].link = 13; /* the chest */
    assert_int_equal(grobo_robot_def_body(&def, &body), GROBO_ERR_UNSUPPORTED);
}
