#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl robot new: a robot's file of what answers on a line.
. tests/support/cli.sh
unset GRCTL_ROBOT
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}
new() {
    "$GRCTL" -d "$robot" --timeout 30 robot new "$@"
}

start_sim --robot koch || { echo "Bail out! the simulator did not start"; exit 1; }
test_case "a robot of servos that answer gets a file"
check "of every family" both exits 0 new -b 1000000 -o "$work/arm.yaml" --name arm --- \
    said 'the ids and servos of koch (.*--robot koch$'
check "its file is a robot" fails 0 'arm: 6 joints, nothing wrong' \
    "$GRCTL" robot check "$work/arm.yaml"
check "with its servos" \
    grep -q 'id: 6, servo: XL330-M288, limits_deg: \[-90, 90\]}' "$work/arm.yaml"
check "that count turns where they do" \
    grep -q 'id: 3, servo: XL330-M288, .*, turns: true}' "$work/arm.yaml"
check "its rate" grep -q '^line: {baud: 1000000}$' "$work/arm.yaml"
check "and finds the robot" both exits 0 on_robot --robot "$work/arm.yaml" status --- \
    says '^ *6  joint6 '
check_json "JSON" 'lines[0]["fits"] == ["koch"] and lines[0]["n_joints"] == 6' \
    new --json --family dynamixel2 -b 1000000
check "nobody of that family" fails 1 'no servo answers' new --family lx16a -b 115200
check "a file is not replaced" both \
    exits 2 new --family dynamixel2 -b 1000000 -o "$work/arm.yaml" --- \
    said 'arm.yaml is there already'
check "no folder" both exits 3 new --family dynamixel2 -b 1000000 -o "$work/none/a.yaml" --- \
    said 'no such folder'
stop_sim

start_told_sim --robot so101
"$GRCTL" --robot so101 -d "$robot" --timeout 200 servo-set 2 max_position 3000 --flash 2>/dev/null
test_case "limits and offsets are those of the servos"
check "limits are those of the servos" both exits 0 new --family feetech -b 1000000 --- \
    says 'id: 2, servo: STS3215, limits_deg: \[-100, 83.6\]'
"$GRCTL" --robot so101 -d "$robot" --timeout 200 servo-set 3 offset 40 --flash 2>/dev/null
offset_kept() {
    exits 0 new --family feetech -b 1000000 -o "$work/kept.yaml" &&
        grep -q '^calibrated: true' "$work/kept.yaml" &&
        exits 0 "$GRCTL" --robot "$work/kept.yaml" -d "$robot" --timeout 200 move joint3 5
}
check "offsets that servos keep are a calibration" offset_kept
stop_sim

start_sim --servo 4=LX-16A,9=LX-16A
test_case "servos of other families"
check "a model that is not told" both exits 0 new --family lx16a --- \
    says 'id: 9, servo: LX-16A, .*does not tell its model'
stop_sim

start_sim --servo 1=STS3215,2=XL330-M288,3=STS3215 -b 1000000
check "of two families that of most" both exits 0 new -b 1000000 --- \
    said 'skipped: XL330-M288 of id 2'
check "who is nobody twice" [ "$(grep -c 'unknown model' "$work/err")" -eq 0 ]
stop_sim

test_case "a simulator of its own"
check "a simulator of its own" fails 2 "looked for on a line; 'grctl sim --servo' makes one" \
    "$GRCTL" -d sim robot new
done_testing
