#!/bin/sh
# SPDX-License-Identifier: MIT
# Robots other than GR001: in a simulator of their own, where a joint is blocked, and their guard.
. tests/support/cli.sh
unset GRCTL_ROBOT

# plays COMMAND...: to the end.
plays() {
    exits 0 "$@" && says '^largest error at the end'
}

test_case "its simulator"

own_sim
start_told_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }
check "served to another program" both exits 0 on_robot --robot so101 status --- \
    says '^ *6  gripper '
check "it plays there" plays on_robot --robot so101 play --speed 200 \
    motions/so101-wave.yaml
# Its gripper may use half of its torque, and comes late at twice the speed.
check "all stand where it ended" wait_for sim_shows 6 ' -*0\.[0-9] deg'
shell_moves() {
    echo 'move gripper 40' | on_robot --robot so101 shell >"$work/out" 2>"$work/err"
    grep -q 'done; largest error' "$work/err"
}
check "in a shell" shell_moves
tell block gripper on
check "a gripper that is blocked is not there" fails 0 \
    '^not reached: largest error 1[0-9]\.[0-9] deg (gripper); is it blocked?$' \
    on_robot --robot so101 move gripper 55
tell block gripper off
check "it is free" wait_for sim_shows 6 ' 5[45]\.[0-9] deg .* mA .* C$'
check "and gets back" fails 0 'done; largest error 0\.[0-4]' on_robot --robot so101 move gripper 40
tell block shoulder_pan on
check "a joint that is blocked ends its move" \
    fails 4 'stopped for safety: joint blocked ([0-9.]* deg) at motor 1 (shoulder_pan)' \
    on_robot --robot so101 move shoulder_pan 60 4000
check "and pushes no more" wait_for sim_shows 1 ' [0-9][0-9] mA .* C$'
tell block shoulder_pan off
check "it stands where it was held" wait_for sim_shows 1 ' -*[01]\.[0-9] deg .* [0-9][0-9] mA '
# ---- its guard ------------------------------------------------------------------------------

# A killed program leaves nothing moving: the guard makes the same driver, from the file too.
guarded() {
    exits 0 on_robot --robot "$1" init || return 1
    : >"$work/moving"
    "$GRCTL" -d "$robot" --timeout 500 --robot "$1" -v move shoulder_pan 100 20000 >"$work/moved" \
        2>"$work/moving" &
    mover=$!
    written "$work/moving" 'robot found' && wait_for sim_shows 1 ' [2-9][0-9]\.[0-9] .*, moving' ||
        return 1
    kill -s KILL $mover
    wait $mover 2>/dev/null
    written "$work/moving" 'its guard stopped the robot' && wait_for stands
}
stands() {
    sim_shows 1 'torque on .* C$'
}
test_case "its guard"
if [ -z "${NATIVE_GRCTL:-}" ]; then
    check "killed: its guard stops it" guarded so101
    check "of a file too" guarded ./src/robots/so101.yaml
fi
stop_sim
done_testing
