/* SPDX-License-Identifier: MIT */
/* Checking motions against GR001: what is said, where, and what is not. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/files.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

typedef struct checked {
    grobo_diagnostics *list;
    int errors;
    size_t warnings, notes;
} checked;

/* slack: NULL: none is taken. */
static checked check_with(const char *text, bool positions, grobo_slack_taken *slack)
{
    const grobo_check_options how = {GROBO_CHECK_OPTIONS_INIT, .slack = slack};
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .model = &grobo_i_gr001_model,
                                  .keep_positions = positions};
    checked found;
    grobo_motion *motion = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &found.list), 0);
    assert_int_equal(grobo_motion_read_memory(text, strlen(text), &options, found.list, &motion),
                     0);
    found.errors = grobo_motion_check(motion, &grobo_i_gr001_model, &how, found.list);
    assert_true((size_t)found.errors == grobo_diagnostics_total(found.list, GROBO_SEVERITY_ERROR));
    found.warnings = grobo_diagnostics_total(found.list, GROBO_SEVERITY_WARNING);
    found.notes = grobo_diagnostics_total(found.list, GROBO_SEVERITY_NOTE);
    grobo_motion_free(motion);
    return found;
}

static checked check(const char *text, bool positions)
{
    return check_with(text, positions, NULL);
}

static bool says(const checked *found, const char *words)
{
    grobo_diagnostic said;

    for (size_t i = 0; grobo_diagnostics_get(found->list, i, &said) == 0; i++) {
        if (strstr(said.message, words) != NULL) {
            return true;
        }
    }
    return false;
}

#define TOP "type: PoseSeq\nname: t\ntargetBody: GR001\nrefs:\n"

TEST(test_clean)
{
    checked found = check(TOP "- { time: 0, refer: { type: Pose, joints: [ 13 ], q: [ 0 ] } }\n"
                              "- { time: 1, refer: { type: Pose, joints: [ 13 ], q: [ 0.5 ] } }\n"
                              "- { time: 2, refer: { type: Pose, joints: [ 13 ], q: [ 0 ] } }\n",
                          true);

    assert_int_equal(found.errors, 0);
    grobo_diagnostic said;
    assert_int_equal(grobo_diagnostics_get(found.list, 0, &said), GROBO_ERR_ARG);
    grobo_diagnostics_free(found.list);
}

TEST(test_limits)
{
    static const char text[] =
        TOP "- { time: 0, refer: { type: Pose, joints: [ 13, 3 ], q: [ 0.8731, 0.01 ] } }\n";
    checked found = check(text, true);

    /* 50.02 degrees are 50.0 on the wire, within; the knee does not bend forwards. */
    assert_int_equal(found.errors, 1);
    assert_true(has_diagnostic(found.list, "limit", 5, 67));
    assert_true(says(&found, "R_KNEE_P: 0.6 degrees, outside -130..0"));
    grobo_diagnostics_free(found.list);
    found = check(text, false);
    assert_true(has_diagnostic(found.list, "limit", 5, 0));
    grobo_diagnostics_free(found.list);
}

/* Within a degree of a limit an angle is counted, beyond it is an error, on curves too. */
TEST(test_slack)
{
    grobo_slack_taken slack = {0};

    checked found = check_with(
        TOP "- { time: 0, refer: { type: Pose, joints: [ 3, 12 ], q: [ 0, 0 ] } }\n"
            "- { time: 1, refer: { type: Pose, joints: [ 12, 3 ], q: [ 0.005, 0.01 ] } }\n"
            "- { time: 2, refer: { type: Pose, joints: [ 3 ], q: [ 0.02 ] } }\n",
        true, &slack);
    assert_int_equal(found.errors, 1);
    assert_true(has_diagnostic(found.list, "limit", 7, 55));
    assert_true(slack.n == 2 && slack.joint == 3 && slack.line == 6);
    assert_true(slack.worst_rad == 0.01);
    grobo_diagnostics_free(found.list);
    /* the keys are within, the curve swings out by 0.4 degrees; then from a slack key by 2 */
    memset(&slack, 0, sizeof slack);
    found =
        check_with(TOP "- { time: 0, refer: { type: Pose, joints: [ 13 ], q: [ 0 ] } }\n"
                       "- { time: 1, refer: { type: Pose, joints: [ 13 ], q: [ 0.87 ] } }\n"
                       "- { time: 1.2, refer: { type: Pose, joints: [ 13 ], q: [ 0.8712 ] } }\n",
                   true, &slack);
    assert_int_equal(found.errors, 0);
    assert_true(slack.n == 1 && slack.joint == 13 && slack.line == 7);
    grobo_diagnostics_free(found.list);
    found =
        check_with(TOP "- { time: 0, refer: { type: Pose, joints: [ 13 ], q: [ 0 ] } }\n"
                       "- { time: 0.3, refer: { type: Pose, joints: [ 13 ], q: [ 0.878 ] } }\n"
                       "- { time: 2.3, refer: { type: Pose, joints: [ 13 ], q: [ 0.8795 ] } }\n",
                   true, &slack);
    assert_int_equal(found.errors, 1);
    assert_true(has_diagnostic(found.list, "limit-between", 7, 0));
    grobo_diagnostics_free(found.list);
}

TEST(test_too_fast)
{
    checked found =
        check(TOP "- { time: 0, refer: { type: Pose, joints: [ 14, 13 ], q: [ 0, 0 ] } }\n"
                  "- { time: 0.1, refer: { type: Pose, joints: [ 14 ], q: [ 1.5 ] } }\n"
                  "- { time: 9, maxTransitionTime: 0.05, refer: { type: Pose, joints: [ 14 ],"
                  " q: [ 0 ] } }\n"
                  "- { time: 9, refer: { type: Pose, joints: [ 13 ], q: [ 0.8 ] } }\n",
              true);

    assert_int_equal(found.errors, 2);
    assert_true(has_diagnostic(found.list, "too-fast", 6, 58));
    assert_true(has_diagnostic(found.list, "too-fast", 7, 81));
    assert_true(says(&found, "R_SHOULDER_P: 85.9 degrees in 100 ms, the servo needs 230 ms") ||
                says(&found, "R_SHOULDER_P: 85.9 degrees in 100 ms, the servo needs 158 ms"));
    grobo_diagnostics_free(found.list);
}

/* The curve is steeper than its ends say, and swings further than its keys. */
TEST(test_curve)
{
    checked found =
        check(TOP "- { time: 0, refer: { type: Pose, joints: [ 14 ], q: [ 0 ] } }\n"
                  "- { time: 0.25, refer: { type: Pose, joints: [ 14 ], q: [ 1.5 ] } }\n",
              true);

    assert_int_equal(found.errors, 0);
    assert_true(has_diagnostic(found.list, "peak-speed", 6, 0));
    grobo_diagnostics_free(found.list);
    found = check(TOP "- { time: 0, refer: { type: Pose, joints: [ 13 ], q: [ 0 ] } }\n"
                      "- { time: 0.3, refer: { type: Pose, joints: [ 13 ], q: [ 0.87 ] } }\n"
                      "- { time: 2.3, refer: { type: Pose, joints: [ 13 ], q: [ 0.8715 ] } }\n",
                  true);
    assert_int_equal(found.errors, 1);
    assert_true(has_diagnostic(found.list, "limit-between", 7, 0));
    grobo_diagnostics_free(found.list);
}

TEST(test_postures)
{
    /* Motor 2 is the neck: 40 degrees in 20 ms; a restart that takes the default time. Two angles
     * are perhaps those of another robot. */
    checked found = check("500 0 0\n520 0 400\n100 0 390\n", true);

    assert_int_equal(found.errors, 2);
    assert_true(has_diagnostic(found.list, "joint-missing", 0, 0));
    assert_true(has_diagnostic(found.list, "too-fast", 2, 7));
    assert_true(has_diagnostic(found.list, "step-default", 3, 0));
    grobo_diagnostics_free(found.list);
}

TEST(test_increments)
{
    checked found = check("type: MotionSeq\nname: t\nrefs:\n"
                          "- { time: 0.5, refer: { type: Motion, joints: [ 13 ], q: [ 0.5 ] } }\n"
                          "- { time: 1, refer: { type: Motion, joints: [ 13 ], q: [ 0.5 ] } }\n",
                          true);

    assert_int_equal(found.errors, 1); /* 57 degrees in the end */
    assert_true(has_diagnostic(found.list, "limit", 5, 58));
    grobo_diagnostics_free(found.list);
}

TEST(test_frames)
{
    /* A fault that lasts is said once, and again when it comes back. */
    checked found =
        check("type: BodyMotion\ntargetBody: Other\ncomponents:\n"
              "- { type: MultiValueSeq, content: JointPosition, frameRate: 1, numParts: 1,\n"
              "    frames: [\n[ 0 ],\n[ 1 ],\n[ 1 ],\n[ 0 ],\n[ 1 ] ] }\n",
              true);

    assert_int_equal(found.errors, 3); /* another robot's too */
    assert_true(has_diagnostic(found.list, "limit", 7, 3));
    assert_true(has_diagnostic(found.list, "limit", 10, 3));
    assert_true(has_diagnostic(found.list, "target-body", 0, 0));
    assert_true(has_diagnostic(found.list, "joint-missing", 0, 0));
    grobo_diagnostics_free(found.list);
}

TEST(test_warnings)
{
#define LINK "translation: [ 0, 0, 0 ], rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }"
    checked found = check(
        TOP "- { time: 1, refer: { type: Pose, joints: [ 13, 25, 26 ], q: [ 0, 0, 0 ] } }\n"
            "- { time: 0, refer: { type: Pose, ikLinks: [ { name: NOPE, index: 99, " LINK ",\n"
            "  { name: L_ANKLE_R, index: 6, " LINK ", { name: WAIST, index: 0, " LINK ",\n"
            "  { index: 6, " LINK ", { name: R_ANKLE_R, index: 6, " LINK ",\n"
            "  { name: R_HIP_Y, " LINK " ] } }\n",
        true);
#undef LINK

    assert_int_equal(found.errors, 0);
    assert_true(has_diagnostic(found.list, "joint-unknown", 5, 67));
    assert_true(has_diagnostic(found.list, "time-back", 6, 0));
    assert_true(has_diagnostic(found.list, "legs-by-ik", 6, 0));
    assert_true(has_diagnostic(found.list, "link-unknown", 6, 0));
    assert_true(says(&found, "link 'NOPE' with index 99"));
    assert_true(says(&found, "link 'L_ANKLE_R' with index 6"));
    assert_int_equal(found.warnings, 5);
    grobo_diagnostics_free(found.list);
}

/* Half the speed gives a move twice the time. */
TEST(test_speed_it_is_played_at)
{
    static const struct {
        uint16_t speed_pct;
        int errors;
    } speeds[] = {{0, 1}, {100, 1}, {90, 1}, {50, 0}, {200, 1}};
    grobo_motion *motion =
        motion_of(TOP "- { time: 0, refer: { type: Pose, joints: [ 13 ], q: [ 0 ] } }\n"
                      "- { time: 0.1, refer: { type: Pose, joints: [ 13 ], q: [ 0.8 ] } }\n",
                  GROBO_FORMAT_PSEQ);

    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        grobo_check_options how = {GROBO_CHECK_OPTIONS_INIT, .speed_pct = speeds[i].speed_pct};
        grobo_diagnostics *list = NULL;
        assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
        assert_int_equal(grobo_motion_check(motion, &grobo_i_gr001_model, &how, list),
                         speeds[i].errors);
        grobo_diagnostics_free(list);
    }
    grobo_motion_free(motion);
}

/* A motion of another robot: what this one has not is said once, where it is there first. */
TEST(test_unknown_once)
{
#define AT "translation: [ 0, 0, 0 ], rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }"
    checked found =
        check(TOP "- { time: 0, refer: { type: Pose, joints: [ 13, 30, 31 ], q: [ 0, 0, 0 ] } }\n"
                  "- { time: 1, refer: { type: Pose, joints: [ 30 ], q: [ 0 ], ikLinks: [\n"
                  "  { name: TAIL, index: 40, " AT ", { name: FIN, index: 41, " AT " ] } }\n"
                  "- { time: 2, refer: { type: Pose, joints: [ 25, 31 ], q: [ 0, 0 ], ikLinks: [\n"
                  "  { name: TAIL, index: 40, " AT ", { name: TAIL, index: 42, " AT " ] } }\n",
              true);
#undef AT

    assert_int_equal(found.errors, 0);
    assert_true(has_diagnostic(found.list, "joint-unknown", 5, 67));
    assert_true(has_diagnostic(found.list, "joint-unknown", 8, 60));
    assert_true(says(&found, "joint 30 and others: GR001 has joints 0 to 19"));
    assert_true(says(&found, "joint 25: "));
    assert_true(says(&found, "link 'TAIL' with index 40"));
    assert_true(says(&found, "link 'FIN' with index 41"));
    assert_true(says(&found, "link 'TAIL' with index 42"));
    assert_int_equal(found.warnings, 2 + 3 + 1 /* legs-by-ik */);
    grobo_diagnostics_free(found.list);
}

TEST(test_empty)
{
    checked found = check("type: PoseSeq\nname: t\n", true);

    assert_int_equal(found.errors, 0);
    assert_true(has_diagnostic(found.list, "empty", 0, 0));
    grobo_diagnostics_free(found.list);
}

/* The list keeps so many and counts the rest; names of several files stay apart. */
TEST(test_list_is_bounded)
{
    grobo_diagnostics *list = NULL;
    grobo_diagnostic said = {.file = "a", .code = "x", .message = "m", .line = 1};

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    for (int i = 0; i < GROBO_DIAGNOSTICS_MAX + 10; i++) {
        said.file = i % 2 ? "a" : "b";
        said.line = (uint32_t)i + 1;
        grobo_diagnostics_add(list, &said);
    }
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR),
                     GROBO_DIAGNOSTICS_MAX + 10);
    assert_int_equal(grobo_diagnostics_kept(list), GROBO_DIAGNOSTICS_MAX);
    assert_int_equal(grobo_diagnostics_get(list, 3, &said), 0);
    assert_string_equal(said.file, "a");
    assert_int_equal(said.line, 4);
    assert_int_equal(grobo_diagnostics_get(list, GROBO_DIAGNOSTICS_MAX - 1, &said), 0);
    assert_int_equal(grobo_diagnostics_get(list, GROBO_DIAGNOSTICS_MAX, &said), GROBO_ERR_ARG);
    grobo_diagnostics_add(NULL, &said);
    assert_int_equal(grobo_diagnostics_get(NULL, 0, &said), GROBO_ERR_ARG);
    assert_string_equal(grobo_severity_name(GROBO_SEVERITY_WARNING), "warning");
    assert_string_equal(grobo_severity_name((grobo_severity)3), "unknown");
    assert_string_equal(grobo_motion_format_name((grobo_motion_format)5), "unknown");
    assert_int_equal(grobo_motion_format_kind((grobo_motion_format)-1), GROBO_MOTION_KEYS);
    assert_int_equal(grobo_motion_kind_format((grobo_motion_kind)4), GROBO_FORMAT_AUTO);
    grobo_diagnostics_free(list);
}

/* The real motion is within limits and speeds, and says what its legs need. */
TEST(test_real_motion)
{
    size_t size;
    char *text = file_text(shared_file("data/choreonoid/GR001-SampleMotion1.pseq"), &size);
    checked found = check(text, true);

    assert_int_equal(found.errors, 0);
    assert_int_equal(found.warnings, 1);
    assert_true(has_diagnostic(found.list, "legs-by-ik", 51, 0));
    grobo_diagnostics_free(found.list);
    free(text);
}

/* Which robot a motion may move: by its name, or where it has none by the number of angles. */
TEST(test_robot_it_is_for)
{
    static const struct {
        const char *text;
        bool fits;
    } motions[] = {
        {"500 0 0 0 0 0 0\n", false},
        {"500 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n", true},
        {"type: PoseSeq\nrefs: [ { time: 1, refer: { type: Pose, joints: [ 2 ], q: [ 0 ] } } ]\n",
         true},
        {"type: PoseSeq\ntargetBody: so101\n"
         "refs: [ { time: 1, refer: { type: Pose, joints: [ 2 ], q: [ 0 ] } } ]\n",
         false},
#define FRAMES                                                                                     \
    "components: [ { type: MultiValueSeq, content: JointPosition, frameRate: 1, numParts: 2, "     \
    "frames: [ [ 0, 0 ] ] } ]\n"
        {"type: BodyMotion\n" FRAMES, false},
        {"type: BodyMotion\ntargetBody: SerialRobot\n" FRAMES, false},
        {"type: BodyMotion\ntargetBody: GR001\n" FRAMES, true},
        {"type: BodyMotion\ntargetBody: gr001\n" FRAMES, false},
    };

    const char *const alike[] = {"cousin", "brother", NULL};
    grobo_model like_brother = grobo_i_gr001_model;
    like_brother.alike = alike;

    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .model = &grobo_i_gr001_model};
        grobo_motion *motion, *copy;
        assert_int_equal(grobo_motion_read_memory(motions[i].text, strlen(motions[i].text),
                                                  &options, NULL, &motion),
                         0);
        assert_int_equal(grobo_motion_is_for(motion, &grobo_i_gr001_model), motions[i].fits);
        assert_int_equal(grobo_motion_check(motion, &grobo_i_gr001_model, NULL, NULL) > 0,
                         !motions[i].fits);
        assert_int_equal(grobo_motion_dup(motion, &copy), 0);
        assert_int_equal(grobo_motion_is_for(copy, &grobo_i_gr001_model), motions[i].fits);
        assert_int_equal(grobo_motion_set_target_body(copy, "GR001"), 0);
        assert_true(grobo_motion_is_for(copy, &grobo_i_gr001_model));
        assert_int_equal(grobo_motion_set_target_body(copy, "brother"), 0);
        assert_false(grobo_motion_is_for(copy, &grobo_i_gr001_model));
        assert_true(grobo_motion_is_for(copy, &like_brother));
        assert_int_equal(grobo_motion_set_target_body(copy, "sister"), 0);
        assert_false(grobo_motion_is_for(copy, &like_brother));
        grobo_motion_free(copy);
        grobo_motion_free(motion);
    }
}
