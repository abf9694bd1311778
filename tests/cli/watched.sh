#!/bin/sh
# SPDX-License-Identifier: MIT
# A command that moves the robot reads the joints while they move: heat, low voltage and a joint
# that is blocked end the move. Motions that are played are in engine/test_watched.c.
. tests/support/cli.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# stops PATTERN TELL... --- COMMAND...: while that moves R_ELBOW_P for 20 s, the simulator is told
# so. Exit status 4, a message like that, and the joint stands on its way.
stops() {
    stops_pattern=$1
    shift
    stops_told=
    while [ "$1" != --- ]; do
        stops_told="$stops_told $1"
        shift
    done
    shift
    exits 0 on_robot init --time 500 || return 1
    on_robot "$@" >"$work/out" 2>"$work/err" </dev/null &
    stops_pid=$!
    # Words of the simulator's console.
    # shellcheck disable=SC2086
    wait_for sim_shows 5 ' -[2-9][0-9]\.[0-9] .*, moving' && tell $stops_told
    wait $stops_pid
    status_was 4 "$@" && complains "$stops_pattern" && ! sim_shows 5 moving
}
heat='stopped for safety: over-temperature .* at motor 12 (R_KNEE_P)'
# recovers TELL...: told so, the robot moves again.
recovers() {
    tell "$@" && exits 0 on_robot init --time 500
}

test_case "heat of another joint ends a move"
check "heat of another joint ends a move" stops "$heat" temperature 12 70 --- move m5 -120 20000
check "it moves again when it is cool" recovers temperature 12 25
test_case "low voltage ends a pose"
check "low voltage ends a pose" stops 'stopped for safety: low voltage' voltage 5 --- \
    --json pose --time 20000 R_ELBOW_P=-120
if have_json; then
    check "and JSON says why" json 'lines[-1]["error"]["code"] == "latched" and
        lines[-1]["error"]["trip"] == "low_voltage"'
else
    skip "and JSON says why" "no python3"
fi
check "it moves again with a full battery" recovers voltage 7.4
test_case "a joint that is blocked ends a move"
check "a joint that is blocked ends a move" stops 'stopped for safety: .*motor 5 (R_ELBOW_P)' \
    block 5 on --- move m5 -120 20000
check "it moves again when it is free" recovers block 5 off

# The way to the initial posture is as long as the approach from here.
hot_init() {
    exits 0 on_robot move m5 -120 500 || return 1
    on_robot init --time 20000 >"$work/out" 2>"$work/err" </dev/null &
    hot_pid=$!
    wait_for sim_shows 5 ' -1*[0-9][0-9]\.[0-9] .*, moving' && tell temperature 12 70
    wait $hot_pid
    status_was 4 init && complains "$heat" && ! sim_shows 5 moving
}
test_case "heat ends init"
check "heat ends init" hot_init
check "it moves again then too" recovers temperature 12 25

# A servo that has cut its torque says so until its torque is written, however cold it is.
cold_and_flagged() {
    exits 0 on_robot servo on && tell temperature 12 90 && exits 4 on_robot servo on m12 &&
        tell temperature 12 25 && exits 4 on_robot servo on m12 &&
        complains "servo overheated (25 deg C) at motor 12 .*then 'grctl servo off m12'" &&
        on_robot status >"$work/out" && grep -q "R_KNEE_P .*cut its torque for heat" "$work/out" &&
        exits 1 on_robot doctor &&
        grep -q "grctl servo off m12; if it is reported again" "$work/out"
}
test_case "a servo that was too hot says what clears it"
check "a servo that was too hot says what clears it" cold_and_flagged
clears() {
    exits 0 on_robot servo off m12 && exits 0 on_robot servo on m12 &&
        exits 0 on_robot init --time 500
}
check "that clears it" clears

stop_sim
done_testing
