#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl sim` told what to do on its standard input, as somebody beside the robot would do it.
. tests/support/cli.sh
own_sim

# answers PATTERN WORD...
answers() {
    answers_pattern=$1
    shift
    tell "$@"
    tail -n 1 "$work/sim.log" | grep -q -e "$answers_pattern" && return
    cat "$work/sim.log"
    return 1
}

start_told_sim --robots 2 || { echo "Bail out! the simulator did not start"; exit 1; }
test_case "words turn, heat, unplug and silence servos"
check "turn a shaft" answers '^sim: turn 5 -45$' turn 5 -45
check_json "it is there" 'lines[0]["joints"][0]["angle_deg"] == -45' on_robot --json status m5
check "look at a servo" answers 'R_ELBOW_P  *-45.0 deg' look R_ELBOW_P
check "heat a group" answers '^sim: temperature legs 60$' temperature legs 60
check_json "it is hot" 'all(j["temperature_c"] in (59, 60) for j in lines[0]["joints"])' \
    on_robot --json status legs
check "the battery goes down" answers '^sim: voltage 6.5$' voltage 6.5
check_json "it is low" '6.3 < lines[0]["joints"][0]["voltage_v"] < 6.6' on_robot --json status m1
check "a cable out" answers '^sim: cable 12 out$' cable 12 out
check "silence" both exits 1 on_robot status m12 --- says 'R_KNEE_P.*no reply'
check "and in" answers '^sim: cable 12 in$' cable 12 in
check "a mute servo" answers '^sim: silent m13 on$' silent m13 on
check "silence again" exits 1 on_robot status m13
check "it speaks" answers '^sim: silent m13 off$' silent m13 off
check "both answer" exits 0 on_robot status m13
test_case "each robot has words of its own"
check "a second robot" answers '^sim: robot 2$' robot 2
check "its battery" answers '^sim: voltage 8$' voltage 8
check_json "the first keeps its own" 'lines[0]["joints"][0]["voltage_v"] < 6.6' \
    on_robot --json status m1
first=$robot
if by_tcp; then read -r robot <&6; else robot=${robot}2; fi
check_json "the second has it" 'lines[0]["joints"][0]["voltage_v"] > 7.9' on_robot --json status m1
test_case "the host's cable, and faults"
check "the host's cable" answers '^sim: plug out$' plug out
check "nobody is there" fails 1 "$robot: .*\(no such file\|refused\)" on_robot status
check "plugged in again" answers '^sim: plug in$' plug in
check "somebody is there" exits 0 on_robot status m1
check "a fault" answers '^sim: fault silent=1$' fault silent=1
check "it strikes" exits 1 on_robot status m1

test_case "words that are none"
check "no such command" answers "'dance'? say: robot fault" dance
check "no weight, no push" answers "this robot has no weight" push 5 1
check "no such servo" answers "'turn 21 0'? say: turn SERVO DEG" turn 21 0
check "no angle" answers "'turn 5 up'? say: turn SERVO DEG" turn 5 up
check "no switch" answers "'silent 5 maybe'? say: silent SERVO on|off" silent 5 maybe
check "no such robot" answers "'robot 3'? say: robot N" robot 3
check "no such fault" answers "'fault flood=1'? say: fault KIND=RATE" fault flood=1
check "too many words" answers 'at most 4 words' turn 5 1 2 3
check "a long line" answers 'more than 255 bytes' "$(printf '%0300d' 0)"

robot=$first
exec 5>&-
test_case "its end"
check "the end of its input is not its end" exits 0 on_robot status m1
stop_sim

quits() {
    echo quit | "$GRCTL" -q sim >/dev/null
}
check "quit" quits
done_testing
