#!/bin/sh
# SPDX-License-Identifier: MIT
# The process beside grctl that stops the robot when grctl dies. How each death looks on the wire is
# in deaths.sh.
. tests/support/cli.sh

# Whatever fails, no process stays stopped.
mover=
end_mover() {
    [ -z "$mover" ] || kill -s KILL $mover 2>/dev/null
    end_cli_test
}
trap end_mover EXIT
start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# moves OPTIONS...: a joint goes on its way of 20 s; $mover is the process, $guard its guard.
moves() {
    exits 0 on_robot init --time 500 || return 1
    : >"$work/moving"
    "$GRCTL" -d "$robot" --timeout 500 -v "$@" move m5 -120 20000 >"$work/moved" 2>"$work/moving" &
    mover=$!
    is_on_its_way
}
is_on_its_way() {
    written "$work/moving" 'robot found' && wait_for sim_shows 5 ' -[2-9][0-9]\.[0-9] .*, moving'
    guard=$(sed -n 's/^guarded by process //p' "$work/moving")
}
stands() {
    wait_for sim_shows 5 "-[2-9][0-9]\.[0-9] deg .* torque on .* C\$" && ! sim_shows 5 moving
}
guard_is_gone() {
    case $(ps -o stat= -p "${guard:-1}") in
    '' | Z*) ;; # to be reaped by whoever inherited it
    *) return 1 ;;
    esac
}
# ends SIGNAL: the mover gets it; its status in $ended.
ends() {
    kill -s "$1" $mover
    wait $mover 2>/dev/null
    ended=$?
}

# ended_by SIGNAL: its status told that.
ended_by() {
    [ $ended -gt 128 ] && [ "$(kill -l $((ended - 128)))" = "$1" ] && return
    echo "status $ended"
    return 1
}

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
