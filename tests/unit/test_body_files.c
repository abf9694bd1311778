/* SPDX-License-Identifier: MIT */
/* Motions with link targets, as files have them, through the bridge to the body and back. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/body_motion.h>
#include <grobo/motion_io.h>

#include "tests/support/body_script.h"
#include "tests/support/counted_mem.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

/* Feet on the ground, the waist goes down and up; the head turns. The left foot has a name that
 * the body has not: its index tells which link it is. */
static const char bow[] =
    "type: PoseSeq\n"
    "name: \"bow\"\n"
    "targetBody: \"GR001\"\n"
    "refs:\n"
    "  - time: 0\n"
    "    refer:\n"
    "      type: Pose\n"
    "      name: \"\"\n"
    "      joints: [ 13 ]\n"
    "      q: [ 0.2 ]\n"
    "      ikLinks:\n"
    "        - { name: WAIST, index: 0, isBaseLink: true, translation: [ 0, 0, 0.15 ],\n"
    "            rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }\n"
    "        - { name: R_ANKLE_R, index: 6, translation: [ 0.0252, -0.0196, 0.02115 ],\n"
    "            rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ], isTouching: true }\n"
    "        - { name: FOOT_L, index: 12, translation: [ 0.0252, 0.0196, 0.02115 ],\n"
    "            rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ], isTouching: true }\n"
    "        - { name: TAIL, index: 99, translation: [ 0, 0, 9 ],\n"
    "            rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }\n"
    "      zmp: [ 0.02, 0, 0 ]\n"
    "      isZmpStationaryPoint: true\n"
    "  - time: 1\n"
    "    maxTransitionTime: 0.5\n"
    "    refer:\n"
    "      type: Pose\n"
    "      name: \"\"\n"
    "      joints: [ 13 ]\n"
    "      q: [ -0.2 ]\n"
    "      spJoints: [ 13 ]\n"
    "      ikLinks:\n"
    "        - { name: WAIST, index: 0, isBaseLink: true, translation: [ 0, 0, %s ],\n"
    "            rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }\n"
    "  - time: 2\n"
    "    refer:\n"
    "      type: Pose\n"
    "      name: \"\"\n"
    "      ikLinks:\n"
    "        - { name: WAIST, index: 0, isBaseLink: true, translation: [ 0, 0, 0.15 ],\n"
    "            rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ] }\n";

static grobo_motion *read_bow(const char *height)
{
    char text[sizeof bow + 32];
    char *place;
    grobo_motion *motion = NULL;
    const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = GROBO_FORMAT_PSEQ};

    memcpy(text, bow, sizeof bow);
    place = strstr(text, "%s");
    memmove(place + strlen(height), place + 2, strlen(place + 2) + 1);
    memcpy(place, height, strlen(height));
    assert_int_equal(grobo_motion_read_memory(text, strlen(text), &options, NULL, &motion), 0);
    return motion;
}

TEST(a_file_and_a_script_give_the_same)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 50};
    grobo_motion *motion = read_bow("0.13");
    grobo_body *body = NULL;
    struct script script;
    struct run run;

    memset(&script, 0, sizeof script);
    script_key(&script, 0);
    script_joint(&script, 13, 0.2);
    script_stand(&script, 0, 0, 0.15);
    script_key(&script, 1)->max_transition_s = 0.5;
    script_joint(&script, 13, -0.2);
    script_target(&script, WAIST, 0, 0, 0.13);
    script_key(&script, 2);
    script_target(&script, WAIST, 0, 0, 0.15);

    assert_true(grobo_body_wanted(&grobo_i_gr001_body, motion));
    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, &options, NULL, &body), 0);
    grobo_motion_free(motion);
    run_start(&run, &grobo_i_gr001_body, &script, &options);
    assert_int_equal(grobo_body_frame_count(body), 101);
    for (int i = 0; i <= 100; i++) {
        double q[JOINTS], want[JOINTS];
        grobo_body_report report;

        assert_int_equal(grobo_body_frame(body, i, q, &report), 0);
        assert_int_equal(grobo_body_frame(run.body, i, want, NULL), 0);
        assert_memory_equal(q, want, sizeof q);
        assert_true(report.has_zmp && fabs(report.zmp_m[0] - 0.02) < 1e-15);
    }
    run_finish(&run);
    grobo_body_free(body);
}

TEST(a_clip_plays_the_body)
{
    grobo_motion *motion = read_bow("0.13");
    grobo_body *body = NULL;
    grobo_clip clip;
    grobo_posture posture;
    int64_t at_us = 0;
    double q[JOINTS];

    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, NULL, NULL, &body), 0);
    grobo_motion_free(motion);
    grobo_body_clip(body, true, &clip);
    assert_int_equal(clip.length_us, 2000000);
    assert_int_equal(clip.n_keys, 3);
    assert_int_equal(clip.n_joints, 20);
    assert_false(clip.relative);
    assert_int_equal(clip.sample(clip.ctx, 750000, &posture), 0);
    assert_int_equal(grobo_body_frame(body, 75, q, NULL), 0);
    assert_int_equal(posture.set, GROBO_JOINTS_ALL(12) | GROBO_JOINT_BIT(13));
    assert_memory_equal(posture.angle_rad, q, sizeof q);
    assert_int_equal(clip.key(clip.ctx, 1, &posture, &at_us), 0);
    assert_int_equal(at_us, 1000000);
    assert_int_equal(posture.time_us, 1000000);
    assert_true(fabs(posture.angle_rad[13] + 0.2) < 1e-15);
    assert_int_equal(clip.key(clip.ctx, 3, &posture, &at_us), GROBO_ERR_ARG);
    grobo_body_free(body);
}

TEST(a_clip_stops_where_a_leg_does_not_reach)
{
    grobo_motion *motion = read_bow("0.19");
    grobo_motion *frames = NULL;
    grobo_body *body = NULL;
    grobo_clip clip;
    grobo_posture posture;
    int unreached;

    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, NULL, NULL, &body), 0);
    grobo_motion_free(motion);
    grobo_body_clip(body, true, &clip);
    assert_int_equal(clip.sample(clip.ctx, 100000, &posture), 0);
    assert_int_equal(clip.sample(clip.ctx, 1000000, &posture), GROBO_ERR_UNREACHABLE);
    grobo_body_clip(body, false, &clip);
    assert_int_equal(clip.sample(clip.ctx, 1000000, &posture), 0);
    unreached = grobo_body_frames(body, NULL, &frames);
    assert_in_range(unreached, 30, 150);
    assert_int_equal(grobo_motion_size(frames), 201);
    grobo_motion_free(frames);
    grobo_body_free(body);
}

TEST(frames_are_the_body_s)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .balance = GROBO_BODY_BALANCE_ON,
                                        .rate_hz = 30};
    grobo_motion *motion = read_bow("0.13");
    grobo_motion *frames = NULL;
    grobo_body *body = NULL;

    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, &options, NULL, &body), 0);
    grobo_motion_free(motion);
    assert_int_equal(grobo_body_frames(body, NULL, &frames), 0);
    assert_int_equal(grobo_motion_get_kind(frames), GROBO_MOTION_FRAMES);
    assert_true(fabs(grobo_motion_frame_rate(frames) - 30) < 1e-15);
    assert_int_equal(grobo_motion_size(frames), 91);
    for (int i = 0; i <= 90; i++) {
        grobo_posture posture;
        double q[JOINTS];

        assert_int_equal(grobo_motion_get(frames, (size_t)i, &posture), 0);
        assert_int_equal(grobo_body_frame(body, i, q, NULL), 0);
        assert_int_equal(posture.set, grobo_body_joints(body));
        for (int j = 0; j < JOINTS; j++) {
            assert_true((posture.set & GROBO_JOINT_BIT(j)) == 0 ||
                        fabs(posture.angle_rad[j] - q[j]) < 1e-15);
        }
    }
    grobo_motion_free(frames);
    grobo_body_free(body);
}

TEST(other_motions_are_refused)
{
    grobo_motion *motion = NULL;
    grobo_body *body = NULL;

    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, 20, NULL, &motion), 0);
    assert_false(grobo_body_wanted(&grobo_i_gr001_body, motion));
    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, NULL, NULL, &body),
                     GROBO_ERR_EMPTY);
    grobo_motion_free(motion);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_FRAMES, 20, NULL, &motion), 0);
    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, NULL, NULL, &body),
                     GROBO_ERR_TYPE);
    grobo_motion_free(motion);
    grobo_body_free(NULL);
}

/* Every allocation fails once: nothing is lost, nothing made. */
TEST(each_allocation_may_fail)
{
    grobo_motion *motion = read_bow("0.13");
    bool whole = false;

    for (size_t n = 1; !whole; n++) {
        counted_mem counter = {.fail_at = n};
        const grobo_mem mem = counted_mem_of(&counter);
        grobo_motion *frames = NULL;
        grobo_body *body = NULL;
        int result = grobo_body_new(&grobo_i_gr001_body, motion, NULL, &mem, &body);

        if (result == 0) {
            result = grobo_body_frames(body, &mem, &frames);
        }
        whole = !counter.failed;
        assert_int_equal(result, whole ? 0 : GROBO_ERR_NOMEM);
        assert_true(whole == (frames != NULL));
        grobo_motion_free(frames);
        grobo_body_free(body);
        assert_int_equal(counter.bytes, 0);
    }
    grobo_motion_free(motion);
}
