#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl estop` and `grctl stop` stop first and complain after: what is wrong with their command
# line, their configuration, their trace or their output keeps no robot from being stopped.
. tests/support/cli.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

holds() {
    exits 0 on_robot servo on m5 >/dev/null && sim_shows 5 'torque on'
}
# brakes STATUS PATTERN ARGUMENTS...: these make an emergency stop, with that status and message.
brakes() {
    brakes_status=$1
    brakes_pattern=$2
    shift 2
    holds && exits "$brakes_status" "$GRCTL" --timeout 500 "$@" &&
        grep -q -e "$brakes_pattern" "$work/err" && sim_shows 5 'torque brake' &&
        exits 0 on_robot estop --reset && return
    cat "$work/err"
    return 1
}
# halts STATUS PATTERN ARGUMENTS...: a soft stop does so too: a joint that a killed program sent on
# its way stands.
halts() {
    halts_status=$1
    halts_pattern=$2
    shift 2
    exits 0 on_robot init --time 500 || return 1
    GRCTL_GUARD='' "$GRCTL" -d "$robot" --timeout 500 move m5 -120 20000 2>"$work/moving" &
    halts_pid=$!
    wait_for sim_shows 5 ' -[2-9][0-9]\.[0-9] .*, moving'
    kill -s KILL $halts_pid
    wait $halts_pid
    sim_shows 5 moving && exits "$halts_status" "$GRCTL" --timeout 500 "$@" &&
        grep -q -e "$halts_pattern" "$work/err" && ! sim_shows 5 moving && return
    cat "$work/err"
    return 1
}

test_case "the command line"

check "an unknown option behind it" brakes 2 'unknown option --now' -d "$robot" estop --now
check "an unknown option before it" brakes 2 'unknown option --now' -d "$robot" --now estop
check "a value that is none" brakes 2 "'soon' is not a whole number" \
    -d "$robot" estop --retries soon
check "an argument too many" brakes 2 "'now' is one argument too many" -d "$robot" estop now
check "an option without its value" brakes 2 'needs a value' estop -d "$robot" --trace
check "an echo without its bus" brakes 2 'echo needs --wiring bus' -d "$robot" --echo estop
check "the same of stop" halts 2 'unknown option --now' -d "$robot" stop --now
releases_nothing() {
    exits 0 on_robot estop && fails 2 "'now' is one argument too many" on_robot estop --reset now &&
        fails 2 'unknown option --no' on_robot estop --reset --no &&
        fails 4 "stopped by 'grctl estop'" on_robot move m5 0 && exits 0 on_robot estop --reset
}
check "but with a mistake nothing is released" releases_nothing
# What names no command, or asks for help, moves nothing.
harmless() {
    holds && exits 2 on_robot sotp estop && exits 0 on_robot estop --help &&
        exits 0 on_robot estop --version && sim_shows 5 'torque on'
}
check "no stop where another command is meant" harmless

test_case "the configuration"

mkdir -p "$XDG_CONFIG_HOME/grctl"
config=$XDG_CONFIG_HOME/grctl/config.yaml
printf 'default: kitchen\nrobots:\n  kitchen: {device: %s}\nsofa: 1\n' "$robot" >"$config"
sofa='config.yaml:4:1: no key .sofa'
check "a configuration with a mistake behind the robot" brakes 3 "$sofa" estop
check "and of stop" halts 3 "$sofa" stop
check "a robot of it that is asked for" brakes 3 "$sofa" -d kitchen estop
printf 'sofa: 1\nrobots: {kitchen: {device: %s}}\n' "$robot" >"$config"
check "what cannot be found in it is not released" fails 3 'config.yaml:1:1: no key .sofa' \
    "$GRCTL" estop --reset
printf 'default: kitchen\nrobots:\n  kitchen: {device: %s}\nsofa: 1\n' "$robot" >"$config"
check "a device needs no configuration" brakes 0 'stopped and verified' -d "$robot" estop
rm "$config"
check "a robot that the configuration no longer has: it says so" fails 1 \
    '^grctl: kitchen: no robot of the configuration.*; NOT stopped, nothing was sent' \
    "$GRCTL" -d kitchen estop

test_case "the trace"

check "a trace in a folder that is missing" brakes 3 'trace cannot be written: no such folder' \
    -d "$robot" --trace "$work/nowhere/trace" estop
check "a trace that is a folder" brakes 3 'trace cannot be written' \
    -d "$robot" --trace "$work" estop
check "and of stop" halts 3 'trace cannot be written' -d "$robot" --trace "$work" stop
check "a file that is no trace" brakes 3 'it is no trace' -d "$robot" --trace "$0" estop
if [ -c /dev/full ]; then
    check "a trace on a full disk" brakes 3 'trace cannot be written' \
        -d "$robot" --trace /dev/full estop
else
    skip "a trace on a full disk" "no /dev/full here"
fi
if [ -z "${NATIVE_GRCTL:-}" ]; then # no pipes with a name
    mkfifo "$work/unread"
    check "a trace into a pipe that nobody reads" brakes 3 'trace cannot be written' \
        -d "$robot" --trace "$work/unread" estop
fi

test_case "its output"

# run_closed HOW: with descriptors that are closed, or a pipe whose reader has gone.
run_closed() {
    holds || return 1
    case $1 in
    stdout) on_robot --json estop >&- 2>"$work/err" ;;
    stderr) on_robot estop >"$work/out" 2>&- ;;
    both) on_robot --json -vv estop >&- 2>&- ;;
    pipe) on_robot --json -vv estop >&7 2>&7 ;;
    esac
    closed_status=$?
    sim_shows 5 'torque brake' && exits 0 on_robot estop --reset && return $closed_status
    return 99
}
# closed STATUS HOW
closed() {
    run_closed "$2"
    status_was "$1" "with $2 closed"
}
: >"$work/out"
: >"$work/err"
check "standard output is closed" closed 1 stdout
check "standard error is closed" closed 0 stderr
check "both are" closed 1 both
if [ -z "${NATIVE_GRCTL:-}" ]; then
    mkfifo "$work/gone"
    true <"$work/gone" &
    exec 7>"$work/gone"
    wait $!
    check "both are a pipe whose reader has gone" closed 141 pipe
    exec 7>&-
fi

test_case "signals"

# signalled STATUS SIGNAL BIT: it gets a signal, which it catches or ignores (bit), while it waits
# for the port, which another program has.
signalled() {
    holds || return 1
    flock -F "$sim_pty" sleep 100 &
    stranger_pid=$!
    wait_for fails 1 'in use by' on_robot status || return 1
    "$GRCTL" -d "$robot" --timeout 500 estop >"$work/out" 2>"$work/err" &
    signalled_pid=$!
    wait_for minds "$3" && kill -s "$2" $signalled_pid
    kill $stranger_pid
    wait $stranger_pid
    wait $signalled_pid
    status_was "$1" "estop, SIG$2" && sim_shows 5 'torque brake' &&
        complains 'stopped and verified' && exits 0 on_robot estop --reset
}
minds() {
    [ $((($(signals_of Cgt) | $(signals_of Ign)) & $1)) -ne 0 ]
}
signals_of() {
    echo "0x$(sed -n "s/^Sig$1:.//p" "/proc/$signalled_pid/status")"
}
if [ -z "${NATIVE_GRCTL:-}" ] && [ -d /proc/self ] && command -v flock >/dev/null 2>&1; then
    check "SIGTERM waits for the stop" signalled 143 TERM 0x4000
    check "SIGHUP too" signalled 129 HUP 0x1
    check "Ctrl-Z does not suspend it" signalled 0 TSTP 0x80000
else
    skip "SIGTERM waits for the stop" "no flock or /proc here"
fi

stop_sim
done_testing
