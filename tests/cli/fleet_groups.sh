#!/bin/sh
# SPDX-License-Identifier: MIT
# Stops of groups of a fleet: of all, of one group, of a label, of a group that there is not.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

test_case "stops of groups"

# A name that is mistyped stops nobody: that is no success.
mistyped() {
    exits 1 fleet stop --group tree &&
        complains 'no agent is of group tree; there are all, .*left.*: nothing was seen to stop' &&
        exits 1 fleet reset --group tree && complains 'no agent is of group tree'
}
check "a stop of a group that there is not" mistyped
# A stop of all, one of the group, and that of the group taken back.
two_stops() {
    exits 1 fleet estop && exits 0 fleet stop --group one && exits 1 fleet reset --group one &&
        complains 'one: reset: a stop of group all stands' || return 1
    exits 1 fleet play greet.pseq --group one && complains 'a stop of group all stands' &&
        exits 0 fleet reset && exits 0 plays_through greet.pseq --group one
}
check "a stop of all stands when that of a group is taken back" two_stops
labelled() {
    exits 1 fleet stop --group arms && fails 1 'two: prepare: a stop of group arms stands' \
        fleet play greet.pseq --group left && exits 0 plays_through greet.pseq --group one &&
        exits 0 fleet reset --group arms
}
check "a label is a group of its own" labelled
fits_schema cmd_reset latch
done_testing
