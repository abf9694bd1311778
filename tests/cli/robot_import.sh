#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl robot import and servos: robots as other programs describe them.
. tests/support/cli.sh
. tests/support/terminal.sh
unset GRCTL_ROBOT

test_case "servos are listed"
check "servos of all families" both exits 0 "$GRCTL" robot servos --- says '^ics  *KRS-3301 '
only_lx() {
    exits 0 "$GRCTL" robot servos lx16a &&
        [ "$(grep -cv '^lx16a ' "$work/out")" -eq 0 ] && says HTS-35H
}
check "of one" only_lx
check "those that cannot be joints" both exits 0 "$GRCTL" robot servos ics --- \
    says '^ics  *KRS-2552RHV .* V  cannot be a joint: it does not tell its position$'
check "and no other" both exits 0 "$GRCTL" robot servos ics --- \
    says '^ics  *KRS-3301 .* V  speed, torque or current unverified$'
check "nor those whose figures have a source" both exits 0 "$GRCTL" robot servos --- \
    says '^feetech  *STS3215 .* V$'
printf '%s\n' 'name: two' 'family: dynamixel2' 'joints:' \
    '  - {name: a, id: 1, servo: 2XL430-W250, limits_deg: [-90, 90]}' >"$work/two.yaml"
check "one whose name begins with a digit may be a joint's" exits 0 \
    "$GRCTL" robot check "$work/two.yaml"
check "of none" fails 2 "no family 'sts'" "$GRCTL" robot servos sts

test_case "Choreonoid"

cat >"$work/arm.body" <<'END'
format: ChoreonoidBody
name: crane
links:
  - {name: BASE, mass: 0.2}
  - {name: TURN, parent: BASE, jointType: revolute, jointId: 0, jointAxis: Z,
     jointRange: [-90, 90]}
  - {name: LIFT, parent: TURN, jointType: revolute, jointId: 1, jointAxis: -Y,
     jointRange: [-20, 60], translation: [0, 0, 0.05]}
END
grep -v LIFT "$work/arm.body" | sed '/jointRange: \[-20/d' >"$work/one.body"
take() {
    "$GRCTL" robot import "$@"
}
check "a body" both exits 0 take "$work/arm.body" -o "$work/arm.yaml" --family dynamixel2 \
    --servo XL430-W250,XL330-M288 --ids TURN=11,LIFT=12 --- grep -q "^name: crane$" "$work/arm.yaml"
check "its file is a robot" fails 0 'crane: 2 joints, nothing wrong' \
    "$GRCTL" robot check "$work/arm.yaml"
check "with the servos and ids that were given" \
    grep -q 'name: LIFT, id: 12, servo: XL330-M288, limits_deg: \[-20, 60\]}' "$work/arm.yaml"
check "which moves in its simulator" both exits 0 \
    "$GRCTL" --robot "$work/arm.yaml" -d sim move LIFT 45 --- true
check "a file is not replaced" fails 2 'arm.yaml is there already; --yes replaces it' \
    take "$work/arm.body" -o "$work/arm.yaml" --ids TURN=11,LIFT=12
check "unless that is wanted" exits 0 take "$work/arm.body" -o "$work/arm.yaml" --yes \
    --ids TURN=11,LIFT=12
check "what is not known is said" both exits 0 take "$work/arm.body" --ids TURN=1,LIFT=2 --- \
    says 'to be filled in .* family and servos,$'
# not_written COMMAND...: refused with status 2, and no file is there.
not_written() {
    rm -f "$work/none.yaml"
    fails 2 "$@" -o "$work/none.yaml" && [ ! -e "$work/none.yaml" ]
}
check "ids are never guessed" not_written \
    'import: the description has no ids of servos; give them: --ids TURN=ID,LIFT=ID$' \
    take "$work/arm.body"
check "nor with --yes" not_written 'no ids of servos' take "$work/arm.body" --yes
check "numbers of joints are no ids: a list is refused" both exits 2 \
    take "$work/arm.body" --ids 11-12 --- grep -q \
    '; name the joints: --ids TURN=11,LIFT=12, or accept the list with --yes$' "$work/err"
check "unless it is accepted" both exits 0 take "$work/arm.body" --ids 11-12 --yes --- \
    says 'LIFT, id: 12,'
asks() {
    type_line "$GRCTL robot import $work/arm.body -o $work/asked.yaml" &&
        until_screen '^id of the servo of TURN? *$' && keys Enter && until_screen "'' is no id" &&
        keys 12 Enter && until_screen '^id of the servo of LIFT? *$' && keys 1x Enter &&
        until_screen "'1x' is no id" && keys 11 Enter && until_screen '2 joints; check it' &&
        grep -q 'TURN, id: 12,' "$work/asked.yaml" && grep -q 'LIFT, id: 11,' "$work/asked.yaml"
}
if have_terminal; then
    open_screen || { echo "Bail out! no screen"; exit 1; }
    check "on a terminal each is asked for, without a usual answer" asks
else
    skip "on a terminal each is asked for, without a usual answer" "no tmux"
fi
check "a list of one joint needs no name" exits 0 take "$work/one.body" --ids 7
sed '1,/^joints:/b
    s/id: 11/id: 5/' "$work/arm.yaml" >"$work/before.yaml"
check "ids of a robot's file" both exits 0 take "$work/arm.body" --ids "@$work/before.yaml" --- \
    says 'TURN, id: 5,'
check "of a robot that comes with grctl" fails 2 "--ids @so101: so101 has no joint 'TURN'" \
    take "$work/arm.body" --ids @so101
check "of no file" fails 3 '--ids @none.yaml: none.yaml: no such file' \
    take "$work/arm.body" --ids @none.yaml
check_json "as JSON" 'lines[0]["name"] == "crane" and lines[0]["file"] is None and
    "STS3215" in lines[0]["text"] and lines[0]["n_joints"] == 2' \
    take "$work/arm.body" --ids TURN=1,LIFT=2 --json
test_case "bodies as Choreonoid writes them"
check "another name" both exits 0 take "$work/arm.body" --ids TURN=1,LIFT=2 --name lift-1 --- \
    says '^name: lift-1$'
sed 's/jointType/joint_type/; s/jointRange/joint_range/; s/jointAxis/joint_axis/
    s/jointId: 0/joint_id: 1, joint_velocity_range: [-100, 90]/
    s/jointId: 1/joint_id: 0, max_joint_velocity: unlimited/' "$work/arm.body" >"$work/new.body"
check "a body as Choreonoid writes it today" both exits 0 take "$work/new.body" --yes --ids 1-2 \
    --servo STS3215 --- says 'LIFT, id: 1, servo: STS3215, limits_deg: \[-20, 60\]}$'
check "with the speed of its slower direction" \
    says 'TURN, id: 2, servo: STS3215, limits_deg: \[-90, 90\], speed_deg_s: 90}$'
{
    cat "$work/arm.body"
    echo 'standardPose: [10, -30]'
    echo 'symmetricJoints: [[TURN, LIFT, -1], [GONE, TURN]]'
} >"$work/pair.body"
check "its standard pose is the initial one, within the limits" both exits 0 \
    take "$work/pair.body" --ids TURN=1,LIFT=2 --- \
    says 'LIFT, .*limits_deg: \[-20, 60\], init_deg: -20, mirror: TURN, mirror_sign: -1}$'
check "and its joints have partners in the mirror" \
    says 'TURN, .*init_deg: 10, mirror: LIFT, mirror_sign: -1}$'
{
    cat "$work/arm.body"
    echo 'symmetricJoints: [[TURN]]'
} >"$work/alone.body"
check "or turn the other way themselves" both exits 0 take "$work/alone.body" \
    --ids TURN=1,LIFT=2 --- says 'TURN, .*limits_deg: \[-90, 90\], mirror_sign: -1}$'
{
    cat "$work/arm.body"
    echo 'symmetricJoints: [TURN]'
} >"$work/odd.body"
check "a row that is none" fails 3 'odd.body:[0-9]*: one or two joints and a sign are wanted' \
    take "$work/odd.body" --ids TURN=1,LIFT=2
test_case "mistakes in ids and files are refused"
check "too few ids" fails 2 '2 ids are wanted' take "$work/arm.body" --ids 1
check "too many" fails 2 '2 ids are wanted' take "$work/arm.body" --ids 1-3
check "ids that are none" fails 2 '2 ids are wanted' take "$work/arm.body" --ids 1,x
check "the same id twice" fails 3 'has the id of another joint' \
    take "$work/arm.body" --ids TURN=4,LIFT=4
check "an id that the family has not" fails 2 'id 32: servos of family ics have 0 to 31' \
    take "$work/arm.body" --family ics --servo KRS-3301 --ids TURN=31,LIFT=32
check "a servo that is none" fails 2 "no servo of family feetech is called 'XL430-W250'" \
    take "$work/arm.body" --servo XL430-W250
check "a list that is too short" fails 2 'one for each of 2 joints' \
    take "$work/arm.body" --servo STS3215,
check "no such file" fails 3 'none.urdf: no such file' take "$work/none.urdf"
check "a folder" fails 3 'is a directory' take "$work"
check "nothing" fails 3 'neither a URDF nor a body' take /dev/null
check "no end of it" fails 3 'longer than 4 MiB' take /dev/zero
check "no folder" fails 3 'no such folder' take "$work/arm.body" --ids TURN=1,LIFT=2 \
    -o "$work/none/arm.yaml"

test_case "URDF"

urdf=tests/cli/urdf/so101.urdf
if [ "${XML:-expat}" = none ]; then
    check "URDF needs expat" fails 3 'built without expat' take "$urdf"
    done_testing
    exit
fi
check "a URDF" both exits 0 take "$urdf" -o "$work/so101.yaml" --family feetech --servo STS3215 \
    --ids 1-6 --- true
check "plays what was made for the robot that comes with grctl" both exits 0 \
    "$GRCTL" --robot "$work/so101.yaml" -d sim play motions/so101-wave.yaml --- \
    says '^largest error'
check_json "and has its joints" \
    '[(j["name"], j["id"], round(j["limits_deg"][0])) for j in lines[0]["joints"]] ==
     [("shoulder_pan", 1, -110), ("shoulder_lift", 2, -100), ("elbow_flex", 3, -97),
      ("wrist_flex", 4, -95), ("wrist_roll", 5, -157), ("gripper", 6, -10)]' \
    "$GRCTL" --robot "$work/so101.yaml" joints --json
check_json "and its parts" 'lines[0]["n_links"] == 8 and lines[0]["mass_kg"] == 0.632' \
    "$GRCTL" robot show "$work/so101.yaml" --json
# As its makers' URDF: the gripper first. No servo may move another joint for that.
{
    sed -n 1,3p "$urdf"
    sed -n 39,45p "$urdf"
    sed -n 4,38p "$urdf"
    sed -n '46,$p' "$urdf"
} >"$work/first.urdf"
right_ids() {
    "$GRCTL" --robot "$work/first.yaml" joints >"$work/joints"
    [ "$(awk 'NR > 1 { print $1 "=" $4 }' "$work/joints" | paste -sd,)" = "$all_ids" ]
}
all_ids=shoulder_pan=1,shoulder_lift=2,elbow_flex=3,wrist_flex=4,wrist_roll=5,gripper=6
for ids in '--ids 1-6' '' "--ids gripper=6,${all_ids%,*}"; do
    # shellcheck disable=SC2086
    check "a gripper that comes first: ${ids:-no ids}" both exits 0 take "$work/first.urdf" --yes \
        -o "$work/first.yaml" --family feetech --servo STS3215 $ids --- right_ids
done
test_case "ids are taken or refused"
listed() {
    exits 0 take "$work/first.urdf" --yes --order file &&
        [ "$(sed -n 's/.*name: \([a-z_]*\), id.*/\1/p' "$work/out" | head -n 1)" = gripper ]
}
check "or stands first, as it is listed" listed
check "ids of a known robot are said" both exits 0 take "$work/first.urdf" --- \
    complains "ids as of so101, whose joints have these names: $all_ids"
check "others are refused" fails 2 '--ids 2-7 gives shoulder_pan the id 2, in so101 it has 1' \
    take "$work/first.urdf" --ids 2-7
check "unless the joints are named" exits 0 take "$work/first.urdf" --yes -o "$work/swapped.yaml" \
    --ids shoulder_pan=6,shoulder_lift=2,elbow_flex=3,wrist_flex=4,wrist_roll=5,gripper=1
check "of which a check warns" both exits 0 "$GRCTL" robot check "$work/swapped.yaml" --- \
    grep -q 'warning: gripper has the id 1, in so101 it has 6' "$work/err"
check "a joint without an id" fails 2 'no id for gripper' take "$work/first.urdf" \
    --ids "${all_ids%,*}"
check "the same joint twice" fails 2 'each joint once' take "$work/first.urdf" \
    --ids "$all_ids,gripper=7"
sed 's/gripper"/claw"/g' "$work/first.urdf" >"$work/other.urdf"
check "of an unknown robot a list is shown" both exits 2 take "$work/other.urdf" --ids 1-6 --- \
    grep -q '^ids: shoulder_pan=1,.*,claw=6$' "$work/err"
check "and taken when that is said" exits 0 take "$work/other.urdf" --ids 1-6 --yes
check "without one it has none" not_written \
    'no ids of servos; give them: --ids shoulder_pan=ID,.*,claw=ID$' take "$work/other.urdf"
check "with a joint's name of its own neither has a known robot's file" fails 2 \
    "--ids @so101: so101 has no joint 'claw'" take "$work/other.urdf" --ids @so101
check "of other servos the names of a known robot say nothing" not_written 'no ids of servos' \
    take "$work/first.urdf" --family lx16a --servo LX-16A
cat >"$work/geared.urdf" <<'END'
<robot name="geared"><link name="base"/><link name="a"/><link name="b"/>
<transmission name="t1"><type>transmission_interface/SimpleTransmission</type>
  <joint name="turn"><hardwareInterface>position</hardwareInterface></joint>
  <actuator name="m1"><mechanicalReduction> -2.5
  </mechanicalReduction></actuator></transmission>
<joint name="turn" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
  <limit lower="-0.5" upper="0.9" velocity="1" effort="1"/></joint>
<joint name="lift" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
  <limit lower="0.2" upper="1.6" velocity="9" effort="1"/></joint>
<ros2_control name="c" type="system"><joint name="turn"/><transmission name="t2">
  <joint name="lift" role="j"><mechanical_reduction>4</mechanical_reduction><offset>0.0</offset>
  </joint><actuator name="m2" role="a"/></transmission></ros2_control></robot>
END
test_case "gears and offsets"
check "gears of transmissions" both exits 0 take "$work/geared.urdf" --ids turn=1,lift=2 \
    -o "$work/geared.yaml" --family feetech --servo STS3215 --- grep -q \
    'turn, .* speed_deg_s: 57.2958, sign: -1, gear: 2.5} # gear: 1 if' "$work/geared.yaml"
check "those of ros2_control, with the servo's middle where it reaches" grep -q \
    'lift, .* init_deg: 51.5662, zero_deg: -206.265, gear: 4} ' "$work/geared.yaml"
check "move in their simulator" both exits 0 \
    "$GRCTL" --robot "$work/geared.yaml" -d sim --json move lift 90 --- true
# geared SED COMPLAINT
geared() {
    sed "$1" "$work/geared.urdf" >"$work/other.urdf"
    fails 3 "$2" take "$work/other.urdf" --ids turn=1,lift=2
}
check "a gear that is in the servo" geared 's/>4</>345</' \
    'lift: STS3215 does not reach its limits with a reduction of 345; take that out'
check "an offset" geared 's/>0.0</>0.1</' ":11: transmission 't2': an offset is not read"
check "no number" geared 's/-2.5/fast/' ":5: transmission 't1': 'fast' is not a number"
check "no gear" geared 's/>4</>0</' "'t2': a reduction of 0.001 to 1000 is wanted"
check "two motors for two joints" geared 's,<actuator name="m2" role="a"/>,<joint name="turn"/>,' \
    "transmission 't2' is of 2 joints: a servo moves one"
check "a joint that is not there" geared 's/joint name="lift" role/joint name="x" role/' \
    "transmission 't2': there is no joint 'x'"
check "two for a joint" geared 's/joint name="lift" role/joint name="turn" role/' \
    "transmission 't2': 'turn' has another one already"
sed 's/<axis/<axes>/' "$urdf" >"$work/broken.urdf"
test_case "files that are broken"
check "one that is broken" fails 3 'broken.urdf:[0-9]*:[0-9]*: mismatched tag' \
    take "$work/broken.urdf"
{
    echo '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    echo '<robot name="&b;"/>'
} >"$work/laughs.urdf"
check "entities" fails 3 'laughs.urdf:1:13: a document type is not read' \
    take "$work/laughs.urdf"
done_testing
