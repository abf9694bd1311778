#!/bin/sh
# SPDX-License-Identifier: MIT
# Servo models of a user's own beside a robot's file, of every family: driven, read and judged by
# their own ranges; files that are wrong or hostile, each refused with one line that has a place.
. tests/support/cli.sh
unset GRCTL_ROBOT

# arm_of FAMILY: a robot whose servo is in own.yaml.
arm_of() {
    cat >"$work/arm.yaml" <<END
name: arm
family: $1
joints:
  - {name: turn, id: 3, servo: ./own.yaml, limits_deg: [-30, 30]}
END
}
arm() {
    "$GRCTL" --robot "$work/arm.yaml" -d sim "$@"
}
printf '%s\n' status 'servo-get turn' 'move turn 20 50' doctor 'servo off' >"$work/shell"

# drives REGISTER RANGE OUTSIDE: by its own name, speed and range of that register.
drives() {
    exits 0 "$GRCTL" robot check "$work/arm.yaml" && exits 0 arm -y shell "$work/shell" &&
        says 'all 1 answer' && exits 0 arm servo-get turn &&
        exits 2 arm servo-set turn "$1" "$3" --flash && grep -q "$1 takes $2\( \|$\)" "$work/err"
}
while read -r family like register low high outside; do
    arm_of "$family"
    cat >"$work/own.yaml" <<END
name: Mine
like: $like
number: 4711
speed_dps: 100
registers:
  $register: {range: [$low, $high]}
END
    test_that "like $like" drives "$register" "$low to $high" "$outside"
done <<'END'
rs30x RS304MD cw_slope 1 100 101
ics KRS-3301 punch 0 5 6
lx16a LX-16A temperature_limit 50 90 91
feetech STS3215 position_p 1 40 41
feetech SCS0009 position_p 1 40 41
feetech HLS3930 position_p 1 40 41
dynamixel2 XL430-W250 position_p 0 900 901
dynamixel2 XL-320 position_p 0 60 61
dynamixel2 PH54-200-S500-R position_p 0 400 401
dynamixel2 H54-200-S500-R position_p 0 400 401
dynamixel1 AX-12A cw_slope 0 128 129
END

test_case "a strict simulator judges by the servo's own model"
if by_tcp || ! command -v python3 >/dev/null 2>&1; then
    skip "a strict simulator" "needs a pty and python3"
else
    arm_of feetech
    printf 'name: Mine\nlike: STS3215\nregisters: {goal_position: {range: [0, 2600]}}\n' \
        >"$work/own.yaml"
    start_sim --strict --robot "$work/arm.yaml"
    # Goals of 2500 and of 3000; the second is what an STS3215 takes, and this one does not.
    python3 - "$robot" <<'END'
import os, select, sys, tty
fd = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(fd)
for goal in (2500, 3000):
    body = bytes([3, 5, 3, 42, goal & 255, goal >> 8])
    os.write(fd, b"\xff\xff" + body + bytes([~sum(body) & 255]))
    wanted = 6
    while wanted > 0 and select.select([fd], [], [], 30)[0]:
        wanted -= len(os.read(fd, wanted))
END
    wait_for grep -q '^grctl: sim: robot ' "$work/sim.log"
    check "one offence" [ "$(grep -c '^grctl: sim: robot ' "$work/sim.log")" -eq 1 ]
    check "by its own range" grep -q 'range: .*3000 .*outside 0\.\.2600' "$work/sim.log"
    stop_sim
fi

test_case "files that are wrong or hostile"
arm_of feetech
# wrong PATTERN: one line, with this.
wrong() {
    exits 3 "$GRCTL" robot check "$work/arm.yaml" && [ "$(wc -l <"$work/out")" -eq 1 ] &&
        says "$1" && return
    cat "$work/out"
    return 1
}
own() {
    # shellcheck disable=SC2059 # a format
    printf "$@" >"$work/own.yaml"
}
rm -f "$work/own.yaml"
check "missing" wrong 'arm.yaml:4:32: .*own.yaml: no such file \[open\]$'
own ''
check "empty" wrong 'own.yaml:1:1: an empty file'
own '\0\0\0'
check "of zeros" wrong 'own.yaml:1:1: control characters are not allowed'
head -c 300000 /dev/zero | tr '\0' a >"$work/own.yaml"
check "of one long word" wrong 'own.yaml:1:.*no end of this within'
own '[1, 2]\n'
check "a list" wrong 'own.yaml:1:1: not a servo model.s file'
own 'name: M\nlike: ./own.yaml\n'
check "like itself" wrong "own.yaml:2:7: no servo of family feetech called './own.yaml'"
own 'name: M\nlike: RS304MD\n'
check "of another family" wrong "own.yaml:2:7: no servo of family feetech called 'RS304MD'"
own 'name: M\nlike: STS-ANY\n'
check "like what has no scale" wrong 'arm.yaml:4:32: turn: .* of which the scale is not known'
own 'name: "\\e[31mM"\nlike: STS3215\n'
check "a name that colours" wrong 'own.yaml:1:7: name: a plain text'
own 'name: M\nlike: STS3215\nscale: [4096, 360]\n'
check "a short list" wrong 'own.yaml:3:8: scale has 2 numbers, not 3'
own 'name: M\nlike: STS3215\nscale: [0, 360, 0]\n'
check "no counts" wrong 'own.yaml:3:8: scale: at least 1 count'
own 'name: M\nlike: STS3215\nspeed_dps: 1e308\n'
check "a speed beyond reason" wrong "own.yaml:3:12: speed_dps: '1e308' is not a whole number"
own 'name: M\nlike: STS3215\nrates: [[0, 1]]\n'
check "a rate that is none" wrong 'own.yaml:3:9: rates: a code up to 255 and its bps'
own 'name: M\nlike: STS3215\nregisters: {mine: {at: 70000}}\n'
check "an address that is none" wrong "own.yaml:3:24: at: '70000' is not a whole number"
own 'name: M\nlike: STS3215\nregisters: {mine: {at: 42, bytes: 2}}\n'
check "on another register" wrong 'own.yaml:3:13: register mine: it shares a byte'
own 'name: M\nlike: STS3215\nspeed_dps: 0\n'
check "no speed" wrong "own.yaml:3:12: speed_dps: '0' is not a whole number in range"
own 'name: M\nlike: SCS0009\nscale: [1024, 300, 1100]\n'
check "a middle that is no position" wrong 'own.yaml:3:8: scale: the middle 1100 is not within'
own 'name: M\nlike: STS3215\nrates: [[0, 9600], [0, 57600]]\n'
check "a code twice" wrong 'own.yaml:3:20: rates: code 0 is there twice'
own 'name: M\nlike: STS3215\nregisters: {id: {at: 9}}\n'
check "a register moved onto another" wrong 'own.yaml:3:13: register id: only its range and'
own 'name: M\nlike: STS3215\nregisters: {mine: {bytes: 2}}\n'
check "a register without a place" wrong "own.yaml:3:13: register mine: it has no 'at'"
own 'name: M\nlike: STS3215\nregisters: {mine: {at: 90, role: goal}}\n'
check "a second goal" wrong 'own.yaml:3:13: register mine: its role is that of another'
own 'name: M\nlike: STS3215\nwithout: [id]\n'
check "without an id" wrong 'own.yaml:2:7: register id: STS3215 has it'
own 'name: M\nlike: STS3215\nnotes: &n x\nphysics: *n\n'
check "an alias" wrong 'own.yaml:4:10: aliases are not known here'
own 'name: M\nlike: STS3215\n---\nname: N\n'
check "two documents" wrong 'own.yaml:3:1: another document behind the first'
rm "$work/own.yaml"
mkdir "$work/own.yaml"
check "a folder" wrong 'own.yaml: is a directory'
rmdir "$work/own.yaml"
ln -s /dev/zero "$work/own.yaml"
check "a device" wrong 'arm.yaml:4:32: .*own.yaml: is no regular file \[open\]$'
rm "$work/own.yaml"
if mkfifo "$work/own.yaml" 2>/dev/null; then # nobody writes into it
    check "a pipe" wrong 'arm.yaml:4:32: .*own.yaml: is no regular file \[open\]$'
    check "a pipe as the robot" exits 3 "$GRCTL" robot check "$work/own.yaml"
    rm "$work/own.yaml"
fi
own 'name: M\nlike: STS3215\nregisters: {mine: {at: 90, range: [3, .nan]}}\n'
check "a number that is none" wrong 'own.yaml:3:39: range: .nan is not a finite number'
rm "$work/own.yaml"
for path in ./../own.yaml ./sub/../../own.yaml ./; do
    sed "s|./own.yaml|$path|" "$work/arm.yaml" >"$work/beside.yaml"
    outside() {
        exits 3 "$GRCTL" robot check "$work/beside.yaml" &&
            says 'beside.yaml:4:32: .*a file beside the robot.s file is wanted'
    }
    check "$path" outside
done
done_testing
