#!/bin/sh
# SPDX-License-Identifier: MIT
# Simulated robots have weight where their file has masses; a wall and a payload that is too heavy
# stop a command with their name.
. tests/support/cli.sh

# hangs_not [OPTION...]: an arm in the simulator inside is read to be at its goal.
hangs_not() {
    exits 0 "$GRCTL" --robot so101 -d sim "$@" move shoulder_lift 20 500 &&
        grep -q 'error 0.0 deg' "$work/out" "$work/err"
}
unset GRCTL_PHYSICS
sags() {
    ! hangs_not && grep -q 'error 0.[1-9] deg' "$work/out" "$work/err"
}
check "an arm has weight" sags
check "not with --physics off" hangs_not --physics off
by_environment() {
    GRCTL_PHYSICS=off
    export GRCTL_PHYSICS
    hangs_not
    by_status=$?
    unset GRCTL_PHYSICS
    return $by_status
}
check "nor with GRCTL_PHYSICS=off" by_environment

start_told_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }
on_arm() {
    on_robot --robot so101 "$@"
}
on_wall() {
    exits 0 on_arm init --time 1000 && tell wall shoulder_lift -100 20 &&
        exits 4 on_arm --json move shoulder_lift 60 1500 &&
        grep -q '"trip": *"joint_blocked"' "$work/out" "$work/err"
}
check "a wall is a blocked joint" on_wall
freed() {
    tell wall shoulder_lift off && exits 0 on_arm move shoulder_lift 30 1000
}
check "without the wall it moves" freed
too_heavy() {
    on_arm move wrist_roll 90 8000 >"$work/out" 2>"$work/err" </dev/null &
    heavy_pid=$!
    sleep 2
    tell payload 1.5
    wait $heavy_pid
    status_was 4 move && complains 'joint overloaded'
}
check "a payload that is too heavy is an overload" too_heavy
stop_sim
done_testing
