#!/bin/sh
# SPDX-License-Identifier: MIT
# The process beside grctl that stops the robot when grctl dies. How each death looks on the wire is
# in deaths.sh.
. tests/support/cli.sh
. tests/support/guard.sh


off() {
    moves --on-exit off || return 1
    ends KILL
    written "$work/moving" 'its guard stopped the robot' && wait_for sim_shows 5 'torque off'
}
test_that "torque goes off where the exit policy says so" off

# The guard has the driver of a configured robot too.
trimmed() {
    mkdir -p "$XDG_CONFIG_HOME/grctl"
    printf 'robots:\n  kitchen: {device: %s, trim: {R_ELBOW_P: 2.5}, on_exit: off}\n' "$robot" \
        >"$XDG_CONFIG_HOME/grctl/config.yaml"
    moves -d kitchen || return 1
    ends KILL
    written "$work/moving" 'its guard stopped the robot' && ! grep -q 'guard has' "$work/moving" &&
        wait_for sim_shows 5 'torque off'
}
test_that "a configured robot: its own exit policy, and a guard that knows it" trimmed

# Every process of the group, as kill -9 -GROUP or a closed container does it.
group_killed() {
    exits 0 on_robot init --time 500 || return 1
    : >"$work/moving"
    setsid "$GRCTL" -d "$robot" --timeout 500 -v move m5 -120 20000 2>"$work/moving" &
    mover=$!
    is_on_its_way || return 1
    group=$(ps -o pgid= -p $mover | tr -d ' ')
    [ "$group" = $mover ] || group=$mover
    kill -s KILL -- "-$group"
    wait $mover 2>/dev/null
    written "$work/moving" 'its guard stopped the robot' && stands && wait_for guard_is_gone
}
test_that "the whole process group is killed" group_killed

# The guard is not in the way: nothing but stopped processes has the port.
stopped() {
    moves || return 1
    kill -s STOP $mover
    stands || return 1
    wait_for exits 0 on_robot status m5 || return 1 # the guard has released the port
    kill -s CONT $mover
    wait $mover
    ended=$?
    [ $ended -eq 4 ] && grep -q 'stopped for safety: host stalled' "$work/moving" &&
        stands && wait_for guard_is_gone
}
test_that "SIGSTOP: the guard stops the joint, and the program says so when it continues" stopped

# It is stopped and holds, as it may continue; when it is dead, its policy is.
stopped_and_killed() {
    moves --on-exit off || return 1
    kill -s STOP $mover
    stands && wait_for exits 0 on_robot ports || return 1
    ends KILL
    written "$work/moving" 'its guard stopped the robot' && wait_for sim_shows 5 'torque off' &&
        wait_for guard_is_gone && exits 0 on_robot status m5
}
test_that "SIGSTOP, then SIGKILL: torque goes off where the exit policy says so" stopped_and_killed

stop_sim
done_testing
