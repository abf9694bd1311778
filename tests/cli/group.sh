#!/bin/sh
# SPDX-License-Identifier: MIT
# Groups of robots: one command for each at the same time, and a motion that they begin together.
. tests/support/cli.sh

mkdir -p "$work/config/grctl"
config=$work/config/grctl/config.yaml

# simulates NAME: a simulator behind $work/NAME; $pid is its process.
simulates() {
    "$GRCTL" sim --link "$work/$1" >"$work/$1.out" 2>"$work/$1.err" &
    pid=$!
    echo "$pid" >>"$work/pids"
    wait_for test -e "$work/$1"
}
if ! "$GRCTL" sim --help | grep -q -e --link; then
    echo "1..0 # SKIP the simulator has no pseudo-terminals here"
    exit 0
fi
simulates a && simulates b && simulates c || { echo "Bail out! no simulator"; exit 1; }
pid_c=$pid

cat >"$config" <<EOF2
groups: {stage: [a, b, c], pair: [a, b], ghosts: [a, nobody]}
robots:
  a: {device: $work/a}
  b: {device: $work/b}
  c: {device: $work/c}
EOF2

test_case "each by itself"

each_says() {
    grep -q "^a: .*$1" "$work/$2" && grep -q "^b: .*$1" "$work/$2" && grep -q "^c: .*$1" "$work/$2"
}
check "status of each" both exits 0 "$GRCTL" -d stage --timeout 500 status m3 --- \
    each_says R_SHOULDER_P out
check_json "as JSON, with names" '[l["name"] for l in lines] == ["a", "b", "c"]' \
    "$GRCTL" -d stage --timeout 500 --json status m3
check "an option may stand behind" both exits 0 "$GRCTL" --timeout 500 status m3 -d stage --- \
    each_says R_SHOULDER_P out
check "by the environment" exits 0 env GRCTL_DEVICE=stage "$GRCTL" --timeout 500 status m3
check "a mistake is each one's" both exits 2 "$GRCTL" -d stage status nose --- \
    each_says "no joint or group called 'nose'" err
check "a command for one robot says so" fails 2 \
    "stage is a group of robots; 'move' works with one of them, such as -d a" \
    "$GRCTL" -d stage move m5 -20
check "so does a trace" fails 2 '--trace: stage is a group' \
    "$GRCTL" -d stage --trace "$work/t" status
check "a robot that is not there makes it fail" both exits 1 "$GRCTL" -d ghosts status m3 --- \
    grep -q '^nobody: grctl: nobody: no such file' "$work/err"
check "but the others are asked" grep -q '^a: .*R_SHOULDER_P' "$work/out"

# watches WORDS...: $watcher; what it shows is in $work/seen, and it hears the keys of descriptor 7.
mkfifo "$work/keys"
watches() {
    : >"$work/seen"
    "$GRCTL" --timeout 500 "$@" <"$work/keys" >"$work/seen" 2>"$work/said" &
    watcher=$!
    echo "$watcher" >>"$work/pids"
    exec 7>"$work/keys"
}
watcher_ended() { # STATUS
    exec 7>&-
    ended_with "$1" "$watcher"
}
all_stopped() {
    [ "$(tail -n 3 "$work/seen" | grep -c '^[abc] .* stopped, read back$')" -eq 3 ]
}
monitored() {
    watches -d stage monitor && written "$work/seen" '^c  *stands .*/20 .* V  *-$' &&
        printf e >&7 && wait_for all_stopped && printf q >&7 && watcher_ended 0
}
check "monitor shows each, and stops all" monitored
watched() {
    watches -d ghosts status --watch -i 100 && written "$work/seen" '^a  *stands ' &&
        written "$work/seen" '^nobody  *not there$' && kill -INT "$watcher" && watcher_ended 130 &&
        grep -q 'nobody: .*tried again every 5 s' "$work/said"
}
check "status --watch too, with one that is not there" watched
if have_json; then
    check "after Ctrl-S a table is left out, not kept" \
        exits 0 python3 tests/support/unread_tables.py "$GRCTL" stage
else
    skip "after Ctrl-S a table is left out, not kept" "no python3 here"
fi
watched_json() {
    watches -d stage --json monitor && written "$work/seen" '"name": *"c"' &&
        kill -INT "$watcher" && watcher_ended 130
}
check "as JSON, a line each" watched_json
check "a monitor of all plays nothing" fails 2 'to play, grctl -d stage play' \
    "$GRCTL" -d stage monitor motions/greet.pseq
recorded() {
    watches -d stage record -o "$work/led.m" &&
        written "$work/said" 'record: a, the first of stage' &&
        written "$work/said" 'save and end' && printf s >&7 && watcher_ended 0 &&
        test -s "$work/led.m"
}
check "of a group the first leads, and is recorded" recorded

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

test_case "the configuration"

bad_config() {
    printf '%s\n' "$1" >"$config"
    fails 3 "$2" "$GRCTL" -d stage status
}
check "a group is a list" bad_config 'groups: {stage: a}' ':1:17: a list of robots is wanted here'
check "of names" bad_config 'groups: {stage: [[a]]}' ':1:18: the name of a robot is wanted here'
check "each once" bad_config 'groups: {stage: [a, a]}' ':1:21: a is in the group already'
check "and at least one" bad_config 'groups: {stage: []}' ':1:10: group stage has no robots'
check "a name is one thing" bad_config 'groups: {stage: [a]}
robots: {stage: {device: sim}, a: {device: sim}}' 'a robot and a group are called stage'

done_testing
