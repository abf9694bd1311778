#!/bin/sh
# SPDX-License-Identifier: MIT
# scan, info, servo-get, servo-set and doctor with servos of other families: by the names of their
# own registers, kept as the family keeps them.
. tests/support/cli.sh

said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}
# of ROBOT COMMAND...
of() {
    of_robot=$1
    shift
    "$GRCTL" --robot "$of_robot" -d "$robot" --timeout 200 "$@"
}
# restarted ID: its power goes and comes.
restarted() {
    tell cable "$1" out
    tell cable "$1" in
}

test_case "Feetech: a lock"

start_told_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }
check "scan names model, firmware and joint" both exits 0 of so101 scan --last 8 --- \
    says '^  3  STS3215   firmware   3  1000000 bps  elbow_flex$'
check "info" both exits 0 of so101 info --- says '^  6  STS3215 .* gripper$'
check "servo-get by the joint's name" both exits 0 of so101 servo-get wrist_roll --- \
    says '^ 42  goal_position  *2048  *0.0 deg$'
check "bits are bits" says '^ 18  phase  *12  *0Ch$'
check "its rate" says '^  6  baud  *0  *1000000 bps$'
check "another family's register" fails 2 "no register 'delay'; STS3215 has: firmware" \
    of so101 servo-get 1 delay
check "a setting without --flash" both exits 0 of so101 servo-set 1 position_p 20 --- \
    said '^servo 1: position_p 32 -> 20; lost at power-off without --flash$'
restarted 1
check "is lost at power-off" wait_for both exits 0 of so101 servo-get 1 position_p --- \
    says '^ 21  position_p  *32$'
check "with --flash" both exits 0 of so101 servo-set 1 position_p 20 --flash --- \
    said '^servo 1: position_p 32 -> 20, kept$'
check "the lock is closed again" both exits 0 of so101 servo-get 1 lock --- says '^ 55  lock  *1$'
restarted 1
check "is kept" wait_for both exits 0 of so101 servo-get 1 position_p --- \
    says '^ 21  position_p  *20$'
check "a goal" fails 4 "goal_position moves the motor; use 'grctl move'" \
    of so101 servo-set 1 goal_position 2000
check "torque" fails 4 "torque moves the motor; use 'grctl servo'" of so101 servo-set 1 torque 1
check "a speed goes with a goal" fails 4 "goal_speed moves the motor" \
    of so101 servo-set 1 goal_speed 100
check "what has no lock is not kept" fails 2 'flash does not keep register torque_limit' \
    of so101 servo-set 1 torque_limit 500 --flash
exits 0 of so101 servo on shoulder_lift
check "an id of a servo that holds" fails 4 'servo 2 holds, and would jump with another id' \
    of so101 servo-set 2 id 9 --flash
check "its offset" fails 4 'servo 2 holds, and would jump with another offset' \
    of so101 servo-set 2 offset 100
exits 0 of so101 servo off shoulder_lift
check "an id that another has" fails 4 'a servo with the id 3 is there already' \
    of so101 servo-set 2 id 3 --flash
check "one that nobody has" both exits 0 of so101 servo-set 2 id 9 --flash --- \
    said '^servo 9: id 2 -> 9, kept$'
check "which is no joint" both exits 0 of so101 scan --first 9 --last 9 --- \
    says '^  9  STS3215 .*bps  $'
check "and has registers all the same" both exits 0 of so101 servo-get 9 id --- says '^  5  id  *9$'
check "and back" exits 0 of so101 servo-set 9 id 2 --flash
check "another rate" both exits 0 of so101 servo-set 4 baud 115200 --flash --- \
    said 'baud 0 (1000000 bps) -> 4 (115200 bps), kept; it answers at 115200 bps$'
check "where it is found" both exits 0 of so101 scan --all-baud --first 4 --last 4 --- \
    says '^  4  STS3215   firmware   3  115200 bps  wrist_flex$'
check "and back from there" both exits 0 of so101 -b 115200 servo-set 4 baud 1000000 --flash --- \
    said 'it answers at 1000000 bps$'
check "doctor" both exits 0 of so101 doctor --- says 'all 6 answer'
tell temperature 5 90
check "doctor names one that is too hot" both exits 1 of so101 doctor --- \
    says 'wrist_roll .*\(is hot\|cut its torque for heat\)'
check "a servo that is not there, and how long that took" fails 1 \
    'no reply from servo 77 in [0-9.]* ms after 2 retries' of so101 servo-get 77
check "decode knows the robot's servos and joints" both exits 0 \
    "$GRCTL" --robot so101 decode FFFF0304023802BC FFFF0304000008F0 --- \
    says '^servo 3 (elbow_flex) returns present_position 0.0 deg; sum F0 right$'
of so101 --trace "$work/line" scan --last 2 >"$work/out" 2>"$work/err"
check "also out of a trace" both exits 0 "$GRCTL" --robot so101 decode "$work/line" --- \
    says 'robot    servo 1 (shoulder_pan) returns firmware 3, .*model STS3215; .*its request$'
check "replay says that it cannot" fails 2 'replay: knows the frames of RS30x only' \
    "$GRCTL" --robot so101 replay "$work/line"
check_json "registers in JSON" 'lines[0]["model"] == "STS3215" and lines[0]["registers"] == [
    {"name": "max_position", "address": 11, "value": 3150, "unit": "0.088 deg",
     "max_position_deg": 96.9}]' of so101 --json servo-get 3 max_position
test_case "a servo may answer nothing but readings"
check "a servo may answer nothing but readings" both \
    exits 0 of so101 servo-set 6 reply_level 0 --flash --- \
    said '^servo 6: reply_level 1 -> 0, kept$'
check "and is set all the same" both exits 0 of so101 servo-set 6 position_p 20 --flash --- \
    said '^servo 6: position_p 32 -> 20, kept$'
check "its lock is closed" both exits 0 of so101 servo-get 6 lock --- says '^ 55  lock  *1$'
stop_sim

# What is sent has the form of a status here: FF FF 01 04 02 38 02 BE would be -130.1 degrees.
start_told_sim --robot so101 --echo
test_case "an adapter that returns what is sent"
check "an adapter that returns what is sent, though nobody said so" both \
    exits 0 of so101 servo-get 1 present_position --- \
    says '^ 56  present_position  *2048  *0.0 deg$'
check "nobody answers for a servo that is not there" fails 1 'no reply from servo 9' \
    of so101 servo-get 9 present_position
check "what is written is read back" both exits 0 of so101 servo-set 1 offset 100 --- \
    said 'offset 0 (0.0 deg) -> 100 (8.8 deg); lost at power-off without --flash$'
stop_sim

test_case "DYNAMIXEL: kept at once, without torque only"

start_told_sim --robot koch || { echo "Bail out! the simulator did not start"; exit 1; }
check "two models on a line" both exits 0 of koch scan --last 4 --- \
    both says '^  2  XL430-W250  firmware  52  1000000 bps  shoulder_lift$' --- \
    says '^  3  XL330-M288  firmware  52  1000000 bps  elbow_flex$'
check "each has its own registers" both exits 0 of koch servo-get 1 present_load --- \
    fails 2 "no register 'present_load'; XL330-M288 has: model" of koch servo-get 3 present_load
check "a setting is kept" both exits 0 of koch servo-set 3 return_delay 0 --- \
    said '^servo 3: return_delay 250 (500 us) -> 0 (0 us), kept$'
restarted 3
check "over power-off" wait_for both exits 0 of koch servo-get 3 return_delay --- \
    says '^  9  return_delay  *0  *0 us$'
exits 0 of koch servo on elbow_flex
check "not of a servo that holds" fails 4 'servo 3 holds, and .* another return_delay' \
    of koch servo-set 3 return_delay 10
check "what is no setting" both exits 0 of koch servo-set 3 led 1 --- \
    said '^servo 3: led 0 -> 1; lost at power-off$'
exits 0 of koch servo off elbow_flex
check "one that would answer pings alone" fails 4 'reply_level 0 a servo answers nothing' \
    of koch servo-set 2 reply_level 0
check "or in another protocol" fails 4 'protocol_type 1 a servo answers nothing' \
    of koch servo-set 2 protocol_type 1
exits 0 of koch servo-set 2 reply_level 1
check "one that answers readings alone" both exits 0 of koch servo-set 2 led 1 --- \
    said '^servo 2: led 0 -> 1; lost at power-off$'
check "the rate" both exits 0 of koch servo-set 6 baud 57600 --- \
    said 'baud 3 (1000000 bps) -> 1 (57600 bps), kept; it answers at 57600 bps$'
check "and back" exits 0 of koch -b 57600 servo-set 6 baud 1000000
check "doctor" both exits 0 of koch doctor --- says 'all 6 answer'
stop_sim

test_case "Hiwonder LX and Kondo KRS: values that go in pieces"

describe() {
    printf 'name: t\nfamily: %s\njoints:\n' "$1"
    printf '  - {name: turn, id: 1, servo: %s, limits_deg: [-90, 90]}\n' "$2"
    printf '  - {name: lift, id: 2, servo: %s, limits_deg: [-20, 60]}\n' "$2"
}
describe lx16a LX-16A >"$work/lx.yaml"
describe ics KRS-3301 >"$work/krs.yaml"
describe ics KRS-2552RHV >"$work/krs35.yaml"

start_told_sim --robot "$work/lx.yaml"
check "LX: scan" both exits 0 of "$work/lx.yaml" scan --last 4 --- says '^  1  Hiwonder LX .* turn$'
check "info" both exits 0 of "$work/lx.yaml" info --- says '^  2  Hiwonder LX .* lift$'
check "all of its values" both exits 0 of "$work/lx.yaml" servo-get lift --- \
    says '^ 30  voltage  *7[0-9]*  *7\.[0-9]* V$'
check "one of two that go together" both exits 0 of "$work/lx.yaml" \
    servo-set 1 max_position 900 --- \
    said '^servo 1: max_position 1000 (120.0 deg) -> 900 (96.0 deg), kept$'
check "the other stays" both exits 0 of "$work/lx.yaml" servo-get 1 min_position --- \
    says '^  2  min_position  *0  *-120.0 deg$'
check "an id" both exits 0 of "$work/lx.yaml" servo-set 2 id 9 --- said '^servo 9: id 2 -> 9, kept$'
check "found again" both exits 0 of "$work/lx.yaml" scan --first 9 --last 9 --- \
    says '^  9  Hiwonder LX'
check "and back" exits 0 of "$work/lx.yaml" servo-set 9 id 2
check "doctor" both exits 0 of "$work/lx.yaml" doctor --- says 'all 2 answer'
check "no brake" fails 4 'the servos of t have no brake' of "$work/lx.yaml" servo brake
stop_sim

start_told_sim --robot "$work/krs.yaml"
test_case "Kondo KRS"
check "KRS: scan" both exits 0 of "$work/krs.yaml" scan --- says '^  1  Kondo KRS .* turn$'
check "its EEPROM" both exits 0 of "$work/krs.yaml" servo-get 1 max_position --- \
    says '^  8  max_position  *11500  *135.0 deg$'
exits 0 of "$work/krs.yaml" move turn 30
check "halves of a position are put together" both exits 0 of "$work/krs.yaml" servo-get 1 --- \
    says '^ 50  present_position  *8[0-9]*  *30.0 deg$'
check "a setting of one that holds" fails 4 'servo 1 holds' \
    of "$work/krs.yaml" servo-set 1 stretch 80
exits 0 of "$work/krs.yaml" servo off
check "of one that does not" both exits 0 of "$work/krs.yaml" servo-set 1 stretch 80 --- \
    said '^servo 1: stretch 60 -> 80, kept$'
check "the rest of the EEPROM stays" both exits 0 of "$work/krs.yaml" servo-get 1 punch --- \
    says '^  3  punch  *1$'
check "the rate" both exits 0 of "$work/krs.yaml" servo-set 2 baud 625000 --- \
    said 'baud 10 (115200 bps) -> 1 (625000 bps), kept; it answers at 625000 bps$'
check "where it is found" both exits 0 of "$work/krs.yaml" scan --all-baud --last 2 --- \
    says '^  2  Kondo KRS .* 625000 bps'
check "and back" exits 0 of "$work/krs.yaml" -b 625000 servo-set 2 baud 115200
check "doctor tells no voltage" both exits 0 of "$work/krs.yaml" doctor -v --- \
    says 'do not report their voltage'
stop_sim
check "ICS 3.5 does not tell where it stands" both \
    exits 3 "$GRCTL" robot check "$work/krs35.yaml" --- \
    says '4:.*turn: a KRS-2552RHV does not tell where it stands'

test_case "whoever is there"

for one in 3=LX-16A:lx16a 4=KRS-3301:ics; do
    start_sim --servo "${one%:*}"
    check "scan finds ${one%:*}" both exits 0 "$GRCTL" -d "$robot" --timeout 100 scan \
        --family "${one#*:}" --last 5 --- says "^  ${one%%=*} .* ${one#*:}\$"
    stop_sim
done
start_sim --servo 1=XL330-M288,2=STS3215,3=AX-12A,5=SCS0009 -b 1000000
on_line() {
    "$GRCTL" -d "$robot" --timeout 100 scan "$@"
}
check "every family is found" exits 0 on_line --family all --last 6
check "DYNAMIXEL 2.0" says '^  1  XL330-M288  firmware  52  1000000 bps  dynamixel2$'
check "Feetech STS" says '^  2  STS3215   firmware   3  1000000 bps  feetech$'
check "DYNAMIXEL 1.0" says '^  3  AX-12A    firmware  24  1000000 bps  dynamixel1$'
check "Feetech SCS" says '^  5  SCS0009   firmware   3  1000000 bps  feetech$'
check "and nobody twice" [ "$(grep -c ' bps  ' "$work/out")" -eq 4 ]
check "one family" both exits 0 on_line --family dynamixel2 -b 1000000 --last 3 --- \
    said '^1 servo; 3 silent; '
check "nobody there" exits 1 on_line --family rs30x --last 3
check_json "in JSON" '[(s["id"], s["family"], s["joint"]) for s in lines[0]["servos"]] ==
    [(1, "dynamixel2", None)]' on_line --json --family dynamixel2 --last 2
check "without a line" fails 2 '--family needs a line' \
    "$GRCTL" -d sim scan --family dynamixel2 --last 2
stop_sim
done_testing
