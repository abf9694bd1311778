#!/bin/sh
# SPDX-License-Identifier: MIT
# Commands on a simulated robot behind a pty: status, servo, init, move, and how they leave.
. tests/support/cli.sh

start_sim || { echo "Bail out! the simulator did not start"; exit 1; }
test_case "the state of the robot is shown"
check "sim keeps a link to its pty" [ "$(readlink "$work/robot")" = "$sim_pty" ]
check "sim says that it is none" written "$work/sim.log" SIMULATED

check "status shows a joint" both exits 0 on_robot status --- says '^ *12  R_KNEE_P  *-40\.0  .*off'
check "status of a group" both exits 0 on_robot status arms --- says 'L_ELBOW_P'
check "status of a joint that is none" fails 2 'no joint or group' on_robot status tail
check_json "status has 20 joints with their values" \
    'len(lines[0]["joints"]) == 20 and all(j["status"] == "ok" and j["torque"] == "off" and
     j["voltage_v"] > 7 and j["temperature_c"] == 25 for j in lines[0]["joints"])' \
    on_robot --json status
check_json "status counts frames" 'lines[0]["link"]["rx_frames"] == 2' on_robot --json status j3

# Who has seen enough of a stream closes the pipe: that ends it.
left_alone() {
    timeout 20 "$GRCTL" -d "$robot" --timeout 500 status --watch --interval 20 2>/dev/null |
        head -n 3 >"$work/out"
    says '^ *9  R_HIP_Y'
}
watch_ends() {
    left_alone && ! on_robot status 2>&1 | grep -q 'in use'
}
check "status --watch ends with its reader" watch_ends

test_case "torque is switched"
check "servo on" both exits 0 on_robot servo on right_arm --- true
check_json "torque stays on" '[j["torque"] for j in lines[0]["joints"]] == ["on"] * 3' \
    on_robot --json status 2
check_json "the others stay off" 'all(j["torque"] == "off" for j in lines[0]["joints"])' \
    on_robot --json status legs
check_json "servo brake" 'lines[0]["joints"][0]["torque"] == "brake"' \
    on_robot --json servo brake m5
check_json "servo off" 'lines[0]["joints"][0]["torque"] == "off"' \
    on_robot --json servo off R_ELBOW_P
check "servo up" fails 2 "'up' is not one of on, off, brake" on_robot servo up

test_case "joints are moved"
check_json "move gets there, and switches torque on" \
    'abs(lines[0]["joints"][0]["angle_deg"] + 60) <= 0.1 and lines[0]["max_error_deg"] <= 0.1' \
    on_robot --json move m5 -60 500
check_json "where it was moved, it stays" \
    'abs(lines[0]["joints"][0]["angle_deg"] + 60) <= 0.1 and
     lines[0]["joints"][0]["torque"] == "on"' on_robot --json status m5
check "outside limits" fails 4 'R_ELBOW_P (motor 5) to 51.0 deg is outside its limits -130 to 50' \
    on_robot move R_ELBOW_P 51
check_json "init" 'len(lines[0]["joints"]) == 20 and lines[0]["max_error_deg"] <= 0.1' \
    on_robot --json init --time 500
check_json "leaving with the torque off" 'len(lines[0]["joints"]) == 1' \
    on_robot --json --on-exit off move m5 0 200
check_json "it is off" 'all(j["torque"] == "off" for j in lines[0]["joints"])' \
    on_robot --json status

# interrupted SIGNAL STATUS: a slow move is stopped, the status tells, the joint stands still.
interrupted() {
    rm -f "$work/moving"
    "$GRCTL" -d "$robot" --timeout 500 -v move m5 -120 5000 >"$work/out" 2>"$work/moving" &
    interrupted_pid=$!
    written "$work/moving" 'robot found' || return 1
    on_robot status >/dev/null 2>"$work/busy"
    kill -s "$1" $interrupted_pid
    wait $interrupted_pid
    interrupted_got=$?
    [ $interrupted_got -eq "$2" ] && grep -q 'exit policy carried out' "$work/moving" && return
    echo "status $interrupted_got, not $2"
    cat "$work/moving"
    return 1
}
test_case "signals: the exit policy is carried out"
check "torque on before" exits 0 on_robot servo on m5
check "SIGINT: the exit policy, then 130" interrupted INT 130
check "a second program is told who has the port" grep -q "in use by.*$known_as (pid" "$work/busy"
check_json "the joint holds on its way" \
    'lines[0]["joints"][0]["torque"] == "on" and lines[0]["joints"][0]["speed_dps"] == 0 and
     -120 < lines[0]["joints"][0]["angle_deg"] <= 0' on_robot --json status m5
check "SIGTERM: 143" interrupted TERM 143
check "SIGHUP: 129" interrupted HUP 129

stop_sim
done_testing
