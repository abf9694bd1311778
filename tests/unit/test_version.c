/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include <grobo/version.h>

static void string_is_made_of_the_three_numbers(void **state)
{
    (void)state;
    char expected[32];
    int n = snprintf(expected, sizeof expected, "%d.%d.%d", GROBO_VERSION_MAJOR,
                     GROBO_VERSION_MINOR, GROBO_VERSION_PATCH);
    assert_in_range(n, 5, sizeof expected - 1);
    assert_string_equal(GROBO_VERSION_STRING, expected);
}

static void library_has_the_version_of_its_headers(void **state)
{
    (void)state;
    assert_string_equal(grobo_version(), GROBO_VERSION_STRING);
}

static void numbers_compare_as_versions_do(void **state)
{
    (void)state;
    assert_true(GROBO_VERSION_MINOR < 100);
    assert_true(GROBO_VERSION_PATCH < 100);
    assert_int_equal(GROBO_VERSION_NUMBER / 10000, GROBO_VERSION_MAJOR);
    assert_int_equal(GROBO_VERSION_NUMBER / 100 % 100, GROBO_VERSION_MINOR);
    assert_int_equal(GROBO_VERSION_NUMBER % 100, GROBO_VERSION_PATCH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(string_is_made_of_the_three_numbers),
        cmocka_unit_test(library_has_the_version_of_its_headers),
        cmocka_unit_test(numbers_compare_as_versions_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
