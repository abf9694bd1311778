#!/bin/sh
# SPDX-License-Identifier: MIT
# Servos one by one and the commands about the whole of the robot, by what they print.
. tests/support/cli.sh

# said PATTERN: on standard error.
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "scan, info"

# It waits for each that is silent: not as long as on_robot() would.
scan() {
    "$GRCTL" -d "$robot" --timeout 100 scan "$@"
}
finds() {
    [ "$(grep -c ' bps  ' "$work/out")" -eq "$1" ]
}
check "scan finds 20" both exits 0 scan --last 30 --- finds 20
check "a row of it" says '^ 12  RS301CR   firmware   1  115200 bps  R_KNEE_P$'
check "how long it took" said '^20 servos; 10 silent; [0-9]* ms, of which the wire took [0-9]*$'
check "all ids are asked without --last" both exits 0 "$GRCTL" -d sim scan --- said '; 107 silent; '
check "nobody there" exits 1 scan --first 21 --last 40
check_json "as JSON" '[s["id"] for s in lines[0]["servos"]] == [12, 13] and
    lines[0]["silent"] == 0 and lines[0]["wire_ms"] > 0' on_robot scan --json --first 12 --last 13
tell fault delay=1
check "who answers late is found" both exits 0 on_robot scan --first 10 --last 15 --- \
    says '^ 12 .*R_KNEE_P'
tell fault delay=0
check "a move as asked" exits 0 on_robot move m5 -40 1500
as_asked() {
    ! grep -q 'it took' "$work/err"
}
check "needs no word on its time" as_asked
check "status of another process knows the target" both exits 0 on_robot status m5 --- \
    says '^    5  R_ELBOW_P  *-40\.0  *-40\.0  on '
check "a joint without torque has none" both exits 0 on_robot status m4 --- \
    says '^    4  R_SHOULDER_R  *[-0-9.]*  *-  off '
check "a move that took longer" both exits 0 on_robot move m5 40 10 --- \
    said '^it took [0-9]* ms, not 10: no joint moves faster'
tell id 3 12
check "two servos with one id are named" both exits 1 on_robot scan --first 10 --last 13 --- \
    said '^id 12 answers, but: .* (two servos with one id?)$'
check "nobody else is" both finds 3 --- said '^not sure: '
if have_json; then
    twice_as_json() {
        exits 1 on_robot scan --json --first 10 --last 13 &&
            json '[(s["id"], s["name"]) for s in lines[0]["failed"]] == [(12, "R_KNEE_P")] and
                lines[0]["failed"][0]["status"] in ("checksum", "mismatch", "short")'
    }
    check "and in JSON, with the error" twice_as_json
else
    skip "and in JSON" "no python3"
fi
tell id 3 3
check "--first behind --last" fails 2 'first is behind' on_robot scan --first 5 --last 3
check "--all-baud through the board" fails 2 'needs --wiring bus' on_robot scan --all-baud
check "--all-baud without a line" fails 2 'needs a line' \
    "$GRCTL" -d sim --wiring bus scan --all-baud
check "info" both exits 0 on_robot info --- says '^ 20  RS301CR   firmware   1 .* L_ANKLE_R$'
check "how it is reached" says '^GR001 on .*, through its board, which answers$'
# One that is silent costs the whole time, at each try.
soon() {
    "$GRCTL" -d "$robot" --timeout 150 "$@"
}
tell silent 12 on
check "a silent servo is named" both exits 1 on_robot info --- \
    said '^motor 12 (R_KNEE_P): no reply in time$'
check "who does not answer: what, where, what to do" fails 1 \
    "no reply from motor 12 (R_KNEE_P) in [0-9.]* ms after 2 retries; is its cable in? see" \
    soon servo on m12
check "as often as asked" fails 1 'R_KNEE_P) in [0-9.]* ms after 1 retry;' \
    soon --retries 1 servo on m12
check "-v: the bytes too" both exits 1 soon -v servo on m12 --- \
    said '^sent 54 09 FA AF 0C 0F 1E 18 00 05 20; received nothing$'
tell silent 12 off
check "-vv: every byte" both exits 0 on_robot -vv status m12 --- \
    said '^ *[0-9.]*  >  54 09 FA AF 0C 0F 1E 18 00 05 20$'
check "and what came" said '^ *[0-9.]*  <  FD DF 0C 00 1E 18 01 '

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
    {"name": "delay", "address": 7, "value": 2, "unit": "50 us", "delay_us": 200}]' \
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
    exits 0 "$GRCTL" -q decode "$work/estop" &&
        head -n 1 "$work/out" | grep 'host .*20 servos: torque'
}
check "nothing goes before it" goes_first
check "nothing moves then" fails 4 "stopped by 'grctl estop'" on_robot move m5 0
check "brakes are on" both exits 0 on_robot status m5 --- says ' brake '
check "estop --reset" both exits 0 on_robot estop --reset --- said '^emergency stop released'
check "it moves again" exits 0 on_robot move m5 -20 300

check "budget" both exits 0 "$GRCTL" budget --- says '^motion, 20 joints  *110 B  *0 B  *18.92 ms$'
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

test_case "on a bus of servos"

start_sim --wiring bus --baud 57600
check "--all-baud finds the rate" both exits 0 scan --wiring bus --all-baud --first 3 \
    --last 4 --- says '^  3 .*  57600 bps  R_SHOULDER_P$'
check "and no other" [ "$(grep -c R_SHOULDER_P "$work/out")" -eq 1 ]
stop_sim

# A servo changes its rate when it restarts, or at once: the command finds out where it answers.
# All servos but one are silent where the line has another rate, each for the whole time: two will
# do.
cat >"$work/two.yaml" <<EOF2
name: two
family: rs30x
joints:
  - {name: turn, id: 2, servo: RS302CD, limits_deg: [-90, 90]}
  - {name: lift, id: 12, servo: RS302CD, limits_deg: [-90, 90]}
EOF2
on_bus() {
    "$GRCTL" -d "$robot" --robot "$work/two.yaml" --timeout 300 "$@"
}
# follows NAME: with --flash to the new rate, and back.
follows() {
    check "$1: with --flash the servo is followed" both \
        exits 0 on_bus servo-set 2 baud 460800 --flash --- \
        said '^servo 2: baud [57] (.*) -> 10 (460800 bps), kept in flash; it answers at 460800 bps$'
    check "$1: it is not at the old rate" fails 1 'no reply from servo 2' \
        on_bus servo-get 2 baud
    check "$1: it is where the command says" both exits 0 on_bus -b 460800 servo-get 2 baud --- \
        says '^  6  baud  *10  *460800 bps$'
    check_json "$1: and back" 'lines[0]["flash"] and lines[0]["baud_bps"] == 115200' \
        on_bus -b 460800 --json servo-set 2 baud 7 --flash
}

start_told_sim --robot "$work/two.yaml"
check "a baud rate without --flash" both exits 0 on_bus servo-set 2 baud 57600 --- \
    said '(57600 bps); takes effect at a restart, and is lost there .*; it answers at 115200 bps$'
check_json "in JSON" 'lines[0]["flash"] is False and lines[0]["baud_bps"] == 115200' \
    on_bus --json servo-set 2 baud 57600
follows 'at the restart'
tell cable 2 out
tell cable 2 in
# It starts for half a second.
check "its power does not take the rate away" wait_for exits 0 on_bus servo-get 2 baud
exits 0 on_bus servo on m12
check "a servo that holds is not restarted" fails 4 'servo 12 holds, and would restart limp' \
    on_bus servo-set 12 baud 57600 --flash
check "and keeps its rate" both exits 0 on_bus servo-get 12 baud --- says ' 115200 bps$'
check "without --flash it goes on holding" exits 0 on_bus servo-set 12 baud 57600
stop_sim
start_sim --robot "$work/two.yaml" --baud-at-once
check "--baud-at-once, without --flash" both exits 0 on_bus servo-set 2 baud 57600 --- \
    said '(57600 bps); lost at power-off without --flash; it answers at 57600 bps$'
check "and back" both exits 0 on_bus -b 57600 servo-set 2 baud 115200 --- said 'at 115200 bps$'
follows '--baud-at-once'
stop_sim
check_json "in process" 'lines[0]["flash"] and lines[0]["baud_bps"] == 9600' \
    "$GRCTL" -d sim --wiring bus --timeout 500 --json servo-set 2 baud 9600 --flash
start_sim --robot "$work/two.yaml" --tcp 0
written "$work/sim.log" '^also at '
tcp=$(sed -n 's/^also at //p' "$work/sim.log")
check "behind TCP" fails 4 'the rate of a line behind TCP is not set from here' \
    "$GRCTL" -d "$tcp" --robot "$work/two.yaml" --timeout 500 servo-set 2 baud 57600
check "nothing was written" both exits 0 on_bus servo-get 2 baud --- says ' 115200 bps$'
check "--all-baud behind TCP" fails 2 'the rate of a line behind TCP' \
    "$GRCTL" -d "$tcp" --robot "$work/two.yaml" scan --all-baud
stop_sim
done_testing
