#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl estop` and its mark: of a device that is missing or goes, of a mark that cannot be written.
. tests/support/cli.sh
. tests/support/estop.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
exits 0 on_robot servo on
test_case "a mark stands, whatever is there"

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
