#!/bin/sh
# SPDX-License-Identifier: MIT
# Robots other than GR001: --robot, files, their motions.
. tests/support/cli.sh
unset GRCTL_ROBOT

test_case "which"

check "those that come with it" both exits 0 "$GRCTL" robot list --- says '^pan-tilt  *feetech'
check "one of them" both exits 0 "$GRCTL" robot show koch --- says 'family dynamixel2'
check "its joints" both exits 0 "$GRCTL" --robot so101 joints arm --- says '^wrist_roll .* -157 '
in_environment() {
    exits 0 env GRCTL_ROBOT=pan-tilt "$GRCTL" joints && says '^tilt '
}
check "in the environment" in_environment
check "GR001 else" both exits 0 "$GRCTL" joints --- says '^R_KNEE_P '
check "a name nearly right" fails 2 "no robot called 'so10'; did you mean so101?" \
    "$GRCTL" --robot so10 joints
check "another name" fails 2 "a file is named with its folder: ./spider.yaml" \
    "$GRCTL" --robot spider joints
check "another robot's joint" fails 2 'as wrist_flex, m4 or j3, groups are all arm' \
    "$GRCTL" --robot so101 -d sim move R_KNEE_P 3
check "servos that no board takes" fails 2 'cannot be behind GR001' \
    "$GRCTL" --robot so101 --wiring board joints
completes() {
    "$GRCTL" __complete --robot so101 move wr >"$work/out" && says '^wrist_flex$' &&
        "$GRCTL" __complete --robot k >"$work/out" && says '^koch-leader'
}
check "completion knows both" completes

test_case "a file"

cat >"$work/arm.yaml" <<'END'
name: crane
family: dynamixel2
line: {baud: 57600}
joints:
  - {name: turn, id: 3, servo: XL430-W250, limits_deg: [-90, 90]}
  - {name: lift, id: 4, servo: XL330-M288, limits_deg: [-20, 60], init_deg: 10, sign: -1}
END
check "a file" fails 0 'crane.*2 joints, nothing wrong\|crane: 2 joints' \
    "$GRCTL" robot check "$work/arm.yaml"
check "moves in its simulator" fails 0 'done; largest error 0\.[0-4]' \
    "$GRCTL" --robot "$work/arm.yaml" -d sim init
check "joint by joint" fails 0 '(lift)\|(turn)' \
    "$GRCTL" --robot "$work/arm.yaml" -d sim move lift 50
check "within its limits" fails 4 'lift (motor 4) to 61.0 deg is outside its limits -20 to 60' \
    "$GRCTL" --robot "$work/arm.yaml" -d sim move lift 61
loud() {
    sed 's/^name.*/&\ntitle: "Loud\\a\\e[2J\\nrobot"/' "$work/arm.yaml" >"$work/loud.yaml"
    exits 0 "$GRCTL" robot show "$work/loud.yaml" && says '^crane: Loud??\[2J?robot$'
}
check "its title is a line without control characters" loud
sed 's/limits_deg: \[-90, 90\]/limit_deg: [-90, 90]/' "$work/arm.yaml" >"$work/wrong.yaml"
check "a mistake has line and column" fails 3 "wrong.yaml:5:44: no key .* called 'limit_deg'" \
    "$GRCTL" --robot "$work/wrong.yaml" joints
check "and is found" both exits 3 "$GRCTL" robot check "$work/wrong.yaml" --- \
    says "5:5: a joint has no 'limits_deg'"

cat >"$work/clone.yaml" <<'END'
# A clone of the STS3215 with a shorter range and a gain of its own.
name: Clone-15
like: STS3215
number: 4711
registers:
  goal_position: {range: [0, 3100]}
  my_gain: {at: 50, bytes: 2, access: kept rw, range: [0, 500], default: 7}
END
cat >"$work/cloned.yaml" <<'END'
name: cloned
family: feetech
joints:
  - {name: turn, id: 3, servo: ./clone.yaml, limits_deg: [-90, 90]}
  - {name: lift, id: 4, servo: STS3215, limits_deg: [-20, 60]}
END
cloned() {
    "$GRCTL" --robot "$work/cloned.yaml" -d sim "$@"
}
check "a servo model beside it" fails 0 '2 joints, nothing wrong' \
    "$GRCTL" robot check "$work/cloned.yaml"
check "its registers" both exits 0 cloned servo-get 3 --- says '^ 50  my_gain  *7$'
check "are those of its joint alone" fails 2 "no register 'my_gain'" cloned servo-get 4 my_gain
check "are set within their range" fails 2 'my_gain takes 0 to 500' \
    cloned servo-set 3 my_gain 501
check "and can be set" fails 0 'my_gain 7 -> 100' cloned servo-set 3 my_gain 100
check "doctor knows it" exits 0 cloned doctor
check "so does info" both exits 0 cloned info --- says '^  3  Clone-15 .* turn$'
check "it moves" fails 0 'done; largest error 0\.[0-4]' cloned move turn 50
start_sim --robot "$work/cloned.yaml"
found() {
    exits 0 "$GRCTL" -d "$robot" -b 1000000 scan --family feetech &&
        says '^  3  unknown model 4711 '
}
check "who does not know it says its number" found
sed '/clone.yaml/d' "$work/cloned.yaml" >"$work/alone.yaml"
alone() {
    "$GRCTL" --robot "$work/alone.yaml" -d "$robot" "$@" >"$work/out" 2>"$work/err"
}
any() {
    alone servo-get 3 && says '^ 42  goal_position  *[0-9]*$' && says '^ 62  voltage .* V$' &&
        grep -q 'servo 3: unknown model 4711; as STS-ANY, what all of its series have' "$work/err"
}
check "shows what all have, and counts for what is not known" any
check "not of one that is known" \
    both alone servo-get 4 goal_position --- says '^ 42  goal_position .* deg$'
for any in feetech:STS-ANY dynamixel2:X-ANY dynamixel1:AX-MX-ANY; do
    cat >"$work/any.yaml" <<END
name: a
family: ${any%:*}
joints:
  - {name: x, id: 1, servo: ${any#*:}, limits_deg: [-9, 9]}
END
    check "${any#*:} is no joint" fails 3 "x: ${any#*:} stands for servos of which the scale" \
        "$GRCTL" --robot "$work/any.yaml" joints
done
while read -r family model why; do
    printf 'name: a\nfamily: %s\njoints: [{name: x, id: 1, servo: %s, limits_deg: [-9, 9]}]\n' \
        "$family" "$model" >"$work/no_joint.yaml"
    check "$model is no joint" fails 3 "x: $why" "$GRCTL" --robot "$work/no_joint.yaml" joints
done <<'END'
feetech SCS15 the scale of a SCS15 is not known
feetech SM85CL the scale of a SM85CL is not known
ics KRS-2552RHV a KRS-2552RHV does not tell where it stands
END
drops() {
    "$GRCTL" -d "$robot" -b 1000000 robot new --family feetech -o "$work/new.yaml" 2>"$work/err" &&
        grep -q 'id 3 .* unknown model 4711; .* describe it in a file' "$work/err" &&
        grep -q 'id: 4, servo: STS3215' "$work/new.yaml" && ! grep -q 'id: 3' "$work/new.yaml"
}
check "and guesses nothing" drops
stop_sim
sed 's/3100/300/' "$work/clone.yaml" >"$work/short.yaml"
sed 's/clone.yaml/short.yaml/' "$work/cloned.yaml" >"$work/shortened.yaml"
check "its range is judged" fails 3 'shortened.yaml:4:58: turn: its servo does not reach' \
    "$GRCTL" --robot "$work/shortened.yaml" joints
sed 's/number/numbr/' "$work/clone.yaml" >"$work/short.yaml"
check "a mistake in it has its file and line" fails 3 \
    "short.yaml:4:1: no key in the file called 'numbr'; did you mean 'number'?" \
    "$GRCTL" --robot "$work/shortened.yaml" joints
rm "$work/short.yaml"
check "it is not there" fails 3 'shortened.yaml:4:32: .*short.yaml: no such file' \
    "$GRCTL" --robot "$work/shortened.yaml" joints
check "no file" fails 3 'none.yaml: no such file' "$GRCTL" --robot "$work/none.yaml" joints
check "a folder" fails 3 'is a folder' "$GRCTL" --robot "$work/" joints

test_case "motions"

arm() {
    "$GRCTL" --robot so101 -d sim "$@"
}
# plays COMMAND...: to the end.
plays() {
    exits 0 "$@" && says '^largest error at the end'
}
check "an arm waves" plays arm play motions/so101-wave.yaml
check "and is rehearsed" both exits 0 "$GRCTL" --robot so101 play --dry-run --table \
    motions/so101-wave.yaml --- says .
check "its motion is looked at for it" fails 0 'nothing wrong' \
    "$GRCTL" check motions/so101-wave.yaml
check "and drawn" both exits 0 "$GRCTL" plot -o "$work/wave.svg" motions/so101-wave.yaml --- \
    grep -q wrist_flex "$work/wave.svg"
check "a humanoid's is refused" fails 3 'greet.pseq: has 20 joints, so101 has 6' \
    arm play motions/greet.pseq
check "motions of the board too" fails 2 'slot: so101 has no board here' arm slot 1
check "torque by group" fails 0 'torque of 5 joints is on' arm servo on arm

test_case "pipes and folders"

mkfifo "$work/pipe"
mkdir "$work/folder"
while read -r what complaint; do
    check "robot check of a $what" fails 3 "^grctl: .*/$what: $complaint" \
        "$GRCTL" robot check "$work/$what"
    check "--robot of a $what" fails 3 "^grctl: .*/$what: $complaint" \
        "$GRCTL" --robot "$work/$what" joints
done <<'END'
pipe is a pipe; a robot's file must be a regular file$
folder is a folder, not a robot's file$
END
for option in "calibrate --from" "calibrate --restore" "servo-set 1 --restore"; do
    # shellcheck disable=SC2086 # words
    check "$option of a pipe" fails 3 '/pipe: is a pipe; a regular file is needed$' \
        arm $option "$work/pipe"
done

test_case "servos without registers"

for family in lx16a:LX-16A ics:KRS-3301; do
    cat >"$work/pair.yaml" <<END
name: pair
family: ${family%%:*}
joints:
  - {name: pan, id: 1, servo: ${family##*:}, limits_deg: [-60, 60]}
  - {name: tilt, id: 2, servo: ${family##*:}, limits_deg: [-60, 60], sign: -1}
END
    check "$family moves" both exits 0 "$GRCTL" --robot "$work/pair.yaml" -d sim move tilt 20 --- \
        written "$work/err" 'done; largest error 0\.[01] deg'
    check "$family is found" both exits 0 "$GRCTL" --robot "$work/pair.yaml" -d sim scan --last 3 \
        --- says '^  2  .* tilt$'
done
done_testing
