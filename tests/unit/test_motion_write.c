/* SPDX-License-Identifier: MIT */
/* Writing and converting motions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/support/counted_mem.h"
#include "tests/support/files.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

/* ---- layout ------------------------------------------------------------------------------- */

/* What Choreonoid writes, to the blank at the end of a line. */
static const char pose_file[] =
    "# Body pose sequence format version 1.0 defined by cnoid-Robotics\n"
    "\n"
    "type: PoseSeq\n"
    "name: \"a \\\"b\\\" \\x07 \\u2028\"\n"
    "targetBody: \"GR001\"\n"
    "author: { who: me }\n"
    "refs: \n"
    "  - \n"
    "    time: 0\n"
    "    note: \"a: b\"\n"
    "    refer: \n"
    "      type: Pose\n"
    "      name: \"\"\n"
    "      joints: [ \n"
    "        0, 1, 2, 3, 4, 5, 6, 7, 8, \n"
    "        9, 10, 11 ]\n"
    "      q: [ \n"
    "        0, 1, 2, 3, 4, 5, 6, 7, 8, \n"
    "        9, -1.80616593e-19, 0.10000000000000002 ]\n"
    "      spJoints: [ 1 ]\n"
    "      ikLinks: \n"
    "        - \n"
    "          name: WAIST\n"
    "          index: 0\n"
    "          isBaseLink: true\n"
    "          isStationaryPoint: true\n"
    "          translation: [ 1, 2, 3 ]\n"
    "          rotation: [ \n"
    "            1, 0, 0, \n"
    "            0, 1, 0, \n"
    "            0, 0, 1 ]\n"
    "          isTouching: true\n"
    "          partingDirection: [ 0, 0, 1 ]\n"
    "          contactPoints: [ [ 0, 0, 0 ] ]\n"
    "          isSlave: true\n"
    "      zmp: [ 0.5, 0, 0 ]\n"
    "      isZmpStationaryPoint: true\n"
    "  - \n"
    "    time: 1.5\n"
    "    maxTransitionTime: 0.541666667\n"
    "    refer: \n"
    "      type: Pose\n"
    "      name: \"two\"\n";

/* What later ones write: ten in a line; a ZMP on its way says so. */
static const char later_pose_file[] =
    "# Body pose sequence format version 1.0 defined by cnoid-Robotics\n"
    "\n"
    "type: PoseSeq\n"
    "name: \"sway\"\n"
    "targetBody: \"KNIGHT\"\n"
    "refs: \n"
    "  - \n"
    "    time: 2\n"
    "    refer: \n"
    "      type: Pose\n"
    "      name: \"\"\n"
    "      joints: [ \n"
    "        0, 1, 2, 3, 4, 5, 6, 7, 8, 9, \n"
    "        10, 11, 12, 13, 14, 15, 16, 17, 18, 19, \n"
    "        20, 21 ]\n"
    "      q: [ \n"
    "        0, 0.5, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0.5, \n"
    "        0, 0.5, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0.5, \n"
    "        0, 0.5 ]\n"
    "      spJoints: [ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, \n"
    "        11, 12, 13, 14, 15, 16, 17, 18, 19, 20, \n"
    "        21 ]\n"
    "      zmp: [ 0, 0.04, 0 ]\n"
    "      isZmpStationaryPoint: false\n";

/* What is read and written comes out to the letter. */
static void expect_same_pseq(const char *file)
{
    grobo_motion *motion = motion_of(file, GROBO_FORMAT_PSEQ);
    char *text = written_as(motion, GROBO_FORMAT_AUTO, NULL, NULL);

    assert_string_equal(text, file);
    free(text);
    grobo_motion_free(motion);
}

TEST(test_later_pseq_layout)
{
    expect_same_pseq(later_pose_file);
}

TEST(test_pseq_layout)
{
    expect_same_pseq(pose_file);
}

/* Keys without a meaning here, of the file and of the component, and a content that is nothing. */
TEST(test_yaml_keeps_keys)
{
    grobo_motion *motion =
        motion_of("type: BodyMotion\nauthor: me\ncomponents:\n"
                  "  - { type: MultiVector3Seq, content: ZMP, mine: 1, frames: [ ] }\n"
                  "  - { type: MultiValueSeq, content: ~, purpose: JointPosition, mine: { a: 2 }, "
                  "frameRate: 50, numParts: 2, frames: [ [ 1, 2 ] ] }\n",
                  GROBO_FORMAT_YAML);
    char *written = written_as(motion, GROBO_FORMAT_YAML, NULL, NULL);

    assert_non_null(strstr(written, "\nauthor: me\n"));
    assert_non_null(strstr(written, "\n    mine: { a: 2 }\n    frames: \n"));
    grobo_motion *back = motion_of(written, GROBO_FORMAT_YAML);
    assert_true(grobo_motion_equal(motion, back));
    grobo_motion_free(back);
    free(written);
    grobo_motion_free(motion);
}

/* Names that are not words to YAML stay names. */
TEST(test_pseq_odd_names)
{
    static const char *const names[] = {"null", "~", "NULL", "7", "True", "off", "-1", ".5", "- a"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char text[400], link[40];
        (void)snprintf(link, sizeof link, "          name: \"%s\"\n", names[i]);
        (void)snprintf(text, sizeof text,
                       "type: PoseSeq\nname: t\n\"%s\": 1\nrefs:\n- { time: 0, refer: { type: "
                       "Pose, ikLinks: [ { name: \"%s\", translation: [ 0, 0, 0 ], rotation: [ 1, "
                       "0, 0, 0, 1, 0, 0, 0, 1 ] } ] } }\n",
                       names[i], names[i]);
        grobo_motion *motion = motion_of(text, GROBO_FORMAT_PSEQ);
        char *written = written_as(motion, GROBO_FORMAT_PSEQ, NULL, NULL);
        grobo_motion *back = motion_of(written, GROBO_FORMAT_PSEQ);
        assert_non_null(strstr(written, link));
        assert_true(grobo_motion_equal(motion, back));
        grobo_motion_free(back);
        free(written);
        grobo_motion_free(motion);
    }
}

TEST(test_yaml_layout)
{
    static const char file[] = "type: BodyMotion\n"
                               "components: \n"
                               "  - \n"
                               "    type: MultiValueSeq\n"
                               "    content: JointPosition\n"
                               "    purpose: JointPosition\n"
                               "    frameRate: 30\n"
                               "    numFrames: 2\n"
                               "    numParts: 2\n"
                               "    frames: \n"
                               "      - [ 0, 1 ]\n"
                               "      - [ 0.5, -7.779e-05 ]\n";
    static const char timed[] = "type: CompositeSeq\n"
                                "content: BodyMotion\n"
                                "format_version: 4\n"
                                "name: \"t\"\n"
                                "frame_rate: 30\n"
                                "num_frames: 1\n"
                                "components: \n"
                                "  - \n"
                                "    type: MultiValueSeq\n"
                                "    content: JointDisplacement\n"
                                "    frame_rate: 30\n"
                                "    num_frames: 1\n"
                                "    num_parts: 1\n"
                                "    has_frame_time: true\n"
                                "    frames: \n"
                                "      - [ 0.25, 1 ]\n";
    static const char *const files[] = {file, timed};

    for (int i = 0; i < 2; i++) {
        grobo_motion *motion = motion_of(files[i], GROBO_FORMAT_YAML);
        char *text = written_as(motion, GROBO_FORMAT_YAML, NULL, NULL);
        assert_string_equal(text, files[i]);
        free(text);
        grobo_motion_free(motion);
    }
}

TEST(test_m_layout)
{
    static const char file[] = "500  10 -20.5 0\n1000  1 2 3\n";
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model};
    grobo_motion *motion = motion_of(file, GROBO_FORMAT_M);
    char *text = written_as(motion, GROBO_FORMAT_M, &options, NULL);

    /* The original reads whole numbers. */
    assert_string_equal(text, "500  10 -21 0\n1000  1 2 3\n");
    free(text);
    options.exact = true;
    text = written_as(motion, GROBO_FORMAT_M, &options, NULL);
    assert_string_equal(text, file);
    free(text);
    grobo_motion_free(motion);
}

TEST(test_print)
{
    char text[256] = "";
    FILE *stream = tmpfile();
    grobo_motion *motion = motion_of("500  10 -20\n", GROBO_FORMAT_M);
    grobo_posture posture;

    assert_non_null(stream);
    assert_int_equal(grobo_motion_print(motion, &grobo_i_gr001_model, stream), 0);
    (void)grobo_posture_init(&posture, 3);
    (void)grobo_posture_set_deg(&posture, 0, -0.04);
    (void)grobo_posture_set_deg(&posture, 2, -12.34);
    assert_int_equal(grobo_posture_print(&posture, stream), 0);
    rewind(stream);
    size_t size = fread(text, 1, sizeof text - 1, stream);
    text[size] = '\0';
    assert_string_equal(text, "500  10 -20\n0.0 - -12.3\n");
    fclose(stream);
    grobo_motion_free(motion);
}

static int failing_write(void *ctx, const void *data, size_t size)
{
    size_t *left = ctx;

    (void)data;
    if (size > *left) {
        return GROBO_ERR_IO;
    }
    *left -= size;
    return 0;
}

TEST(test_sink_fails)
{
    grobo_motion *motion = motion_of(pose_file, GROBO_FORMAT_PSEQ);

    for (int format = GROBO_FORMAT_M; format <= GROBO_FORMAT_YAML; format++) {
        size_t left = 0;
        assert_int_equal(grobo_motion_write(motion, (grobo_motion_format)format, NULL,
                                            &(grobo_sink){failing_write, &left}, NULL),
                         GROBO_ERR_IO);
    }
    grobo_motion_free(motion);
}

/* ---- conversions -------------------------------------------------------------------------- */

static grobo_motion *converted(const grobo_motion *motion, grobo_motion_kind kind,
                               const grobo_write_options *options, grobo_diagnostics *list)
{
    grobo_motion *made = NULL;

    assert_int_equal(grobo_motion_convert(motion, kind, options, list, &made), 0);
    assert_int_equal(grobo_motion_get_kind(made), kind);
    return made;
}

/* There and back again: every pair of kinds keeps sizes, times and angles, if told to. */
TEST(test_every_pair)
{
    const grobo_write_options exact = {GROBO_WRITE_OPTIONS_INIT, .exact = true};
    static const char *const files[] = {
        "0  10 -20 30\n400  15 -20 31\n1000  40 0 0\n",
        "type: PoseSeq\nname: t\nrefs:\n"
        "- { time: 0, refer: { type: Pose, joints: [ 0, 1 ], q: [ 0.1, 0.2 ] } }\n"
        "- { time: 0.7, refer: { type: Pose, joints: [ 0, 1 ], q: [ 0.3, 0.123456789012345 ] } }\n",
        "type: MotionSeq\nname: t\nrefs:\n"
        "- { time: 0, refer: { type: Motion, joints: [ 0, 1 ], q: [ 0.1, 0.2 ] } }\n"
        "- { time: 0.5, refer: { type: Motion, joints: [ 0, 1 ], q: [ 0.3, 0.7 ] } }\n",
        "type: BodyMotion\ncomponents:\n- { type: MultiValueSeq, content: JointPosition,"
        " frameRate: 30, numParts: 2,"
        " frames: [ [ 0.1, 0.2 ], [ 0.3, 0.33333333333333331 ], [ 1, 2 ] ] }\n"};

    for (int from = 0; from < 4; from++) {
        grobo_motion *motion = NULL;
        assert_int_equal(
            grobo_motion_read_memory(files[from], strlen(files[from]), NULL, NULL, &motion), 0);
        for (int to = 0; to < 4; to++) {
            grobo_motion *there = converted(motion, (grobo_motion_kind)to, &exact, NULL);
            grobo_motion *back = converted(there, (grobo_motion_kind)from, &exact, NULL);
            assert_true(grobo_motion_near(motion, back, 1e-15, 1e-12));
            grobo_motion_free(there);
            grobo_motion_free(back);
        }
        grobo_motion_free(motion);
    }
}

TEST(test_conversion_says_what_is_dropped)
{
    grobo_motion *motion = motion_of(pose_file, GROBO_FORMAT_PSEQ);
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    grobo_motion_free(converted(motion, GROBO_MOTION_POSTURES, NULL, list));
    static const char *const codes[] = {"ik-links-dropped", "zmp-dropped", "sp-joints-dropped",
                                        "keys-dropped"};
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        assert_true(has_diagnostic(list, codes[i], 8 + 1, 0));
    }
    assert_true(has_diagnostic(list, "transition-dropped", 39, 0));
    assert_true(has_diagnostic(list, "name-dropped", 39, 0));
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR), 0);
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_WARNING), 0);
    grobo_diagnostics_clear(list);
    grobo_motion_free(converted(motion, GROBO_MOTION_STEPS, NULL, list));
    grobo_diagnostic said;
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), GROBO_ERR_ARG);
    grobo_diagnostics_free(list);
    grobo_motion_free(motion);
}

/* Joints that a pose does not list: as before, at first as in their first pose. */
TEST(test_conversion_fills_joints)
{
    grobo_motion *motion =
        motion_of("type: PoseSeq\nname: t\nrefs:\n"
                  "- { time: 0, refer: { type: Pose, joints: [ 0 ], q: [ 1 ] } }\n"
                  "- { time: 12, refer: { type: Pose, joints: [ 1 ], q: [ 2 ] } }\n"
                  "- { time: 12, refer: { type: Pose, joints: [ 3 ], q: [ 3 ] } }\n",
                  GROBO_FORMAT_PSEQ);
    grobo_diagnostics *list = NULL;
    grobo_posture start;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    (void)grobo_posture_init(&start, 4);
    (void)grobo_posture_set_rad(&start, 2, 7);
    grobo_motion *postures =
        converted(motion, GROBO_MOTION_POSTURES,
                  &(grobo_write_options){GROBO_WRITE_OPTIONS_INIT, .start = &start}, list);
    assert_true(angle_of(postures, 0, 1) == 2.0 && angle_of(postures, 2, 0) == 1.0);
    assert_true(angle_of(postures, 0, 2) == 7.0);
    assert_true(has_diagnostic(list, "joints-unset", 0, 0));
    assert_true(has_diagnostic(list, "step-default", 5, 0));
    grobo_motion *frames = converted(
        motion, GROBO_MOTION_FRAMES,
        &(grobo_write_options){GROBO_WRITE_OPTIONS_INIT, .start = &start, .exact = true}, list);
    assert_true(angle_of(frames, 0, 2) == 7.0);
    assert_true(grobo_motion_has_frame_times(frames));
    grobo_motion_free(postures);
    grobo_motion_free(frames);
    grobo_motion_free(motion);
    grobo_diagnostics_free(list);
}

TEST(test_conversion_at_a_rate)
{
    grobo_motion *motion = motion_of("0  0\n1000  100\n", GROBO_FORMAT_M);
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .rate_hz = 10};
    grobo_motion *frames = converted(motion, GROBO_MOTION_FRAMES, &options, NULL);

    /* It begins with its first posture. */
    assert_int_equal(grobo_motion_size(frames), 11);
    assert_true(grobo_motion_frame_rate(frames) == 10.0);
    grobo_motion *finer =
        converted(frames, GROBO_MOTION_FRAMES,
                  &(grobo_write_options){GROBO_WRITE_OPTIONS_INIT, .rate_hz = 20}, NULL);
    assert_int_equal(grobo_motion_size(finer), 21);
    grobo_motion *bad = NULL;
    assert_int_equal(
        grobo_motion_convert(motion, GROBO_MOTION_FRAMES,
                             &(grobo_write_options){GROBO_WRITE_OPTIONS_INIT, .rate_hz = -1}, NULL,
                             &bad),
        GROBO_ERR_ARG);
    assert_null(bad);
    grobo_motion_free(motion);
    grobo_motion_free(frames);
    grobo_motion_free(finer);
}

/* Without a rate asked for, key poses become frames that programs which hold each can play. */
TEST(test_frames_are_resampled)
{
    grobo_motion *motion =
        motion_of("type: PoseSeq\nname: t\nrefs:\n"
                  "- { time: 0.1, refer: { type: Pose, joints: [ 0 ], q: [ 1 ] } }\n"
                  "- { time: 0.35, refer: { type: Pose, joints: [ 0 ], q: [ 2 ] } }\n",
                  GROBO_FORMAT_PSEQ);
    grobo_diagnostics *list = NULL;
    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    grobo_motion *frames = converted(motion, GROBO_MOTION_FRAMES, NULL, list);
    size_t size = grobo_motion_size(frames);

    assert_true(has_diagnostic(list, "resampled", 0, 0));
    assert_false(grobo_motion_has_frame_times(frames));
    /* At 50 per second it would end at 360 ms. */
    assert_true(grobo_motion_frame_rate(frames) == 100);
    assert_int_equal(size, 36);
    assert_int_equal(grobo_motion_length_us(frames, -1), 350000);
    assert_true(angle_of(frames, 10, 0) == 1 && angle_of(frames, size - 1, 0) == 2);
    grobo_motion_free(frames);
    /* On no frame: 0, 20 ... 340 ms, and one more for the end at 351. */
    assert_int_equal(grobo_motion_set_time_s(motion, 1, 0.351), 0);
    frames = converted(motion, GROBO_MOTION_FRAMES, NULL, NULL);
    assert_true(grobo_motion_frame_rate(frames) == GROBO_MOTION_RATE_HZ);
    assert_int_equal(grobo_motion_size(frames), 19);
    grobo_motion_free(frames);
    grobo_motion_free(motion);
    /* What stands at a rate keeps it. */
    motion = motion_of("40  0\n80  10\n120  0\n", GROBO_FORMAT_M);
    grobo_diagnostics_clear(list);
    frames = converted(motion, GROBO_MOTION_FRAMES, NULL, list);
    assert_true(grobo_motion_frame_rate(frames) == 50);
    grobo_motion_free(frames);
    grobo_motion_free(motion);
    grobo_diagnostics_free(list);
}

/* An empty motion has a file in every format, and comes back from it. */
TEST(test_empty_motions_are_written)
{
    const grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model};

    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
        for (int format = GROBO_FORMAT_M; format <= GROBO_FORMAT_YAML; format++) {
            grobo_motion *motion = NULL;
            assert_int_equal(grobo_motion_new((grobo_motion_kind)kind, 0, NULL, &motion), 0);
            char *text = written_as(motion, (grobo_motion_format)format, &options, NULL);
            grobo_motion *back = motion_of(text, (grobo_motion_format)format);
            assert_int_equal(grobo_motion_size(back), 0);
            grobo_motion_free(back);
            free(text);
            grobo_motion_free(motion);
        }
    }
}

/* ---- memory ------------------------------------------------------------------------------- */

TEST(test_allocations_fail)
{
    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
        int result = GROBO_ERR_NOMEM;
        for (size_t n = 1; result < 0; n++) {
            counted_mem counter = {0};
            grobo_mem mem = counted_mem_of(&counter);
            grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem};
            grobo_motion *motion = NULL, *made = NULL;
            assert_int_equal(
                grobo_motion_read_memory(pose_file, strlen(pose_file), &options, NULL, &motion), 0);
            counter.fail_at = counter.calls + n;
            result = grobo_motion_convert(motion, (grobo_motion_kind)kind, NULL, NULL, &made);
            assert_true(result == 0 || (result == GROBO_ERR_NOMEM && made == NULL));
            grobo_motion_free(made);
            grobo_motion_free(motion);
            assert_int_equal(counter.bytes, 0);
        }
    }
}

/* ---- the reference material --------------------------------------------------------------- */

static const char *const real_names[] = {
    "data/choreonoid/GR001-SampleMotion1.pseq", "data/choreonoid/SR1WalkPattern2.pseq",
    "data/choreonoid/SR1WalkPattern3.yaml", "data/choreonoid/SR1WalkPattern3.seq"};

/* What Choreonoid wrote comes out as it wrote it. */
TEST(test_real_key_poses_byte_for_byte)
{
    for (int i = 0; i < 2; i++) {
        size_t size, written;
        char *file = file_text(shared_file(real_names[i]), &size);
        grobo_motion *motion = motion_of(file, GROBO_FORMAT_PSEQ);
        char *text = written_as(motion, GROBO_FORMAT_PSEQ, NULL, &written);
        assert_int_equal(size, written);
        assert_memory_equal(file, text, size);
        free(text);
        free(file);
        grobo_motion_free(motion);
    }
}

/* Read, written to each format and read, and back: the same sizes, times and angles. */
TEST(test_real_files_there_and_back)
{
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model,
                                   .exact = true};

    for (size_t i = 0; i < sizeof real_names / sizeof real_names[0]; i++) {
        grobo_motion *motion = NULL;
        assert_int_equal(grobo_motion_read_file(shared_file(real_names[i]), NULL, NULL, &motion),
                         0);
        grobo_motion_kind kind = grobo_motion_get_kind(motion);
        for (int format = GROBO_FORMAT_M; format <= GROBO_FORMAT_YAML; format++) {
            bool fills = format == GROBO_FORMAT_M || format == GROBO_FORMAT_YAML;
            char *text = written_as(motion, (grobo_motion_format)format, &options, NULL);
            grobo_motion *there = motion_of(text, (grobo_motion_format)format);
            grobo_motion *back = converted(there, kind, &options, NULL);
            assert_int_equal(grobo_motion_size(back), grobo_motion_size(motion));
            for (size_t n = 0; n < grobo_motion_size(motion); n++) {
                double time_s, back_s;
                (void)grobo_motion_time_s(motion, n, &time_s);
                (void)grobo_motion_time_s(back, n, &back_s);
                assert_true(fabs(time_s - back_s) < 1e-12);
                for (int j = 0; j < grobo_motion_joints(motion); j++) {
                    double angle_rad = angle_of(motion, n, j);
                    bool set = !isnan(angle_rad);
                    assert_true(set || fills || isnan(angle_of(back, n, j)));
                    assert_true(!set || fabs(angle_rad - angle_of(back, n, j)) < 1e-15);
                }
            }
            free(text);
            grobo_motion_free(there);
            grobo_motion_free(back);
        }
        grobo_motion_free(motion);
    }
}

/* The walk in two versions of the format is the same walk. */
TEST(test_versions_agree)
{
    grobo_motion *a = NULL, *b = NULL;

    assert_int_equal(grobo_motion_read_file(shared_file(real_names[2]), NULL, NULL, &a), 0);
    assert_int_equal(grobo_motion_read_file(shared_file(real_names[3]), NULL, NULL, &b), 0);
    assert_true(grobo_motion_equal(a, b));
    grobo_motion_free(a);
    grobo_motion_free(b);
}

/* ---- a first posture at 0 -------------------------------------------------------------------- */

static int64_t played_us(const grobo_motion *motion)
{
    grobo_clip clip;
    grobo_posture start;
    (void)grobo_posture_init(&start, grobo_motion_joints(motion));
    start.set = GROBO_JOINTS_ALL(start.n_joints);
    assert_int_equal(
        grobo_motion_clip(motion, &(grobo_clip_options){GROBO_CLIP_OPTIONS_INIT, .start = &start},
                          &clip),
        0);
    int64_t length_us = clip.length_us;
    grobo_motion_clip_free(&clip);
    return length_us;
}

/* An .m that begins at 0 begins with its first posture, as frames and key poses do: its length,
 * what is played of it, and each copy. */
TEST(test_a_motion_that_begins_at_0)
{
    static const struct {
        const char *text;
        grobo_motion_format format;
        int64_t length_us;
    } rows[] = {
        {"0 0 0\n500 10 0\n1000 0 0\n", GROBO_FORMAT_M, 1000000},
        {"0 0 0\n0 10 0\n1000 0 0\n", GROBO_FORMAT_M, 1250000}, /* the second takes the default */
        {"250 0 0\n500 10 0\n1000 0 0\n", GROBO_FORMAT_M, 1000000},
        {"type: PoseSeq\nname: t\nrefs:\n"
         "- { time: 0, refer: { type: Pose, joints: [ 0, 1 ], q: [ 1, 0 ] } }\n"
         "- { time: 1, refer: { type: Pose, joints: [ 0, 1 ], q: [ 2, 1 ] } }\n",
         GROBO_FORMAT_PSEQ, 1000000},
        {"type: MotionSeq\nname: t\nrefs:\n"
         "- { time: 0, refer: { type: Motion, joints: [ 0, 1 ], q: [ 1, 0 ] } }\n"
         "- { time: 1, refer: { type: Motion, joints: [ 0, 1 ], q: [ 1, 1 ] } }\n",
         GROBO_FORMAT_MSEQ, 1000000},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_motion *motion = motion_of(rows[i].text, rows[i].format);
        assert_int_equal(grobo_motion_length_us(motion, -1), rows[i].length_us);
        assert_int_equal(played_us(motion), rows[i].length_us);
        for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
            grobo_diagnostics *list = NULL;
            grobo_posture start;
            (void)grobo_posture_init(&start, 2);
            start.set = GROBO_JOINTS_ALL(2);
            assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
            grobo_motion *copy = converted(
                motion, (grobo_motion_kind)kind,
                &(grobo_write_options){GROBO_WRITE_OPTIONS_INIT, .start = &start, .exact = true},
                list);
            assert_int_equal(played_us(copy), rows[i].length_us);
            assert_int_equal(grobo_motion_length_us(copy, -1), rows[i].length_us);
            grobo_motion_free(copy);
            grobo_diagnostics_free(list);
        }
        grobo_motion_free(motion);
    }
}
