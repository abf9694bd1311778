#!/bin/sh
# SPDX-License-Identifier: MIT
# scan, info, servo-get, servo-set and doctor with servos of Feetech: by the names of their own
# registers, kept as they keep them.
. tests/support/cli.sh
. tests/support/registers.sh

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
check "replay knows them too" both exits 0 \
    "$GRCTL" --robot so101 replay "$work/line" --- says ' 0 differ, 0 missing, 0 extra'
check_json "registers in JSON" 'lines[0]["model"] == "STS3215" and lines[0]["registers"] == [
    {"name": "max_position", "address": 11, "value": 3150, "unit": "0.088 deg",
     "access": "kept rw", "range": [-32767, 32767], "max_position_deg": 96.9}]' \
    of so101 --json servo-get 3 max_position
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
done_testing
