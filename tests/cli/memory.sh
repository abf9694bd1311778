#!/bin/sh
# SPDX-License-Identifier: MIT
# Whichever one allocation of a command fails: it ends in time, by itself, with a status that says
# so, and a stop says of no joint that goes on that it stands.
. tests/support/cli.sh

all_skipped() {
    echo "1..0 # SKIP $1"
    exit
}
[ -z "${EMULATOR:-}" ] || all_skipped "the command is of another machine"
grep -q __asan_init "$GRCTL" && all_skipped "built with a sanitizer"
${CC:-cc} -shared -fPIC -o "$work/nth.so" tests/cli/nth_allocation.c 2>"$work/said" ||
    all_skipped "no library to load first can be built"
LD_PRELOAD=$work/nth.so "$GRCTL" --version >"$work/out" 2>&1 ||
    all_skipped "allocations are not those of glibc"

# failing N ARGUMENTS...: the N-th allocation fails. Status above 123: late, or ended by a signal.
failing() {
    failing_at=$1
    shift
    FAIL_AT=$failing_at LD_PRELOAD=$work/nth.so timeout 30 "$GRCTL" "$@" >"$work/out" \
        2>"$work/err" </dev/null
    status=$?
    failed=$((failed + (status != 0)))
    [ $status -lt 124 ] && { [ $status -eq 0 ] || [ -s "$work/err" ]; } && return
    echo "allocation $failing_at of grctl $*: status $status"
    sed -n '1,5p' "$work/err"
    return 1
}

# each_fails MOST ARGUMENTS...: of so many allocations some are such that the command cannot go on.
each_fails() {
    most=$1
    shift
    n=0
    failed=0
    while [ $n -lt "$most" ]; do
        n=$((n + 1))
        failing $n --robot so101 -d sim "$@" || return 1
    done
    [ $failed -gt 5 ]
}
test_that 'status' each_fails 90 status
test_that 'a move' each_fails 110 move elbow_flex 10 50
test_that 'an emergency stop' each_fails 60 estop
done_testing
