#!/bin/sh
# SPDX-License-Identifier: MIT
# A robot's file with two servos on one shaft, and a finger that mirrors another one.
. tests/support/cli.sh

cat >"$work/two.yaml" <<'END'
name: two
family: dynamixel2
line: {baud: 1000000}
exit: off
joints:
  - {name: base, id: 1, servo: XM430-W350, limits_deg: [-110, 110]}
  - {name: shoulder, servos: [2, 3], servo: XM430-W350, limits_deg: [-20, 60], init_deg: 10}
  - {name: left, id: 4, servo: XL430-W250, limits_deg: [0, 40]}
  - {name: right, id: 5, servo: XL430-W250, follows: left, ratio: -1}
groups:
  - {name: arm, joints: [base, shoulder]}
END
export GRCTL_ROBOT="$work/two.yaml"

test_case "the file"
check "it is right" fails 0 'two: 5 joints, nothing wrong' "$GRCTL" robot check "$work/two.yaml"
check "the second servo is a joint that follows" both exits 0 "$GRCTL" joints --- \
    says '^shoulder\.2 .* 3 .* 60 .*arm (follows shoulder)$'
check "with the limits of the one that it follows" says '^right .* -40 *0 *0 .*(follows left)$'
if have_json; then
    follows_json() {
        exits 0 "$GRCTL" --json joints && json '[j.get("follows") for j in lines[0]["joints"]] ==
            [None, None, 1, None, 3] and lines[0]["joints"][4]["ratio"] == -1'
    }
    check "in JSON" follows_json
else
    skip "in JSON" "no python3"
fi

start_told_sim --robot "$work/two.yaml" || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "it moves"
check "one servo takes the other along" exits 0 on_robot move shoulder 45 500
check "the other way round" both sim_shows 2 ' 45\.0' --- sim_shows 3 ' -45\.0'
check "a finger takes the other one" exits 0 on_robot move left 30 500
check "at its ratio" both sim_shows 4 ' 30\.' --- sim_shows 5 ' -30\.'
check "what follows is not sent anywhere" fails 2 'move: right follows left; move left instead' \
    on_robot move right -10
check "nor by a pose" fails 2 'pose: shoulder.2 follows shoulder' \
    on_robot pose base=3 shoulder.2=4
check "its torque goes with the other's" exits 0 on_robot servo off shoulder.2
limp() {
    exits 0 on_robot status && says '^ *2 .* off ' && says '^ *3 .* off '
}
check "of both" limp

test_case "servos apart"
check "they are turned apart" tell turn 3 10
check "they get no torque" fails 4 'safety: servos apart (.* deg): motor 2 (shoulder) and' \
    on_robot move shoulder 20 1000
still_limp() {
    sim_shows 2 ' off\|limp\|without torque' && sim_shows 3 ' off\|limp\|without torque'
}
check "none of the two" still_limp
check "together they move again" tell turn 3 -45
check "so it does" exits 0 on_robot move shoulder 20 500

done_testing
