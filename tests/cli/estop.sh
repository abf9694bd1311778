#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl estop` while another program has the port, is stopped, does not obey, or cannot be reached:
# what it says is what was done.
. tests/support/cli.sh
. tests/support/terminal.sh

braked() {
    exits 0 on_robot status && says '^ *12  R_KNEE_P .* brake '
}

# while_running PATTERN COMMAND...: an emergency stop once it has said that; its status in $ended.
while_running() {
    while_pattern=$1
    shift
    rm -f "$work/busy"
    on_robot "$@" >"$work/busy" 2>&1 <"$work/keys" &
    while_pid=$!
    written "$work/busy" "$while_pattern" || return 1
    exits 0 on_robot estop
    while_status=$?
    wait $while_pid
    ended=$?
    return $while_status
}
# stopped COMMAND...: exit status 4, all braked, and nothing moves until it is taken back.
stopped() {
    while_running "$@" && [ $ended -eq 4 ] && grep -q 'emergency stop' "$work/busy" && braked &&
        fails 4 "stopped by 'grctl estop'" on_robot move m5 0 &&
        exits 0 on_robot estop --reset && return
    echo "it ended with $ended:"
    cat "$work/busy"
    return 1
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
mkfifo "$work/keys"
exec 8<>"$work/keys" # open, and silent: teaching is refused where no key can come
exits 0 on_robot servo on
test_case "one reaches a robot that another grctl drives"
check "while it plays" stopped '"t_ms":[1-9]' --json play --speed 20 motions/greet.pseq
check "while it moves" stopped 'robot found' -v move m5 -100 20000
exits 0 on_robot servo on
check "while it is taught" stopped 'follow your hands' record -o "$work/taught.m"
check "what was taught is kept" test -s "$work/taught.m"
check "while it is taught limp" stopped 'are limp' teach -o "$work/limp.m"

# stopped_by COMMAND...: it stops a robot that another command plays on.
stopped_by() {
    rm -f "$work/busy" # what the one before said does not count
    "$GRCTL" -d "$robot" --timeout 500 --json play --speed 20 motions/greet.pseq >"$work/busy" \
        2>&1 </dev/null &
    while_pid=$!
    written "$work/busy" '"t_ms":[1-9]' && exits 0 "$@"
    by_status=$?
    [ $by_status -eq 0 ] || kill $while_pid 2>/dev/null
    wait $while_pid
    ended=$?
    [ $by_status -eq 0 ] && [ $ended -eq 4 ] && braked &&
        fails 4 "stopped by 'grctl estop'" on_robot move m5 0 && exits 0 on_robot estop --reset &&
        return
    echo "it ended with $ended:"
    tail "$work/busy"
    return 1
}
by_another_name() {
    (cd "$work" && exec "$GRCTL" -d "$1" --timeout 500 estop)
}
if [ -z "${NATIVE_GRCTL:-}" ]; then # there a port has one name
    check "by the name that a link leads to" stopped_by by_another_name "$sim_pty"
    check "by a name that begins here" stopped_by by_another_name robot
    mkdir "$work/run"
    check "by one who is logged in, of a service" stopped_by \
        env XDG_RUNTIME_DIR="$work/run" "$GRCTL" -d "$robot" --timeout 500 estop
    check "where the folder of the session is missing" stopped_by \
        env XDG_RUNTIME_DIR="$work/none" "$GRCTL" -d "$robot" --timeout 500 estop
fi

watched() {
    "$GRCTL" -d "$robot" --timeout 500 status --watch --interval 100 >"$work/watch" 2>&1 &
    watch_pid=$!
    written "$work/watch" 'R_KNEE_P .* on ' || return 1
    exits 0 on_robot estop && complains "^stopped by process $(known_pid $watch_pid), .* verified"
    watched_status=$?
    written "$work/watch" 'R_KNEE_P .* brake '
    watched_brake=$?
    kill $watch_pid
    wait $watch_pid
    [ $watched_status -eq 0 ] && [ $watched_brake -eq 0 ]
}
exits 0 on_robot servo on
test_case "who reads brakes too"
check "who goes on reading brakes too, and says in whose hands it is" watched
check "it stands" fails 4 "stopped by 'grctl estop'" on_robot init
exits 0 on_robot estop --reset

if have_full_screen; then
    open_screen
    type_line "'$GRCTL' -d '$robot' --timeout 500 monitor"
    until_screen '^12 KNEE_P'
    keys t
    until_screen '^torque on: done'
    exits 0 on_robot estop
    check "monitor" until_screen 'EMERGENCY STOP: R releases it'
    keys R
    check "and takes it back" until_screen 'stop released'
    keys q
    until_screen '^>'
    on_screen kill-server
else
    skip "monitor" "$no_screen"
fi

test_case "who is stopped, who does not obey"

# under_way [guarded]: a slow move, as seen from the joint; its process in $mover. A guard would
# stop the joint of one that is stopped, and release the port.
under_way() {
    [ "${1:-}" = guarded ] || export GRCTL_GUARD=''
    rm -f "$work/moving"
    exits 0 on_robot servo on && exits 0 on_robot move m5 0 500 || return 1
    "$GRCTL" -d "$robot" --timeout 500 -v move m5 -120 20000 >"$work/moving" 2>&1 </dev/null &
    mover=$!
    written "$work/moving" 'robot found' && wait_for sim_shows 5 ' -[1-9][0-9]\.[0-9] deg'
}
# read_angle: what the simulator says of the joint's angle, in $angle.
read_angle() {
    tell look 5 && angle=$(tail -n +"$((tell_lines + 1))" "$work/sim.log" |
        sed -n 's/.* \(-*[0-9]*\)\.[0-9] deg.*/\1/p')
}
seconds() {
    date +%s
}
frozen() {
    under_way || return 1
    kill -s STOP $mover
    read_angle && at_first=$angle && frozen_s=$(seconds)
    exits 0 on_robot estop || { kill -s KILL $mover; return 1; }
    frozen_s=$(($(seconds) - frozen_s))
    sim_shows 5 'torque brake' && read_angle || return 1
    wait $mover
    frozen_ended=$?
    [ $frozen_ended -eq 4 ] && grep -q 'emergency stop' "$work/moving" && [ $frozen_s -le 2 ] &&
        [ $((at_first - angle)) -le 10 ] && braked && exits 0 on_robot estop --reset && return
    echo "ended with $frozen_ended after $frozen_s s; from $at_first to $angle"
    cat "$work/moving"
    return 1
}

# Its guard has stopped the joint and released the port: it is braked all the same, and stays so.
frozen_and_guarded() {
    under_way guarded || return 1
    kill -s STOP $mover
    wait_for exits 0 on_robot status m5 && exits 0 on_robot estop && sim_shows 5 'torque brake'
    guarded_status=$?
    kill -s CONT $mover
    wait $mover
    [ $? -eq 4 ] && [ $guarded_status -eq 0 ] && braked && exits 0 on_robot estop --reset
}

# A process of this user with the port, and no session: it obeys nobody, and is ended.
stranger() {
    flock -F "$sim_pty" sleep 100 &
    stranger_pid=$!
    wait_for fails 1 'in use by' on_robot status || return 1
    exits 0 on_robot estop && complains '^stopped, after the end (SIGTERM) of a program .* verified'
    stranger_status=$?
    kill $stranger_pid 2>/dev/null
    wait $stranger_pid
    [ $? -eq 143 ] && [ $stranger_status -eq 0 ] &&
        fails 4 "stopped by 'grctl estop'" on_robot move m5 0 && exits 0 on_robot estop --reset
}

# A process that is registered, and does not answer.
deaf() {
    mkdir -p "$work/run/grobo" && chmod 700 "$work/run" "$work/run/grobo" || return 1
    sh -c 'trap "" TERM; exec flock -F "$1" sleep 100' sh "$sim_pty" &
    deaf_pid=$!
    wait_for fails 1 'in use by' on_robot status || return 1
    deaf_note=$work/run/grobo/holder-$(echo "$sim_pty" | tr / !)
    printf '%s %s\n' $deaf_pid "$(sed 's/.*) //' /proc/$deaf_pid/stat | cut -d ' ' -f 20)" \
        >"$deaf_note"
    chmod 600 "$deaf_note"
    fails 1 "NOT stopped: process $deaf_pid has the port and has not answered in [0-9]* s; end it" \
        env XDG_RUNTIME_DIR="$work/run" "$GRCTL" -d "$robot" --timeout 500 estop
    deaf_status=$?
    kill -s KILL $deaf_pid
    wait $deaf_pid
    rm "$deaf_note"
    [ $deaf_status -eq 0 ] &&
        exits 0 env XDG_RUNTIME_DIR="$work/run" "$GRCTL" -d "$robot" --timeout 500 estop --reset
}

# The mark is set before the device is looked for, and is there when that is.
missing() {
    fails 1 "no such file or device.*; NOT stopped, nothing was sent; programs refuse to move it" \
        "$GRCTL" -d "$work/missing" --timeout 500 estop || return 1
    ln -s "$sim_pty" "$work/missing"
    fails 4 "stopped by 'grctl estop'" "$GRCTL" -d "$work/missing" --timeout 500 move m5 0 &&
        exits 0 "$GRCTL" -d "$work/missing" --timeout 500 estop --reset &&
        exits 0 "$GRCTL" -d "$work/missing" --timeout 500 status && exits 0 on_robot servo on m5
}

# reset_of_busy: the mark goes, and who has the port is told of.
reset_of_busy() {
    rm -f "$work/watch"
    "$GRCTL" -d "$robot" --timeout 500 status --watch --interval 100 >"$work/watch" 2>&1 &
    watch_pid=$!
    written "$work/watch" 'R_KNEE_P ' && exits 0 on_robot estop && exits 0 on_robot estop --reset &&
        grep -q "process $watch_pid, which has the port, stays stopped" "$work/err"
    busy_status=$?
    kill $watch_pid
    wait $watch_pid
    [ $busy_status -eq 0 ] && exits 0 on_robot move m5 0 500
}

# Nothing stands any more: this grctl itself has the port then, and that is no news.
reset_again() {
    exits 0 on_robot estop && exits 0 on_robot estop --reset && exits 0 on_robot estop --reset &&
        ! grep 'which has the port' "$work/err"
}

# unplugged: the line goes while the stop is sent. It is owed, also by who has not heard of it.
has_sent() {
    [ "$(wc -c <"$work/unplugged.pcapng")" -gt 500 ]
}
unplugged() {
    exits 0 on_robot servo on && tell silent all on || return 1
    rm -f "$work/unplugged.pcapng"
    on_robot --trace "$work/unplugged.pcapng" estop 2>"$work/unplugged" &
    unplugged_pid=$!
    wait_for has_sent && tell plug out
    wait $unplugged_pid
    unplugged_status=$?
    tell silent all off && tell plug in && wait_for test -e "$robot" || return 1
    cat "$work/unplugged"
    [ $unplugged_status -eq 1 ] && grep -q 'NOT verified; switch the robot off' "$work/unplugged" &&
        fails 4 "stopped by 'grctl estop'" on_robot move m5 0 && braked &&
        exits 0 on_robot estop --reset
}

# with_tmp MOUNTS COMMAND: with another /tmp and no session, as root of a name space.
with_tmp() {
    env -u XDG_RUNTIME_DIR -u XDG_CONFIG_HOME -u XDG_STATE_HOME unshare -m sh -c "$1"' &&
        shift && exec "$@"' sh "$@"
}
read_only='mount --bind /tmp /tmp && mount -o remount,ro,bind /tmp'
# The command stays where it is, which may be below that: its folder as it was before.
another_tmp='cd "${GRCTL%/*}" && mount -t tmpfs -o mode=1777 none /tmp && mkdir -p "${GRCTL%/*}" &&
    mount -c --bind . "${GRCTL%/*}" && cd "$OLDPWD"'
unwritable() {
    fails 1 'stopped and verified, .*; the mark could not be written (.*): other programs may' \
        with_tmp "$read_only" "$GRCTL" -d "$robot" --timeout 500 estop && exits 0 on_robot servo on
}
# Who is stopped and cannot see a mark would go on.
unwritable_and_frozen() {
    under_way || return 1
    kill -s STOP $mover
    fails 1 'NOT stopped: .* was not resumed, .*; the mark could not be written' \
        with_tmp "$read_only" "$GRCTL" -d "$robot" --timeout 500 estop
    unseen_status=$?
    grep -q '^State:.T' /proc/$mover/status
    unseen_still=$?
    kill -s KILL $mover
    wait $mover
    [ $unseen_status -eq 0 ] && [ $unseen_still -eq 0 ]
}
# Another user has taken the name of the directory; both programs meet in another one all the same.
taken() {
    exits 0 on_robot servo on || return 1
    # shellcheck disable=SC2016
    exits 0 with_tmp "$another_tmp" sh -c '
        mkdir "/tmp/grobo-$(id -u)" && chown 65534 "/tmp/grobo-$(id -u)" || exit 9
        GRCTL_GUARD="" "$1" -d "$2" --timeout 500 --json play --speed 20 motions/greet.pseq \
            >/tmp/busy 2>/tmp/err &
        for i in $(seq 1000); do grep -q "\"t_ms\":[1-9]" /tmp/busy && break; sleep 0.03; done
        kill -s STOP $!
        "$1" -d "$2" --timeout 500 estop || exit 8
        wait $!
        [ $? -eq 4 ] || exit 7
        "$1" -d "$2" --timeout 500 move m5 0
        [ $? -eq 4 ] || exit 6
        rmdir "/tmp/grobo-$(id -u)"
        "$1" -d "$2" --timeout 500 move m5 0
        [ $? -eq 4 ] || exit 5
        exec "$1" -d "$2" --timeout 500 estop --reset' sh "$GRCTL" "$sim_pty"
}

if [ -z "${NATIVE_GRCTL:-}" ]; then # there nobody is stopped, and nobody else has a port
    check "who is stopped is resumed, and sends nothing but the stop" frozen
    check "who is stopped, and whose guard has stopped the joint" frozen_and_guarded
    if command -v flock >/dev/null 2>&1; then
        check "another program has the port: it is ended, and the robot stopped" stranger
        check "who is registered does not answer" deaf
    else
        skip "another program has the port: it is ended, and the robot stopped" "no flock here"
    fi
    check "the device is missing" missing
    check "taken back while another grctl has the port" reset_of_busy
    check "taken back twice" reset_again
    if unshare -m true 2>/dev/null; then
        check "no mark can be written" unwritable
        check "who could not see a mark is not resumed" unwritable_and_frozen
        check "another user has taken the name of the directory" taken
    else
        skip "no mark can be written" "no name space can be made here"
    fi
    # While it is unplugged the simulator of another test may get the number of its terminal: the
    # marks are where nobody else looks.
    stop_sim
    XDG_RUNTIME_DIR=$work/own
    export XDG_RUNTIME_DIR
    mkdir -m 700 "$XDG_RUNTIME_DIR"
    start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
    check "unplugged while it stops" unplugged
fi
stop_sim
done_testing
