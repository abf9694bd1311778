#!/bin/sh
# SPDX-License-Identifier: MIT
# A robot of two lines where robots of one are expected: in a fleet, as a leader and a follower, and
# moved by hand.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
arms=$PWD/docs/examples/robots/two-arms.yaml
ports="left=$work/both-left,right=$work/both-right"
"$GRCTL" --robot "$arms" sim --link "$work/both" >"$work/both.out" 2>&1 3>&- &
echo $! >>"$work/pids"
wait_for test -e "$work/both-right" || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "in a fleet"
mkdir -p "$work/config/grctl" "$work/motions"
cat >"$work/config/grctl/config.yaml" <<EOF2
robots: {arms: {device: "$ports", robot: $arms}}
EOF2
printf 'type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n    content: JointPosition\n' \
    >"$work/motions/wave.yaml"
printf '    frameRate: 1\n    numFrames: 3\n    numParts: 8\n    frames:\n' \
    >>"$work/motions/wave.yaml"
for angle in 0 0.5 0.1; do
    echo "      - [$angle, 0, 0, 0, $angle, 0, 0, 0]" >>"$work/motions/wave.yaml"
done
begin_open_broker
begin_agent arms --timeout 300
wait_for is_listed arms ONLINE || { echo "Bail out! the agent did not start"; exit 1; }
check "it plays" exits 0 fleet play wave.yaml --on-link-lost finish
moves() {
    fleet status --json >"$work/look" && grep -q '"play": *"playing"' "$work/look"
}
stopped() {
    : >"$work/said"
    fleet play wave.yaml -s 10 --on-link-lost finish \
        >"$work/played" 2>"$work/said" </dev/null 3>&- &
    play=$!
    { written "$work/said" "all begin in" || { cat "$work/said" "$work/arms.err"; false; }; } &&
        comes_to_move && exits 0 fleet estop &&
        grep -q '^arms/arms: stopped$' "$work/err" && ended_with 1 "$play"
}
check "it is stopped in mid motion" stopped
check "it is released" exits 0 fleet reset
kill "$agent"
wait "$agent"

test_case "as a follower"
on_ports() {
    "$GRCTL" --robot "$arms" -d "$ports" --timeout 300 "$@"
}
sed 's/^name: two-arms/name: leaders/' "$arms" >"$work/leaders.yaml"
check "joint by joint" ends_with 0 'targets at .* Hz' \
    "$GRCTL" follow "$work/leaders.yaml@sim" "$arms@$ports" --for 1
check "both hold" ends_with 0 '^right *4  R_gripper .* on ' on_ports status
by_hand() {
    printf ' q' | on_ports record -o "$work/hand.m" >"$work/said" 2>&1 || cat "$work/said"
    test -s "$work/hand.m"
}
check "by hand: it is recorded" by_hand
all_joints() {
    cat "$work/hand.m"
    grep -qE "^[0-9]+ ( -?[0-9]+){8} *$" "$work/hand.m"
}
check "all its joints" all_joints
done_testing
