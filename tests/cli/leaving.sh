#!/bin/sh
# SPDX-License-Identifier: MIT
# How a command leaves the robot when its terminal closes, it is stopped, or its reader goes away;
# signals are in robot.sh and play.sh, a lost line and a silent robot in play.sh.
. tests/support/cli.sh
. tests/support/terminal.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# stands ANGLE: R_ELBOW_P holds at an angle like that.
stands() {
    exits 0 on_robot status m5 && says "R_ELBOW_P  *$1  *[-0-9.]*  *on  *0 "
}

# The last window of a screen closes: the kernel hangs up on who runs there.
terminal_closes() {
    LC_ALL=C.UTF-8 on_screen new-session -d -x 80 -y 24 \
        "exec '$GRCTL' -d '$robot' --timeout 500 -v move m5 -120 20000 2>'$work/moving'"
    written "$work/moving" 'robot found' || return 1
    wait_for exits 1 on_robot status m5
    wait_for sim_shows 5 ' -[3-9][0-9]\.[0-9] deg'
    on_screen kill-server
    written "$work/moving" 'exit policy carried out' || { cat "$work/moving"; return 1; }
    wait_for exits 0 on_robot status m5
    says ' on '
}
test_case "a closed terminal: the exit policy is carried out"
if have_terminal; then
    trap 'on_screen kill-server 2>/dev/null; end_cli_test' EXIT
    check "a closed terminal: the exit policy is carried out" terminal_closes
    check "and the joint stands on its way" stands '-[2-9][0-9]\.[0-9]'
else
    skip "a closed terminal: the exit policy is carried out" "no tmux here"
    skip "and the joint stands on its way" "no tmux here"
fi

# Ctrl-Z, and back a while later: what was due meanwhile is not caught up with.
stopped() {
    rm -f "$work/out" "$work/err"
    "$GRCTL" -d "$robot" --timeout 500 --json play motions/greet.pseq >"$work/out" 2>"$work/err" &
    stopped_pid=$!
    written "$work/out" '"t_ms":[1-9]' || return 1
    kill -s STOP $stopped_pid
    sleep 1 # a time is what is tested: four times what a host may be late
    kill -s CONT $stopped_pid
    wait $stopped_pid
    stopped_got=$?
    [ $stopped_got -eq 4 ] && complains 'stopped for safety: host stalled'
}
test_that "a stopped process: the motion is over" stopped
check "and the robot holds" stands '[-0-9.]*'

# Who is killed without a guard leaves nothing behind, but the servos know where they were sent.
killed() {
    rm -f "$work/moving"
    GRCTL_GUARD='' "$GRCTL" -d "$robot" --timeout 500 -v move m5 -120 20000 2>"$work/moving" &
    killed_pid=$!
    written "$work/moving" 'robot found' || return 1
    wait_for sim_shows 5 ' -[3-9][0-9]\.[0-9] deg' || return 1
    kill -s KILL $killed_pid
    wait $killed_pid
    exits 0 on_robot stop && on_robot status m5 | sed 's/ *[0-9]*$//' >"$work/first"
    on_robot status m5 | sed 's/ *[0-9]*$//' | diff "$work/first" - # but for the age
}
exits 0 on_robot init --time 500
test_that "killed: stop stops what it left" killed
check "and it holds" stands '-[2-9][0-9]\.[0-9]'

# The robot plays on where nobody reads what it says.
unread() {
    { on_robot --json play motions/greet.pseq; echo $? >"$work/status"; } |
        head -n 1 >"$work/out"
    grep -qx 141 "$work/status" || { cat "$work/status"; return 1; } # as if by SIGPIPE
}
test_that "nobody reads: the motion goes on" unread
check "and the robot holds then too" stands '[-0-9.]*'
stop_sim
done_testing
