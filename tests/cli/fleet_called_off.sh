#!/bin/sh
# SPDX-License-Identifier: MIT
# A motion of a fleet that is called off by whoever began it, or by a stop of its group.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

test_case "a motion is called off"

interrupted() {
    plays && kill -INT "$play" && ended 130 && wait_for rests
}
check "Ctrl-C calls it off" interrupted
stopped() {
    plays && exits 0 fleet "$1" --group one && complains_of a && complains_of b && ended 1
}
complains_of() {
    grep -q "^one/$1: stopped" "$work/err"
}
check "an emergency stop is told robot by robot" stopped estop
check "it stands" fails 1 'one: prepare: a stop of group one stands' \
    fleet play greet.pseq --group one
check "until it is taken back" exits 0 fleet reset --group one
check "a soft stop" stopped stop
check "stands as well" fails 1 'a stop of group one stands' fleet play greet.pseq --group one
check "and is taken back" exits 0 fleet reset --group one
mistaken() {
    plays && exits 2 fleet stop two --group one && grep -q "'two' is one argument" "$work/err" &&
        complains_of a && ended 1 && exits 0 fleet reset --group one
}
check "a word too many is reported after the stop" mistaken
fits_schema event cmd_reset latch
done_testing
