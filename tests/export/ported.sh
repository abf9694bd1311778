#!/bin/sh
# SPDX-License-Identifier: MIT
# The programs of docs/examples/classic, which are ported from C++: they do on a simulated robot
# what they say, and docs/guide/from-original.md tells how many lines are not those of the C++.
# With the original's sources in $GROBO_ORIGINAL the C++ compiles with them.
. tests/support/tap.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
examples=docs/examples/classic

# prints PATTERN... --- PROGRAM ARGUMENT...: it ends well, and prints lines like these.
prints() {
    for pattern in "$@"; do
        [ "$pattern" != --- ] || break
        printf '%s\n' "$pattern" >>"$work/patterns"
    done
    while [ "$1" != --- ]; do
        shift
    done
    name=$2
    shift 2
    ${EMULATOR:-} "$BUILD/$examples/$name" "$@" >"$work/output" 2>&1 || {
        cat "$work/output"
        return 1
    }
    while read -r pattern; do
        grep -q -x -e "$pattern" "$work/output" || {
            echo "no line '$pattern'"
            cat "$work/output"
            return 1
        }
    done <"$work/patterns"
    rm "$work/patterns"
}
told_lines() {
    for program in "$examples"/*.c; do
        name=$(basename "$program" .c)
        changed=$(diff "$examples/$name.cpp.txt" "$program" | grep -c '^>')
        total=$(wc -l <"$program")
        grep -q "^| \[$name\](.* | $changed of $((total)) |$" docs/guide/from-original.md || {
            echo "$name: $changed of $((total)) lines"
            return 1
        }
    done
}
cxx_compiles() {
    : >"$work/tchar.h"
    for program in "$examples"/*.cpp.txt; do
        ${CXX:-g++} -w -fpermissive -std=gnu++11 '-D__declspec(x)=' -DGR001_EXPORTS -I"$work" \
            -I"$GROBO_ORIGINAL/libgrobot/include" -x c++ -fsyntax-only "$program" || return 1
    done
}

test_that 'stand' prints 'knee pitch *-38\.0 *38\.0' --- stand sim
test_that 'nod' prints 'neck at -\{0,1\}\(19[0-9]\|20[0-9]\)' 'neck at -\{0,1\}[0-3]' --- nod sim
printf '300  0 100 200 0 -200 -200 0 200 0 200 0 -400 -200 0 0 -200 0 400 200 0\n' >"$work/a.m"
printf '600  0 0 200 0 -200 -200 0 200 0 200 0 -400 -200 0 0 -200 0 400 200 0\n' >>"$work/a.m"
test_that 'perform' prints '2 postures' --- perform sim "$work" a 2
two_postures() {
    printf '\n\n' | prints 'posture 1' 'posture 2' '2 saved' --- learn sim "$work" b &&
        [ "$(wc -l <"$work/b.m")" -eq 2 ]
}
test_that 'learn' two_postures
console() {
    printf '%s\n' 'i' 's 1' 'm 2 100 50' 'a 2' 'p 30 0 -50 200 0 -200 -200 0 200' 'a 2' 'l a' \
        'r 1' 'c c' 'q' | prints '9[0-9]\|10[0-9]' '-[45][0-9]' 2 --- console sim "$work" &&
        [ "$(wc -l <"$work/c.m")" -eq 3 ]
}
test_that 'console' console
test_that 'the guide tells how many lines are new' told_lines
# The original's sources are not free to be handed on: measured by who has them.
[ ! -d "${GROBO_ORIGINAL:-}/libgrobot" ] ||
    test_that 'the C++ compiles with the original' cxx_compiles
done_testing
