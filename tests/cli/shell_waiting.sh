#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl shell while it waits for a line: the robot is looked after, what happens is told at once.
. tests/support/cli.sh
. tests/support/terminal.sh

# start_shell [OPTION|FILE]...: a shell, its output in $work/said and $work/told; what is written to
# descriptor 7 it reads.
start_shell() {
    rm -f "$work/lines" "$work/said" "$work/told" "$work/status"
    mkfifo "$work/lines"
    {
        if [ "$*" = "$work/lines" ]; then
            exec </dev/null
        else
            exec <"$work/lines"
        fi
        # shellcheck disable=SC2016 # of the inner shell
        sh -c 'echo $$ >"$0/pid"; exec "$@"' "$work" "$GRCTL" -d "$robot" --timeout 500 \
            shell "$@" >"$work/said" 2>"$work/told"
        echo $? >"$work/status"
    } &
    exec 7>"$work/lines"
}

line() {
    printf '%s\n' "$*" >&7
}

said() {
    written "$work/said" "$1" || { cat "$work/said" "$work/told"; return 1; }
}

told() {
    written "$work/told" "$1" || { cat "$work/told"; return 1; }
}

# ended STATUS: it has ended with that, though more lines might have come; leaves STATUS: at the end
# of its input it does.
ended() {
    wait_for test -s "$work/status"
    leaves "$1"
}
leaves() {
    exec 7>&-
    wait_for test -s "$work/status"
    grep -qx "$1" "$work/status" && return
    echo "status $(cat "$work/status"), not $1"
    cat "$work/said" "$work/told"
    return 1
}

# holds OPTIONS...: a joint has torque, and the shell waits.
holds() {
    start_shell "$@"
    line servo on m5
    line status m5
    said 'R_ELBOW_P .* on '
}

braked() {
    exits 0 on_robot status m5 && says ' brake '
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "an emergency stop of another grctl"

stops() {
    holds && exits 0 on_robot estop && ended 4 &&
        told 'stopped for safety: emergency stop' && braked
}
check "an emergency stop ends a script at once" stops
exits 0 on_robot estop --reset
goes_on() {
    holds -k || return 1
    exits 0 on_robot estop && complains 'which has the port, and verified' || return 1
    told 'stopped for safety: emergency stop' && wait_for sim_shows 5 'torque brake' || return 1
    line m m5 0
    told "standard input:3: .*stopped by 'grctl estop'" || return 1
    line estop --reset
    leaves 4
}
check "with -k it brakes, and goes on" goes_on
exits 0 on_robot estop --reset

test_case "what the robot does"

hot() {
    holds && tell temperature 12 70 && ended 4 &&
        told 'stopped for safety: over-temperature .* at motor 12 (R_KNEE_P)'
}
check "heat ends it" hot
tell temperature 12 25
low() {
    holds && tell voltage 5 && ended 4 && told 'stopped for safety: low voltage'
}
check "so does low voltage" low
tell voltage 7.4
lost() {
    holds && tell plug out && ended 1 && told ': device is gone'
}
check "and a lost line" lost
tell plug in
comes_back() {
    holds -k && tell plug out && told ': device is gone' && tell plug in || return 1
    line status m3
    said 'R_SHOULDER_P' && leaves 1
}
check "with -k the next command opens it again" comes_back
lets_go() {
    holds --on-exit off && leaves 0 && exits 0 on_robot status m5 && says ' off '
}
check "the end of its input: the exit policy" lets_go
signalled() {
    holds --on-exit off && kill -s TERM "$(cat "$work/pid")" && ended 143 &&
        exits 0 on_robot status m5 && says ' off '
}
check "SIGTERM: the exit policy" signalled

test_case "lines of all kinds"

# runs STATUS COMMAND...: what it prints is the shell's input, and the simulator in process answers.
runs() {
    runs_want=$1
    shift
    "$@" | "$GRCTL" -d sim shell >"$work/out" 2>"$work/err"
    status_was "$runs_want" "$@"
}
byte_by_byte() {
    start_shell
    for byte in s t a t u s ' ' m 3; do
        printf '%s' "$byte" >&7
    done
    line ''
    said R_SHOULDER_P && leaves 0
}
check "byte by byte" byte_by_byte
check "lines that end as those of Windows" both runs 0 printf 'status m3\r\nversion\r\n' --- \
    says '^    3  R_SHOULDER_P'
check "a NUL byte" both runs 2 printf 'version\0\nversion\n' --- \
    complains '^grctl: standard input:1: a NUL byte'
long_line() {
    printf '# '
    dd if=/dev/zero bs=1000 count=60 2>/dev/null | tr '\0' x
    printf '\nversion\n'
}
check "a long line" both runs 0 long_line --- says '^grctl'
too_long_line() {
    printf 'version '
    dd if=/dev/zero bs=1000 count=600 2>/dev/null | tr '\0' ' '
    printf '\nversion\n'
}
check "one that is too long" both runs 2 too_long_line --- \
    complains '^grctl: standard input:1: the line is too long'
many_words() {
    printf 'status'
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        printf ' m1 m2 m3 m4 m5 m6 m7 m8 m9 m10 m1 m2 m3 m4 m5 m6 m7 m8 m9 m10'
        printf ' m1 m2 m3 m4 m5 m6 m7 m8 m9 m10'
    done
    echo
}
check "too many words" both runs 2 many_words --- \
    complains '^grctl: standard input:1: too many words'

# from FILE: standard input is that.
from() {
    "$GRCTL" -d sim shell <"$1" >"$work/out" 2>"$work/err" && [ ! -s "$work/err" ]
}
printf 'version\nstatus m3' >"$work/script"
check "standard input is a file" both from "$work/script" --- says R_SHOULDER_P
check "is nothing" from /dev/null
closed() {
    "$GRCTL" -d sim shell <&- >"$work/out" 2>&1 && [ ! -s "$work/out" ]
}
check "is closed" closed
check "a script that is a folder" fails 3 ': is a directory$' \
    "$GRCTL" -d sim shell "$work"
from_fifo() {
    start_shell "$work/lines"
    line status m3
    said R_SHOULDER_P && exits 0 on_robot estop && ended 4 && told 'emergency stop'
}
check "a script may be a pipe" from_fifo
exits 0 on_robot estop --reset

test_case "a person at a terminal"

if ! have_terminal; then
    skip "a person at a terminal" "no tmux here"
    stop_sim
    done_testing
    exit
fi
open_screen 100 30
type_line "'$GRCTL' -d '$robot' --timeout 500 shell"
until_screen '^grctl>'
keys 'servo on m5' Enter 'status m5' Enter
until_screen 'R_ELBOW_P .* on '
keys 'status m'
until_screen '^grctl> status m$'
exits 0 on_robot estop
check "an emergency stop brakes while a line is typed" wait_for sim_shows 5 'torque brake'
check "and is told" until_screen 'stopped for safety: emergency stop$'
if [ "${EDIT:-libedit}" = libedit ]; then
    keys '5' Enter
    check "the line is as it was" until_screen 'R_ELBOW_P .* brake '
else
    skip "the line is as it was" "built without libedit"
    keys '5' Enter
    until_screen 'R_ELBOW_P .* brake '
fi
keys 'estop --reset' Enter
until_screen 'released'
# A row of before is on the screen still.
is_on_again() {
    screen |
        awk '/R_ELBOW_P .* on / { n++ } NF { last = $0 } END { exit n != 2 || last != "grctl>" }'
}
typed_unseen() {
    keys 'servo on m5' Enter 'status m5' Enter
    wait_for is_on_again || { screen; return 1; }
    keys C-s
    keys 'status m3'
    exits 0 on_robot estop && complains 'which has the port, and verified' || return 1
    keys C-q
    until_screen '^grctl> status m3$'
}
check "after Ctrl-S too, whatever is typed" typed_unseen
keys C-u 'estop --reset' Enter
# The row of the release before is on the screen still.
is_released_again() {
    screen | awk 'NF { before = last; last = $0 }
        END { exit !(before ~ /released/ && last == "grctl>") }'
}
check "and released once more" wait_for is_released_again
tell plug out
check "a lost line is told" until_screen ': device is gone$'
tell plug in
keys 'status m3' Enter
check "the next command opens it again" until_screen 'R_SHOULDER_P '
keys C-d
until_screen '^>'
stop_sim
done_testing
