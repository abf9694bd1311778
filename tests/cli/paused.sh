#!/bin/sh
# SPDX-License-Identifier: MIT
# Nobody takes what a command prints while it has the robot: a pipe is full. The robot does not wait
# for that.
# Ctrl-S. The robot does not wait for that.
. tests/support/cli.sh

# A reader that is paused: a pipe that this shell holds open, with so many bytes in it already. The
# pipe of Linux takes 64 KiB.
reader=
end_paused() {
    [ -z "$reader" ] || kill "$reader" 2>/dev/null
    end_cli_test
}
trap end_paused EXIT
pause_reader() {
    rm -f "$work/pipe"
    mkfifo "$work/pipe"
    exec 8<>"$work/pipe"
    head -c "$1" /dev/zero >&8
}
# Reads on: what came behind those bytes is in $work/read when resumed_reader() returns.
resume_reader() {
    tail -c +$((full + 1)) <"$work/pipe" >"$work/read" 8>&- &
    reader=$!
    exec 8>&-
}
full=65536

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# is_left_alone: it has moved the robot, and the port is free though it still waits for its reader.
is_left_alone() {
    wait_for sim_shows 5 moving && wait_for exits 0 on_robot status m5 && kill -0 $player
}
# ended STATUS: with its reader back, grctl ends like that.
ended() {
    resume_reader
    wait $player
    ended_got=$?
    wait $reader
    reader=
    [ $ended_got -eq "$1" ] && return
    echo "status $ended_got"
    tail -n 3 "$work/read" "$work/said"
    return 1
}

plays_on() {
    pause_reader $full
    "$GRCTL" -d "$robot" --timeout 500 --json play motions/greet.pseq >&8 2>"$work/said" 8>&- &
    player=$!
    is_left_alone && ended 0 && ! grep -q stalled "$work/said" && grep -q '"done":true' "$work/read"
}
test_that "a full pipe: the motion goes on to its end" plays_on

# Here and for a trace there is room for what is written before the robot is opened.
complains_on() {
    full=61440
    pause_reader $full
    "$GRCTL" -d "$robot" --timeout 500 -vv play --repeat 3 motions/greet.pseq \
        >"$work/said" 2>&8 8>&- &
    player=$!
    is_left_alone && ended 0 && grep -q 'largest error at the end' "$work/said" &&
        grep -q '^standard error: [1-9][0-9]* messages were dropped' "$work/read"
}
test_that "standard error too: what its queue cannot hold is counted" complains_on

prints_on() {
    full=65536
    : >"$work/said"
    pause_reader $full
    "$GRCTL" -d "$robot" --timeout 500 -v status --watch --interval 20 >&8 2>"$work/said" 8>&- &
    player=$!
    written "$work/said" 'robot found' && exits 0 on_robot estop &&
        complains 'which has the port, and verified' && exits 0 on_robot estop --reset
    prints_status=$?
    kill $player
    [ $prints_status -eq 0 ] && ended 143
}
test_that "an emergency stop reaches who prints into it" prints_on

traces_on() {
    full=61440
    pause_reader $full
    "$GRCTL" -d "$robot" --timeout 500 --trace "$work/pipe" play motions/greet.pseq \
        >"$work/said" 2>&1 8>&- &
    player=$!
    is_left_alone && ended 0 && exits 0 "$GRCTL" decode -q "$work/read" &&
        says 'relay .*goal' && ! grep -q stalled "$work/said"
}
# A reply that a busy machine brings in pieces far apart is cut: once more then.
traces_whole() {
    for _ in 1 2 3; do
        traces_on >"$work/why" && return
        grep -q 'cut off: ' "$work/out" || break
    done
    cat "$work/why"
    return 1
}
test_that "a trace into a full pipe: the motion goes on, and the trace is whole" traces_whole

stop_sim
done_testing
