/* SPDX-License-Identifier: MIT */
/* Descriptions for other programs (URDF, Choreonoid's body) as robots. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/unit.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/robot/sketch.h"
#include "tools/grctl/robot/xml.h"

static sketch s;
static char said[1024];

/* All joints with servos of one kind. NULL: refused, see said. */
static char *text_of(const char *bytes, bool urdf, const char *family, const char *servo)
{
    s.n = 0;
    s.bare = false;
    s.baud_bps = 0;
    s.family = family_called(family);
    snprintf(s.name, sizeof s.name, "robot");
    snprintf(s.source, sizeof s.source, "a file");
    bool (*const read)(sketch *, const char *, const char *, size_t, char *, size_t) =
        urdf ? sketch_read_urdf : sketch_read_body;
    if (!read(&s, "arm", bytes, strlen(bytes), said, sizeof said) ||
        !sketch_order(&s, said, sizeof said)) {
        return NULL;
    }
    for (int i = 0; i < sketch_joints(&s); i++) {
        sketch_joint(&s, i)->id = i + 1;
        sketch_joint(&s, i)->servo = family_model(s.family, servo);
    }
    return sketch_fit(&s, said, sizeof said) ? sketch_text(&s) : NULL;
}

static grobo_robot_def *def_of(const char *bytes, bool urdf, const char *family, const char *servo)
{
    grobo_robot_def *def = NULL;
    char *text = text_of(bytes, urdf, family, servo);
    assert_non_null(text);
    int error = sketch_read_back(text, NULL, &def);
    if (error) {
        print_error("%s", text);
    }
    free(text);
    assert_int_equal(error, 0);
    return def;
}

static grobo_robot_def *arm(const char *urdf)
{
    return def_of(urdf, true, "feetech", "STS3215");
}

static char *file_bytes(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    char *bytes = calloc(1, 1 << 20);
    assert_non_null(bytes);
    assert_true(fread(bytes, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    return bytes;
}

static void need_xml(void)
{
    if (xml_missing()) {
        print_message("%s\n", xml_missing());
        skip();
    }
}

static void near(double a, double b, double by)
{
    if (fabs(a - b) > by) {
        fail_msg("%.9g is not %.9g", a, b);
    }
}

static const grobo_robot_def *shipped(const char *name)
{
    for (int i = 0; grobo_i_robot_defs[i]; i++) {
        if (strcmp(grobo_i_robot_defs[i]->name, name) == 0) {
            return grobo_i_robot_defs[i];
        }
    }
    fail_msg("no %s", name);
    return NULL;
}

/* ---- what is read --------------------------------------------------------------------------- */

static void weighs_alike(const grobo_robot_link *a, const grobo_robot_link *b)
{
    for (int k = 0; k < 3; k++) {
        near(a->com_m[k], b->com_m[k], 1e-8);
    }
    for (int k = 0; k < 6; k++) {
        near(a->inertia_kgm2[k], b->inertia_kgm2[k], 1e-10);
    }
}

TEST(so101_is_as_it_is_shipped)
{
    need_xml();
    const grobo_robot_def *own = shipped("so101");
    char *bytes = file_bytes("tests/cli/urdf/so101.urdf");
    assert_non_null(bytes);
    grobo_robot_def *def = arm(bytes);
    free(bytes);
    assert_int_equal(def->model->n_joints, own->model->n_joints);
    for (int j = 0; j < own->model->n_joints; j++) {
        const grobo_joint *a = &def->model->joints[j], *b = &own->model->joints[j];
        assert_string_equal(a->name, b->name);
        assert_int_equal(a->motor, b->motor);
        assert_int_equal(a->servo_model, b->servo_model);
        near(a->min_rad, b->min_rad, 1e-4);
        near(a->max_rad, b->max_rad, 1e-4);
        near(a->max_speed_rad_s, b->max_speed_rad_s, 1e-9);
        near(a->init_rad, b->init_rad, 1e-9);
        near(a->zero_rad, 0, 0);
    }
    assert_int_equal(def->n_links, own->n_links);
    for (int i = 0; i < own->n_links; i++) {
        const grobo_robot_link *a = &def->links[i], *b = &own->links[i];
        assert_string_equal(a->name, b->name);
        assert_int_equal(a->parent, b->parent);
        assert_int_equal(a->joint, b->joint);
        near(a->mass_kg, b->mass_kg, 1e-9);
        weighs_alike(a, b);
        for (int k = 0; k < 3; k++) {
            near(a->origin_m[k], b->origin_m[k], 1e-9);
            near(remainder(a->origin_rad[k] - b->origin_rad[k], 2 * acos(-1)), 0, 1e-6);
            near(a->joint < 0 ? 0 : a->axis[k], a->joint < 0 ? 0 : b->axis[k], 1e-9);
        }
    }
    grobo_robot_def_free(def);
}

TEST(gr001_has_the_limits_of_its_body)
{
    const char *shared = getenv("GROBO_SHARED");
    char path[1024];
    snprintf(path, sizeof path, "%s/data/choreonoid/GR001.body", shared ? shared : "../shared");
    char *bytes = file_bytes(path);
    if (!bytes) {
        print_message("%s is missing: reference material beside the checkout\n", path);
        skip();
    }
    const grobo_robot_def *own = shipped("gr001");
    grobo_robot_def *def = def_of(bytes, false, "rs30x", "RS301CR");
    free(bytes);
    assert_string_equal(def->name, "GR001");
    assert_int_equal(def->model->n_joints, 20);
    for (int j = 0; j < 20; j++) {
        const grobo_joint *a = &def->model->joints[j], *b = &own->model->joints[j];
        assert_string_equal(a->name, b->name);
        near(a->min_rad, b->min_rad, 1e-9);
        near(a->max_rad, b->max_rad, 1e-9);
    }
    assert_int_equal(def->n_links, 21);
    for (int l = 0; l < own->n_links; l++) {
        const grobo_robot_link *a = &def->links[l], *b = &own->links[l];
        assert_string_equal(a->name, b->name);
        near(a->mass_kg, b->mass_kg, 1e-6);
        weighs_alike(a, b);
    }
    grobo_robot_def_free(def);
}

#define LINKS "<link name='a'/><link name='b'/><link name='c'/>"
#define ONE(type, inside)                                                                          \
    "<joint name='j3' type='" type "'><parent link='a'/><child link='b'/>" inside "</joint>"
#define TWO                                                                                        \
    "<joint name='two' type='revolute'><parent link='b'/><child link='c'/>"                        \
    "<limit lower='-1' upper='1' velocity='2'/></joint>"

TEST(what_a_file_cannot_have_is_left_out)
{
    need_xml();
    static const char *const types[] = {"prismatic", "planar", "floating", "fixed"};
    for (int i = 0; i < 4; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "<robot name='r'>" LINKS "<joint name='j' type='%s'><parent link='a'/>"
                 "<child link='b'/></joint>" TWO "</robot>",
                 types[i]);
        grobo_robot_def *def = arm(text);
        assert_int_equal(def->model->n_joints, 1);
        assert_int_equal(def->links[1].joint, -1);
        near(def->model->joints[0].max_speed_rad_s, 2, 1e-5);
        near(def->links[2].axis[0], 1, 0); /* of a joint that names none */
        grobo_robot_def_free(def);
    }
    grobo_robot_def *def =
        arm("<robot name='r'>" LINKS ONE("revolute", "<mimic joint='two'/>") TWO "</robot>");
    assert_int_equal(def->model->n_joints, 1);
    grobo_robot_def_free(def);
}

/* A rack of 20 mm: half a turn of the servo, as nobody knows better. */
TEST(a_joint_that_slides_is_linear)
{
    need_xml();
    grobo_robot_def *def =
        arm("<robot name='r'>" LINKS ONE("prismatic", "<limit lower='-0.005' upper='0.015' "
                                                      "velocity='0.01'/>") TWO "</robot>");
    const grobo_joint *joint = &def->model->joints[0];
    assert_int_equal(def->model->n_joints, 2);
    assert_string_equal(joint->name, "joint_j3");
    assert_int_equal(joint->unit, GROBO_UNIT_MM);
    near(grobo_model_value(def->model, 0, joint->min_rad), -5, 1e-4);
    near(grobo_model_value(def->model, 0, joint->max_rad), 15, 1e-4);
    near(grobo_model_change(def->model, 0, joint->max_speed_rad_s), 10, 1e-3);
    near(joint->max_rad - joint->min_rad, grobo_rad_from_deg(180), 1e-4);
    assert_int_equal(def->links[1].joint, -1); /* drawn fixed */
    assert_int_equal(def->links[2].joint, 1);
    grobo_robot_def_free(def);
}

TEST(limits_fit_the_servo)
{
    need_xml();
    grobo_robot_def *def = arm("<robot name='r'>" LINKS ONE("continuous", "") TWO "</robot>");
    assert_string_equal(def->model->joints[0].name, "joint_j3"); /* j3 is a number */
    near(def->model->joints[0].max_rad, grobo_rad_from_deg(179.5), 1e-6);
    grobo_robot_def_free(def);
    def = arm("<robot name='r'>" LINKS ONE("revolute", "<limit lower='0' upper='6'/>") TWO
              "</robot>");
    near(def->model->joints[0].min_rad, 0, 0);
    near(def->model->joints[0].max_rad, 6, 1e-5);
    near(def->model->joints[0].zero_rad, -3, 1e-5); /* the servo's middle is in the middle */
    grobo_robot_def_free(def);
    def = arm("<robot name='r'>" LINKS ONE("revolute", "<limit lower='-7' upper='7'/>") TWO
              "</robot>");
    near(def->model->joints[0].min_rad, grobo_rad_from_deg(-179.5), 1e-6);
    grobo_robot_def_free(def);
    def = arm("<robot name='r'>" LINKS ONE(
        "revolute", "<limit lower='-2' upper='2'/>"
                    "<safety_controller soft_lower_limit='-1' soft_upper_limit='3'/>") TWO
              "</robot>");
    near(def->model->joints[0].min_rad, -1, 1e-5);
    near(def->model->joints[0].max_rad, 2, 1e-5);
    grobo_robot_def_free(def);
    def = arm("<robot name='r'>" LINKS ONE("revolute", "<limit lower='0.5' upper='1.5'/>") TWO
              "</robot>");
    near(def->model->joints[0].init_rad, 1, 1e-5);
    grobo_robot_def_free(def);
}

#define BODY "format: ChoreonoidBody\nlinks:\n - {name: a}\n"

TEST(a_body_turns_as_choreonoid_does)
{
    /* Degrees by default; -Z; an axis with an angle; a list of such; order by jointId. */
    grobo_robot_def *def = def_of(
        BODY " - {name: b, parent: a, jointType: revolute, jointId: 1, jointAxis: -Z,\n"
             "    jointRange: 90, rotation: [0, 0, 2, 90], maxJointVelocity: 100}\n"
             " - {name: c, parent: b, jointType: revolute, jointId: 0, jointAxis: [0, 3, 4],\n"
             "    jointRange: [-10, 20], rotation: [[1, 0, 0, 90], [0, 0, 1, 90]]}\n"
             " - {name: d, parent: c, jointType: slide}\n",
        false, "feetech", "STS3215");
    assert_int_equal(def->model->n_joints, 2);
    assert_string_equal(def->model->joints[0].name, "c");
    near(def->model->joints[1].min_rad, grobo_rad_from_deg(-90), 1e-9);
    near(def->model->joints[1].max_speed_rad_s, grobo_rad_from_deg(100), 1e-6);
    near(def->links[1].axis[2], -1, 0);
    near(def->links[1].origin_rad[2], grobo_rad_from_deg(90), 1e-6);
    near(def->links[2].axis[1], 0.6, 1e-6);
    /* Rx(90) Rz(90) = Rz(0) Ry(-90) Rx(90) or its like: z of the child is -y of the parent. */
    double r = def->links[2].origin_rad[0], p = def->links[2].origin_rad[1],
           y = def->links[2].origin_rad[2];
    near(cos(r) * sin(p) * cos(y) + sin(r) * sin(y), 0, 1e-6);
    near(cos(r) * sin(p) * sin(y) - sin(r) * cos(y), -1, 1e-6);
    near(cos(r) * cos(p), 0, 1e-6);
    near(-sin(p), 1, 1e-6); /* x of the child is z of the parent */
    grobo_robot_def_free(def);
    def = def_of("format: ChoreonoidBody\nangleUnit: radian\nlinks:\n - {name: a}\n"
                 " - {name: b, parent: a, jointType: revolute, jointAxis: X,\n"
                 "    jointRange: [-1, unlimited], rpy: [0.5, 0, 0]}\n",
                 false, "feetech", "STS3215");
    near(def->model->joints[0].max_rad, grobo_rad_from_deg(179.5), 1e-6);
    near(def->links[1].origin_rad[0], 0.5, 1e-6);
    grobo_robot_def_free(def);
    /* Today's spelling, beside the older one; about Z where no axis is given. */
    def = def_of("format: ChoreonoidBody\nangle_unit: radian\nlinks:\n - {name: a}\n"
                 " - {name: b, parent: a, joint_type: revolute, jointId: 1, joint_axis: X,\n"
                 "    joint_range: [-1, 0.5], jointVelocityRange: [-2, 3]}\n"
                 " - {name: c, parent: b, joint_type: revolute, joint_id: 0, joint_range: 1,\n"
                 "    max_joint_velocity: unlimited}\n",
                 false, "feetech", "STS3215");
    assert_string_equal(def->model->joints[0].name, "c");
    near(def->links[2].axis[2], 1, 0);
    near(def->model->joints[0].min_rad, -1, 1e-6);
    near(def->model->joints[1].max_rad, 0.5, 1e-6);
    near(def->model->joints[1].max_speed_rad_s, 2, 1e-4);
    grobo_robot_def_free(def);
}

/* ---- what is refused ------------------------------------------------------------------------ */

static void refused(const char *bytes, bool urdf, const char *why)
{
    char *text = text_of(bytes, urdf, "feetech", "STS3215");
    if (text || !strstr(said, why) || strchr(said, '\n')) {
        fail_msg("%s: '%s', not '%s'", bytes, text ? "taken" : said, why);
    }
}

TEST(broken_urdf_is_refused_in_a_line)
{
    need_xml();
    refused("<robot name='r'>\n<link name='a'>", true, "arm:2:16: no element found");
    refused("<!DOCTYPE r [<!ENTITY a 'aaaa'>]><robot name='r'>&a;</robot>", true,
            "arm:1:13: a document type is not read");
    refused("<robot name='r'>&a;</robot>", true, "undefined entity");
    refused("<sdf/>", true, "arm:1: a URDF begins with 'robot', not 'sdf'");
    refused("<robot name='r'><xacro:include filename='x'/></robot>", true, "this is a xacro");
    refused("<robot name='r'></robot>", true, "it has no parts");
    refused("<robot name='r'>" LINKS "</robot>", true, "'a' and 'b' both have no parent");
    refused("<robot name='r'><link name='a'/></robot>", true, "it has no joint that turns");
    refused("<robot name='r'><link name='a'/><link name='a'/></robot>", true,
            "two parts are called 'a'");
    refused("<robot name='r'>" LINKS ONE("revolute", "<limit lower='1' upper='x'/>") "</robot>",
            true, "'upper': 'x' is not a number");
    refused("<robot name='r'>" LINKS ONE("revolute", "<limit lower='1' upper='1'/>") TWO "</robot>",
            true, "'j3': its lower limit is not below the upper one");
    refused("<robot name='r'>" LINKS ONE("revolute", "<axis xyz='0 0 0'/>") TWO "</robot>", true,
            "'b': its axis has no direction");
    refused("<robot name='r'>" LINKS ONE("revolute", "<origin xyz='1 2'/>") TWO "</robot>", true,
            "'xyz': 3 numbers are wanted");
    refused("<robot name='r'>" LINKS ONE("revolute", "<origin xyz='1e300 0 0'/>") TWO "</robot>",
            true, "'b': a number is out of range");
    refused("<robot name='r'><link name='a'/>" ONE("revolute", "") "</robot>", true,
            "joint 'j3': there is no link 'b'");
    refused("<robot name='r'>" LINKS ONE("revolute", "") ONE("revolute", "") TWO "</robot>", true,
            "joint 'j3': 'b' has a parent already");
    refused(
        "<robot name='r'>" LINKS ONE(
            "revolute",
            "") "<joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint></robot>",
        true, "'a' hangs on itself");
    char deep[XML_DEPTH_MAX * 3 + sizeof "<robot>"] = "<robot>";
    for (size_t i = strlen(deep); i + 3 < sizeof deep; i += 3) {
        memcpy(deep + i, "<x>", 4);
    }
    refused(deep, true, "elements are nested too deeply");
}

TEST(parts_in_a_circle_are_refused)
{
    refused(BODY " - {name: b, parent: c}\n - {name: c, parent: b}\n", false, "hangs on itself");
    refused(BODY " - {name: b, parent: b}\n", false, "'b' hangs on itself");
    refused(BODY " - {name: b, parent: z}\n", false, "'b' hangs on 'z', which is not there");
}

TEST(a_broken_body_is_refused_in_a_line)
{
    refused("links: [", false, "arm:2:1: did not find");
    refused("name: x\n", false, "neither a URDF nor a body");
    refused("- 1\n", false, "neither a URDF nor a body");
    refused(BODY " - {name: b, parent: a, jointType: revolute, joint__axis: X,\n"
                 "    max_joint_velocity: much}\n",
            false, "arm:5: a number is wanted");
    refused("", false, "neither a URDF nor a body");
    refused("format: ChoreonoidBody\nlinks: {a: b}\n", false, "arm:2: a list of links is wanted");
    refused(BODY " - {parent: a}\n", false, "arm:4: a link has no name");
    refused(BODY " - {name: b, parent: a, type: SubBody}\n", false,
            "only links of type Link are read");
    refused(BODY " - {name: b, parent: a, jointType: revolute, jointAxis: Q}\n", false,
            "jointAxis: X, Y, Z");
    refused(BODY " - {name: b, parent: a, translation: [0, 0, x]}\n", false,
            "arm:4: a number is wanted");
    refused(BODY " - {name: b, parent: a, translation: [0, 0, nan]}\n", false,
            "a number is wanted");
    refused(BODY " - {name: b, parent: a, jointType: revolute, jointAxis: X,\n"
                 "    jointRange: [-400, much]}\n",
            false, "arm:5: a number is wanted");
    refused("a: &a [x, x]\nb: &b [*a, *a]\nlinks: *b\nformat: ChoreonoidBody\n", false,
            "a link is a mapping");
}
