#!/bin/sh
# SPDX-License-Identifier: MIT
# Stops of a fleet: what is said first, to a broker that is there, dead or mute; a stop whose
# message is gone.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/both_hosts.sh

test_case "the stop before anything else"

check "a stop is published before anything is asked" \
    both exits 0 fleet stop --group both --- said_first both
check "so is an emergency stop" both exits 0 fleet estop --group both --- said_first both
check "and is taken back" exits 0 fleet reset --group both
# A host that is online by what the broker keeps, and never said what it has.
ghost() {
    publish -q 1 -r -t grobo/v1/ghost/connection \
        -m '{"v":1,"state":"ONLINE","epoch":"00112233445566778899aabbccddeeff"}'
    exits 1 fleet estop --group both &&
        grep -q 'ghost: is online and never said which robots.*use their switches' "$work/err" &&
        said_first both && grep -q 'one/a: stopped' "$work/err" &&
        ! grep -q 'all stopped' "$work/err"
}
check "a ghost delays no stop, and is no success" ghost
publish -q 1 -r -n -t grobo/v1/ghost/connection
check "without it all stopped" both exits 0 fleet stop --group both --- \
    grep -q 'all stopped' "$work/err"
check "so the reset" exits 0 fleet reset --group both

test_case "a stop whose message is gone"

deleted() {
    exits 0 fleet estop --group both && publish -q 1 -r -n -t grobo/v1/group/both/latch &&
        wait_for latch_is '"stopped":true' && exits 0 fleet reset --group both &&
        exits 0 fleet play greet.pseq --group one -s 400 --spread 50 --on-link-lost finish
}
check "a stop whose retained message was deleted is told again, and released" deleted
overwritten() { # by the release of another stop, or by what cannot be read
    exits 0 fleet stop --group both && publish -q 1 -r -t grobo/v1/group/both/latch -m "$1" &&
        wait_for latch_is '"stopped":true' && exits 0 fleet reset --group both
}
check "so where another's release is in its place" overwritten \
    '{"v":1,"stopped":false,"id":"00112233445566778899aabbccddeeff","by":"x","at_ms":1}'
check "so where rubbish is" overwritten '{"v":1'

test_case "a broker that is not there"

# says_switches PORT WHY: that, while it still tries; $stopper is it.
says_switches() {
    : >"$work/err"
    "$GRCTL" fleet estop --group both --broker "mqtt://127.0.0.1:$1" 2>"$work/err" 3>&- &
    stopper=$!
    echo $stopper >>"$work/pids"
    written "$work/err" "127.0.0.1: $2: nothing is stopped; use the switches" &&
        kill -0 $stopper
}
"$GRCTL" fleet log --broker "$broker" >"$work/log.out" 2>"$work/log.err" </dev/null 3>&- &
log=$!
echo $log >>"$work/pids"
logs() { # what it hears is told; a stop is heard
    fleet stop --group both >/dev/null 2>&1 && fleet reset --group both >/dev/null 2>&1 &&
        grep -q '^one: released' "$work/log.out"
}
check "a log hears what agents say" wait_for logs
kill "$broker_pid"
wait "$broker_pid"
check "and says that the broker is away" written "$work/log.err" 'the broker is away: '
kill -INT $log
wait $log
dead() {
    says_switches "$port" 'the broker cannot be reached' && begin_open_broker && {
        wait "$stopper"
        said_first both && latch_is '"how":"estop"'
    }
}
check "a dead broker is told at once, and hears of the stop when it comes" dead
mute() {
    mute_port=$(find_port && echo $port)
    python3 tests/support/mqtt.py "$mute_port" mute >"$work/mute.out" 2>&1 3>&- &
    echo $! >>"$work/pids"
    written "$work/mute.out" ready && says_switches "$mute_port" 'the broker does not answer'
    mute_status=$?
    wait $stopper
    [ $? -eq 1 ] && [ $mute_status -eq 0 ]
}
if have_json; then
    check "so is one that does not answer" mute
else
    skip "one that does not answer" "no python3 here"
fi
done_testing
