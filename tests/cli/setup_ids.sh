#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl setup: six new servos, all with id 1, become an SO-101: ids one at a time.
. tests/support/setup_ids.sh

test_case "ids, one servo at a time"
tell silent 16 off
begin
check "it asks for the robot" asked 1 'name the robot; else no'
answer so101
check "the gripper is the first" give gripper 16 6
check "then the wrist" give wrist_roll 15 5
again() {
    asked 1 'plug in the servo of wrist_flex alone' && answer '' &&
        asked 1 'no servo answers: has it power' && tell silent 16 off && answer '' &&
        asked 1 'the servo of gripper, which has its id already; plug in that of wrist_flex' &&
        tell silent 14 off && answer '' &&
        asked 1 '2 servos answer: plug in that of wrist_flex alone' &&
        tell silent 16 on && answer '' && asked 1 '^wrist_flex: id 1 -> 4 ' && tell silent 14 on
}
check "none, another one, two" again
kill -TERM "$(cat "$work/setup_pid")"
check "it is ended in the middle" ends 143
exec 8>&-
stop_sim
done_testing
