/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include <grobo/version.h>

#include "tests/support/test.h"

TEST(string_is_made_of_the_three_numbers)
{
    char expected[32];
    int n = snprintf(expected, sizeof expected, "%d.%d.%d", GROBO_VERSION_MAJOR,
                     GROBO_VERSION_MINOR, GROBO_VERSION_PATCH);
    assert_in_range(n, 5, sizeof expected - 1);
    assert_string_equal(GROBO_VERSION_STRING, expected);
}

TEST(library_has_the_version_of_its_headers)
{
    assert_string_equal(grobo_version(), GROBO_VERSION_STRING);
}

TEST(numbers_compare_as_versions_do)
{
    assert_true(GROBO_VERSION_MINOR < 100);
    assert_true(GROBO_VERSION_PATCH < 100);
    assert_int_equal(GROBO_VERSION_NUMBER / 10000, GROBO_VERSION_MAJOR);
    assert_int_equal(GROBO_VERSION_NUMBER / 100 % 100, GROBO_VERSION_MINOR);
    assert_int_equal(GROBO_VERSION_NUMBER % 100, GROBO_VERSION_PATCH);
}
