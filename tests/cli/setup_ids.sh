#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl setup: six new servos, all with id 1, become an SO-101: ids one at a time, name, calibration
# file, first move.
. tests/support/cli.sh
unset GRCTL_ROBOT
own_sim
GRCTL=$(cd "$(dirname "$GRCTL")" && pwd)/${GRCTL##*/}

# Servos 11 to 16 of the simulator, as they leave the factory but for their number there, which is
# how the simulator's commands know them: all say that they have id 1, and none is plugged in.
start_told_sim --servo 11=STS3215,12=STS3215,13=STS3215,14=STS3215,15=STS3215,16=STS3215 ||
    { echo "Bail out! the simulator did not start"; exit 1; }
for number in 11 12 13 14 15 16; do
    tell id $number 1
    tell silent $number on
done

# begin OPTION...: setup in the background; answers go to descriptor 8.
begin() {
    : >"$work/asked"
    rm -f "$work/answers"
    mkfifo "$work/answers"
    rm -f "$work/status"
    {
        "$GRCTL" -d "$robot" --yes setup "$@" <"$work/answers" >"$work/out" \
            2>"$work/asked" &
        echo $! >"$work/setup_pid"
        echo $! >>"$work/pids"
        wait $!
        echo $? >"$work/status"
    } &
    exec 8>"$work/answers"
}
# asked N PATTERN: the N-th line like that has come; none comes behind the end.
asked() {
    wait_for asked_or_ended "$1" "$2"
    asked_now "$1" "$2" || { echo "no $1 of '$2' in:"; cat "$work/asked"; return 1; }
}
asked_or_ended() {
    asked_now "$1" "$2" || [ -s "$work/status" ]
}
asked_now() {
    [ "$(grep -c -e "$2" "$work/asked")" -ge "$1" ]
}
answer() {
    echo "$1" >&8
}
ends() {
    wait_for [ -s "$work/status" ] && [ "$(cat "$work/status")" -eq "$1" ] && return
    cat "$work/status" "$work/asked"
    return 1
}

test_case "ids, one servo at a time"
tell silent 16 off
begin
check "it asks for the robot" asked 1 'name the robot; else no'
answer so101
# give JOINT NUMBER ID: the servo with this number is plugged in, and gets its id.
give() {
    asked 1 "plug in the servo of $1 alone" && tell silent "$2" off && answer '' &&
        asked 1 "^$1: id 1 -> $3 at 1000000 bps, kept" && tell silent "$2" on
}
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

# A change of the id that was cut off: the id is written, its lock is open.
tell silent 13 off
cut_off() {
    exits 0 "$GRCTL" -d "$robot" --timeout 500 --robot so101 -y servo-set 1 id 3 --flash &&
        exits 0 "$GRCTL" -d "$robot" --timeout 500 --robot so101 -y servo-set 3 lock 0
}
check "another change was cut off" cut_off
tell silent 13 on
test_case "setup goes on where it was ended"
begin --robot so101
check "servos are missing" asked 1 'of its 6 servos answer. Are they new'
answer y
skip_done() {
    asked 1 'servo of gripper alone' && answer skip && asked 1 'servo of wrist_roll alone' &&
        tell silent 15 off && answer '' &&
        asked 1 '^wrist_roll: has the id 5 at 1000000 bps already' &&
        tell silent 15 on && asked 1 'servo of wrist_flex alone' && answer skip
}
check "what is done is skipped, or found done" skip_done
finish() {
    asked 1 'servo of elbow_flex alone' && tell silent 13 off && answer '' &&
        asked 1 'its lock was open, from a change that was cut off: closed' &&
        asked 1 '^elbow_flex: has the id 3 ' && tell silent 13 on
}
check "what was cut off is finished" finish
check "the next" give shoulder_lift 12 2
check "the last: it has the factory's id" both asked 1 'servo of shoulder_pan alone' --- \
    tell silent 11 off
answer ''
check "which is its own" asked 1 '^shoulder_pan: has the id 1 at 1000000 bps already'
check "all of them" asked 1 'plug in all of them'
answer ''
check "who is missing is named" asked 1 '^grctl: gripper (id 6) does not answer\|^gripper (id 6)'
for number in 12 13 14 15 16; do
    tell silent $number off
done
cat >"$work/calibration.json" <<'JSON'
{
  "shoulder_pan": {"id": 1, "drive_mode": 0,
    "homing_offset": 25, "range_min": 736, "range_max": 3475},
  "shoulder_lift": {"id": 2, "drive_mode": 0,
    "homing_offset": -12, "range_min": 815, "range_max": 3199},
  "elbow_flex": {"id": 3, "drive_mode": 0,
    "homing_offset": 72, "range_min": 850, "range_max": 3063},
  "wrist_flex": {"id": 4, "drive_mode": 0,
    "homing_offset": 40, "range_min": 811, "range_max": 3183},
  "wrist_roll": {"id": 5, "drive_mode": 0,
    "homing_offset": -77, "range_min": 45, "range_max": 3946},
  "gripper": {"id": 6, "drive_mode": 0,
    "homing_offset": 9, "range_min": 1499, "range_max": 3010}}
JSON
calibrates() {
    cd "$work" && exits 0 "$GRCTL" -d "$robot" --robot so101 --timeout 500 -y calibrate \
        --from calibration.json
}
check "calibrated beside it" calibrates
answer ''
check "it gets its name" asked 1 'its name, for -d?'
answer arm
check "it offers to calibrate by hand" asked 1 'to calibrate it later'
check "and to move the gripper" asked 1 \
    'move it for the first time? gripper goes 5 degrees and back'
answer y
check "which moves, and is limp again" asked 1 'gripper moved, and is limp again'
exec 8>&-
ends_named() {
    ends 0 && grep -q '  arm: {device: .*robot: "so101"' "$work/config/grctl/config.yaml"
}
check "and is in the configuration" ends_named

test_case "it plays"
check "it waves" exits 0 "$GRCTL" -d arm --timeout 500 play --speed 200 motions/so101-wave.yaml
stop_sim
done_testing
