#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl estop` of root while a program of another user has the port: that one reads a mark beside
# it, or its guard takes the port from it, or it is ended. And who cannot read marks at all.
. tests/support/cli.sh

# A number that no user has, and no other test at this time.
user=$((61000 + $$ % 4000))
# In the background the process is that of the command: $instead is exec there.
instead=
as_user() {
    $instead setpriv --reuid=$user --regid=$user --clear-groups \
        env -u XDG_RUNTIME_DIR -u XDG_CONFIG_HOME -u XDG_STATE_HOME HOME=/nowhere "$@"
}
if [ "$(id -u)" -ne 0 ] || ! unshare -m true 2>/dev/null; then
    echo '1..0 # SKIP only root can be another user, with a /tmp of its own'
    exit
fi
if [ -n "${EMULATOR:-}${NATIVE_GRCTL:-}" ] || ! as_user "$GRCTL" --version >/dev/null 2>&1; then
    echo '1..0 # SKIP needs setpriv, and a grctl of this machine that everybody can run'
    exit
fi
mover=
end_users() {
    [ -z "$mover" ] || kill -s KILL $mover 2>/dev/null
    end_cli_test
    rm -rf "/tmp/grobo-$user"
}
trap end_users EXIT

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
chmod 666 "$sim_pty"

# under_way COMMAND...: the other user's joint is on its way, moved by that; its process in $mover.
under_way() {
    exits 0 on_robot servo on && exits 0 on_robot move m5 0 500 || return 1
    : >"$work/moving"
    instead=exec
    "$@" >"$work/moving" 2>&1 </dev/null &
    mover=$!
    instead=
    wait_for sim_shows 5 ' -[1-9][0-9]\.[0-9] deg'
}
moves_there() {
    as_user "$@" "$GRCTL" -d "$sim_pty" --timeout 500 move m5 -120 20000
}
# Where another directory has the name of that with the marks.
moves_apart() {
    (instead= && as_user sh -c 'umask 077; mkdir -p "$1"' sh "/tmp/grobo-$user") || return 1
    # shellcheck disable=SC2016
    $instead unshare -m sh -c 'mount -t tmpfs -o "mode=700,uid=$1" none "/tmp/grobo-$1" && shift &&
        exec "$@"' sh $user \
        setpriv --reuid=$user --regid=$user --clear-groups \
        env -u XDG_RUNTIME_DIR -u XDG_CONFIG_HOME -u XDG_STATE_HOME HOME=/nowhere "$@" \
        "$GRCTL" -d "$sim_pty" --timeout 500 move m5 -120 20000
}
estop() {
    exits 0 on_robot estop && grep -q 'and verified' "$work/err"
}
ended_with() {
    wait $mover
    ended=$?
    mover=
    [ $ended -eq "$1" ] && return
    echo "it ended with $ended:"
    cat "$work/moving"
    return 1
}
# braked: on its way, and nobody moves it before the stop is taken back.
braked() {
    sim_shows 5 ' -[1-9][0-9]*\.[0-9] deg.* torque brake' && ! sim_shows 5 moving &&
        fails 4 "stopped by 'grctl estop'" on_robot move m5 0
}
reset() {
    exits 0 on_robot estop --reset
}

by_mark() {
    under_way moves_there && estop && ended_with 4 && grep -q 'emergency stop' "$work/moving" &&
        braked && fails 4 "stopped by 'grctl estop'" moves_there && reset &&
        exits 0 as_user "$GRCTL" -d "$sim_pty" --timeout 500 move m5 0 500
}
test_that "a mark beside it: it stops the robot, its user is stopped, and both are released" by_mark

by_mark_of_auto() {
    under_way moves_there && exits 0 env GRCTL_DEVICE="$sim_pty" "$GRCTL" estop && ended_with 4 &&
        braked && reset
}
test_that "and where the device is named by the environment" by_mark_of_auto

by_guard() {
    under_way moves_apart && estop && grep -q 'stopped, by the guard of a program' "$work/err" &&
        ended_with 4 && grep -q 'host stalled' "$work/moving" && braked && reset
}
test_that "it cannot read a mark: its guard stops the robot" by_guard

by_sigterm() {
    under_way moves_apart GRCTL_GUARD= && estop &&
        grep -q 'stopped, after the end (SIGTERM) of' "$work/err" && ended_with 143 &&
        braked && reset
}
test_that "nor has it a guard: it is ended, and the robot stopped" by_sigterm

# It ignores that too.
stubborn() {
    instead=exec
    as_user sh -c 'trap "" TERM; exec flock -F "$1" sleep 100' sh "$sim_pty" &
    mover=$!
    instead=
    wait_for fails 1 'in use by' on_robot status || return 1
    fails 1 'NOT stopped, nothing was sent: that program has not ended on SIGTERM; switch' \
        "$GRCTL" -d "$robot" --timeout 500 estop || return 1
    kill -s KILL $mover
    wait $mover 2>/dev/null
    mover=
    reset
}
test_that "it does not end: that is said" stubborn

# The number in a note of the user's is that of a process of root's, which has no port.
liar() {
    instead=exec
    as_user sh -c 'exec flock -F "$1" sleep 100' sh "$sim_pty" &
    mover=$!
    instead=
    wait_for fails 1 'in use by' on_robot status || return 1
    sleep 100 &
    victim=$!
    as_user sh -c 'umask 077; mkdir -p "$1" && echo "$2 0" >"$1/holder-$3"' sh "/tmp/grobo-$user" \
        $victim "$(echo "$sim_pty" | tr / !)" && estop
    liar_status=$?
    kill -s 0 $victim && kill $victim && [ $liar_status -eq 0 ] && ended_with 143 && braked && reset
}
test_that "a number in its note ends nobody" liar

# A directory of the user's that leads to one of root's.
linked() {
    rm -rf "/tmp/grobo-$user" && mkdir -m 700 "$work/roots" &&
        as_user ln -s "$work/roots" "/tmp/grobo-$user" || return 1
    under_way moves_there && estop && ended_with 4 && braked && reset &&
        [ -z "$(ls "$work/roots")" ] && rm "/tmp/grobo-$user"
}
test_that "its directory is a link: nothing is written there" linked

# A user's stop does not end who is another user.
of_another() {
    under_way "$GRCTL" -d "$robot" --timeout 500 move m5 -120 20000 || return 1
    fails 1 'NOT stopped' as_user "$GRCTL" -d "$sim_pty" --timeout 500 estop && kill -s 0 $mover &&
        sim_shows 5 moving && estop && ended_with 4 && reset &&
        exits 0 as_user "$GRCTL" -d "$sim_pty" --timeout 500 estop --reset
}
test_that "a user's stop ends no program of root's" of_another

read_only='mount --bind /tmp /tmp && mount -o remount,ro,bind /tmp'
unwritable() {
    under_way "$GRCTL" -d "$robot" --timeout 500 move m5 -120 20000 || return 1
    fails 1 'by the guard of .* and verified, but not kept so; the mark could not be written' \
        env -u XDG_RUNTIME_DIR unshare -m sh -c "$read_only"' && exec "$@"' sh \
        "$GRCTL" -d "$sim_pty" --timeout 500 estop || return 1
    ended_with 4 && exits 0 on_robot servo on
}
test_that "no mark can be written: the guard stops the robot" unwritable
stop_sim
done_testing
