#!/bin/sh
# SPDX-License-Identifier: MIT
# Agents that leave the broker, are lost to it, or have the same name.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

test_case "leaving"

leaves() {
    kill -TERM "$agent_one" && wait_for is_listed one OFFLINE
}
check "an agent says goodbye" leaves
broken() {
    begin_agent one
    wait_for is_listed one ONLINE && kill -9 "$agent" && wait_for is_listed one CONNECTIONBROKEN
}
check "the broker says it of one that died" broken
again() {
    begin_agent one --on-exit sit
    wait_for is_listed one ONLINE && wait_for grep -q connected "$work/one.err" &&
        ! grep -q 'another agent' "$work/one.err"
}
check "its next life is no other agent" again
has_connected_often() {
    [ "$(grep -c '^connected' "$work/one.err")" -ge 6 ]
}
twins() { # two of them, each of which takes the other's place: after pauses that grow
    twins_from=$(date +%s)
    begin_agent two --host one
    wait_for grep -q "has another agent of the name 'one'" "$work/one.err" &&
        wait_for has_connected_often && [ $(($(date +%s) - twins_from)) -ge 2 ]
    twins_status=$?
    kill -TERM "$agent"
    wait "$agent"
    return $twins_status
}
check "two agents of one name are told so, and leave each other time" twins
fits_schema connection
done_testing
