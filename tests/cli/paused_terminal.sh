#!/bin/sh
# SPDX-License-Identifier: MIT
# Nobody reads the terminal of a command while it has the robot: stopped by Ctrl-S. The robot
# does not wait for that.
. tests/support/cli.sh
. tests/support/terminal.sh

end_paused() {
    on_screen kill-server 2>/dev/null
    end_cli_test
}
start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

plays_on_screen() {
    type_line "'$GRCTL' -d '$robot' --timeout 500 play motions/greet.pseq; echo ended with \$?"
    until_screen 's left at 100' || return 1
    keys C-s
    wait_for exits 0 on_robot status m5 || return 1
    on_screen_is '^ended' && { echo 'it was not stopped'; return 1; }
    keys C-q
    until_screen '^ended with 0'
}
monitors_on() {
    exits 0 on_robot servo on || return 1
    type_line "'$GRCTL' -d '$robot' --timeout 500 monitor"
    until_screen '^12 KNEE_P' || return 1
    keys C-s
    exits 0 on_robot estop && complains 'which has the port, and verified' || return 1
    keys C-q
    until_screen 'EMERGENCY STOP: R releases it' || return 1
    keys R
    until_screen 'stop released' && keys q && until_screen '^>'
}
unread_screen() {
    exits 0 on_robot servo on || return 1
    "${PYTHON:-python3}" tests/support/unread.py "$GRCTL" "$robot" >"$work/out" 2>"$work/err" ||
        { cat "$work/out" "$work/err"; return 1; }
    grep -q 'which has the port, and verified' "$work/out" && exits 0 on_robot estop --reset
}
test_case "one reaches a monitor whose terminal nobody reads"
if have_full_screen && have_json; then
    check "one reaches a monitor whose terminal nobody reads" unread_screen
else
    skip "one reaches a monitor whose terminal nobody reads" "no full screen or no python3 here"
fi
test_case "Ctrl-S: the motion goes on to its end"
if have_full_screen; then
    open_screen
    trap end_paused EXIT
    check "Ctrl-S: the motion goes on to its end" plays_on_screen
    check "an emergency stop reaches a monitor after Ctrl-S" monitors_on
else
    skip "Ctrl-S: the motion goes on to its end" "$no_screen"
    skip "an emergency stop reaches a monitor after Ctrl-S" "$no_screen"
fi
stop_sim
done_testing
