#!/bin/sh
# SPDX-License-Identifier: MIT
# --realtime: what it takes, what the system refuses, what a thread gets, and its guard does not.
. tests/support/cli.sh
start_sim || { echo "Bail out! the simulator did not start"; exit 1; }
motion=motions/greet.pseq

# with_wish WISH: each command that has the option, on what is never opened.
wrong_everywhere() {
    for wish in 0 100 -1 x 50x 50@ 50@64 50@3, '50 @3' 50@-1 50,3 5000000000000000000000 1.5; do
        exits 2 "$GRCTL" -d sim play $motion --realtime="$wish" &&
            complains 'a priority of 1 to 99' &&
            exits 2 "$GRCTL" serve -d sim --port 0 --realtime="$wish" && complains 'realtime' &&
            exits 2 "$GRCTL" follow so101-leader@sim so101@sim --realtime="$wish" &&
            complains 'realtime' &&
            exits 2 "$GRCTL" -d sim agent --broker mqtt://localhost:1 --realtime="$wish" &&
            complains 'realtime' || { echo "wish '$wish'"; return 1; }
    done
}
test_that "a wish that means nothing is refused, by every command that takes one" wrong_everywhere

no_such_cpu() {
    exits 1 "$GRCTL" -d sim play $motion --realtime 1@63 &&
        grep -q 'not on that CPU' "$work/err" && [ "$(grep -c '^grctl: ' "$work/err")" -eq 1 ]
}
name="a CPU that is not there is refused before anything moves"
if [ "$(getconf _NPROCESSORS_CONF)" -lt 64 ] && [ -z "${NATIVE_GRCTL:-}" ] && [ -d /proc/self ]
then
    test_that "$name" no_such_cpu
else
    test_case "$name"
    skip "$name" "64 CPUs, or not Linux"
fi

# Field 41 of /proc/PID/stat, behind the name, is the policy: 1 is FIFO; 40 the priority.
runs_first() {
    [ "$(sed 's/.*) //' "/proc/$player/stat" | cut -d ' ' -f 38,39)" = '7 1' ]
}
cpus_of() {
    sed -n 's/^Cpus_allowed:[[:space:]]*//p' "/proc/$1/status"
}
plays_first() {
    "$GRCTL" -d "$robot" --timeout 500 -v play $motion --realtime 7@0 >"$work/out" 2>"$work/err" &
    player=$!
    echo $player >>"$work/pids"
    written "$work/err" '^guarded by process' && wait_for runs_first ||
        { cat "$work/err"; return 1; }
    guard=$(sed -n 's/^guarded by process //p' "$work/err")
    [ "$(cpus_of $player | tr -d 0,)" = 1 ] || { echo "player: $(cpus_of $player)"; return 1; }
    wait_for guard_is_free || { echo "guard: $(cpus_of "$guard")"; return 1; }
    player=$guard
    ! runs_first && wait
}
guard_is_free() {
    [ "$(cpus_of "$guard")" = "$(cpus_of $$)" ]
}
name="a thread runs first on its CPU, its guard as any other, on every CPU"
if [ -n "${EMULATOR:-}${NATIVE_GRCTL:-}" ] || ! chrt -f 7 true 2>/dev/null ||
    ! taskset 1 true 2>/dev/null; then
    test_case "$name"
    skip "$name" "no priority is granted here, or not Linux"
else
    test_that "$name" plays_first
fi

refused() {
    exits 1 setpriv --reuid=65534 --clear-groups --bounding-set=-all \
        prlimit --rtprio=0:0 "$GRCTL" -d sim play $motion --realtime 7 &&
        grep -q "no priority 7 (.ulimit -r. must be 7 or more: .*): permission" "$work/err"
}
name="a user without that right is told which limit it is"
if [ "$(id -u)" -eq 0 ] && setpriv --reuid=65534 --clear-groups --bounding-set=-all \
    prlimit --rtprio=0:0 "$GRCTL" version >/dev/null 2>&1; then
    test_that "$name" refused
else
    test_case "$name"
    skip "$name" "not root, or no setpriv that can take rights away"
fi
stop_sim
done_testing
