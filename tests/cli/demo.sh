#!/bin/sh
# SPDX-License-Identifier: MIT
# What make demo shows, once everything is built.
. tests/support/cli.sh

mkdir "$work/tmp"
demo() {
    TMPDIR=$work/tmp timeout 60 tools/demo.sh "$GRCTL" "$@"
}
test_case "the demo plays and tells how it went"
check "the demo" exits 0 demo motions/greet.pseq --speed 400
check "it says where the robot is" says '^A simulated GR001 stands behind /dev/.*115200 bps\.$'
check "it says what is played" says '^Playing motions/greet.pseq:$'
check "each joint got there: name, target, reached, error" \
    [ "$(grep -c '^ *[0-9]*  [A-Z_]*  *-*[0-9.]*  *-*[0-9.]*  *-*0\.0[0-9]*$' "$work/out")" -eq 20 ]
check "frames, late ones, jitter" says '^[0-9]* frames, [0-9]* late; jitter p50 [0-9]* us, p99 '
check "no terminal: nothing on standard error" [ ! -s "$work/err" ]
bad_motion() {
    exits 3 demo /dev/none && complains '^grctl: /dev/none: no such file$'
}
test_case "a motion that is none"
check "a motion that is none: its status, one line" bad_motion
check "nothing is left behind" [ -z "$(ls -A "$work/tmp")" ]
done_testing
