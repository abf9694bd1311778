#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: docs/seed-map.md has each of the reference document's 190 members once, with symbols that a
# public header declares and tests that are there. Where the reference material stands beside the
# checkout, the members' names are compared too. The rules are in seed_map.awk.
set -u

gates=$(dirname "$0")
members=${GROBO_SHARED:-../shared}/seed/members.tsv
[ -r "$members" ] || members=
# The names of headers have no blanks.
# shellcheck disable=SC2046
awk -v members="$members" -f "$gates/strip.awk" -f "$gates/named_tests.awk" \
    -f "$gates/seed_map.awk" \
    include/grobo/*.h \
    $(ls include/grobo/*/*.h ports/posix/include/grobo/*/*.h 2>/dev/null) docs/seed-map.md
