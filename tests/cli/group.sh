#!/bin/sh
# SPDX-License-Identifier: MIT
# Groups of robots: one command for each at the same time.
. tests/support/cli.sh
. tests/support/group.sh

test_case "each by itself"

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
