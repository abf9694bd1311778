#!/bin/sh
# SPDX-License-Identifier: MIT
# Which sources of tests may hold a test that is called so: by the file's name, by the names in it,
# or with rows that only the program knows. tests/run.sh asks the programs. A blank, a hyphen and an
# underscore are alike.
#
# usage: tests/only.sh WORD FILE...
set -u

word=$(printf %s "$1" | sed 's/[][\\.*^$]/\\&/g; s/[-_ ]/[-_ ]/g')
shift
{
    printf '%s\n' "$@" | grep -e "/[^/]*$word[^/]*\$"
    # A name that is long stands in a line of its own.
    grep -l -e "^TEST.*$word" -e "^ *[a-z0-9_]*$word[a-z0-9_]*)\$" \
        -e '^TEST_FOR(' -e '^TEST_EACH(' -e "^ *test_case .*$word" \
        -e "^ *test_that .*$word" /dev/null "$@"
} | sort -u
