#!/bin/sh
# SPDX-License-Identifier: MIT
# A lift that is given in millimetres and grippers that are given in percent, from file to plot.
. tests/support/cli.sh

cat >"$work/lift.yaml" <<'EOF'
name: lift
family: feetech
line: {baud: 1000000}
exit: off
joints:
  - {name: turn, id: 1, servo: STS3215, limits_deg: [-110, 110]}
  - {name: height, id: 2, servo: STS3215, limits_mm: [0, 60], mm_per_turn: 180, init_mm: 10}
  - {name: grip, id: 3, servo: STS3215, limits_deg: [-10, 90], percent_deg: [90, -10]}
EOF
export GRCTL_ROBOT="$work/lift.yaml"

test_case "the file"
check "it is right" fails 0 'lift: 3 joints, nothing wrong' "$GRCTL" robot check "$work/lift.yaml"
table() {
    exits 0 "$GRCTL" joints && says '^turn .* -110 *110 *0 *$' &&
        says '^height .* 2 *0 *60 *10mm' && says '^grip .* 3 *0 *100 *90%'
}
check "limits and initial posture in their units" table
if have_json; then
    units_json() {
        exits 0 "$GRCTL" --json joints && json '[(j.get("unit"), j.get("at_min"), j.get("at_max"),
            j.get("init")) for j in lines[0]["joints"]] == [(None, None, None, None),
            ("mm", 0, 60, 10), ("%", 100, 0, 90)] and
            lines[0]["joints"][1]["limits_deg"] == [0, 120]'
    }
    check "in JSON beside degrees" units_json
else
    skip "in JSON beside degrees" "no python3"
fi

start_told_sim --robot "$work/lift.yaml" || {
    echo "Bail out! the simulator did not start"
    exit 1
}

test_case "it moves"
check "a place in mm" fails 0 'done; largest error 0\.. mm (height)' on_robot move height 40 2000
check "of the servo half a turn is 90 mm" sim_shows 2 ' 80\.'
check "with its unit behind it" fails 0 'largest error 0\.. %' on_robot move grip 75% 500
check "100 % is the other end" sim_shows 3 ' 15\.'
check "in degrees all the same" exits 0 on_robot move grip 40deg 500
check "so it is half open" both exits 0 on_robot status --- says '^ *3  *grip .* 50\.[01]%'
check 'and what it is told stands apart from its torque' both exits 0 on_robot status --- \
    says '^ *3  *grip *[0-9.]*% *[0-9.]*%  *on '
check "and the lift is at 40 mm" says '^ *2  *height .* \(39\.9\|40\.[01]\)mm'
check "and the other in degrees" says '^ *1  *turn *-*0\.0  '
check "each in its own" exits 0 on_robot pose turn=10 height=20 grip=100
check "as the servos say" both sim_shows 2 ' \(39\.9\|40\.[01]\)' --- \
    sim_shows 3 ' \(-9\.9\|-10\.[01]\)'
check "in the order of the motors" exits 0 on_robot pose 0 30mm 0%
check "as the servos say again" both sim_shows 2 ' \(59\.9\|60\.[01]\)' --- \
    sim_shows 3 ' \(89\.9\|90\.[01]\)'
if have_json; then
    value_json() {
        exits 0 on_robot --json status && json '[j.get("unit") for j in lines[0]["joints"]] ==
            [None, "mm", "%"] and abs(lines[0]["joints"][1]["value"] - 30) < 0.2 and
            abs(lines[0]["joints"][2]["value"]) < 0.2 and "value" not in lines[0]["joints"][0]'
    }
    check "in JSON" value_json
else
    skip "in JSON" "no python3"
fi

test_case "what is refused"
check "a place beyond its limit" \
    fails 4 'height (motor 2) to 61\.0 mm is outside its limits 0 to 60' \
    on_robot move height 61
check "more than open" fails 4 'grip (motor 3) to 101\.0 % is outside its limits 0 to 100' \
    on_robot move grip 101%
check "another joint's unit" fails 2 "move: '5%' is not a place in mm" on_robot move height 5%
check "nor words" fails 2 "pose: 'grip=wide' is not JOINT=DEG" on_robot pose grip=wide
check "nor mm of a gripper" fails 2 "move: '5mm' is not a number of percent" on_robot move grip 5mm
check "nor percent of an angle" fails 2 "move: '5%' is not an angle in degrees" \
    on_robot move turn 5%

test_case "motions"
cat >"$work/up.pseq" <<'EOF'
type: PoseSeq
name: up
targetBody: lift
refs:
  - {time: 0, refer: {type: Pose, joints: [0, 1, 2], q: [0, 0, 1.5707963]}}
  - {time: 2, refer: {type: Pose, joints: [0, 1, 2], q: [0.1, 1.0471976, 0.6981317]}}
EOF
rows() {
    exits 0 "$GRCTL" show "$work/up.pseq" && says 'angles in degrees, height in mm, grip in %' &&
        says '^ *2000 *5\.7 *30\.0 *50\.0$'
}
check "show" rows
picture() {
    exits 0 "$GRCTL" plot "$work/up.pseq" -o "$work/up.svg" &&
        grep -q 'limits 0 to 60 mm' "$work/up.svg" &&
        grep -q '0 to 50 %' "$work/up.svg" && grep -q '°/s' "$work/up.svg"
}
check "plot" picture
check "play" exits 0 on_robot play "$work/up.pseq"
check "to the same places" both sim_shows 2 ' \(59\.\|60\.\)' --- sim_shows 3 ' \(39\.\|40\.\)'
keep() {
    printf ' q' | "$GRCTL" -d "$robot" record --key -o "$work/kept.pseq" >"$work/out" 2>"$work/err"
}
check "record" keep
kept() {
    exits 0 "$GRCTL" show "$work/kept.pseq" && says ' \(29\.9\|30\.[01]\) *\(49\.9\|50\.[01]\)$'
}
check "what is recorded is that" kept

done_testing
