#!/bin/sh
# SPDX-License-Identifier: MIT
# Groups of robots: a motion that they begin together, and what ends it for all.
. tests/support/cli.sh
. tests/support/group.sh

test_case "together"

check "a motion of all" both exits 0 \
    "$GRCTL" -d stage --timeout 500 play -s 400 motions/greet.pseq --- each_says 'frames, ' out
check_json "as JSON: a start, then the three" \
    'lines[0]["starts"] and [l["name"] for l in lines[1:]] == ["a", "b", "c"] and
     all(l["frames"] > 20 and l["done"] for l in lines[1:])' \
    "$GRCTL" -d stage --timeout 500 --json play -s 400 motions/greet.pseq
check "no such motion" fails 3 'a: .*none.pseq' "$GRCTL" -d stage play "$work/none.pseq"
check "a robot that is not configured" fails 3 'nobody: no robot of that name is configured' \
    "$GRCTL" -d ghosts play motions/greet.pseq
check "one file at a time" fails 2 'a group plays one file' \
    "$GRCTL" -d stage play motions/greet.pseq motions/greet.pseq

begins() { # how it goes on is in $work/played
    : >"$work/played" # what one before said is not taken for its words
    "$GRCTL" -d stage --timeout 500 --json -v play -s 20 "$@" motions/greet.pseq \
        >"$work/played" 2>"$work/said" </dev/null &
    program=$!
    written "$work/played" '"starts":true'
}
ended() {
    ended_with "$1" "$program"
}
holds() {
    exits 0 "$GRCTL" -d "$1" --timeout 500 status && ! grep -q 'moving' "$work/out"
}
all_hold() {
    holds a && holds b && holds c
}
interrupted() {
    begins && kill -INT "$program" && ended 130 && all_hold
}
check "Ctrl-C stops all" interrupted

state_is() { # PATTERN: of $program, as ps has it
    # The shell may have buried it already; its status is kept.
    case $(ps -o stat= -p "$program" || echo gone) in
    $1*) ;;
    *) return 1 ;;
    esac
}
ended_or_suspended() {
    state_is '[Zg]' || state_is T
}
# It is suspended once, when all stand: continued, it has nothing to be stopped for, and ends.
suspended() {
    begins && kill -TSTP "$program" && wait_for state_is T || return 1
    kill -CONT "$program"
    wait_for state_is '[!T]' && wait_for ended_or_suspended
    state_is T && { echo 'suspended twice'; kill -KILL "$program"; }
    wait "$program"
    status_ended=$?
    [ $status_ended -gt 128 ] && [ "$(kill -l $((status_ended - 128)))" = TSTP ] &&
        ! grep 'stopped for safety' "$work/said" && all_hold && return
    echo "status $status_ended"
    return 1
}
check "Ctrl-Z stops all, then suspends" suspended

stopped() {
    begins && exits 0 "$GRCTL" -d stage estop && each_says 'stopped.* and verified' err && ended 4
}
check "an emergency stop from elsewhere" stopped
check "no motion begins under it" both exits 4 "$GRCTL" -d stage play motions/greet.pseq --- \
    complains 'a: .*stopped by .grctl estop.'
check "it is taken back for all" exits 0 "$GRCTL" -d stage estop --reset

killed() {
    begins && kill -9 "$program" && { wait "$program"; wait_for all_hold; }
}
if [ "$(uname)" = Linux ]; then
    check "the guards stop all where it is killed" killed
fi

test_case "one is lost"

loses_c() {
    begins "$@" && kill "$pid_c" && { wait "$pid_c"; written "$work/said" 'c is out'; }
}
goes_on() {
    loses_c --if-lost continue --from 4000 && ended 1 &&
        grep -q '"name":"a","done":true' "$work/played" &&
        grep -q '"name":"b","done":true' "$work/played"
}
check "the others go on where that is asked" goes_on
rm -f "$work/c"
simulates c
pid_c=$pid
all_stop() {
    loses_c && ended 1 && grep -q 'a: play: stopped with the others' "$work/said" &&
        ! grep -q '"done":true' "$work/played" && holds a && holds b
}
check "else they stop" all_stop
done_testing
