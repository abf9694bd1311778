#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl play: what it sends by its options, and when it warns of a fall.
. tests/support/cli.sh

greet=motions/greet.pseq

# The frames of a dry run, as "TIME ANGLE..." with angles in 0.1 degree by motor, hex to numbers by
# the reference's table: motor m at byte 5 (m - 1) + 10, low byte first.
frames() {
    exits 0 "$GRCTL" play --dry-run "$@" || return 1
    awk 'function byte(hex) { return 16 * (index(digits, substr(hex, 1, 1)) - 1) + \
                                     index(digits, substr(hex, 2, 1)) - 1 }
        BEGIN { digits = "0123456789ABCDEF" }
        NF != 111 || $2 != "53" || $3 != "6C" { print "no frame: " $0; exit 1 }
        { line = $1
          for (m = 1; m <= 20; m++) {
              a = byte($(5 * (m - 1) + 12)) + 256 * byte($(5 * (m - 1) + 13))
              line = line " " (a > 32767 ? a - 65536 : a) }
          print line }' "$work/out" >"$work/frames"
}

# plays LINES LAST-MS ARGUMENTS...: so many frames, the last one then.
plays() {
    plays_n=$1
    plays_ms=$2
    shift 2
    frames "$@" || return 1
    set -- "$(wc -l <"$work/frames")" "$(sed -n '$s/ .*//p' "$work/frames")"
    [ "$1" -eq "$plays_n" ] && [ "$2" = "$plays_ms" ] && return
    echo "$1 frames, the last at $2 ms"
    return 1
}

# angle N MOTOR DDEG: of the last dry run.
angle() {
    angle_got=$(sed -n "$1p" "$work/frames" | cut -d ' ' -f $(($2 + 1)))
    [ "$angle_got" = "$3" ] || { echo "frame $1, motor $2: $angle_got, not $3"; return 1; }
}

test_case "what is sent"

# Ten key poses in 5 s, the last two keys 4.2 and 5 s. The first frame is the approach, 100 ms.
check "a frame a key pose, as it begins" plays 10 4300 --key "$greet"
check "its angles: motor 2, NECK_Y, to 20 degrees" angle 2 2 200
check "its angles: motor 1, CHEST_P, to -20 degrees" angle 8 1 -200
check "50 Hz for 5 s" plays 251 5000 --rate 50 --unwatched "$greet"
# 5 s at 39 Hz, the last frame on the end of the motion.
check "by default what the line allows, through the board" plays 196 5000 "$greet"
check "39 Hz may be asked for" plays 196 5000 --rate 39 "$greet"
too_fast='40 frames a second leave no time to read the joints (at most 39); --unwatched plays them'
printf 'type: PoseSeq\nname: t\nrefs:\n- {time: 0, refer: {type: Pose, joints: [0], q: [0]}}
- {time: 1e9, refer: {type: Pose, joints: [0], q: [0]}}\n' >"$work/long.pseq"
check "a motion of 31 years" fails 3 'long.pseq: larger than a built-in cap allows' \
    "$GRCTL" play --dry-run "$work/long.pseq"
sed 's/, joints: .*\]}/}/; s/1e9/1/' "$work/long.pseq" >"$work/still.pseq"
check "a motion of no joints" fails 3 'still.pseq: no posture sets any joint' \
    "$GRCTL" play --dry-run "$work/still.pseq"
check "40 Hz may not" fails 4 "$too_fast" "$GRCTL" play --dry-run --rate 40 "$greet"
check "nor on a robot, of which nothing is opened" \
    fails 4 "$too_fast" "$GRCTL" -d /dev/none play --rate 40 "$greet"
on_a_bus() {
    exits 0 "$GRCTL" --wiring bus play --dry-run "$greet" && [ "$(wc -l <"$work/out")" -eq 251 ] &&
        exits 0 "$GRCTL" --wiring bus play --dry-run --rate 80 "$greet" &&
        fails 4 'at most 80' "$GRCTL" --wiring bus play --dry-run --rate 81 "$greet" &&
        fails 4 'at most 11' "$GRCTL" -b 19200 play --dry-run --rate 12 "$greet"
}
check "on a bus 50 Hz, and up to 80; on a slow line less" on_a_bus
check "10 Hz for 5 s" plays 51 5000 --rate 10 "$greet"
check "half the speed" plays 101 10000 --rate 10 --speed 50 "$greet"
check "twice" plays 20 9400 --key --repeat 2 "$greet"
check "two files" plays 20 9400 --key "$greet" "$greet"
printf '%s\n' 'type: PoseSeq' 'name: lean' 'refs:' \
    '  - {time: 0, refer: {type: Pose, joints: [ 12, 13 ], q: [ -0.1, 0 ]}}' \
    '  - {time: 1, refer: {type: Pose, joints: [ 12, 13 ], q: [ 0.03, 0.1 ]}}' >"$work/lean.pseq"
clamped() {
    fails 4 'lean.pseq:5:60: CHEST_P: 1.7 degrees, outside -95..0; --clamp plays it at the limit' \
        "$GRCTL" play --dry-run --key "$work/lean.pseq" &&
        exits 0 "$GRCTL" play --dry-run --key --clamp "$work/lean.pseq" &&
        says '^100 .* 01 00 00 64 00 02 39 00 64 00 ..$' &&
        exits 0 "$GRCTL" -d sim play --key --clamp "$work/lean.pseq" &&
        says "^angles outside a joint's limits, taken to the limit: 1$"
}
check "--clamp plays an angle outside limits at the limit" clamped
# Within a degree of a limit: 0.2 and 0.6 degrees, and on the curve between.
sed 's/ 0.03, 0.1 / 0.0035, 0.1 /; $p; $s/time: 1/time: 2/; $s/ 0.0035, / 0.0105, /' \
    "$work/lean.pseq" >"$work/near.pseq"
counted='near.pseq:5: warning: 2 angles up to 0.6 degrees outside their limits (CHEST_P): clamped$'
near() {
    exits 0 "$GRCTL" play "$@" "$work/near.pseq" || return 1
    [ "$(grep -c clamped "$work/err")" -eq 1 ] && grep -q "$counted" "$work/err" && return
    cat "$work/err"
    return 1
}
near_frames() { # no frame with motor 1 above 0
    exits 0 "$GRCTL" play --dry-run "$@" "$work/near.pseq" && says ' 05 02 01 00 00 ' &&
        ! grep ' 05 02 01 \(0[1-9A-F]\|[1-9A-F].\) 00 ' "$work/out"
}
check "within a degree of a limit: one warning" near --dry-run --key
check "the robot plays it" near -d sim --speed 400
check "at the limit by keys" near_frames --key
check "at the limit at a rate" near_frames --rate 20
check "at the limit backwards" near_frames --key --reverse
check "a move has no slack" fails 4 'CHEST_P' "$GRCTL" -d sim move CHEST_P 0.6
kept() {
    exits 0 "$GRCTL" convert "$work/near.pseq" "$work/near.m" && grep -q ' 6' "$work/near.m"
}
check "nor does convert change an angle" kept
printf '%s\n' 'type: PoseSeq' 'name: nod' 'refs:' \
    '  - {time: 0, refer: {type: Pose, joints: [ 13 ], q: [ -0.5 ]}}' \
    '  - {time: 0.1, refer: {type: Pose, joints: [ 13 ], q: [ 0.5 ]}}' >"$work/nod.pseq"
slower() {
    fails 4 'nod.pseq:5:58: NECK_Y: 57.3 degrees in 100 ms, .*; a lower --speed gives it time$' \
        "$GRCTL" play --dry-run "$work/nod.pseq" &&
        fails 4 ' in 111.1 ms, ' "$GRCTL" play --dry-run --speed 90 "$work/nod.pseq" &&
        exits 0 "$GRCTL" play --dry-run --speed 50 "$work/nod.pseq"
}
check "too fast a move is played at a lower speed" slower
printf '%s\n' 'type: PoseSeq' 'name: wag' 'refs:' \
    '  - {time: 0, refer: {type: Pose, joints: [ 13, 24 ], q: [ 0, 0 ]}}' >"$work/wag.pseq"
sed 's/\[ 0, 0, /&0, /; s/numParts: 20/numParts: 21/' motions/greet.yaml >"$work/wide.yaml"
printf '500%22s\n' '' | sed 's/ / 0/g' >"$work/wide.m"
strangers() {
    fails 3 'wag.pseq: has 25 joints, GR001 has 20$' "$GRCTL" play --dry-run "$work/wag.pseq" &&
        fails 3 'wide.yaml: has 21 joints, GR001 has 20$' \
            "$GRCTL" play --dry-run --clamp "$work/wide.yaml" &&
        exits 3 "$GRCTL" -d sim play "$work/wide.m" &&
        grep -q 'wide.m: has 22 joints, GR001 has 20$' "$work/err"
}
check "motions with joints that the robot does not have" strangers
# Of another robot: nothing may move, not even the first joints.
sed '/^targetBody/d' motions/so101-wave.yaml >"$work/nameless.yaml"
printf '500 0 0 0 0 0 0\n1000 0 0 0 0 0 0\n' >"$work/six.m"
printf '%s\n' 'type: PoseSeq' 'name: nod' 'targetBody: KNIGHT' 'refs:' \
    '  - {time: 1, refer: {type: Pose, joints: [ 2 ], q: [ 0 ]}}' >"$work/knight.pseq"
of_another() {
    for option in --dry-run -q; do
        fails 2 'wave.yaml: made for so101, not for GR001; choose that robot with --robot;' \
            "$GRCTL" -d sim play $option motions/so101-wave.yaml &&
            fails 2 'knight.pseq: made for KNIGHT, not for GR001' \
                "$GRCTL" -d sim play $option "$work/knight.pseq" &&
            fails 2 'nameless.yaml: has fewer angles than GR001 has joints (20), and names ' \
                "$GRCTL" -d sim play $option "$work/nameless.yaml" &&
            exits 2 "$GRCTL" -d sim play $option "$work/six.m" && [ ! -s "$work/out" ] &&
            grep -q 'six.m: has fewer angles than GR001 has joints' "$work/err" || return 1
    done
    fails 2 'made for so101, not for GR001' "$GRCTL" -d sim pose @motions/so101-wave.yaml:9 &&
        fails 2 'made for so101, not for GR001' "$GRCTL" -d sim monitor motions/so101-wave.yaml &&
        fails 2 'made for so101, not for GR001' \
            "$GRCTL" -d sim play motions/greet.pseq motions/so101-wave.yaml &&
        fails 2 'made for so101, not for koch' \
            "$GRCTL" --robot koch -d sim play motions/so101-wave.yaml
}
check "a motion of another robot is refused" of_another
# A robot of one's own whose joints are called as those of so101, in that order.
sed 's/^name: so101$/name: mine/; /^model:/d' src/robots/so101.yaml >"$work/mine.yaml"
sed 's/gripper/claw/g' "$work/mine.yaml" >"$work/clawed.yaml"
sed 's/shoulder_pan/other/g; s/shoulder_lift/shoulder_pan/g; s/other/shoulder_lift/g' \
    "$work/mine.yaml" >"$work/turned.yaml"
same_joints() {
    exits 0 "$GRCTL" --robot "$work/mine.yaml" play --dry-run motions/so101-wave.yaml &&
        exits 0 "$GRCTL" --robot "$work/mine.yaml" check motions/so101-wave.yaml &&
        exits 0 "$GRCTL" --robot "$work/mine.yaml" -d sim pose @motions/so101-wave.yaml:9 ||
        return 1
    for other in clawed turned; do
        fails 2 'made for so101, not for mine' "$GRCTL" --robot "$work/$other.yaml" -d sim \
            play motions/so101-wave.yaml || return 1
    done
}
check "a robot with the same joints plays it, one with another order does not" same_joints
forced() {
    exits 0 "$GRCTL" play --force --dry-run "$work/six.m" &&
        exits 0 "$GRCTL" play --force --clamp --speed 50 --dry-run "$work/nameless.yaml" &&
        exits 0 "$GRCTL" play --force --clamp --speed 50 --dry-run motions/so101-wave.yaml &&
        exits 0 "$GRCTL" --robot so101 play --dry-run "$work/nameless.yaml"
}
check "and played where that is forced" forced
named_fewer() {
    sed 's/^targetBody.*/targetBody: GR001/' motions/so101-wave.yaml >"$work/legs.yaml"
    exits 0 "$GRCTL" play --clamp --speed 50 --dry-run "$work/legs.yaml"
}
check "some joints of the same robot are played" named_fewer
upright='rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]'
links="ikLinks: [ { name: WAIST, isBaseLink: true, translation: [ 0, 0, 0.15 ], $upright }, \
{ name: R_ANKLE_R, translation: [ 0, -0.0221, 0.0225 ], $upright } ]"
sed "s/q: \[ 0.03, 0.1 \]/&, $links/" "$work/lean.pseq" >"$work/solved.pseq"
clamped_solved() {
    fails 4 'solved.pseq:5:60: CHEST_P' "$GRCTL" play --dry-run "$work/solved.pseq" &&
        exits 0 "$GRCTL" play --dry-run --key --clamp "$work/solved.pseq" &&
        says '^100 .* 01 00 00 64 00 02 39 00 64 00 '
}
check "also where legs are solved" clamped_solved
for joint in 16 19; do
    printf '%s\n' 'type: PoseSeq' 'name: ""' 'refs:' \
        "  - {time: 0, refer: {type: Pose, name: \"\", joints: [ $joint ], q: [ 0 ]}}" \
        "  - {time: 1, refer: {type: Pose, name: \"\", joints: [ $joint ], q: [ 0.1 ]}}" \
        >"$work/j$joint.pseq"
done
other_joints() {
    exits 0 "$GRCTL" play --dry-run --key --ik off "$work/j16.pseq" "$work/j19.pseq" &&
        says '^1440 53 0C FA AF 08 00 1E 04 01 39 00 64 00 4E$'
}
check "a second file may move other joints" other_joints
check "reversed" plays 10 4300 --key --reverse "$greet"
check "reversed: CHEST_P first" angle 2 1 -200
check "mirrored" plays 10 4300 --key --mirror "$greet"
check "mirrored: NECK_Y the other way" angle 2 2 -200
check "mirrored: the left shoulder, the other way" angle 2 7 1200
from() {
    frames --key --from 4500 "$greet" && [ "$(wc -l <"$work/frames")" -lt 4 ]
}
check "from the last key pose on" from
check "from beyond the end" fails 2 'beyond the end' "$GRCTL" play --dry-run --from 6000 "$greet"
check "--rate and --key" fails 2 'cannot be used together' "$GRCTL" play --key --rate 9 "$greet"

# The same motion in each format: a .m and an .mseq frame a line; a .yaml at its own rate.
for format in m mseq yaml; do
    check "convert to .$format" exits 0 "$GRCTL" convert --rate 50 "$greet" "$work/greet.$format"
done
check "play .m" plays 10 4300 "$work/greet.m"
check "its last posture is the initial one" angle 10 12 -400
check "play .mseq" plays 10 4300 "$work/greet.mseq"
check "increments lead to the initial posture" angle 10 12 -400
check "play .yaml" plays 151 5000 --rate 30 "$work/greet.yaml"
check "one after the other" plays 40 19600 --key "$greet" "$work/greet.m" "$greet" "$work/greet.m"
check_json "a dry run as JSON" \
    'len(lines) == 10 and all(len(l["hex"].split()) == 110 for l in lines)' \
    "$GRCTL" --json play --dry-run --key "$greet"

test_case "a fall"

# Leans over to where it falls.
printf '%s\n' 'type: PoseSeq' 'name: falls' 'targetBody: GR001' 'refs:' \
    '  - {time: 0, refer: {type: Pose, joints: [ 4, 10, 12 ], q: [ 0, 0, 0 ]}}' \
    '  - {time: 2, refer: {type: Pose, joints: [ 4, 10, 12 ], q: [ 0.6, -0.6, 0 ]}}' \
    >"$work/falls.pseq"
falls='falls.pseq:[0-9]*: warning: the robot would fall: the ZMP is [0-9.]* mm outside the soles'
silent() {
    exits 0 "$@" && [ ! -s "$work/err" ]
}
check "play warns of a fall" both exits 0 "$GRCTL" play --dry-run "$work/falls.pseq" \
    --- grep -q "$falls" "$work/err"
check "unless it is silenced" silent "$GRCTL" play --dry-run --force "$work/falls.pseq"
mkdir -p "$XDG_CONFIG_HOME/grctl"
echo 'warn_fall: false' >"$XDG_CONFIG_HOME/grctl/config.yaml"
check "by the configuration too" silent "$GRCTL" play --dry-run "$work/falls.pseq"
echo 'warn_fall: maybe' >"$XDG_CONFIG_HOME/grctl/config.yaml"
check "which says true or false" fails 3 'config.yaml:1:12: true or false is wanted here' \
    "$GRCTL" play --dry-run "$work/falls.pseq"
rm "$XDG_CONFIG_HOME/grctl/config.yaml"
# What stands when it is slow falls when it is fast: the arms swing.
printf '%s\n' 'type: PoseSeq' 'name: sways' 'targetBody: GR001' 'refs:' \
    '  - {time: 0, refer: {type: Pose, joints: [ 4, 10 ], q: [ 0, 0 ]}}' \
    '  - {time: 1, refer: {type: Pose, joints: [ 4, 10 ], q: [ 0.1, -0.1 ]}}' \
    '  - {time: 2, refer: {type: Pose, joints: [ 4, 10 ], q: [ -0.1, 0.1 ]}}' \
    '  - {time: 3, refer: {type: Pose, joints: [ 4, 10 ], q: [ 0, 0 ]}}' >"$work/sways.pseq"
check "what stands when it is slow" silent "$GRCTL" play --dry-run "$work/sways.pseq"
check "falls when it is fast" both exits 0 "$GRCTL" play --dry-run --speed 800 "$work/sways.pseq" \
    --- grep -q 'sways.pseq.*the robot would fall' "$work/err"
done_testing
