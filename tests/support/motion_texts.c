/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

const char full_pose[] = "type: PoseSeq\nname: \"a \\\"b\\\"\"\ntargetBody: GR001\n"
                         "author: { who: me, 'two words': [ ] }\n"
                         "refs:\n"
                         "  - time: 0.25\n"
                         "    maxTransitionTime: 0.125\n"
                         "    comment: \"first: one\"\n"
                         "    refer:\n"
                         "      type: Pose\n"
                         "      name: bow\n"
                         "      joints: [ 3, 0 ]\n"
                         "      q: [ .5, -1e-019 ]\n"
                         "      spJoints: [ 3 ]\n"
                         "      weight: 7\n"
                         "      ikLinks:\n"
                         "        - name: R_ANKLE_R\n"
                         "          index: 6\n"
                         "          isTouching: true\n"
                         "          isSlave: true\n"
                         "          contactPoints: [ [ 0, 0, 1 ] ]\n"
                         "          partingDirection: [ 0, 0, 1 ]\n"
                         "          translation: [ 1, 2, 3 ]\n"
                         "          rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]\n"
                         "      zmp: [ 0.1, 0.2, 0 ]\n"
                         "      isZmpStationaryPoint: true\n"
                         "  - { time: 1, refer: bow }\n";

grobo_motion *motion_of(const char *text, grobo_motion_format format)
{
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = format,
                                  .model = &grobo_i_gr001_model, .name = "text"};
    grobo_motion *motion = NULL;
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    int result = grobo_motion_read_memory(text, strlen(text), &options, list, &motion);
    grobo_diagnostic first;
    if (result < 0 && grobo_diagnostics_get(list, 0, &first) == 0) {
        print_error("%u:%u: %s\n", first.line, first.column, first.message);
    }
    grobo_diagnostics_free(list);
    assert_int_equal(result, 0);
    return motion;
}

int read_result(const char *text, const grobo_read_options *options, grobo_diagnostics *list)
{
    grobo_motion *motion = NULL;
    int result = grobo_motion_read_memory(text, strlen(text), options, list, &motion);

    assert_true((result == 0) == (motion != NULL));
    grobo_motion_free(motion);
    return result;
}

typedef struct text_sink {
    char *data;
    size_t size;
} text_sink;

static int write_text(void *ctx, const void *data, size_t size)
{
    text_sink *text = ctx;
    char *grown = realloc(text->data, text->size + size + 1);

    assert_non_null(grown);
    text->data = grown;
    memcpy(text->data + text->size, data, size);
    text->size += size;
    text->data[text->size] = '\0';
    return 0;
}

char *written_as(const grobo_motion *motion, grobo_motion_format format,
                 const grobo_write_options *options, size_t *size)
{
    text_sink text = {NULL, 0};

    (void)write_text(&text, "", 0);
    assert_int_equal(
        grobo_motion_write(motion, format, options, &(grobo_sink){write_text, &text}, NULL), 0);
    if (size != NULL) {
        *size = text.size;
    }
    return text.data;
}

bool has_diagnostic(const grobo_diagnostics *list, const char *code, unsigned line, unsigned column)
{
    grobo_diagnostic found;
    for (size_t i = 0; grobo_diagnostics_get(list, i, &found) == 0; i++) {
        if (strcmp(found.code, code) == 0 && found.line == line &&
            (column == 0 || found.column == column)) {
            return true;
        }
    }
    return false;
}

double angle_of(const grobo_motion *motion, size_t n, int joint)
{
    grobo_posture posture;
    double angle_rad = NAN;

    assert_int_equal(grobo_motion_get(motion, n, &posture), 0);
    (void)grobo_posture_get_rad(&posture, joint, &angle_rad);
    return angle_rad;
}

double time_of(const grobo_motion *motion, size_t n)
{
    double time_s = NAN;

    assert_int_equal(grobo_motion_time_s(motion, n, &time_s), 0);
    return time_s;
}
