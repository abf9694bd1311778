#!/bin/sh
# SPDX-License-Identifier: MIT
# Stops of a fleet: one that is newer than a reset, and one that a robot does not carry out.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/both_hosts.sh

test_case "a stop that is newer than a reset, and one that a robot does not carry out"

# Where a ghost is online, a reset listens for seconds; another stop comes in that time.
asked_latch() { # of a client that came behind that line
    tail -n +"$broker_line" "$work/broker.log" | grep -q 'grobo/v1/group/both/latch (QoS'
}
newer_stop() {
    exits 0 fleet stop --group both && publish -q 1 -r -t grobo/v1/ghost/connection \
        -m '{"v":1,"state":"ONLINE","epoch":"00112233445566778899aabbccddeeff"}' || return 1
    broker_line=$(($(wc -l <"$work/broker.log") + 1))
    : >"$work/said"
    "$GRCTL" fleet reset --group both --broker "$broker" >"$work/played" 2>"$work/said" \
        </dev/null 3>&- &
    reset=$!
    echo $reset >>"$work/pids"
    wait_for asked_latch && publish -q 1 -r -t grobo/v1/group/both/latch -m '{"v":1,"stopped":true,
        "how":"stop","id":"0123456789abcdef0123456789abcdef","by":"Ben","at_ms":1}' &&
        ended_with 1 $reset && publish -q 1 -r -n -t grobo/v1/ghost/connection &&
        grep -q 'another stop was given meanwhile: it stands' "$work/said" &&
        fails 1 'a stop of group both stands' fleet play greet.pseq --group one &&
        latch_is '"by":"Ben"'
}
check "a reset releases no stop that was given after it began" newer_stop
check "one that begins after it does" both exits 0 fleet reset --group both --- \
    latch_is '"stopped":false'
# A servo whose line is cut hears no stop. Its robot is named, and the others are stopped.
not_stopped() {
    tell cable 5 out && exits 1 fleet "$1" --group hard &&
        grep -q '^grctl: hard/d: NOT seen to stop; use its switch$' "$work/err" &&
        grep -q '^hard/e: stopped$' "$work/err" && ! grep -q 'all stopped' "$work/err"
}
not_stopped_json() {
    exits 1 fleet estop --group hard --json &&
        grep -q '"host":"hard","robot":"d","stopped":false' "$work/out" &&
        grep -q '"host":"hard","robot":"e","stopped":true' "$work/out"
}
if by_tcp; then
    skip "a robot that could not be stopped is named" "needs the simulator's console"
else
    own_sim
    start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
    sed -i "s|^groups: {|&hard: [d, e], |; s|^robots: {|&d: {device: $robot}, e: {device: sim}, |" \
        "$work/config/grctl/config.yaml"
    begin_agent hard
    hard_agent=$agent
    check "a robot on a line is there" wait_for is_listed hard ONLINE
    check "it is stopped as the others are" both exits 0 fleet estop --group hard --- \
        grep -q '^hard/d: stopped$' "$work/err"
    check "a robot that could not be stopped is named" not_stopped estop
    check "so in JSON" not_stopped_json
    soft_not_stopped() { # in the middle of a motion
        tell cable 5 in && exits 0 fleet reset --group hard || return 1
        "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group hard --spread 50 \
            --on-link-lost finish >"$work/played" 2>"$work/said" </dev/null 3>&- &
        play=$!
        echo $play >>"$work/pids"
        written "$work/said" 'all begin in' && comes_to_move hard && not_stopped stop
        soft_status=$?
        wait $play
        return $soft_status
    }
    check "so after a soft stop" soft_not_stopped
    kill $hard_agent
    wait $hard_agent
    stop_sim
fi
done_testing
