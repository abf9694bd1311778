/* SPDX-License-Identifier: MIT */
/* A body is taken whole or refused: which field, and what was expected. */
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/web/fields.h"

static const field torque[] = {
    {.name = "joints", .kind = FIELD_JOINTS, .needed = true},
    {.name = "mode", .kind = FIELD_WORD, .needed = true, .words = "on, off, brake"},
    FIELD_SEQUENCE,
    {.name = NULL}};
static const field all[] = {{.name = "text", .kind = FIELD_TEXT, .most = 4},
                            {.name = "flag", .kind = FIELD_FLAG},
                            {.name = "number", .kind = FIELD_NUMBER, .least = -1, .most = 1},
                            {.name = "whole", .kind = FIELD_WHOLE, .least = 1, .most = 1000},
                            {.name = "angles", .kind = FIELD_ANGLES},
                            {.name = "three", .kind = FIELD_NUMBERS, .least = 3, .most = 3},
                            {.name = "none", .kind = FIELD_NUMBERS, .nullable = true, .most = 9},
                            {.name = "list", .kind = FIELD_LIST},
                            {.name = "object", .kind = FIELD_OBJECT},
                            {.name = NULL}};
static const field nothing[] = {{.name = NULL}};

static char said[FIELDS_TEXT_BYTES];

static bool fit(const char *text, const field *fields, const char *what)
{
    json_t *body = json_loads(text, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, NULL);
    assert_non_null(body);
    *said = '\0';
    bool fits = fields_fit(body, fields, what, said);
    assert_true(fits == (*said == '\0'));
    json_decref(body);
    return fits;
}

static void refused(const char *text, const field *fields, const char *why)
{
    assert_false(fit(text, fields, "torque"));
    assert_string_equal(said, why);
}

TEST(what_is_whole_is_taken)
{
    assert_true(
        fit("{\"joints\": [\"R_ELBOW_P\"], \"mode\": \"off\", \"sequence\": 7}", torque, "x"));
    assert_true(fit("{\"joints\": \"all\", \"mode\": \"on\", \"sequence\": 7}", torque, "x"));
    assert_true(fit("{\"joints\": [\"all\"], \"mode\": \"brake\", \"sequence\": 7}", torque, "x"));
    assert_true(fit("{}", nothing, "x"));
    assert_true(fit("{}", all, "x"));
    assert_true(
        fit("{\"text\": \"\", \"flag\": false, \"number\": -1, \"whole\": 1000, \"angles\": "
            "{\"A\": 1}, \"three\": [1, 2.5, -3], \"none\": null, \"list\": [], "
            "\"object\": {}}",
            all, "x"));
}

/* What dropped all joints of a robot. */
TEST(joints_that_are_none_do_not_mean_all)
{
    static const char *const wrong[] = {
        "\"R_ELBOW_P\"",         "[]",      "{}",  "null", "0", "true", "[1]",
        "[\"R_ELBOW_P\", null]", "\"ALL\"", "\"\""};
    char body[128];
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        snprintf(body, sizeof body, "{\"joints\": %s, \"mode\": \"off\", \"sequence\": 7}",
                 wrong[i]);
        refused(body, torque,
                "torque: joints is not valid; expected a list of names of joints or groups, or "
                "\"all\"");
    }
    refused("{\"mode\": \"off\", \"sequence\": 7}", torque,
            "torque: joints is missing; expected a list of names of joints or groups, or \"all\"");
    refused("{\"joint\": [\"R_ELBOW_P\"], \"mode\": \"off\", \"sequence\": 7}", torque,
            "torque: unknown field 'joint'; expected joints, mode, sequence");
}

TEST(each_type_and_range_is_checked)
{
    static const char *const wrong[] = {"{\"text\": 1}",
                                        "{\"text\": \"five!\"}",
                                        "{\"text\": null}",
                                        "{\"flag\": 1}",
                                        "{\"flag\": \"true\"}",
                                        "{\"number\": 1.01}",
                                        "{\"number\": \"1\"}",
                                        "{\"number\": -1e300}",
                                        "{\"whole\": 0}",
                                        "{\"whole\": 1.5}",
                                        "{\"whole\": true}",
                                        "{\"angles\": {}}",
                                        "{\"angles\": [1]}",
                                        "{\"angles\": {\"A\": \"1\"}}",
                                        "{\"angles\": {\"A\": null}}",
                                        "{\"three\": [1, 2]}",
                                        "{\"three\": [1, 2, 3, 4]}",
                                        "{\"three\": [1, 2, \"3\"]}",
                                        "{\"three\": {}}",
                                        "{\"three\": null}",
                                        "{\"none\": [null]}",
                                        "{\"list\": {}}",
                                        "{\"object\": []}",
                                        "{\"object\": null}",
                                        "{\"Text\": \"\"}",
                                        "{\"\": 1}"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_false(fit(wrong[i], all, "x"));
    }
    refused("{\"joints\": \"all\", \"mode\": \"o\", \"sequence\": 7}", torque,
            "torque: mode is not valid; expected one of on, off, brake");
    refused("{\"joints\": \"all\", \"mode\": \"on, off\", \"sequence\": 7}", torque,
            "torque: mode is not valid; expected one of on, off, brake");
    refused("{\"joints\": \"all\", \"mode\": \"on\", \"sequence\": 0}", torque,
            "torque: sequence is not valid; expected a whole number, 1 or more");
    refused("{\"joints\": \"all\", \"mode\": \"on\"}", torque,
            "torque: sequence is missing; expected a whole number, 1 or more");
    refused("[]", torque, "torque: it is no object; expected {\"joints\": ...}");
    refused("{\"x\": 1}", nothing, "torque: unknown field 'x'; expected none");
}

TEST(a_complaint_fits_and_has_whole_characters)
{
    static const char wide[] = "\xe3\x81\x82";
    char body[1024] = "{\"";
    size_t n = 2;
    for (int i = 0; i < 200; i++, n += 3) {
        memcpy(body + n, wide, 3);
    }
    snprintf(body + n, sizeof body - n, "\\n\": 1}");
    assert_false(fit(body, all, "a route with a long name"));
    assert_true(strlen(said) < FIELDS_TEXT_BYTES);
    json_t *whole = json_string(said); /* which checks UTF-8 */
    assert_non_null(whole);
    json_decref(whole);
    assert_false(fit("{\"a\\u001b[2J\": 1}", nothing, "x"));
    assert_string_equal(said, "x: unknown field 'a?[2J'; expected none");
}
