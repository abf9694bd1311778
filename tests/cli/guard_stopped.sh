#!/bin/sh
# SPDX-License-Identifier: MIT
# A grctl that is held by a debugger or suspended while it has a guard.
. tests/support/cli.sh
. tests/support/guard.sh

# by_debugger COMMAND...: of gdb, to the mover.
by_debugger() {
    gdb -p $mover -nx -batch "$@" >"$work/debugger" 2>&1
}
debugged() {
    moves || return 1
    by_debugger -ex 'shell sleep 3' # what a person takes to look
    wait $mover
    ended=$?
    [ $ended -eq 4 ] && grep -q 'stopped for safety: host stalled' "$work/moving" &&
        stands && wait_for guard_is_gone
}
closed() {
    moves || return 1
    by_debugger -ex 'print (int)close_range(3, ~0u, 0)'
    wait $mover
    ended=$?
    [ $ended -eq 1 ] && stands && wait_for guard_is_gone && ! grep '^\[' "$work/moving"
}
has_debugger() {
    [ -z "${EMULATOR:-}" ] && command -v gdb >/dev/null 2>&1 || return 1
    sleep 60 &
    mover=$!
    by_debugger -ex 'print (int)getpid()'
    kill $mover
    wait $mover 2>/dev/null
    grep -q "= $mover\$" "$work/debugger"
}
# Nothing moves, so nobody has missed it: the stop asks its guard.
held() {
    : >"$work/moving"
    mkfifo "$work/lines"
    "$GRCTL" -d "$robot" --timeout 500 -v shell <"$work/lines" >"$work/moved" 2>"$work/moving" &
    mover=$!
    exec 7>"$work/lines"
    rm "$work/lines"
    echo 'init --time 500' >&7
    written "$work/moving" '^done' || return 1
    by_debugger -ex "shell while [ ! -e '$work/go' ]; do sleep 0.05; done" &
    debugger=$!
    wait_for is_held && exits 0 on_robot estop && grep -q 'by the guard of a program' "$work/err"
    held_status=$?
    : >"$work/go"
    wait $debugger
    exec 7>&-
    wait $mover
    [ $held_status -eq 0 ] && sim_shows 5 'torque brake' && exits 0 on_robot estop --reset &&
        exits 0 on_robot servo on
}
is_held() {
    case $(ps -o stat= -p $mover) in
    t*) ;;
    *) return 1 ;;
    esac
}
if has_debugger; then
    test_that "a debugger holds one that moves nothing: its guard obeys an emergency stop" held
    test_that "a debugger holds it: the guard stops the joint" debugged
    test_that "it closes all its descriptors: the guard stops the joint" closed
else
    test_case "a debugger holds it, or closes its descriptors"
    skip "a debugger holds it, or closes its descriptors" "needs gdb, and to be allowed"
fi

suspended() {
    moves || return 1
    kill -s TSTP $mover
    stands || return 1
    wait_for is_stopped || return 1
    kill -s CONT $mover
    wait $mover
    ended=$?
    ended_by TSTP && stands && wait_for guard_is_gone
}
is_stopped() {
    case $(ps -o stat= -p $mover) in
    T*) ;;
    *) return 1 ;;
    esac
}
test_that "Ctrl-Z: grctl stops the joint, then itself" suspended

# While nothing moves, it is suspended and continues as ever.
waits_suspended() {
    rm -f "$work/out"
    "$GRCTL" -d "$robot" --timeout 500 status --watch --interval 100 m5 >"$work/out" 2>&1 &
    mover=$!
    written "$work/out" R_ELBOW_P || return 1
    kill -s TSTP $mover
    wait_for is_stopped || return 1
    : >"$work/out"
    kill -s CONT $mover
    written "$work/out" R_ELBOW_P
    suspended_status=$?
    ends INT
    return $suspended_status
}
test_that "Ctrl-Z of who moves nothing" waits_suspended

stop_sim
done_testing
