#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl estop` while another program has the port: what it says is what was done.
. tests/support/cli.sh
. tests/support/terminal.sh
. tests/support/estop.sh

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

stop_sim
done_testing
