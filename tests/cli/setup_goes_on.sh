#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl setup goes on where it was ended: the ids that are missing, name, calibration file, first
# move.
. tests/support/setup_ids.sh

# Three have their ids.
tell id 16 6
tell id 15 5
tell id 14 4

test_case "setup goes on where it was ended"

# A change of the id that was cut off: the id is written, its lock is open.
tell silent 13 off
cut_off() {
    exits 0 "$GRCTL" -d "$robot" --timeout 500 --robot so101 -y servo-set 1 id 3 --flash &&
        exits 0 "$GRCTL" -d "$robot" --timeout 500 --robot so101 -y servo-set 3 lock 0
}
check "another change was cut off" cut_off
tell silent 13 on
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
