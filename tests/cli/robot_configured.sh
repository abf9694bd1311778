#!/bin/sh
# SPDX-License-Identifier: MIT
# Robots other than GR001: the key robot of the configuration, a record and its motion.
. tests/support/cli.sh
unset GRCTL_ROBOT

# plays COMMAND...: to the end.
plays() {
    exits 0 "$@" && says '^largest error at the end'
}

cat >"$work/arm.yaml" <<'END'
name: crane
family: dynamixel2
line: {baud: 57600}
joints:
  - {name: turn, id: 3, servo: XL430-W250, limits_deg: [-90, 90]}
  - {name: lift, id: 4, servo: XL330-M288, limits_deg: [-20, 60], init_deg: 10, sign: -1}
END

own_sim
start_told_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }
test_case "its configuration"
exits 0 on_robot --robot so101 init
mkdir -p "$work/config/grctl"
cat >"$work/config/grctl/config.yaml" <<END
robots:
  desk: {device: "$robot", robot: so101, trim: {wrist_flex: 2}}
  other: {device: sim, robot: ../../arm.yaml}
  wrong: {device: sim, trim: {R_KNEE_P: 2}, robot: so101}
END
check "trim before robot" fails 3 'robot stands before trim and offset' "$GRCTL" -d desk status
sed -i.old /wrong:/d "$work/config/grctl/config.yaml"
check "a configured robot says which it is" fails 0 'done; ' "$GRCTL" -d desk move wrist_flex 20
check "its trims are its own" both exits 0 on_robot --robot so101 status m4 --- \
    says 'wrist_flex  *2[12]\.'
check "a file beside the configuration" fails 0 'done; ' "$GRCTL" -d other move lift 30
check "not two robots at once" fails 2 'is another robot' "$GRCTL" -d desk --robot koch status
trims_of_another() {
    printf '  trimmed: {device: sim, trim: {R_HIP_Y: 5}}\n' >>"$work/config/grctl/config.yaml"
    fails 2 '^grctl: $GRCTL_ROBOT: so101: trimmed of .* is another robot: gr001' \
        env GRCTL_ROBOT=so101 "$GRCTL" -d trimmed status
}
check "nor the trims of one for another" trims_of_another
records() {
    : >"$work/recording"
    "$GRCTL" --robot so101 -d "$robot" --timeout 500 record -o "$work/taught.yaml" >"$work/out" \
        2>"$work/recording" &
    recorder=$!
    written "$work/recording" . || return 1
    for deg in 10 20 30; do
        tell turn 1 "$deg" 300 || return 1
        wait_for sim_shows 1 " $deg\.[0-9] deg" || return 1
    done
    kill -s INT $recorder
    wait $recorder
    [ -s "$work/taught.yaml" ]
}
check "a hand is recorded" records
check "the record is the arm's" both exits 0 "$GRCTL" --robot so101 show -j shoulder_pan \
    "$work/taught.yaml" --- says shoulder_pan
check "and plays back" plays on_robot --robot so101 play "$work/taught.yaml"

stop_sim
done_testing
