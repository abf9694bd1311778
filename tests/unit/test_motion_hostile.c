/* SPDX-License-Identifier: MIT */
/* Files that mean harm, memory that runs out, and the odd ones of the reference material. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/counted_mem.h"
#include "tests/support/files.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

/* ---- caps and quadratic inputs ------------------------------------------------------------ */

/* A source of one text and then another one for ever, up to a total. */
typedef struct endless {
    const char *first, *then;
    size_t given, total;
} endless;

static int read_endless(void *ctx, void *buffer, size_t size)
{
    endless *text = ctx;
    size_t head = strlen(text->first), tail = strlen(text->then);
    char *to = buffer;
    size_t n = 0;

    for (; n < size && text->given < text->total; n++, text->given++) {
        to[n] =
            text->given < head ? text->first[text->given] : text->then[(text->given - head) % tail];
    }
    return (int)n;
}

/* Refused after little of it was read: nothing costs more than what was read. */
static void assert_refused_early(const char *first, const char *then)
{
    endless text = {first, then, 0, (size_t)100 << 20};
    grobo_motion *motion = NULL;
    int result = grobo_motion_read(&(grobo_source){read_endless, &text}, NULL, NULL, &motion);

    if (result >= 0 || text.given > (size_t)1 << 20) {
        fail_msg("%s%s...: %s after %zu bytes", first, then, grobo_error_name(result), text.given);
    }
    assert_null(motion);
}

TEST(test_caps)
{
    assert_refused_early("", "[");
    assert_refused_early("", "[\n");
    assert_refused_early("", "{");
    assert_refused_early("", "- ");
    assert_refused_early("", "? ");
    assert_refused_early("", "[ a, ");
    assert_refused_early("a: ", "[ ");
    assert_refused_early("", "#");
    assert_refused_early("", "\n");
    assert_refused_early("a: ", " ");
    assert_refused_early("a: ", "x");
    assert_refused_early("a: \"", "x");
    assert_refused_early("a: |\n", " x\n");
    assert_refused_early("", "x");
    assert_refused_early("", "%TAG !a! b\n");
    assert_refused_early("a: [ ", "1, ");
    assert_refused_early("refs: [ { a: &x [ ", "1, ");
    assert_refused_early("refs: [ { time: 0, refer: { joints: [ ", "1, ");
    assert_refused_early("refs: [ { time: 0, refer: { ikLinks: [ ",
                         "{ index: 1, translation: [ 0, 0, 0 ], rotation: [ 1, 0, 0, 0, 1, 0, 0, "
                         "0, 1 ] }, ");
}

TEST(test_many_keys)
{
    char text[20000] = "type: PoseSeq\n";
    size_t used = strlen(text);

    for (int i = 0; i < 1000; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "key%d: %d\n", i, i);
    }
    assert_int_equal(read_result(text, NULL, NULL), GROBO_ERR_CAP);
}

/* Aliases of aliases: a small file that would be a large one. */
TEST(test_billion_laughs)
{
    char text[4000] = "a0: &a0 [ x, x, x, x, x, x, x, x ]\n";
    size_t used = strlen(text);

    for (int i = 1; i < 12; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "a%d: &a%d [ *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d ]\n",
                                 i, i, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1);
    }
    assert_int_equal(read_result(text, NULL, NULL), GROBO_ERR_CAP);
}

/* ---- memory ------------------------------------------------------------------------------- */

static const char *const samples[] = {
    "500 1 2\n600 3 4\n", full_pose,
    "type: MotionSeq\nname:\nrefs:\n- { time: 0, refer: &a { type: Motion, joints: [ 0 ], q: [ 1 ]"
    " } }\n- { time: 0, refer: *a }\n",
    "type: BodyMotion\ncomponents:\n- { type: MultiValueSeq, content: JointPosition, frameRate: "
    "10, numParts: 1, frames: [ [ 1 ], [ 2 ] ] }\n"};

/* Every allocation of every reader fails in turn. */
TEST(test_allocations_fail)
{
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
        int result = GROBO_ERR_NOMEM;
        for (size_t n = 1; result < 0; n++) {
            counted_mem counter = {.fail_at = n};
            grobo_mem mem = counted_mem_of(&counter);
            grobo_diagnostics *list = NULL;
            grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem,
                                          .keep_positions = true, .model = &grobo_i_gr001_model};
            result = grobo_diagnostics_new(&mem, &list);
            if (result == 0) {
                result = read_result(samples[i], &options, list);
            }
            grobo_diagnostics_free(list);
            assert_true(result == GROBO_ERR_NOMEM || result == 0);
            assert_int_equal(counter.bytes, 0);
        }
    }
}

/* Cut at every byte: a motion or an error with a place, and nothing left behind. */
TEST(test_cut_anywhere)
{
    for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
        size_t size = strlen(samples[i]);
        for (size_t cut = 0; cut < size; cut++) {
            counted_mem counter = {0};
            grobo_mem mem = counted_mem_of(&counter);
            grobo_diagnostics *list = NULL;
            grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem};
            grobo_motion *motion = NULL;
            char *exact = malloc(cut > 0 ? cut : 1);
            memcpy(exact, samples[i], cut);
            assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
            int result = grobo_motion_read_memory(exact, cut, &options, list, &motion);
            assert_true(result == 0 || grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR) > 0);
            grobo_motion_free(motion);
            grobo_diagnostics_free(list);
            free(exact);
            assert_int_equal(counter.bytes, 0);
        }
    }
}

/* ---- malformed in every place -------------------------------------------------------------- */

/* Reads it: a motion, or an error with a place; nothing left behind. @return true if refused. */
static bool refused(const char *text)
{
    counted_mem counter = {0};
    grobo_mem mem = counted_mem_of(&counter);
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .mem = &mem};
    grobo_motion *motion = NULL;
    grobo_diagnostics *list = NULL;
    grobo_diagnostic first;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    int result = grobo_motion_read_memory(text, strlen(text), &options, list, &motion);
    if (result < 0) {
        assert_int_equal(grobo_diagnostics_get(list, 0, &first), 0);
        assert_true(first.line > 0 && first.column > 0);
    }
    grobo_motion_free(motion);
    grobo_diagnostics_free(list);
    assert_int_equal(counter.bytes, 0);
    return result < 0;
}

/* A line of its own for each key, so that lines can be taken away and values replaced. */
static const char *const keyed[] = {
    "type: PoseSeq\nname: t\nrefs:\n"
    "  -\n    time: 1\n    maxTransitionTime: 0.5\n    refer:\n      type: Pose\n"
    "      name: a\n      joints: [ 0 ]\n      q: [ 1 ]\n      spJoints: [ 0 ]\n      ikLinks:\n"
    "        -\n          name: WAIST\n          index: 0\n          isBaseLink: true\n"
    "          isStationaryPoint: true\n          translation: [ 0, 0, 0 ]\n"
    "          rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]\n          isTouching: true\n"
    "          partingDirection: [ 0, 0, 1 ]\n          isSlave: true\n"
    "      zmp: [ 0, 0, 0 ]\n      isZmpStationaryPoint: true\n",
    "type: CompositeSeq\ncontent: BodyMotion\nformat_version: 4\ncomponents:\n"
    "  -\n    type: MultiValueSeq\n    content: JointDisplacement\n    frame_rate: 30\n"
    "    num_frames: 1\n    num_parts: 1\n    has_frame_time: true\n    frames: [ [ 0, 1 ] ]\n"};

/* Keys that may be missing; all others are missed. */
static bool may_miss(const char *line)
{
    static const char *const keys[] = {"name: ",
                                       "maxTransitionTime: ",
                                       "spJoints: ",
                                       "index: ",
                                       "isBaseLink: ",
                                       "isStationaryPoint: ",
                                       "isTouching: ",
                                       "partingDirection: ",
                                       "isSlave: ",
                                       "zmp: ",
                                       "isZmpStationaryPoint: ",
                                       "num_frames: ",
                                       "translation: ",
                                       "rotation: ",
                                       "content: BodyMotion",
                                       "type: PoseSeq",
                                       "frame_rate: "};

    line += strspn(line, " ");
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (strncmp(line, keys[i], strlen(keys[i])) == 0) {
            return true;
        }
    }
    return false;
}

TEST(test_each_key_missing)
{
    for (size_t i = 0; i < sizeof keyed / sizeof keyed[0]; i++) {
        for (const char *line = keyed[i]; *line != '\0'; line = strchr(line, '\n') + 1) {
            char text[2000];
            const char *end = strchr(line, '\n') + 1;
            if (end[-2] == ':' || end[-2] == '-') {
                continue; /* what hangs on it would hang on something else */
            }
            (void)snprintf(text, sizeof text, "%.*s%s", (int)(line - keyed[i]), keyed[i], end);
            if (refused(text) == may_miss(line)) {
                fail_msg("without %.*s it is %s", (int)(end - line), line,
                         may_miss(line) ? "refused" : "taken");
            }
        }
    }
}

/* A value of another kind in each place: refused, but where a text may be any text. */
TEST(test_each_value_of_the_wrong_kind)
{
    static const char *const wrong[] = {"{ a: b }", "[ [ x ] ]", "x y", ".nan", "-1e400", "*no"};
    for (size_t i = 0; i < sizeof keyed / sizeof keyed[0]; i++) {
        for (const char *line = keyed[i]; *line != '\0'; line = strchr(line, '\n') + 1) {
            const char *end = strchr(line, '\n');
            const char *value = strstr(line, ": ");
            const char *key = line + strspn(line, " ");
            /* A ref of an unknown type is skipped, and the refs say what the file is. */
            bool any_text = strncmp(key, "name: ", 6) == 0 ||
                            strncmp(key, "type: Pose\n", 11) == 0 ||
                            strncmp(key, "type: PoseSeq\n", 14) == 0;
            if (value == NULL || value > end) {
                continue;
            }
            for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
                char text[2000];
                bool is_text = k >= 2 && k <= 4;
                (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(value + 2 - keyed[i]), keyed[i],
                               wrong[k], end);
                if (!refused(text) && !(any_text && is_text)) {
                    fail_msg("%.*s as %s is taken", (int)(end - line), line, wrong[k]);
                }
            }
        }
    }
}

/* ---- the reference material --------------------------------------------------------------- */

/* Every file of the list does what its last column says. */
TEST(test_edge_files)
{
    size_t size, files = 0;
    char *table = file_text(shared_file("data/edge/expected.tsv"), &size);
    char *next = NULL;

    assert_non_null(table);
    for (char *line = strtok_r(table, "\n", &next); line != NULL;
         line = strtok_r(NULL, "\n", &next)) {
        char name[128], path[4096];
        const char *tab = strchr(line, '\t');
        if (line[0] == '#' || tab == NULL || strchr(tab + 1, '\t') == NULL) {
            continue;
        }
        const char *expected = strchr(tab + 1, '\t') + 1;
        (void)snprintf(name, sizeof name, "data/edge/%.*s", (int)(tab - line), line);
        (void)snprintf(path, sizeof path, "%s", shared_file(name));
        grobo_diagnostics *list = NULL;
        grobo_motion *motion = NULL;
        assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
        int result = grobo_motion_read_file(path, NULL, list, &motion);
        bool refuse = strncmp(expected, "refuse", 6) == 0;
        bool warn = strstr(expected, "warn") != NULL;
        if (result == 0 && warn) {
            (void)grobo_motion_check(motion, &grobo_i_gr001_model, NULL, list);
        }
        grobo_diagnostic first;
        bool placed =
            grobo_diagnostics_get(list, 0, &first) == 0 && first.line > 0 && first.column > 0;
        if (refuse != (result < 0) || (refuse && !placed) ||
            (!refuse && warn != (grobo_diagnostics_total(list, GROBO_SEVERITY_WARNING) > 0))) {
            fail_msg("%s: %s, expected: %s", path, grobo_error_name(result), expected);
        }
        grobo_motion_free(motion);
        grobo_diagnostics_free(list);
        files++;
    }
    assert_true(files > 50);
    free(table);
}
