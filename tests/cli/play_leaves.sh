#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl play: how it leaves, by signals and where nobody answers.
. tests/support/cli.sh

greet=motions/greet.pseq
start_sim

test_case "how it leaves"

# interrupted STATUS POLICY SIGNAL...: in mid-motion; the status tells, the policy was carried out.
interrupted() {
    interrupted_want=$1
    interrupted_policy=$2
    shift 2
    rm -f "$work/out" "$work/leaving"
    "$GRCTL" -d "$robot" -v --json --retries 10 --on-exit "$interrupted_policy" \
        play --speed 50 "$greet" >"$work/out" 2>"$work/leaving" &
    interrupted_pid=$!
    written "$work/out" '"t_ms":[1-9]' || { cat "$work/leaving"; return 1; }
    for interrupted_signal in "$@"; do
        kill -s "$interrupted_signal" $interrupted_pid
    done
    wait $interrupted_pid
    interrupted_got=$?
    [ $interrupted_got -eq "$interrupted_want" ] &&
        grep -q '^interrupted: the servos ' "$work/leaving" && return
    echo "status $interrupted_got, not $interrupted_want"
    cat "$work/out" "$work/leaving"
    return 1
}
check "SIGINT, to hold: 130" interrupted 130 hold INT
check_json "all hold, at a standstill" \
    'all(j["torque"] == "on" and j["speed_dps"] == 0 for j in lines[0]["joints"])' \
    on_robot --json status
check "SIGTERM, torque off: 143" interrupted 143 off TERM
check_json "all are off" 'all(j["torque"] == "off" for j in lines[0]["joints"])' \
    on_robot --json status
check "SIGHUP, to hold: 129" interrupted 129 hold HUP
check "SIGQUIT, torque off: 131" interrupted 131 off QUIT
check "SIGINT again while it leaves changes nothing" interrupted 130 off INT INT INT
check_json "all are off again" 'all(j["torque"] == "off" for j in lines[0]["joints"])' \
    on_robot --json status
check "SIGINT, to sit down: 130" interrupted 130 sit INT
check_json "the knees are bent, the torque is off" \
    '[abs(j["angle_deg"]) > 60 for j in lines[0]["joints"] if "KNEE" in j["name"]] == [True] * 2
     and all(j["torque"] == "off" for j in lines[0]["joints"])' on_robot --json status

# A robot that has fallen silent: nobody knows what its servos do, and the status says so.
silent() {
    rm -f "$work/out" "$work/leaving"
    "$GRCTL" -d "$robot" -v --json --retries 2 play --speed 50 "$greet" \
        >"$work/out" 2>"$work/leaving" &
    silent_pid=$!
    written "$work/out" '"t_ms":[1-9]' || { cat "$work/leaving"; return 1; }
    kill -s STOP "$sim_pid"
    kill -s INT $silent_pid
    wait $silent_pid
    silent_got=$?
    kill -s CONT "$sim_pid"
    [ $silent_got -eq 1 ] && grep -q 'could not be left as asked' "$work/leaving"
}
check "SIGINT, and nobody answers: 1" silent
stop_sim
done_testing
