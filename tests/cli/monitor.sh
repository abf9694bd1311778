#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl monitor` in a real terminal: what it shows, the keys it takes, a lost line, a new size.
. tests/support/cli.sh
. tests/support/terminal.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# rounds COMMAND...: until it has written more than one; a signal ends it.
rounds() {
    : >"$work/out" # what the last one wrote does not count
    "$@" >"$work/out" 2>"$work/err" </dev/null &
    rounds_pid=$!
    wait_for several_rounds
    kill $rounds_pid
    wait $rounds_pid
}
several_rounds() {
    [ "$(grep -c 'R_KNEE_P' "$work/out")" -ge 2 ]
}
# Where no full screen can be, it is a table.
plain() {
    rounds "$GRCTL" -d "$robot" --timeout 500 monitor
    grep -q "this is 'grctl status --watch'" "$work/err" && says '^ *12  R_KNEE_P'
}
test_case "without a terminal it is a table"
check "no terminal: the table" plain
json_lines() {
    rounds "$GRCTL" -d "$robot" --timeout 500 monitor --json
    json 'len(lines) >= 2 and all(len(line["joints"]) == 20 for line in lines)'
}
if have_json; then
    check "as JSON: an object a round" json_lines
else
    skip "as JSON: an object a round" "no python3 to parse JSON with"
fi

check "a file that is not there, without a screen too" fails 3 'none.m: no such file$' \
    "$GRCTL" -d "$robot" --timeout 500 monitor "$work/none.m"
if ! have_full_screen; then
    skip "the full screen" "$no_screen"
    done_testing
    exit
fi

# The simulator may be late on a busy machine, and silent servos are to be noticed soon.
monitor="'$GRCTL' -d '$work/robot' --retries 10 monitor motions/greet.pseq"
monitor="$monitor; echo status \$?; stty -a"
open_screen
on_screen pipe-pane "cat >'$work/bytes'"
type_line "printf begins; TERM=dumb $monitor"
check "a dumb terminal: the table" until_screen 'R_KNEE_P  *-40.0'
keys C-c
until_screen 'status 130'
on_screen pipe-pane
no_escapes() {
    wait_for grep -q 'status 130' "$work/bytes" &&
        ! sed '1,/begins/d; /status 130/,$d' "$work/bytes" | grep "$(printf '\033')"
}
check "nothing that it cannot take" no_escapes

began=$(date +%s)
type_line "$monitor"
test_case "the screen shows the robot, and keys choose joints"
check "the robot and its line" until_screen '^GR001  .*/robot'
check "a joint of either leg" until_screen '12 KNEE_P  *-40.0 .* off .*18 KNEE_P  *40.0 .* off'
check "battery and link" until_screen '^ 7.3[0-9] V  [0-9]* replies'
check "the keys" until_screen 'e EMERGENCY STOP'
check "the first joint is chosen" until_screen ' 2>NECK_Y'
keys Down
check "down: the next one" until_screen ' 3>SHOULDER_P'
keys Right
check "right: the other side" until_screen ' 6>SHOULDER_P'
keys -l ']'
test_case "torque is switched and joints are nudged"
check "limp joints are not nudged" until_screen 'no torque there'
keys 2
check "a group" until_screen '^ 4>SHOULDER_R'
keys t
check "torque of the group" until_screen '^ 5>ELBOW_P  *-20.0 .* on '
check "its end is told" until_screen '^torque on: done'
check "of no other" until_screen ' 8 ELBOW_P  *20.0 .* off'
keys -l '}'
check "a nudge" until_screen '^ 5>ELBOW_P  *-15.0 .* on '
until_screen '^nudge: done'
keys -l '['
check "a small one back" until_screen '^ 5>ELBOW_P  *-16.0 '
until_screen '^nudge: done'
keys b
check "brake" until_screen '^ 5>ELBOW_P .* bra '
until_screen '^brake: done'
keys Space
test_case "moves and motions are seen, paused, slowed, stopped"
check "no pause where nothing plays" until_screen '^nothing is playing'
keys i
check "what is under way is shown" until_screen '^[█░]*  move to the initial posture'
keys p
check "and told to who comes too early" until_screen '^play: not now.*: move to the initial posture'
check "the initial posture" until_screen '^ 5>ELBOW_P  *-20.0 .* on .* 8 ELBOW_P  *20.0 .* on '
check "is told of when it is over" until_screen '^move to the initial posture: done'
keys p
check "playing" until_screen 'playing [0-9.]* of 5.0 s at 100 %'
keys Space
check "pause" until_screen 'paused'
keys Space -
check "slower" until_screen 'playing .* at 90 %'
keys s
check "stop" until_screen '^play: stopped'
keys i
until_screen '^move to the initial posture *$'
keys s
check "a move is stopped too" until_screen '^move to the initial posture: stopped'

tell temperature 13 60
test_case "servos and line that fail are seen"
check "a warm servo" until_screen '^13 ANKLE_P .* \(59\|60\) '
tell silent 12 on
check "a silent one" until_screen '^12 KNEE_P  *no reply'
tell silent 12 off
keys R
check "it answers again" until_screen '^12 KNEE_P .* on '
tell plug out
check "the line is lost" until_screen 'LINE LOST for'
tell plug in
check "the line comes back" until_screen '^ 5>ELBOW_P .* on '
check "and is told of" until_screen 'line lost 1 times'

on_screen resize-window -x 50 -y 12
test_case "windows of all sizes"
check "too small a window" until_screen 'terminal too small'
on_screen resize-window -x 120 -y 40
check "a large one: longer bars" until_screen 'NECK_Y  *[-0-9.]* .\{25,\} on '
check "and what was said before" until_screen '^play: stopped'

# Hundredths of a second of the processor, of those that have passed since the screen came.
little_of_a_core() {
    ticks=$(($(getconf CLK_TCK) * ($(date +%s) - began)))
    pid=$(pgrep -n -x -f "$GRCTL -d $work/robot --retries 10 monitor.*")
    used=$(awk '{ print $14 + $15 }' "/proc/$pid/stat")
    echo "$used of $ticks ticks"
    [ $((used * 100)) -lt $((ticks * 6)) ]
}
if [ -n "${EMULATOR:-}" ]; then
    skip "at most 6 % of a core" "an emulator's processor time tells nothing"
elif [ -r /proc/self/stat ] && command -v pgrep >/dev/null 2>&1; then
    check "at most 6 % of a core, keys and resizing included" little_of_a_core
else
    skip "at most 6 % of a core" "no /proc here"
fi

keys e
test_case "an emergency stop, its end, and that of the monitor"
check "emergency stop" until_screen 'EMERGENCY STOP: R releases it'
check "all are braked" until_screen '^ 5>ELBOW_P .* bra .* 8 ELBOW_P .* bra '
keys i
check "nothing moves then" until_screen 'an emergency stop stands'
keys R
check "it is taken back" until_screen 'stop released'
keys q
check "q quits" until_screen '^status 0'
check "the terminal is as it was" until_screen ' icanon'

type_line "$monitor"
until_screen '^GR001'
keys C-c
check "Ctrl-C is told by the status" until_screen 'status 130'
check "the terminal is as it was then too" until_screen ' icanon'

long=$work/$(printf '%0100d' 0)
mkdir "$long"
cp motions/greet.pseq "$long/$(printf '%0100d' 0).pseq"
type_line "'$GRCTL' -d '$work/robot' --retries 10 monitor '$long/'*"
test_case "names that are too long, letters that are not there"
check "a long name ends with its row" until_screen ' idle .*/00*$'
below_it() {
    until_screen '^arrows' && ! grep -q '^0' "$work/screen"
}
check "and is in no other" below_it
keys C-c
until_screen '^>'
type_line "NO_COLOR=1 LC_ALL=C $monitor"
check "plain letters where nothing else is known" until_screen 'NECK_Y .* -*#-* '
keys q
until_screen '^status 0'
type_line "$monitor"
until_screen '^GR001'
keys Right
until_screen ' 1>CHEST_P'
keys t
until_screen '^torque on: done'
keys -l ']'
test_case "limits"
check "at a limit a nudge is no move" until_screen '^CHEST_P is at its limit: 0 deg'
keys q
until_screen '^status 0'
on_screen pipe-pane "cat >'$work/raw'"
type_line "'$GRCTL' -d '$work/robot' scan; echo status \$?"
until_screen '^status 0'
test_case "a scan shows where it is"
check "a scan shows where it is" written "$work/raw" '115200 bps, id [0-9]'
cleared() {
    ! grep -q 'bps, id' "$work/screen"
}
check "and leaves nothing of that behind" cleared
on_screen pipe-pane
type_line "'$GRCTL' -d '$work/none' monitor"
test_case "no such device"
check "no such device" until_screen 'none: no such file'

# Robots of other shapes: one list, more joints than rows, names longer than their column.
on_screen resize-window -x 80 -y 24
robot_file() {
    printf 'name: %s\nfamily: feetech\nline: {baud: 1000000}\njoints:\n' "$1"
    for k in $(seq "$2"); do
        echo "  - {name: part_with_a_long_name_$k, id: $((k + 100)), servo: STS3215,"
        echo "     limits_deg: [-50, 50]}"
    done
}
type_line "'$GRCTL' -d sim --robot so101 monitor"
test_case "an arm is one list"
check "an arm is one list, longer bars" until_screen '^ 1>shoulder_pan  *[-0-9.]* .\{38,\} off '
check "its last joint" until_screen '^ 6 gripper  *[-0-9.]* .* off '
keys Up
check "up from the first is the last" until_screen '^ 6>gripper'
keys Right
check "beside a list is nothing else" until_screen '^ 6>gripper'
check "the keys of its groups" until_screen '^arrows 0-1 choose'
keys q
until_screen '^>'
robot_file many 64 >"$work/many.yaml"
type_line "'$GRCTL' -d sim --robot '$work/many.yaml' monitor"
test_case "more joints than places: pages"
check "more joints than places" until_screen '^0 more joints above, 40 below'
check "a long name keeps its end" until_screen '^101>part_.*~.*_1  .* off .* 133 part_.*~.*_33 '
keys Up
check "the arrows turn the page" until_screen '^40 more joints above, 0 below'
check "to the joint that is chosen" until_screen ' 164>part_.*_64 '
on_screen resize-window -x 120 -y 40
check "a large screen has them all" until_screen '^101 part_.* 145 part_.*_45 '
keys q
until_screen '^>'
on_screen kill-server
stop_sim
done_testing
