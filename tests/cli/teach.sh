#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl teach` and `record --limp` while a hand turns the simulated robot's joints.
. tests/support/cli.sh

# start_command WORDS...: it hears the keys written to descriptor 6; ready when this returns.
start_command() {
    rm -f "$work/keys" "$work/err"
    mkfifo "$work/keys"
    (cd "$work" && exec "$GRCTL" -d "$robot" --timeout 500 "$@" <keys >out 2>err) &
    command_pid=$!
    exec 6>"$work/keys"
    written "$work/err" '^space'
}

key() {
    printf '%s' "$1" >&6
}

# keep N: the posture is the Nth; when it is kept the hand may go on.
keep() {
    key ' '
    written "$work/err" "^$1 kept"
}

# What it ended with is in $ended then: checks run in a shell of their own.
finish() {
    wait $command_pid
    ended=$?
    exec 6>&-
}

# By hand, in 300 ms.
turn() {
    tell turn "$1" "$2" 300
    wait_for sim_shows "$1" " $2\.0 deg"
}

# file_has DEG: a posture of taught.m has motor 5 there.
file_has() {
    awk -v want="$1" '$6 == want * 10 || $5 == want * 10 { found = 1 } END { exit !found }' \
        "$work/taught.m" && return
    cat "$work/taught.m"
    return 1
}

# torque_is WORD SERVO: of each of them, and the line to the robot is not needed.
torque_is() {
    tell look "$2"
    tail -n +"$((tell_lines + 1))" "$work/sim.log" >"$work/look"
    [ -s "$work/look" ] && ! grep -v "torque $1 " "$work/look"
}

# has_said N PATTERN: so many lines like that.
has_said() {
    [ "$(grep -c -e "$2" "$work/err")" -eq "$1" ]
}

# counts N FILE: so many postures.
counts() {
    exits 0 "$GRCTL" --json show "$2" || return 1
    [ "$(grep -o '"time_ms"' "$work/out" | wc -l)" -eq "$1" ] && return
    cat "$work/out"
    return 1
}

start_told_sim --no-stops || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "record --limp"

# Torque is off when the simulator starts.
start_command record --key -o limp.m m5
check "joints without torque are limp of themselves" grep -q '^1 joint is limp' "$work/err"
check "nothing is said of torque that goes off" has_said 0 'goes off'
key s
finish
check "it ends" [ $ended -eq 0 ]
check "nothing was switched on" torque_is off all

exits 0 on_robot servo on
start_command record --limp --key -o taught.m right_arm
check "it warns of an arm that falls" grep -q 'torque of 3 joints goes off: hold' "$work/err"
check "what is taught is limp" torque_is off right_arm
check "what is not taught holds" torque_is on legs
turn 5 -77
keep 1
turn 5 -21
keep 2
key s
finish
check "s saves" [ $ended -eq 0 ]
check "a posture is what was read when the key came" file_has -77
check "and the next one" file_has -21
check "the arm stays limp" torque_is off right_arm
check "the rest still holds" torque_is on legs

start_command record --limp --rate 20 --moved 5 -o moved.m m5
turn 5 -60
kill -INT $command_pid
finish
check "limp joints are looked at in time" [ "$(wc -l <"$work/moved.m")" -gt 3 ]

test_case "teach"

exits 0 on_robot servo on
start_command teach --time 300 -o wave.pseq right_arm
check "teach makes the arm limp" torque_is off right_arm
key p
check "there is nothing to play yet" written "$work/err" 'nothing is kept yet'
turn 5 -80
keep 1
turn 5 -30
keep 2
turn 5 20
key p
check "p plays what is kept" written "$work/err" '^played'
check "the arm went to the last posture" sim_shows 5 ' -30\.0 deg'
check "and is limp again" torque_is off right_arm
check "what is not taught holds as before" torque_is on legs
turn 5 10
keep 3
echo >&6
check "enter plays too" wait_for has_said 2 '^played'
check "all three" sim_shows 5 ' 10\.0 deg'
key s
finish
check "s saves what was taught" both [ $ended -eq 0 ] --- grep -q PoseSeq "$work/wave.pseq"
check "three postures" counts 3 "$work/wave.pseq"
check "the arm stays limp" torque_is off right_arm

# No other joint is switched on.
exits 0 on_robot servo off
start_command teach m5
turn 5 -40
keep 1
turn 5 0
key p
wait_for sim_shows 5 'torque on'
check "no other joint is switched on" torque_is off legs
check "a limp robot plays the elbow alone" written "$work/err" '^played'
check "which was where it was taught" sim_shows 5 ' -40\.0 deg'
check "and the others were not switched on" torque_is off all
key q
finish
check "the first free name is taken" says '^Motion1.m$'

# The neck's limit is 50 degrees.
start_command teach -o neck.m m2
turn 2 60
keep 1
key p
check "a joint far outside its limits is not switched on" written "$work/err" 'NECK_Y.*limit'
written "$work/err" 'goes off'
turn 2 30
key p
check "back inside it plays" written "$work/err" '^played'
check "the limit" sim_shows 2 ' 50\.0 deg'
key q
finish
check "and teaching went on" [ $ended -eq 0 ]

test_case "it ends while it plays"

start_command teach --time 5000 m5
turn 5 -90
keep 1
turn 5 0
key p
wait_for sim_shows 5 'torque on'
kill -INT $command_pid
finish
check "Ctrl-C while it plays" [ $ended -eq 130 ]
check "keeps what was taught" says 'Motion2.m'

start_command teach --time 5000 m5
turn 5 -90
keep 1
turn 5 0
key p
wait_for sim_shows 5 'torque on'
key e
finish
check "e is the emergency stop" [ $ended -eq 4 ]
check "all joints are braked then" torque_is brake all
check "and teaching is refused" fails 4 'stopped by' on_robot teach


test_case "no key can come: nothing goes limp"

exits 0 on_robot estop --reset
exits 0 on_robot servo on
no_key="no key can come: standard input is neither this terminal nor an open pipe"
deaf() {
    fails 2 "^grctl: teach: $no_key" on_robot teach -o "$work/deaf.m" &&
        fails 2 "^grctl: record: $no_key" on_robot record --key --limp -o "$work/deaf.m" ||
        return 1
    # Whether standard input is closed, a file, or a pipe at its end.
    for command in teach 'record --key'; do
        # shellcheck disable=SC2086
        "$GRCTL" -d "$robot" --timeout 500 $command <&- >"$work/out" 2>"$work/err"
        status_was 2 "$command, closed" && complains "$no_key" || return 1
        # shellcheck disable=SC2086
        "$GRCTL" -d "$robot" --timeout 500 $command <"$0" >"$work/out" 2>"$work/err"
        status_was 2 "$command, a file" && complains "$no_key" || return 1
        mkfifo "$work/ended"
        true >"$work/ended" & # opened, and closed at once
        # shellcheck disable=SC2086
        "$GRCTL" -d "$robot" --timeout 500 $command <"$work/ended" >"$work/out" 2>"$work/err"
        status_was 2 "$command, a pipe at its end" && complains "$no_key" || return 1
        rm "$work/ended"
    done
}
check "a teaching that no key could end is refused" deaf
check "and all joints hold" torque_is on all
calibrates_none() {
    fails 2 '^grctl: calibrate: needs a person to press enter' "$GRCTL" --robot so101 -d sim \
        calibrate -o "$work/none.json"
}
check "so is a calibration" calibrates_none

stop_sim
done_testing
