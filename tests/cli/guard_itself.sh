#!/bin/sh
# SPDX-License-Identifier: MIT
# The guard itself: killed, missing, not needed; and a trace that cannot be written.
. tests/support/cli.sh
. tests/support/guard.sh

# ---- the guard itself ----------------------------------------------------------------------------

unguarded() {
    : >"$work/err"
    "$GRCTL" -d "$robot" --timeout 500 -v play motions/greet.pseq >"$work/out" 2>"$work/err" &
    mover=$!
    written "$work/err" 'robot found' || return 1
    kill -s KILL "$(sed -n 's/^guarded by process //p' "$work/err")"
    wait $mover || return 1
    [ "$(grep -c 'the guard has ended' "$work/err")" -eq 1 ] && says 'largest error at the end'
}
test_that "it is killed: the motion goes on, and that is said once" unguarded

clean_exit() {
    exits 0 on_robot -v init || return 1
    guard=$(sed -n 's/^guarded by process //p' "$work/err")
    guard_is_gone # grctl has waited for it
}
test_that "none is left behind a command that ends well" clean_exit

has_port() {
    ls -l "/proc/$guard/fd" | grep -q "$sim_pty\$"
}
has_no_port() {
    ! has_port
}
unplugged() {
    : >"$work/moving"
    mkfifo "$work/lines"
    "$GRCTL" -d "$robot" --timeout 500 -v shell <"$work/lines" >"$work/moved" 2>"$work/moving" &
    mover=$!
    exec 7>"$work/lines"
    rm "$work/lines"
    echo 'init --time 500' >&7
    written "$work/moving" '^done' || return 1
    guard=$(sed -n 's/^guarded by process //p' "$work/moving")
    wait_for has_port || return 1
    tell plug out
    wait_for has_no_port
    unplugged_status=$?
    tell plug in
    exec 7>&-
    wait $mover
    return $unplugged_status
}
test_case "a line that is lost is not kept from coming back"
if [ -d /proc/self/fd ]; then
    check "a line that is lost is not kept from coming back" unplugged
else
    skip "a line that is lost is not kept from coming back" "no /proc here"
fi

missing() {
    GRCTL_GUARD=/nowhere/grctl exits 0 on_robot init &&
        grep -q '^no guard: no such file' "$work/err"
}
test_that "where it cannot be started the command says so and goes on" missing
test_that "nobody types it" fails 2 'guard: is started by grctl itself' "$GRCTL" guard
reads_only() {
    exits 0 on_robot -v status m5 && ! grep -q guarded "$work/err"
}
test_that "a command that only reads has none" reads_only
in_process() {
    exits 0 "$GRCTL" -d sim -v move m5 0 && ! grep -q guarded "$work/err"
}
test_that "nor has a simulator in the same process" in_process

# ---- a trace that cannot be written --------------------------------------------------------------

cut_trace() (
    no_counters
    ulimit -f 8
    "$GRCTL" -d "$robot" --timeout 500 --trace "$work/cut.pcapng" play motions/greet.pseq \
        >"$work/out" 2>"$work/err"
)
trace_ends() {
    cut_trace
    trace_status=$?
    [ $trace_status -eq 3 ] || { echo "status $trace_status"; cat "$work/err"; return 1; }
    complains 'the trace cannot be written: File too large' && says 'largest error at the end'
}
test_that "ulimit -f: the trace ends, the motion does not" trace_ends

stop_sim
done_testing
