#!/bin/sh
# SPDX-License-Identifier: MIT
# Servos one by one and the commands about the whole of the robot, by what they print.
. tests/support/cli.sh

# said PATTERN: on standard error.
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "registers"

check "servo-get" both exits 0 on_robot servo-get R_KNEE_P --- says '^ 52  voltage  *738  *7.38 V$'
check "a word" says '^  0  model  *12304  *RS301CR$'
check "a code" both exits 0 on_robot servo-get 12 baud --- says '^  6  baud  *7  *115200 bps$'
check "a register that is none" fails 2 "no register 'tail'; RS301CR has: model" \
    on_robot servo-get 12 tail
check "an id that is none" fails 2 "'128' is not an id from 1 to 127" on_robot servo-get 128
check "an id where nobody is" fails 1 'no reply from servo 77 in .* after 2' on_robot servo-get 77
check "servo-set" both exits 0 on_robot servo-set 12 delay 2 --- \
    said '^servo 12: delay 0 (100 us) -> 2 (200 us); lost at power-off without --flash$'
check "is read back" both exits 0 on_robot servo-get 12 delay --- says '  200 us$'
check_json "in JSON under its unit" 'lines[0]["registers"] == [
    {"name": "delay", "address": 7, "value": 2, "unit": "50 us",
     "access": "kept rw", "range": [0, 127], "delay_us": 200}]' \
    on_robot --json servo-get 12 delay
check "an id that another has" fails 4 'servo-set: a servo with the id 13 is there already' \
    on_robot servo-set 12 id 13
check "one that nobody has" both exits 0 on_robot servo-set 12 id 40 --- \
    said '^servo 40: id 12 -> 40; lost'
check "and back" exits 0 on_robot servo-set 40 id 12
check "--flash says what it will write" both exits 0 on_robot servo-set 12 delay 0 --flash --- \
    said '^servo 12: delay 2 (200 us) -> 0 (100 us), and No.4-29 go to flash'
check "a baud rate as it is" both exits 0 on_robot servo-set 12 baud 115200 --- \
    said 'baud 7 (115200 bps) -> 7 (115200 bps)'
check "another baud rate through the board" fails 4 'bus behind the board has 115200 bps' \
    on_robot servo-set 12 baud 57600 --flash
check "and nothing was written" both exits 0 on_robot servo-get 12 baud --- says ' 115200 bps$'
for value in 128 -1 1.5 1e300 nan '' x; do
    check "delay '$value'" fails 2 "servo-set: '$value': delay takes 0 to 127 (counts of 50 us)" \
        on_robot servo-set 12 delay "$value"
done
check "a baud rate that is none" fails 2 'baud takes 0 to 10 ' on_robot servo-set 12 baud 115201
check "read only" fails 2 'voltage is read only' on_robot servo-set 12 voltage 600
check "what moves the motor" fails 4 "goal moves the motor; use 'grctl move'" \
    on_robot servo-set 12 goal 100
exits 0 on_robot servo on m12
for key in id reverse cw_limit ccw_limit; do
    check "$key of a servo that holds" fails 4 "servo 12 holds, and would jump with another $key" \
        on_robot servo-set 12 $key 1
done
check "its delay" exits 0 on_robot servo-set 12 delay 0
exits 0 on_robot servo off m12
check "cw_limit of one that does not" both exits 0 on_robot servo-set 12 cw_limit 1400 --- \
    exits 0 on_robot servo-set 12 cw_limit 1500
check "flash does not keep it" fails 2 'flash does not keep register max_torque' \
    on_robot servo-set 12 max_torque 50 --flash

test_case "poses"

initial=$(awk '{ for (i = 2; i < 22; i++) print $i / 10; exit }' motions/greet.m)
check "pose by joints" both exits 0 on_robot pose --time 300 m5=-30 L_ELBOW_P=30 --- \
    said '^done; largest error 0\.[0-9] deg'
# The angles are words.
# shellcheck disable=SC2086
check "pose by 20 angles" both exits 0 on_robot pose --time 300 $initial --- said '^done; '
check "pose of a file" exits 0 on_robot pose @motions/greet.pseq:3
check "pose of too few angles" fails 2 'pose takes 20 angles, .*, not 2' on_robot pose 10 20
check "pose outside limits" fails 4 'R_ELBOW_P (motor 5) to 51.0 deg is outside' \
    on_robot pose m5=51
check "pose of a joint by two of its names" fails 2 "'m5=6': R_ELBOW_P is there twice" \
    on_robot pose R_ELBOW_P=5 m5=6
check "pose without a number" fails 2 "'m5=' is not" on_robot pose m5=
check "pose of infinity" fails 2 "'m5=inf' is not" on_robot pose m5=inf

test_case "the whole of it"

check "slot" both exits 0 on_robot slot 3 --- said '^slot 3 was asked for'
check "scenario" both exits 0 on_robot scenario 2 --- said '^scenario 2 was asked for'
check "a slot that is none" fails 2 "'-1' is not" on_robot slot -1
check "stop" both exits 0 on_robot stop --- said '^stopped; joints with torque hold'
check "estop" both exits 0 on_robot --trace "$work/estop" estop --- \
    said "verified; 'grctl estop --reset'"
goes_first() {
    # On a busy machine a reply in the trace may be cut.
    "$GRCTL" -q decode "$work/estop" 2>&1 | head -n 1 | grep 'host .*20 servos: torque'
}
check "nothing goes before it" goes_first
check "nothing moves then" fails 4 "stopped by 'grctl estop'" on_robot move m5 0
check "brakes are on" both exits 0 on_robot status m5 --- says ' brake '
check "estop --reset" both exits 0 on_robot estop --reset --- said '^emergency stop released'
check "it moves again" exits 0 on_robot move m5 -20 300

check "budget" both exits 0 "$GRCTL" budget --- says '^motion, 20 joints  *110 B  *0 B  *18.92 ms$'
printf '%s\n' 'name: lx' 'family: lx16a' 'joints:' \
    '  - {name: a, id: 1, servo: LX-16A, limits_deg: [-90, 90]}' >"$work/lx.yaml"
# A full reading has the angle in it: on no robot it is the faster one.
full_is_not_faster() {
    for one in gr001 so101 so101-leader koch koch-leader openmanipulator-x pan-tilt \
        "$work/lx.yaml"; do
        "$GRCTL" --robot "$one" budget --json >"$work/budget" || return 1
        python3 -c "
import json, sys
o = json.load(open(sys.argv[1]))
assert o['costs'][1]['wire_us'] >= o['costs'][2]['wire_us'], o['costs']
assert o['full_rounds_per_s'] <= o['angle_rounds_per_s'], o" "$work/budget" || return 1
    done
}
check "full readings are no faster than angles alone" full_is_not_faster
check "all that a reading asks is counted" both \
    exits 0 "$GRCTL" --robot "$work/lx.yaml" budget --- \
    says '^one joint, full  *24 B  *30 B '
check "what a reply waits for, and what saves it" both exits 0 "$GRCTL" --robot koch budget --- \
    says '0\.50 ms is a delay .*: grctl servo-set ID return_delay 0 --flash$'
no_delay() {
    exits 0 "$GRCTL" --robot so101 budget && ! grep -q 'delay of' "$work/out"
}
check "not where there is none" no_delay
check "doctor names it" both exits 0 "$GRCTL" --robot koch -d sim doctor --- \
    says '^ok    delay .* 500 us (servo 1).*: grctl servo-set 1 return_delay 0 --flash$'
check "what does not fit" both exits 0 "$GRCTL" budget --rate 60 --- \
    says '^motion at 60 Hz does not fit'
check "how many frames leave time for readings" both exits 0 "$GRCTL" budget --- \
    says '^each joint read in 2 s  *at most 39 Hz$'
check "what leaves none" both exits 0 "$GRCTL" budget --rate 40 --- \
    says '^motion at 40 Hz is unwatched'
check_json "budget as JSON" 'lines[0]["fits"] and lines[0]["costs"][0]["wire_us"] == 18924' \
    "$GRCTL" budget --json --rate 50
check "ports" exits 0 "$GRCTL" ports
check_json "ports as JSON" 'all(p["path"].startswith("/dev/") for p in lines[0]["ports"])' \
    "$GRCTL" ports --json
stop_sim
done_testing
