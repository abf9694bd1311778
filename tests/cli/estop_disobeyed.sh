#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl estop` while a program is stopped, or does not obey: what it says is what was done.
. tests/support/cli.sh
. tests/support/estop.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
exits 0 on_robot servo on
test_case "who is stopped, who does not obey"

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

if [ -z "${NATIVE_GRCTL:-}" ]; then # there nobody is stopped, and nobody else has a port
    check "who is stopped is resumed, and sends nothing but the stop" frozen
    check "who is stopped, and whose guard has stopped the joint" frozen_and_guarded
    if command -v flock >/dev/null 2>&1; then
        check "another program has the port: it is ended, and the robot stopped" stranger
        check "who is registered does not answer" deaf
    else
        skip "another program has the port: it is ended, and the robot stopped" "no flock here"
    fi
fi
stop_sim
done_testing
