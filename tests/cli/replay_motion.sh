#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl replay: a whole motion runs again on a robot, and frames of torque that come long behind the
# last reading.
. tests/support/cli.sh
. tests/support/traces.sh

test_case 'a motion to a robot'

# An adapter hands over a reply in one piece: on a busy machine it could stand still in its middle
# for so long that it is cut there.
start_told_sim --latency 16 || { echo "Bail out! the simulator did not start"; exit 1; }

# Only the first target is held to the approach speed.
"$GRCTL" -d sim --timeout 500 -q --trace "$work/greet" play --key motions/greet.pseq >"$work/out"
# Frames are sent once: on a busy machine one reply in hundreds comes too late, rarely in each run.
whole_motion() {
    for _ in 1 2 3; do
        exits 0 on_robot init --time 500
        exits 1 on_robot replay --yes "$work/greet" && says ' 0 missing, 0 extra' && return
    done
    return 1
}
check 'a whole motion is replayed' whole_motion

test_case 'torque, long behind the last reading'
# The engine takes torque only for a joint read just now: replay reads it, and compares nothing.
on='53 09 FA AF 0C 00 24 01 01 01 29' # torque of R_KNEE_P
torque_late() {
    printf 'out %d %s\n' 0 "$on" 3000000 "$on" | make_trace >"$work/late"
    exits 0 on_robot --yes replay "$work/late" &&
        says '^2 frames sent, 0 call for a reply' && ! says 'nobody asked'
}
check 'torque is sent though the joint was read a while ago' torque_late
# That reading is asked again where its reply is lost.
torque_late_and_lost() {
    printf 'out %d %s\n' 0 "$on" 2000000 "$on" 4000000 "$on" 6000000 "$on" |
        make_trace >"$work/lost"
    tell fault silent=0.4
    "$GRCTL" -d "$robot" --timeout 200 --retries 20 --yes replay "$work/lost" >"$work/out" \
        2>"$work/err"
    lost_status=$?
    tell fault silent=0
    [ $lost_status -eq 0 ] && says '^4 frames sent, 0 call for a reply' || {
        cat "$work/out" "$work/err"
        return 1
    }
}
check 'a lost reply does not keep it from being sent' torque_late_and_lost
shows_how_far() {
    script -qec "stty cols 60; '$GRCTL' -d '$robot' --timeout 500 --yes replay '$work/late'" \
        /dev/null </dev/null >"$work/screen" && grep -q 'replay: [0-9.]* of 3\.0 s' "$work/screen"
}
if command -v script >/dev/null 2>&1 && script -qec true /dev/null </dev/null >/dev/null 2>&1; then
    check 'a terminal shows how far it is' shows_how_far
else
    skip 'a terminal shows how far it is' 'no script(1) to make a terminal'
fi
done_testing
