#!/bin/sh
# SPDX-License-Identifier: MIT
# Whichever one allocation of a command fails, in its own code or in that of a library: it ends in
# time, by itself, with a status and a reason that say so, a stop says of no joint that goes on that
# it stands, and the robot that was driven stands a moment later.
#
# Environment: ALLOCATIONS=all fails each allocation of the commands that drive a robot (make
# nightly); without it some, spread over all of them.
. tests/support/cli.sh
. tests/support/registers.sh

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
test_case "each allocation of a short command"
check 'status' each_fails 90 status
check 'a move' each_fails 110 move elbow_flex 10 50
check 'an emergency stop' each_fails 60 estop

test_case "allocations of commands that drive a robot"
start_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }
cat >"$work/two.pseq" <<'PSEQ'
type: PoseSeq
name: "two"
refs:
  - time: 0
    refer: { type: Pose, name: "", joints: [ 2, 3 ], q: [ 0, 0 ] }
  - time: 0.3
    refer: { type: Pose, name: "", joints: [ 2, 3 ], q: [ 0.3, -0.3 ] }
PSEQ

# Each runs the command with what is loaded first, and prints what a person would read.
plays() {
    LD_PRELOAD=$work/nth.so timeout 60 "$GRCTL" --robot so101 -d "$robot" play "$work/two.pseq" \
        </dev/null 2>&1
}
records() {
    rm -f "$work/kept.yaml"
    printf ' q' | LD_PRELOAD=$work/nth.so timeout 60 "$GRCTL" --robot so101 -d "$robot" \
        record -o "$work/kept.yaml" -k 2>&1
}
# Its screen is drawn on a terminal of its own. Where that cannot be set up it is `status --watch`,
# which Ctrl-C ends.
monitors() {
    monitors_env="TERM=xterm LD_PRELOAD=$work/nth.so FAIL_AT=$FAIL_AT COUNT_TO=$work/count"
    { printf q; sleep 0.5; printf '\003'; } | timeout 60 script -qec \
        "env $monitors_env '$GRCTL' --robot so101 -d $robot monitor" /dev/null
}

# stands: none of its joints turns.
stands() {
    "$GRCTL" --robot so101 -d "$robot" --timeout 2000 status >"$work/status" 2>&1 &&
        awk '$1 ~ /^[0-9]+$/ { joints++; turning += $6 != 0 } END { exit joints != 6 || turning }' \
            "$work/status"
}

# point_fails N RUN: the N-th allocation fails.
point_fails() {
    export FAIL_AT="$1"
    "$2" >"$work/out"
    status=$?
    failed=$((failed + (status != 0)))
    [ $status -ne 130 ] || status=0 # it was interrupted, and ended
    if [ $status -ge 124 ] ||
        { [ $status -ne 0 ] && ! grep -qi "grctl\|memory" "$work/out"; }; then
        echo "allocation $1 of $2: status $status"
        sed -n '1,5p' "$work/out"
        return 1
    fi
    wait_for stands || {
        echo "allocation $1 of $2: the robot does not stand"
        return 1
    }
}

# points_fail RUN: so many of all that it makes without a failure, the first and the last too.
points_fail() {
    export FAIL_AT=0 COUNT_TO="$work/count"
    rm -f "$work/count"
    "$1" >"$work/out" || {
        cat "$work/out"
        return 1
    }
    total=$(sort -n "$work/count" | tail -n 1) # the guard's are fewer
    points=8
    [ "${ALLOCATIONS:-}" = all ] && points=$total
    failed=0
    point=0
    while [ $point -lt "$points" ]; do
        point_fails $((1 + point * (total - 1) / (points - 1))) "$1" || return 1
        point=$((point + 1))
    done
    echo "$points of $total allocations failed: $failed ended the command"
    [ $failed -gt 0 ]
}
check 'a motion' points_fail plays
check 'a recording' points_fail records
if script -qec true /dev/null </dev/null >/dev/null 2>&1; then
    check 'the monitor' points_fail monitors
else
    skip 'the monitor' 'no script(1)'
fi
done_testing
