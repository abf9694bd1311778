/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/error.h>

#include "tests/support/test.h"

typedef struct row {
    const char *name;
    int value;
    int enumerator;
    const char *text;
} row;

static const row rows[] = {
#define ROW(name, value, text) {#name, (value), (int)GROBO_ERR_##name, (text)},
    GROBO_ERROR_LIST(ROW)
#undef ROW
};

enum { ROWS = (int)(sizeof rows / sizeof rows[0]) };

TEST(each_error_is_found_by_its_value)
{
    for (int i = 0; i < ROWS; i++) {
        assert_true(rows[i].value < 0);
        assert_int_equal(rows[i].enumerator, rows[i].value);
        assert_string_equal(grobo_error_name(rows[i].value), rows[i].name);
        assert_string_equal(grobo_error_text(rows[i].value), rows[i].text);
    }
}

TEST(values_names_and_texts_are_unique)
{
    for (int i = 0; i < ROWS; i++) {
        for (int k = i + 1; k < ROWS; k++) {
            assert_int_not_equal(rows[i].value, rows[k].value);
            assert_string_not_equal(rows[i].name, rows[k].name);
            assert_string_not_equal(rows[i].text, rows[k].text);
        }
    }
}

/* Values are binary interface: a list without gaps shows that nothing was removed or renumbered. */
TEST(values_count_down_from_minus_one)
{
    for (int i = 0; i < ROWS; i++) {
        assert_int_equal(rows[i].value, -1 - i);
    }
}

TEST(texts_are_phrases_that_fit_into_a_sentence)
{
    for (int i = 0; i < ROWS; i++) {
        size_t length = strlen(rows[i].text);
        assert_true(length > 0);
        assert_true(rows[i].text[0] >= 'a' && rows[i].text[0] <= 'z');
        assert_int_not_equal(rows[i].text[length - 1], '.');
    }
}

TEST(success_and_counts_are_ok)
{
    assert_string_equal(grobo_error_name(GROBO_OK), "OK");
    assert_string_equal(grobo_error_name(110), "OK");
    assert_string_equal(grobo_error_name(INT32_MAX), "OK");
    assert_string_equal(grobo_error_text(GROBO_OK), "success");
}

TEST(numbers_that_are_no_error_are_unknown)
{
    static const int strangers[] = {-1 - ROWS, -1000, INT32_MIN};
    for (size_t i = 0; i < sizeof strangers / sizeof strangers[0]; i++) {
        assert_string_equal(grobo_error_name(strangers[i]), "UNKNOWN");
        assert_string_equal(grobo_error_text(strangers[i]), "unknown error");
    }
}
