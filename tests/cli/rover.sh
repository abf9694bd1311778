#!/bin/sh
# SPDX-License-Identifier: MIT
# A rover from file to cockpit: two wheels and a head of STS3215 (docs/examples/robots), against its
# simulator.
. tests/support/cli.sh
unset GRCTL_ROBOT
rover=docs/examples/robots/rover.yaml

test_case "its file"
check "is right" fails 0 'rover: 4 joints, nothing wrong' "$GRCTL" robot check $rover
check "lists its wheels" ends_with 0 'left .* - *- *-  wheels (wheel, 180 deg/s)' \
    "$GRCTL" --robot $rover joints
wheel_file() {
    printf 'name: w\nfamily: %s\njoints:\n  - {name: a, id: 1, servo: %s, %s}\n' "$1" "$2" "$3" \
        >"$work/w.yaml"
}
refuses() { # FAMILY SERVO KEYS TEXT
    wheel_file "$1" "$2" "$3"
    ends_with 3 "$4" "$GRCTL" robot check "$work/w.yaml"
}
takes() {
    wheel_file "$1" "$2" 'type: wheel'
    exits 0 "$GRCTL" robot check "$work/w.yaml"
}
for servo in 'feetech STS3215' 'feetech SCS0009' 'feetech HLS3606' 'dynamixel1 AX-12A' \
    'dynamixel1 MX-28' 'dynamixel2 XL330-M288' 'dynamixel2 XL-320' 'dynamixel2 PM42-010-S260-R' \
    'lx16a LX-16A'; do
    # shellcheck disable=SC2086 # two words
    check "a wheel of $servo" takes $servo
done
check "KRS have no mode for it" refuses ics KRS-3301 'type: wheel' \
    'a KRS-3301 cannot be a wheel: it has no mode for speeds'
check "RS30x neither" refuses rs30x RS302CD 'type: wheel' 'cannot be a wheel'
check "it goes to no angle" refuses feetech STS3215 'type: wheel, limits_deg: [0, 1]' \
    "a wheel has no 'limits_deg'"
check "and has one servo" refuses feetech STS3215 'type: wheel, servos: [2, 3]' \
    "a wheel has no 'servos'"
check "others have no acceleration" refuses feetech STS3215 'limits_deg: [0, 1], accel_deg_s2: 9' \
    "'accel_deg_s2' needs 'type: wheel'"
check "a mistyped type" refuses feetech STS3215 'type: whel' "no type of joint called 'whel'; did"
check "without an id" ends_with 3 "a joint has no 'id'" \
    sh -c 'printf "name: w\nfamily: feetech\njoints:
  - {name: a, servo: STS3215, type: wheel}\n" >"$0/w.yaml"; exec "$1" robot check "$0/w.yaml"' \
    "$work" "$GRCTL"

test_case "it is driven"
turns() {
    wheel_file "$1" "$2" 'type: wheel'
    ends_with 0 'a: 30.0 deg/s' "$GRCTL" --robot "$work/w.yaml" -d sim drive a=30 --for 0.3
}
for servo in 'feetech STS3215' 'feetech SCS0009' 'feetech HLS3606' 'dynamixel1 AX-12A' \
    'dynamixel1 MX-28' 'dynamixel2 XL330-M288' 'dynamixel2 XL430-W250' 'dynamixel2 XL-320' \
    'dynamixel2 MX-28-2' 'dynamixel2 H42-20-S300-R' 'dynamixel2 PM42-010-S260-R' 'lx16a LX-16A'; do
    # shellcheck disable=SC2086 # two words
    check "a wheel of $servo turns" turns $servo
done
two_lines() {
    printf '%s\n' 'name: w' 'lines:' '  - {name: l, family: feetech}' \
        '  - {name: r, family: dynamixel2}' 'joints:' \
        '  - {name: a, line: l, id: 1, servo: STS3215, type: wheel}' \
        '  - {name: b, line: r, id: 1, servo: XL430-W250, type: wheel}' >"$work/w.yaml"
    ends_with 0 'a: 40.0 deg/s for 0.5 s, read at [34][0-9]; it stands' \
        "$GRCTL" --robot "$work/w.yaml" -d sim drive a=40 b=-30 --for 0.5 &&
        grep -q 'b: -30.0 deg/s .*; it stands' "$work/said"
}
check "two wheels of two families on two lines" two_lines
check "for a time" ends_with 0 'right: 90.0 deg/s for 0.8 s, read at 90; it stands' \
    "$GRCTL" --robot $rover -d sim drive left=90 right=90 --for 0.8
check "backwards, by its group" ends_with 0 'left: -45.0 deg/s' \
    "$GRCTL" --robot $rover -d sim drive wheels=-45 --for 0.3
check "no faster than its limit" fails 4 'left at 300.0 deg/s is above its limit of 180.0 deg/s' \
    "$GRCTL" --robot $rover -d sim drive left=300
check "not its head" fails 2 "pan is not a wheel; use 'grctl move'" \
    "$GRCTL" --robot $rover -d sim drive pan=3
check "not without a speed" fails 2 "'left' is not WHEEL=DEG/S" \
    "$GRCTL" --robot $rover -d sim drive left
check "no wheel twice" fails 2 'left is there twice' \
    "$GRCTL" --robot $rover -d sim drive left=3 wheels=2
check "a robot without wheels" fails 2 'GR001 has no wheels' "$GRCTL" -d sim drive R_KNEE_P=3

test_case "beside its joints"
check "it goes to its initial posture" exits 0 "$GRCTL" --robot $rover -d sim init
check "its head moves" exits 0 "$GRCTL" --robot $rover -d sim pose pan=20 tilt=10
check "a wheel goes to no angle" fails 2 "left is a wheel; use 'grctl drive left=DEG/S'" \
    "$GRCTL" --robot $rover -d sim move left 20
check "torque of all" exits 0 "$GRCTL" --robot $rover -d sim servo on
check "its state" exits 0 "$GRCTL" --robot $rover -d sim status
printf 'type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n    content: JointPosition\n' \
    >"$work/look.yaml"
printf '    frameRate: 2\n    numFrames: 3\n    numParts: 4\n    frames:\n' >>"$work/look.yaml"
printf '      - [0, %s, 0, 0]\n      - [0, %s, 0.1, 0]\n      - [0, %s, 0, 0]\n' \
    0 0 0 >>"$work/look.yaml"
sed 's/\[0, 0, /[0, 1.5, /' "$work/look.yaml" >"$work/turns.yaml"
check "a motion of its head" exits 0 "$GRCTL" --robot $rover -d sim play "$work/look.yaml"
check "says that no motion turns a wheel" ends_with 0 'right: a wheel, which no motion turns' \
    "$GRCTL" --robot $rover check "$work/turns.yaml"
check "and plays the rest" exits 0 "$GRCTL" --robot $rover -d sim play "$work/turns.yaml"

# One simulator for several commands: what a command has left is seen by the next.
test_case "it is stopped"
"$GRCTL" --robot $rover sim --link "$work/port" >"$work/sim.out" 2>&1 &
simulator=$!
wait_for test -e "$work/port"
turned() { # the left wheel stands
    "$GRCTL" --robot $rover -d "$work/port" --json status left >"$work/a" &&
        "$GRCTL" --robot $rover -d "$work/port" --json status left >"$work/b" &&
        python3 -c 'import json, sys
a, b = (json.load(open(f))["joints"][0] for f in sys.argv[1:3])
sys.exit(a["angle_deg"] != b["angle_deg"] or a["speed_dps"] != 0)' "$work/a" "$work/b"
}
killed() { # SIGNAL
    "$GRCTL" --robot $rover -d "$work/port" drive left=90 right=90 --for 30 2>"$work/err" &
    driver=$!
    sleep_until_turning || return 1
    kill "-$1" $driver
    wait $driver 2>/dev/null
    wait_for turned
}
sleep_until_turning() {
    wait_for kill -0 $driver && sleep 1
}
if have_json; then
    check "by Ctrl-C" killed INT
    check "by a kill: the guard stops it" killed KILL
else
    skip "by Ctrl-C" "no python3"
    skip "by a kill: the guard stops it" "no python3"
fi
estops() {
    "$GRCTL" --robot $rover -d "$work/port" drive left=90 --for 30 2>"$work/err" &
    driver=$!
    sleep_until_turning
    exits 0 "$GRCTL" --robot $rover -d "$work/port" estop || return 1
    wait $driver
    [ $? -ne 0 ]
}
check "by an emergency stop" estops
check "which latches" exits 4 "$GRCTL" --robot $rover -d "$work/port" drive left=9
check "until it is released" exits 0 "$GRCTL" --robot $rover -d "$work/port" estop --reset
check "a servo in the other mode is refused with what fixes it" ends_with 1 \
    "mode is 0, 1 is wanted; 'grctl servo-set 1 mode 1 --flash' sets it" sh -c \
    '"$0" --robot "$1" -d "$2" servo off >/dev/null 2>&1
    "$0" --robot "$1" -d "$2" servo-set 1 mode 0 --flash >/dev/null &&
        exec "$0" --robot "$1" -d "$2" drive left=9' "$GRCTL" $rover "$work/port"
check "which does" exits 0 "$GRCTL" --robot $rover -d "$work/port" servo-set 1 mode 1 --flash
check "and it turns" exits 0 "$GRCTL" --robot $rover -d "$work/port" drive left=9 --for 0.2
if have_json && ! "$GRCTL" -d sim serve nowhere 2>&1 | grep -q 'without evhttp'; then
    check "in the cockpit" python3 tests/support/cockpit.py wheels
else
    skip "in the cockpit" "no python3, or no evhttp"
fi
kill $simulator
wait $simulator 2>/dev/null

done_testing
