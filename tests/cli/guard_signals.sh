#!/bin/sh
# SPDX-License-Identifier: MIT
# Signals to a grctl that moves a joint: those that it catches, and those that its guard sees.
. tests/support/cli.sh
. tests/support/guard.sh

# ---- what can be caught: grctl itself leaves the robot well --------------------------------------

# caught SIGNAL: the exit policy is carried out, and the status tells the signal.
caught() {
    moves || return 1
    ends "$1"
    ended_by "$1" && grep -q 'interrupted: the servos hold' "$work/moving" && stands &&
        wait_for guard_is_gone
}
for signal in ALRM USR1 USR2 XCPU VTALRM PROF; do
    test_that "SIG$signal is caught: the joint stands" caught $signal
done

# ---- what cannot be: the guard does --------------------------------------------------------------

# killed SIGNAL
killed() {
    moves || return 1
    ends "$1"
    written "$work/moving" 'its guard stopped the robot' && stands && wait_for guard_is_gone
}
for signal in KILL ABRT SEGV; do
    test_that "SIG$signal: the guard stops the joint" killed $signal
done

next_opens() {
    moves || return 1
    ends KILL
    exits 0 on_robot status m5 && says '-[2-9][0-9]\.[0-9] .* on  *0 ' && wait_for guard_is_gone
}
test_that "the next program can open the port" next_opens
stop_sim
done_testing
