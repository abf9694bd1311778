#!/bin/sh
# SPDX-License-Identifier: MIT
# The command under valgrind: no error, no leak, whatever way it ends.
. tests/support/cli.sh

all_skipped() {
    echo "1..0 # SKIP $1"
    exit
}
command -v valgrind >/dev/null 2>&1 || all_skipped "no valgrind"
[ -z "${EMULATOR:-}" ] || all_skipped "the command is of another machine"
grep -q __asan_init "$GRCTL" && all_skipped "built with a sanitizer"

# clean STATUS ARGUMENTS...
clean() {
    clean_status=$1
    shift
    # What is slow by valgrind and by a busy machine too ends a motion, as it has to: again then.
    for _ in 1 2 3 4 5; do
        exits "$clean_status" timeout 100 valgrind -q --leak-check=full --error-exitcode=99 \
            "$GRCTL" "$@" >"$work/why"
        clean_got=$?
        grep '^==' "$work/err" && return 1
        [ $clean_got -ne 0 ] && grep -q 'host stalled' "$work/err" || break
    done
    [ $clean_got -eq 0 ] || cat "$work/why"
    return $clean_got
}

while read -r status line; do
    # $line is a command line, to be split.
    # shellcheck disable=SC2086
    test_that "grctl $line" clean $status $line
done <<END
0 -d sim status
0 -d sim --json init --time 300
0 -d sim --on-exit sit play --key --speed 500 motions/step.pseq
0 play --dry-run --rate 10 motions/greet.pseq
0 convert --to m motions/greet.pseq -
1 -d /dev/none status
2 -d sim move m5
3 play /dev/none
4 -d sim move m5 120
END
done_testing
