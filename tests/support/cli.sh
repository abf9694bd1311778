# SPDX-License-Identifier: MIT
# For tests of the command: tap.sh, a scratch directory, a simulator behind a pty, exit statuses.
# $GRCTL is the command under test. What is started here is ended here, whatever happens.

. tests/support/tap.sh

work=$(mktemp -d)
sim_pid=
known_as=${EMULATOR:-grctl} # as what the system knows the command; an emulator has options
known_as=${known_as%% *}
known_as=${known_as##*/}
[ -z "${NATIVE_GRCTL:-}" ] || known_as=grctl.exe
unset GRCTL_DEVICE
# Shafts are where they are told; what is about weight says so.
export GRCTL_PHYSICS=off
# Messages are compared in English; characters stay as they are.
[ -z "${LC_ALL:-}" ] || export LC_CTYPE="$LC_ALL"
unset LC_ALL
export LC_MESSAGES=C
# What grctl starts of itself goes to the emulator too.
[ -z "${EMULATOR:-}" ] || [ -n "${NATIVE_GRCTL:-}" ] || export GRCTL_GUARD="$GRCTL"
XDG_CONFIG_HOME=$work/config # not that of whoever runs the tests
XDG_STATE_HOME=$work/state
export XDG_CONFIG_HOME XDG_STATE_HOME

# What a test begins besides, a process of its own each, is ended with it. A check is a shell of its
# own, so a file knows them.
: >"$work/pids"
# group_of PID: one that has ended may be the number of another test's process by now.
group_of() {
    ps -o pgid= -p "$1" 2>/dev/null
}
own_group=$(group_of $$)
end_cli_test() {
    stop_sim
    while read -r ended_pid; do
        [ "$(group_of "$ended_pid")" = "$own_group" ] || continue
        kill "$ended_pid" 2>/dev/null
        kill -CONT "$ended_pid" 2>/dev/null
        wait "$ended_pid" 2>/dev/null
    done <"$work/pids"
    rm -rf "$work"
}
trap end_cli_test EXIT
trap 'exit 1' INT TERM

# known_pid PID: a pattern of the number that the system gives a program begun here: wine its own.
known_pid() {
    [ -n "${NATIVE_GRCTL:-}" ] && echo '[0-9][0-9]*' || echo "$1"
}

# For Windows the simulator is that of this machine, and wine takes its pty for a COM port: $robot.
# wine names those up to COM9 itself. Tests of the simulator itself say own_sim: $robot is its TCP
# port then.
simulator=${NATIVE_GRCTL:-$GRCTL}
sim_place="--link $work/robot"
own_sim() {
    [ "$simulator" = "$GRCTL" ] || sim_place='--tcp 0'
    simulator=$GRCTL
}
by_tcp() {
    [ "$sim_place" = '--tcp 0' ]
}

sim_com=
# find_robot: sets $robot to where the command finds it.
find_robot() {
    robot=$work/robot
    if by_tcp; then
        robot=$sim_pty
    elif [ -n "${NATIVE_GRCTL:-}" ]; then
        map_com
    fi
}
map_com() {
    sim_number=50
    until ln -s "$sim_pty" "$GROBO_WINE/prefix/dosdevices/com$sim_number" 2>/dev/null; do
        sim_number=$((sim_number + 1))
    done
    sim_com=$GROBO_WINE/prefix/dosdevices/com$sim_number
    robot=COM$sim_number
    # The mark of an estop before; others' tests run beside this one.
    rm -f "$GROBO_WINE"/prefix/drive_c/users/*/AppData/Local/grobo/estop-*"$robot"
}

# start_sim [OPTIONS]: $robot is its pty when this returns.
start_sim() {
    mkfifo "$work/ready"
    # $sim_place is a list of words.
    # shellcheck disable=SC2086
    "$simulator" sim $sim_place "$@" >"$work/ready" 2>"$work/sim.log" &
    sim_pid=$!
    exec 6<"$work/ready" # stays open: a line for each robot follows
    read -r sim_pty <&6
    rm "$work/ready"
    [ -n "$sim_pty" ] && find_robot
}

# start_told_sim [OPTIONS]: as start_sim, and what is written to descriptor 5 it is told.
start_told_sim() {
    mkfifo "$work/ready" "$work/tell"
    # shellcheck disable=SC2086
    "$simulator" sim $sim_place "$@" <"$work/tell" >"$work/ready" 2>"$work/sim.log" &
    sim_pid=$!
    exec 5>"$work/tell"
    exec 6<"$work/ready" # stays open: a line for each robot follows
    read -r sim_pty <&6
    rm "$work/ready" "$work/tell"
    [ -n "$sim_pty" ] && find_robot
}

# on_robot ARGUMENTS...: the command on that simulator, which on a busy machine answers late.
on_robot() {
    "$GRCTL" -d "$robot" --timeout 500 "$@"
}

sim_has_answered() {
    [ "$(wc -l <"$work/sim.log")" -gt "$tell_lines" ]
}
sim_has_answered_or_ended() {
    sim_has_answered || ! kill -0 "$sim_pid"
}

# tell WORD...: returns when the simulator has said something to it.
tell() {
    tell_lines=$(wc -l <"$work/sim.log")
    echo "$*" >&5
    wait_for sim_has_answered_or_ended && sim_has_answered
}

# sim_shows WORDS PATTERN: told "look WORDS", the simulator says a line like that; what its joints
# do then is its word, not a time. For wait_for.
sim_shows() {
    tell look "$1" && tail -n +"$((tell_lines + 1))" "$work/sim.log" | grep -q -e "$2"
}

stop_sim() {
    [ -z "$sim_pid" ] && return
    kill "$sim_pid" 2>/dev/null
    wait "$sim_pid" 2>/dev/null
    sim_pid=
    [ -z "$sim_com" ] || rm -f "$sim_com"
}

# written FILE PATTERN: waits until a program in the background has written such a line; it may have
# ended instead.
written() {
    wait_for grep -qs -e "$2" "$1" || { echo "no '$2' in $1"; return 1; }
}

# Where files may not grow: counters of the lines that ran (make check-coverage) are not written, as
# one that is cut off spoils those of all other processes.
no_counters() {
    GCOV_PREFIX=/dev/null
    export GCOV_PREFIX
}

# exits STATUS COMMAND...: what it printed is in $work/out and $work/err. Where it says that the
# machine held it up, as it must then, it is run again: one that always says so is wrong.
exits() {
    exits_want=$1
    shift
    for _ in 1 2 3; do
        "$@" >"$work/out" 2>"$work/err" </dev/null
        status_was "$exits_want" "$@" >"$work/otherwise" && return
        grep -q -e 'stopped for safety: host stalled' \
            -e 'stopped for safety: lost replies (1 in a row)' "$work/err" || break
    done
    cat "$work/otherwise"
    return 1
}

# ended_with STATUS PID: that process of this shell ends so; else what it said is shown.
ended_with() {
    wait "$2"
    ended_status=$?
    [ $ended_status -eq "$1" ] && return
    echo "status $ended_status, not $1"
    cat "$work/said"
    return 1
}

# status_was STATUS COMMAND...: that of the command that was just run; shows what it printed if not.
status_was() {
    status_got=$?
    status_want=$1
    shift
    [ $status_got -eq "$status_want" ] && return
    echo "status $status_got, not $status_want: $*"
    cat "$work/out" "$work/err"
    return 1
}

# says PATTERN: the last command wrote a line like that on standard output.
says() {
    grep -q -e "$1" "$work/out" || { echo "no '$1' in:"; cat "$work/out"; return 1; }
}

# ends_with STATUS TEXT COMMAND...: it ends so, and this is among what it printed, on either.
ends_with() {
    expected=$1 like=$2
    shift 2
    "$@" >"$work/said" 2>&1 </dev/null
    status=$?
    [ $status -eq "$expected" ] && grep -q -e "$like" "$work/said" && return
    echo "status $status, and said:"
    cat "$work/said"
    return 1
}

# complains PATTERN: exactly one line on standard error, and it is like that.
complains() {
    [ "$(wc -l <"$work/err")" -eq 1 ] && grep -q -e "$1" "$work/err" && return
    echo "not one line like '$1' but:"
    cat "$work/err"
    return 1
}

# fails STATUS PATTERN COMMAND...: that status, one line of complaint, nothing on standard output.
fails() {
    fails_status=$1
    fails_pattern=$2
    shift 2
    exits "$fails_status" "$@" && complains "$fails_pattern" || return 1
    [ ! -s "$work/out" ] || { echo "standard output is not empty:"; cat "$work/out"; return 1; }
}

# json EXPRESSION: each line on standard output is JSON, and the Python expression holds of the
# list `lines` of them. Needs python3: see have_json.
json() {
    python3 -c '
import json, sys
lines = [json.loads(line) for line in open(sys.argv[1])]
if not eval("(" + sys.argv[2] + ")"):
    sys.exit("does not hold: %s of %.2000s" % (sys.argv[2], lines))
' "$work/out" "$1"
}

have_json() {
    command -v python3 >/dev/null 2>&1
}

# check_json NAME EXPRESSION COMMAND...: status 0 and the expression holds. Without python3 the
# command runs all the same, as later checks may build on what it did, and the rest is skipped.
check_json() {
    check_json_name=$1
    check_json_expression=$2
    shift 2
    if have_json; then
        check "$check_json_name" both exits 0 "$@" --- json "$check_json_expression"
    elif exits 0 "$@" >/dev/null; then
        skip "$check_json_name" "no python3 to parse JSON with"
    else
        check "$check_json_name" exits 0 "$@"
    fi
}

# both COMMAND1... --- COMMAND2...: the one, then the other.
both() {
    both_n=0
    for both_word in "$@"; do
        [ "$both_word" = --- ] && break
        both_n=$((both_n + 1))
    done
    both_first=
    both_i=0
    while [ $both_i -lt $both_n ]; do
        both_first="$both_first \"\${$((both_i + 1))}\""
        both_i=$((both_i + 1))
    done
    eval "$both_first" || return 1
    shift $((both_n + 1))
    "$@"
}
