#!/bin/sh
# SPDX-License-Identifier: MIT
# What calls a motion of a fleet off, and who may; an agent that dies in it.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/both_hosts.sh

test_case "who may call a motion off"

goes_on() { # another's is refused, and it is called off: its own, and nothing else
    plays && exits 1 fleet play greet.pseq --group both &&
        grep -q 'one: prepare: another motion is played' "$work/err" &&
        fails 1 'another motion is played' fleet play greet.pseq --group one &&
        moves one && moves two
    goes_status=$?
    kill -INT "$play"
    ended 130 && wait_for rests one && wait_for rests two && return $goes_status
}
check "a play that is refused leaves another's motion alone; who began it calls it off" goes_on

test_case "an agent that dies in the motion"

dies() { # [OPTIONS]
    plays "$@" && kill -9 "$agent_two" && ended 1 &&
        grep -q '^grctl: two: its agent went away in the motion' "$work/said"
}
comes_back() {
    wait "$agent_two"
    begin_agent two --label both
    agent_two=$agent
    wait_for is_listed two ONLINE
}
check "the others are called off where an agent dies, and that is told" \
    both dies --- grep -q 'one/a: .*cancel' "$work/said"
check "they rest" wait_for rests one
comes_back
check "they go on, where that was chosen" \
    both dies -s 200 --if-lost continue --- \
    grep -q '^one/a: played' "$work/played"
comes_back
waits_for_time() { # all stand and wait for a time that is far away
    "$GRCTL" fleet play greet.pseq --broker "$broker" --group both --spread 50 \
        --at "$(date -d '+1 hour' +%H:%M:%S)" >"$work/played" 2>"$work/said" </dev/null 3>&- &
    play=$!
    echo $play >>"$work/pids"
    written "$work/said" 'all are ready' && kill -9 "$agent_two" && ended 1 &&
        grep -q '^grctl: two: start: its agent is gone' "$work/said" && wait_for rests one
}
check "nobody waits for the time of one that is gone" waits_for_time
comes_back
done_testing
