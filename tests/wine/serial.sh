#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl.exe and a simulator: the simulator of this machine behind a pseudo-terminal, which wine
# takes for a COM port, and that of grctl.exe behind TCP.
. tests/support/cli.sh

on() {
    device=$1
    shift
    "$GRCTL" -d "$device" --timeout 500 "$@"
}

# The joint's angle, read through a port.
angle_is() {
    on "$1" --json status R_ELBOW_P >"$work/status" &&
        grep -q "\"angle_deg\":$2" "$work/status"
}

moves() {
    on "$robot" -y move R_ELBOW_P -45 300 && angle_is "$robot" -4[45]
}

plays() {
    on "$robot" play --speed 400 motions/greet.pseq
}

no_carriage_returns() {
    on "$robot" --json status >"$work/json" && ! grep -q "$(printf '\r')" "$work/json"
}

traces() {
    on "$robot" --trace "$work/trace.pcapng" status R_ELBOW_P >"$work/out" &&
        "$NATIVE_GRCTL" decode "$work/trace.pcapng" >"$work/decoded" 2>&1 &&
        cat "$work/decoded" && grep -q 'R_ELBOW_P\|tx' "$work/decoded"
}

# start_play: $player plays a motion that takes long, and has begun when this returns.
start_play() {
    : >"$work/playing"
    "$GRCTL" -d "$robot" --trace "$work/playing" play --speed 20 motions/greet.pseq \
        >"$work/out" 2>"$work/err" &
    player=$!
    wait_for plays_for_long
}
plays_for_long() {
    [ "$(wc -c <"$work/playing")" -gt 20000 ]
}

holder_is_named() {
    on "$robot" status >"$work/second" 2>&1 && return 1
    grep 'held by grctl.exe (pid [0-9]*)' "$work/second"
}

# player_ended STATUS WORDS: it says so on standard error.
player_ended() {
    cat "$work/err"
    [ "$player_status" -eq "$1" ] && grep -q "$2" "$work/err"
}

nobody_there() {
    on COM99 status >"$work/out" 2>&1
    [ $? -eq 1 ] && grep -q 'COM99' "$work/out"
}

serves_tcp() {
    mkfifo "$work/port"
    "$GRCTL" sim --tcp 0 >"$work/port" 2>"$work/tcp.log" &
    sim_pid=$!
    tcp=$(head -n 1 "$work/port" | tr -d '\r')
    case $tcp in tcp:127.0.0.1:*) ;; *) return 1 ;; esac
    on "$tcp" -y move R_ELBOW_P -45 300 && angle_is "$tcp" -4[45]
}

start_told_sim
test_that 'a COM port beyond COM9' on "$robot" status
check 'by its full name' on '\\.\'"$robot" status R_ELBOW_P
test_that 'a joint moves and is read back' moves
test_that 'a motion is played' plays
test_that 'JSON has no carriage returns' no_carriage_returns
test_that 'a trace is the same as anywhere' traces
start_play
test_that 'a second program is told who holds the port' holder_is_named
kill -INT "$player"
wait "$player"
player_status=$?
test_that 'Ctrl-C leaves the servos as the policy says' \
    player_ended 130 'interrupted: the servos hold'
start_play
tell plug out
wait "$player"
player_status=$?
test_that 'a port that is unplugged ends the command' player_ended 1 "$robot: .*gone"
test_that 'a port that is not there' nobody_there
stop_sim
start_told_sim -b 1000000
test_that 'at a million bits per second' on "$robot" -b 1000000 --retries 20 status R_ELBOW_P
stop_sim
test_that 'grctl.exe serves another grctl.exe by TCP' serves_tcp
done_testing
