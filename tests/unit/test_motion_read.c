/* SPDX-License-Identifier: MIT */
/* Reading: what each format gives, and what is wrong with a file, where. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/support/counted_mem.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

/* ---- .m ----------------------------------------------------------------------------------- */

TEST(test_m)
{
    grobo_motion *motion =
        motion_of("# recorded\n500  10 -20 30\r\n1000.5\t0 1.5 0\n\n\n", GROBO_FORMAT_AUTO);
    const grobo_model *model = &grobo_i_gr001_model;
    double time_s;

    assert_int_equal(grobo_motion_get_kind(motion), GROBO_MOTION_POSTURES);
    assert_int_equal(grobo_motion_size(motion), 2);
    assert_int_equal(grobo_motion_joints(motion), 20);
    assert_int_equal(grobo_motion_time_s(motion, 1, &time_s), 0);
    assert_true(time_s == 1.0005);
    assert_true(angle_of(motion, 0, grobo_model_joint_of_motor(model, 2)) ==
                grobo_rad_from_ddeg(-20));
    assert_true(isnan(angle_of(motion, 0, grobo_model_joint_of_motor(model, 4))));
    assert_int_equal(grobo_motion_line(motion, 0), 2);
    assert_int_equal(grobo_motion_line(motion, 1), 3);
    grobo_motion_free(motion);
}

TEST(test_m_of_other_robots)
{
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = GROBO_FORMAT_M};
    grobo_motion *motion = NULL;
    char text[1000] = "10";
    size_t used = 2;

    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        used += (size_t)snprintf(text + used, sizeof text - used, " 5");
    }
    assert_int_equal(grobo_motion_read_memory(text, strlen(text), &options, NULL, &motion), 0);
    assert_int_equal(grobo_motion_joints(motion), GROBO_JOINTS_MAX);
    assert_true(angle_of(motion, 0, GROBO_JOINTS_MAX - 1) == grobo_rad_from_ddeg(5));
    grobo_motion_free(motion);
    (void)snprintf(text + used, sizeof text - used, " 5");
    assert_int_equal(read_result(text, &options, NULL), GROBO_ERR_CAP);
}

TEST(test_m_refused)
{
    static const struct {
        const char *text, *code;
        unsigned line, column;
    } bad[] = {{"500 1 2\nx 1 2\n", "number", 2, 1},         {"500 1 2\n600 1\n", "columns", 2, 5},
               {"500 1 2\n600 1 2 3\n", "columns", 2, 9},    {"500\n", "columns", 1, 1},
               {"500 1 2\n\n600 1 2\n", "blank-line", 2, 0}, {"500 1 nan\n", "number", 1, 7},
               {"500 1 2\r600 1 2\r", "line-end", 1, 9},     {"1e300 1\n", "time-range", 1, 1}};

    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        grobo_diagnostics *list = NULL;
        grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = GROBO_FORMAT_M};
        assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
        assert_int_equal(read_result(bad[i].text, &options, list), GROBO_ERR_SYNTAX);
        assert_true(has_diagnostic(list, bad[i].code, bad[i].line, bad[i].column));
        grobo_diagnostics_free(list);
    }
}

TEST(test_m_line_too_long)
{
    size_t size = 100000;
    char *text = malloc(size + 1);

    memset(text, '1', size);
    text[size] = '\0';
    assert_int_equal(
        read_result(text, &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .format = GROBO_FORMAT_M},
                    NULL),
        GROBO_ERR_CAP);
    free(text);
}

/* ---- key poses ---------------------------------------------------------------------------- */

/* A ZMP stands still at its key unless the file denies it. */
TEST(test_zmp_stands_still)
{
    static const struct {
        const char *pose;
        bool has_zmp, stationary;
    } poses[] = {{"zmp: [ 0.3, 0, 0 ]", true, true},
                 {"zmp: [ 0.3, 0, 0 ], isZmpStationaryPoint: false", true, false},
                 {"isZmpStationaryPoint: false, zmp: [ 0.3, 0, 0 ]", true, false},
                 {"isZmpStationaryPoint: true, zmp: [ 0.3, 0, 0 ]", true, true},
                 {"name: n", false, false}};

    for (size_t i = 0; i < sizeof poses / sizeof poses[0]; i++) {
        char text[200];
        grobo_key_info info;
        (void)snprintf(text, sizeof text,
                       "type: PoseSeq\nname: z\nrefs: [ { time: 0, refer: { type: Pose, %s } } ]\n",
                       poses[i].pose);
        grobo_motion *motion = motion_of(text, GROBO_FORMAT_PSEQ);
        assert_int_equal(grobo_motion_get_key(motion, 0, &info), 0);
        assert_int_equal(info.has_zmp, poses[i].has_zmp);
        assert_int_equal(info.zmp_stationary, poses[i].stationary);
        grobo_motion_free(motion);
    }
}

/* Choreonoid takes the words of YAML 1.1 for true and false, but for mixed case. */
TEST(test_words_for_true_and_false)
{
    static const char *const words[2][11] = {
        {"n", "N", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"},
        {"y", "Y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}};
    static const char *const others[] = {"tRUE", "1", "0", "yep", "\"\"", "~"};
    static const char pose[] = "type: PoseSeq\nname: w\nrefs: [ { time: 0, refer: { type: Pose, "
                               "zmp: [ 0, 0, 0 ], isZmpStationaryPoint: %s } } ]\n";
    char text[200];

    for (size_t i = 0; i < 22; i++) {
        grobo_key_info info;
        (void)snprintf(text, sizeof text, pose, words[i / 11][i % 11]);
        grobo_motion *motion = motion_of(text, GROBO_FORMAT_PSEQ);
        assert_int_equal(grobo_motion_get_key(motion, 0, &info), 0);
        assert_int_equal(info.zmp_stationary, i / 11);
        grobo_motion_free(motion);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        (void)snprintf(text, sizeof text, pose, others[i]);
        assert_int_equal(read_result(text, NULL, NULL), GROBO_ERR_SYNTAX);
    }
}

TEST(test_pose)
{
    grobo_motion *motion = motion_of(full_pose, GROBO_FORMAT_AUTO);
    grobo_key_info info;
    grobo_kept kept;
    size_t count;

    assert_int_equal(grobo_motion_get_kind(motion), GROBO_MOTION_KEYS);
    assert_string_equal(grobo_motion_name(motion), "a \"b\"");
    assert_string_equal(grobo_motion_target_body(motion), "GR001");
    assert_int_equal(grobo_motion_joints(motion), 4);
    assert_true(angle_of(motion, 0, 3) == 0.5 && angle_of(motion, 0, 0) == -1e-19);
    assert_int_equal(grobo_motion_get_key(motion, 0, &info), 0);
    assert_true(info.max_transition_s == 0.125 && info.stationary == 8);
    assert_true(info.has_zmp && info.zmp_stationary && info.zmp_m[1] == 0.2);
    assert_string_equal(grobo_motion_key_name(motion, 0), "bow");
    const grobo_ik_link *link = grobo_motion_ik_links(motion, 0, &count);
    assert_int_equal(count, 1);
    assert_string_equal(link->name, "R_ANKLE_R");
    assert_true(link->index == 6 && link->is_touching && link->is_slave && !link->is_base);
    assert_true(link->has_parting_direction && link->translation_m[2] == 3.0);
    assert_int_equal(grobo_motion_get_kept(motion, GROBO_MOTION_TOP, 0, &kept), 0);
    assert_string_equal(kept.value, "{ who: me, \"two words\": [ ] }");
    assert_int_equal(grobo_motion_kept_count(motion, 0), 3);
    assert_int_equal(grobo_motion_get_kept(motion, 0, 0, &kept), 0);
    assert_string_equal(kept.key, "comment");
    assert_string_equal(kept.value, "\"first: one\"");
    assert_int_equal(kept.level, GROBO_KEPT_REF);
    /* The second ref is the same pose, without what the first ref itself says. */
    assert_true(angle_of(motion, 1, 3) == 0.5);
    assert_int_equal(grobo_motion_get_key(motion, 1, &info), 0);
    assert_true(info.max_transition_s == 0 && info.stationary == 8);
    assert_int_equal(grobo_motion_kept_count(motion, 1), 2);
    grobo_motion_free(motion);
}

TEST(test_positions)
{
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .keep_positions = true};
    grobo_motion *motion = NULL;
    uint32_t line = 0, column = 0;

    assert_int_equal(
        grobo_motion_read_memory(full_pose, strlen(full_pose), &options, NULL, &motion), 0);
    assert_true(grobo_motion_position(motion, 0, 3, &line, &column));
    assert_true(line == 13 && column == 12);
    assert_false(grobo_motion_position(motion, 0, 1, &line, &column));
    assert_false(grobo_motion_position(motion, 9, 0, &line, &column));
    assert_int_equal(grobo_motion_line(motion, 0), 6);
    grobo_motion_free(motion);
}

/* Each key that must be there is missed, each wrong value named, with its place. */
#define TOP "type: PoseSeq\nname: t\nrefs:\n"
static const struct bad_file {
    const char *text;
    int result;
    const char *code;
    unsigned line, column;
} bad_poses[] = {
    {TOP "- { refer: { type: Pose } }", GROBO_ERR_SYNTAX, "key-missing", 4, 3},
    {TOP "- { time: 0 }", GROBO_ERR_SYNTAX, "key-missing", 4, 3},
    {TOP "- { time: 0, refer: { name: a } }", GROBO_ERR_SYNTAX, "key-missing", 4, 21},
    {TOP "- { time: 0, refer: { type: Pose, q: [ 1 ] } }", GROBO_ERR_SYNTAX, "key-missing", 4, 21},
    {TOP "- { time: [ 0 ], refer: { type: Pose } }", GROBO_ERR_SYNTAX, "type", 4, 11},
    {TOP "- { time: 1e10, refer: { type: Pose } }", GROBO_ERR_SYNTAX, "time-range", 4, 11},
    {TOP "- { time: .inf, refer: { type: Pose } }", GROBO_ERR_NAN, "not-finite", 4, 11},
    {TOP "- { time: 0, refer: [ ] }", GROBO_ERR_SYNTAX, "type", 4, 21},
    {TOP "- { time: 0, refer: unknown }", GROBO_ERR_SYNTAX, "refer", 4, 21},
    {TOP "- 5", GROBO_ERR_SYNTAX, "type", 4, 3},
    {TOP "- { time: 0, refer: { type: Pose, joints: 5, q: [ ] } }", GROBO_ERR_SYNTAX, "type", 4,
     43},
    {TOP "- { time: 0, refer: { type: Pose, joints: [ 0, 0 ], q: [ 1, 2 ] } }", GROBO_ERR_SYNTAX,
     "joint-twice", 4, 48},
    {TOP "- { time: 0, refer: { type: Pose, joints: [ 64 ], q: [ 1 ] } }", GROBO_ERR_CAP, "joints",
     4, 45},
    {TOP "- { time: 0, refer: { type: Pose, joints: [ -1 ], q: [ 1 ] } }", GROBO_ERR_SYNTAX,
     "joints", 4, 45},
    {TOP "- { time: -1, refer: { type: Pose } }", GROBO_ERR_SYNTAX, "time-range", 4, 11},
    {TOP "- { time: 0, refer: { type: Pose, joints: [ 1 ], q: [ 1e308 ] } }", GROBO_ERR_SYNTAX,
     "angle-range", 4, 55},
    {TOP "- { time: 0, refer: { type: Pose, isZmpStationaryPoint: 3 } }", GROBO_ERR_SYNTAX, "type",
     4, 57},
    {TOP "- { time: 0, refer: { type: Pose, a: 1, a: 2 } }", GROBO_ERR_SYNTAX, "key-twice", 4, 41},
    {"type: Other\n", GROBO_ERR_TYPE, "top-type", 1, 7},
    {"type: PoseSeq\ncomponents: [ ]\n", GROBO_ERR_TYPE, "top-type", 1, 7},
    {"type: [ PoseSeq", GROBO_ERR_SYNTAX, "type", 1, 7},
    {"? [ a ]\n: b\n", GROBO_ERR_SYNTAX, "key", 1, 3},
    {TOP "- *a", GROBO_ERR_SYNTAX, "alias", 4, 3},
    {TOP "- &a { time: 0, x: *a }", GROBO_ERR_SYNTAX, "alias", 4, 20},
    {TOP "- { <<: 5 }", GROBO_ERR_SYNTAX, "merge", 4, 9},
    {"a\0b", GROBO_ERR_TYPE, "top-type", 1, 1},
    {"\xFF\xFE", GROBO_ERR_SYNTAX, "empty", 1, 1},
    {"name: \xC3\x28", GROBO_ERR_SYNTAX, "encoding", 1, 7},
    {TOP "- \xC3\xA9 \x01", GROBO_ERR_SYNTAX, "encoding", 4, 5},
    {TOP "- { time: 0, refer: { type: Pose, joints: [ 1", GROBO_ERR_SYNTAX, "yaml", 5, 1},
};
#undef TOP

TEST(test_pose_refused)
{
    for (size_t i = 0; i < sizeof bad_poses / sizeof bad_poses[0]; i++) {
        grobo_diagnostics *list = NULL;
        assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
        int result = read_result(bad_poses[i].text, NULL, list);
        if (result != bad_poses[i].result ||
            !has_diagnostic(list, bad_poses[i].code, bad_poses[i].line, bad_poses[i].column)) {
            grobo_diagnostic found = {.code = "nothing", .message = ""};
            (void)grobo_diagnostics_get(list, 0, &found);
            fail_msg("%s\ngives %s, %s at %u:%u: %s", bad_poses[i].text, grobo_error_name(result),
                     found.code, found.line, found.column, found.message);
        }
        grobo_diagnostics_free(list);
    }
}

/* With keep_going one run says it all. */
TEST(test_keep_going)
{
    static const char text[] =
        "type: PoseSeq\nname: t\nrefs:\n"
        "- { time: x, refer: { type: Pose, joints: [ 0, 1 ], q: [ y, z ] } }\n"
        "- { time: 0 }\n"
        "- { time: 0, refer: { type: Pose, joints: [ 0 ], q: [ 1, 2 ] } }\n"
        "- 7\n";
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(
        read_result(text, &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .keep_going = true}, list),
        GROBO_ERR_SYNTAX);
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR), 6);
    assert_true(has_diagnostic(list, "type", 4, 11) && has_diagnostic(list, "type", 4, 58) &&
                has_diagnostic(list, "type", 4, 61) && has_diagnostic(list, "key-missing", 5, 3) &&
                has_diagnostic(list, "q-length", 6, 53) && has_diagnostic(list, "type", 7, 3));
    grobo_diagnostics_clear(list);
    assert_int_equal(read_result(text, NULL, list), GROBO_ERR_SYNTAX);
    grobo_diagnostic said;
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), 0);
    assert_int_equal(grobo_diagnostics_get(list, 1, &said), GROBO_ERR_ARG);
    grobo_diagnostics_free(list);
}

TEST(test_merge_and_alias)
{
    grobo_motion *motion =
        motion_of("type: PoseSeq\nname: t\nrefs:\n"
                  "  - { time: 0, refer: &a { type: Pose, joints: [ 0 ], q: [ 1 ], mine: &s 5 } }\n"
                  "  - { time: 1, refer: { <<: *a, q: [ 2 ], other: *s } }\n"
                  "  - { time: 2, refer: &b { q: [ 3 ], <<: [ *a ] } }\n"
                  "  - { time: 3, refer: { <<: *b, joints: [ 1 ] } }\n",
                  GROBO_FORMAT_AUTO);
    grobo_kept kept;

    assert_true(angle_of(motion, 1, 0) == 2.0);
    assert_true(angle_of(motion, 2, 0) == 3.0);
    assert_true(angle_of(motion, 3, 1) == 3.0 && isnan(angle_of(motion, 3, 0)));
    assert_int_equal(grobo_motion_get_kept(motion, 1, 0, &kept), 0);
    assert_string_equal(kept.key, "other");
    assert_string_equal(kept.value, "5");
    assert_int_equal(grobo_motion_get_kept(motion, 3, 0, &kept), 0);
    assert_string_equal(kept.key, "mine");
    grobo_motion_free(motion);
}

TEST(test_type_behind_refs)
{
    static const char text[] =
        "refs: [ { time: 0, refer: { type: Motion, joints: [ 0 ], q: [ 1 ] } } ]\n";
    char whole[200];
    grobo_motion *motion = motion_of(text, GROBO_FORMAT_AUTO);

    assert_int_equal(grobo_motion_get_kind(motion), GROBO_MOTION_STEPS);
    grobo_motion_free(motion);
    (void)snprintf(whole, sizeof whole, "%stype: MotionSeq\n", text);
    motion = motion_of(whole, GROBO_FORMAT_MSEQ);
    assert_int_equal(grobo_motion_size(motion), 1);
    grobo_motion_free(motion);
    (void)snprintf(whole, sizeof whole, "%stype: PoseSeq\n", text);
    assert_int_equal(read_result(whole, NULL, NULL), GROBO_ERR_TYPE);
}

/* ---- body motion -------------------------------------------------------------------------- */

TEST(test_body_motion_keys_behind)
{
    grobo_motion *motion =
        motion_of("components:\n"
                  "- { frames: [ [ 0, 1, 2 ], [ 0.5, 3, 4 ] ], hasFrameTime: true, numParts: 2,\n"
                  "    content: JointPosition, type: MultiValueSeq }\n"
                  "type: BodyMotion\nframeRate: 20\n",
                  GROBO_FORMAT_AUTO);
    double time_s;

    assert_int_equal(grobo_motion_joints(motion), 2);
    assert_true(grobo_motion_frame_rate(motion) == 20.0);
    assert_true(grobo_motion_has_frame_times(motion));
    assert_int_equal(grobo_motion_time_s(motion, 1, &time_s), 0);
    assert_true(time_s == 0.5 && angle_of(motion, 1, 0) == 3.0 && angle_of(motion, 1, 1) == 4.0);
    grobo_motion_free(motion);
}

/* Frames with times of their own need no rate: Choreonoid takes 100 Hz for them. */
TEST(test_frame_times_without_rate)
{
    grobo_motion *motion = motion_of(
        "type: CompositeSeq\ncontent: BodyMotion\nformatVersion: 2\ncomponents:\n"
        "- { type: MultiValueSeq, content: JointDisplacement, numParts: 1, hasFrameTime: true, "
        "frames: [ [ 0, 0.5 ], [ 0.75, 1 ] ] }\n",
        GROBO_FORMAT_YAML);
    double time_s;

    assert_true(grobo_motion_has_frame_times(motion));
    assert_int_equal(grobo_motion_time_s(motion, 1, &time_s), 0);
    assert_true(time_s == 0.75 && angle_of(motion, 1, 0) == 1);
    assert_true(grobo_motion_frame_rate(motion) == 100);
    grobo_motion_free(motion);
}

TEST(test_body_motion_refused)
{
#define PART "type: BodyMotion\nframeRate: 10\ncomponents:\n- { type: MultiValueSeq, "
    static const struct {
        const char *text, *code;
        unsigned line, column;
    } bad[] = {
        {PART "content: JointPosition, frames: [ [ 1 ], 5 ] }", "type", 4, 67},
        {PART "content: JointPosition, frames: [ [ 1 ], [ 1, 2 ] ] }", "frame-length", 4, 67},
        {PART "content: JointPosition, frames: [ [ ] ] }", "frame-length", 4, 60},
        {PART "content: JointPosition, frames: [ [ [ 1 ] ] ] }", "type", 4, 62},
        {PART "content: JointPosition }", "no-frames", 4, 3},
        {PART "content: JointPosition, numParts: 2, frames: [ [ 1 ] ] }", "frame-length", 4, 73},
        {PART "content: Other, frames: [ [ 1 ] ] }", "no-joints", 1, 7},
        {PART "content: JointPosition, frames: [ [ 1 ] ] }", "no-parts", 4, 58},
        {PART "content: JointPosition, numParts: 1, frames: [ [ 1e7 ] ] }", "angle-range", 4, 75},
        {PART "content: JointPosition, numParts: 1, hasFrameTime: true, frames: [ [ -1, 1 ] ] }",
         "time-range", 4, 95},
        {PART "content: JointPosition, numParts: 1, frames: [ [ -1, 1 ] ], hasFrameTime: true }",
         "frame-length", 4, 73},
        {PART "content: JointPosition, numParts: 1, frames: [ [ 1 ] ], hasFrameTime: true }",
         "frame-length", 4, 71},
        {PART "content: JointPosition, frameRate: x, frames: [ [ 1 ] ] }", "type", 4, 61},
        {PART "content: JointPosition, frameRate: -1, frames: [ [ 1 ] ] }", "frame-rate", 4, 61},
    };
#undef PART
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        grobo_diagnostics *list = NULL;
        assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
        int result = read_result(bad[i].text, NULL, list);
        if (result != GROBO_ERR_SYNTAX ||
            !has_diagnostic(list, bad[i].code, bad[i].line, bad[i].column)) {
            grobo_diagnostic found = {.code = "nothing", .message = ""};
            (void)grobo_diagnostics_get(list, 0, &found);
            fail_msg("%s\ngives %s, %s at %u:%u: %s", bad[i].text, grobo_error_name(result),
                     found.code, found.line, found.column, found.message);
        }
        grobo_diagnostics_free(list);
    }
}

/* As Choreonoid: version 1 is called BodyMotion. */
TEST(test_composite_needs_a_version)
{
    assert_int_equal(
        read_result("type: CompositeSeq\ncomponents:\n- { type: MultiValueSeq, content: "
                    "JointPosition, frameRate: 1, numParts: 1, frames: [ [ 1 ] ] }\n",
                    NULL, NULL),
        GROBO_ERR_TYPE);
}

/* A target that cannot be used is left out with a warning, and what it kept goes with it. */
TEST(test_unusable_links_are_skipped)
{
#define LINK "rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }"
    static const char text[] =
        "type: PoseSeq\nname: t\nrefs:\n- { time: 0, refer: { type: Pose, ikLinks: [\n"
        "  { name: A, mine: 1, translation: [ 0, 0 ], " LINK ",\n"
        "  { name: B, " LINK ",\n  { translation: [ 0, 0, 0 ], " LINK ",\n"
        "  { name: C, mine: 2, translation: [ 1, 2, 3 ], " LINK " ] } }\n";
#undef LINK
    grobo_diagnostics *list = NULL;
    grobo_kept kept;
    size_t count = 0;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(read_result(text, NULL, list), 0);
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_WARNING), 3);
    assert_true(has_diagnostic(list, "link-skipped", 5, 3) &&
                has_diagnostic(list, "link-skipped", 6, 3) &&
                has_diagnostic(list, "link-skipped", 7, 3));
    grobo_diagnostics_free(list);
    grobo_motion *motion = motion_of(text, GROBO_FORMAT_PSEQ);
    const grobo_ik_link *links = grobo_motion_ik_links(motion, 0, &count);
    assert_int_equal(count, 1);
    assert_string_equal(links[0].name, "C");
    assert_int_equal(grobo_motion_kept_count(motion, 0), 1);
    assert_int_equal(grobo_motion_get_kept(motion, 0, 0, &kept), 0);
    assert_string_equal(kept.value, "2");
    assert_int_equal(kept.link, 0);
    grobo_motion_free(motion);
}

TEST(test_who_is_no_mapping)
{
    grobo_diagnostics *list = NULL;
    grobo_diagnostic said;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(read_result("[ 1 ]\n", NULL, list), GROBO_ERR_TYPE);
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), 0);
    assert_string_equal(said.message, "not a motion file: no mapping at the top");
    grobo_diagnostics_free(list);
}

/* Choreonoid does not look at the type: the refs say what the file is. */
TEST(test_key_poses_of_another_type)
{
    static const char text[] = "type: Foo\nname: t\nrefs: [ { time: 0, refer: { type: Pose } } ]\n";
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(read_result(text, NULL, list), 0);
    assert_true(has_diagnostic(list, "top-type", 1, 7));
    grobo_diagnostics_free(list);
}

/* A posture of 20 joints takes 188 bytes, also where places are kept: those of the first alone. */
TEST(test_memory_of_a_long_file)
{
    enum { POSTURES = 100000 };
    static const char line[] = "10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";
    size_t length = strlen(line);
    char *text = malloc(length * POSTURES + 1);
    for (size_t n = 0; n < POSTURES; n++) {
        memcpy(text + n * length, line, length + 1);
    }
    counted_mem counter = {0};
    grobo_mem mem = counted_mem_of(&counter);
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem, .keep_positions = true,
                                  .model = &grobo_i_gr001_model, .format = GROBO_FORMAT_M};
    grobo_motion *motion = NULL;
    uint32_t at_line, at_column;

    assert_int_equal(grobo_motion_read_memory(text, length * POSTURES, &options, NULL, &motion), 0);
    size_t places = (size_t)GROBO_MOTION_POSITIONS_MAX * 512;
    assert_in_range(counter.bytes, 188 * POSTURES, 200 * POSTURES + places);
    assert_true(
        grobo_motion_position(motion, GROBO_MOTION_POSITIONS_MAX - 1, 0, &at_line, &at_column));
    assert_false(
        grobo_motion_position(motion, GROBO_MOTION_POSITIONS_MAX, 0, &at_line, &at_column));
    grobo_motion_free(motion);
    assert_int_equal(counter.bytes, 0);
    free(text);
}

/* What a ref says beside the name of an earlier pose is kept as anywhere else. */
TEST(test_keys_beside_a_name)
{
    static const char text[] =
        "type: PoseSeq\nname: t\nrefs:\n"
        "- { time: 0, mine: 1, refer: { type: Pose, name: a, of_pose: 2 } }\n"
        "- { time: 1, mine: 3, other: 4, refer: a }\n- { time: 2, refer: a }\n";
    static const char *const kept_of_1[] = {"mine", "3", "other", "4", "of_pose", "2"};
    grobo_motion *motion = motion_of(text, GROBO_FORMAT_PSEQ);
    grobo_kept kept;

    assert_int_equal(grobo_motion_kept_count(motion, 1), 3);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(grobo_motion_get_kept(motion, 1, i, &kept), 0);
        assert_string_equal(kept.key, kept_of_1[2 * i]);
        assert_string_equal(kept.value, kept_of_1[2 * i + 1]);
    }
    assert_int_equal(grobo_motion_kept_count(motion, 2), 1);
    grobo_motion_free(motion);
}

/* ---- messages ----------------------------------------------------------------------------- */

/* A long name is cut; what is left of it stays legible, and only what is no character is not. */
TEST(test_long_names_in_messages)
{
#define POSE_14 "\xE3\x81\x82\xE3\x82\x8B\xE3\x81\x8F" /* aruku, in 3 of 14 characters */
    static const char text[] =
        "type: PoseSeq\nname: t\nrefs:\n- { time: 0, refer: \"" POSE_14 POSE_14 POSE_14 POSE_14
            POSE_14 "\" }\n";
    grobo_diagnostics *list = NULL;
    grobo_diagnostic found;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(read_result(text, NULL, list), GROBO_ERR_SYNTAX);
    assert_int_equal(grobo_diagnostics_get(list, 0, &found), 0);
    assert_string_equal(found.message,
                        "no pose '" POSE_14 POSE_14 POSE_14 POSE_14 "\xE3\x81\x82?' before this");
    grobo_diagnostics_clear(list);
    assert_int_equal(read_result("100 \xE3\x81\x82\xFF\x1B\n", NULL, list), GROBO_ERR_SYNTAX);
    grobo_diagnostics_clear(list);
    grobo_read_options as_m = {GROBO_READ_OPTIONS_INIT, .format = GROBO_FORMAT_M};
    assert_int_equal(read_result("100 \xE3\x81\x82\xFF\x1B\n", &as_m, list), GROBO_ERR_SYNTAX);
    assert_int_equal(grobo_diagnostics_get(list, 0, &found), 0);
    assert_string_equal(found.message, "'\xE3\x81\x82?\?' is not a number");
#undef POSE_14
    grobo_diagnostics_free(list);
}

/* ---- formats ------------------------------------------------------------------------------ */

TEST(test_format_by_content_and_name)
{
    static const char key_poses[] = "type: PoseSeq\nname: t\n";
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_motion_format_of_path("a/b.PSEQ"), GROBO_FORMAT_PSEQ);
    assert_int_equal(grobo_motion_format_of_path("walk.seq"), GROBO_FORMAT_YAML);
    assert_int_equal(grobo_motion_format_of_path("m"), GROBO_FORMAT_AUTO);
    assert_int_equal(grobo_motion_format_of_path("x.auto"), GROBO_FORMAT_AUTO);
    assert_int_equal(grobo_motion_format_of_path("walk.yml"), GROBO_FORMAT_YAML);
    assert_int_equal(grobo_motion_format_of_path("walk.nope"), GROBO_FORMAT_AUTO);
    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(read_result(key_poses,
                                 &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .name = "a.yaml"},
                                 list),
                     0);
    assert_true(has_diagnostic(list, "format", 1, 7));
    assert_int_equal(
        read_result(key_poses,
                    &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .format = GROBO_FORMAT_YAML},
                    list),
        GROBO_ERR_TYPE);
    assert_int_equal(read_result("100 1 2\n",
                                 &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .name = "a.txt"},
                                 list),
                     0);
    assert_int_equal(read_result("\xEF\xBB\xBF# by hand\r\n100 1 2\r\n", NULL, list), 0);
    assert_int_equal(
        read_result("", &(grobo_read_options){GROBO_READ_OPTIONS_INIT, .name = "a.m"}, list), 0);
    assert_int_equal(read_result("", NULL, list), GROBO_ERR_SYNTAX);
    grobo_diagnostics_free(list);
}

TEST(test_files_refused)
{
    grobo_motion *motion = NULL;
    int folder = grobo_motion_read_file("/", NULL, NULL, &motion);

    assert_int_equal(grobo_motion_read_file("/no/such.pseq", NULL, NULL, &motion), GROBO_ERR_NOENT);
    assert_true(folder == GROBO_ERR_ISDIR || folder == GROBO_ERR_PERM);
    assert_null(motion);
}

static int failing_read(void *ctx, void *buffer, size_t size)
{
    int *left = ctx;

    (void)size;
    if ((*left)-- == 0) {
        return GROBO_ERR_UNPLUGGED;
    }
    memset(buffer, '#', 1);
    return 1;
}

TEST(test_source_fails)
{
    for (int format = GROBO_FORMAT_AUTO; format <= GROBO_FORMAT_YAML; format++) {
        int left = 3;
        grobo_motion *motion = NULL;
        grobo_read_options options = {GROBO_READ_OPTIONS_INIT,
                                      .format = (grobo_motion_format)format};
        assert_int_equal(
            grobo_motion_read(&(grobo_source){failing_read, &left}, &options, NULL, &motion),
            GROBO_ERR_UNPLUGGED);
        assert_null(motion);
    }
}
