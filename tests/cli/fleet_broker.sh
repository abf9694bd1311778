#!/bin/sh
# SPDX-License-Identifier: MIT
# A fleet whose broker hangs, dies and comes back.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

test_case "the broker"

hangs() {
    : >"$work/one.err"
    lapsed='the permit lapsed: the motion stops'
    plays && kill -STOP "$broker_pid" && written "$work/one.err" "$lapsed"
    hangs_status=$?
    kill -CONT "$broker_pid"
    wait "$play"
    [ $hangs_status -eq 0 ] && wait_for rests
}
check "a broker that hangs stops a motion softly" hangs
# What it has not taken is not lost with it.
hangs_and_dies() {
    : >"$work/one.err"
    lapsed='the permit lapsed: the motion stops'
    plays && kill -STOP "$broker_pid" && written "$work/one.err" "$lapsed" &&
        kill -9 "$broker_pid" && written "$work/state/grctl/agent-one.events" unpermitted
    hangs_status=$?
    wait "$play"
    return $hangs_status
}
check "what happens while it hangs is kept when it dies" hangs_and_dies
: >"$work/broker.log"
begin_open_broker
keep_all
back_again() {
    wait_for is_listed one ONLINE && wait_for is_listed two ONLINE &&
        wait_for test ! -e "$work/state/grctl/agent-one.events" &&
        written "$work/broker.log" "Received PUBLISH from one .*'grobo/v1/one/event'"
}
check "and told to the next" back_again
dies() {
    : >"$work/one.err"
    exits 1 fleet estop --group two && lapsed='the permit lapsed: the motion stops'
    plays && kill -9 "$broker_pid" && written "$work/one.err" 'the broker is away' &&
        written "$work/one.err" "$lapsed"
}
check "so does one that dies" dies
check "what happens meanwhile is kept" written "$work/state/grctl/agent-one.events" unpermitted
begin_open_broker
keep_all
came_back() {
    wait "$play"
    wait_for is_listed one ONLINE && wait_for is_listed two ONLINE && rests
}
check "agents come back to it, and nothing moves" came_back
check "and was told to it" test ! -e "$work/state/grctl/agent-one.events"
check "a stop that it forgot still stands" fails 1 'two: prepare: a stop of group two stands' \
    fleet play greet.pseq --group two
check "it can be taken back" exits 0 fleet reset --group two --host two
check "and robots play again" exits 0 plays_through greet.pseq --group one
fits_schema connection event
done_testing
