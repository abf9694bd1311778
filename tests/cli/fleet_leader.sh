#!/bin/sh
# SPDX-License-Identifier: MIT
# Whoever leads a motion of a fleet is gone: in the motion, and before it.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts --on-exit sit

test_case "the leader is lost"

lapsed='the permit lapsed: the motion stops'
check "a motion stops softly when who leads it dies" both leader_killed --- wait_for rests
lapsed='the permit lapsed: the motion goes on'
goes_on() {
    leader_killed --on-link-lost finish && moves && exits 0 fleet stop --group one &&
        wait_for rests && exits 0 fleet reset --group one
}
check "or goes on, where that was said" goes_on

# Who leads is gone between the order to start and the start: then nothing begins and none leaves.
abandoned() { # FINISH
    : >"$work/one.err"
    python3 tests/support/mqtt.py "$port" abandon one one \
        '{"file":"greet.pseq","on_link_lost":"'$1'"}' >"$work/out" &&
        json 'all(l["ok"] for l in lines)' &&
        written "$work/one.err" 'the permit lapsed before the start: it stops' &&
        python3 tests/support/mqtt.py "$port" still 1 3 >"$work/out" &&
        json 'all(r["rests"] and r["came_deg"] < 1 and r["moved_deg"] < 1
              for r in (lines[0]["one/a"], lines[0]["one/b"]))'
}
if have_json; then
    check "a start whose leader is lost before it is none" abandoned finish
    check "no exit policy is carried out before it either" abandoned exit
else
    skip "a start whose leader is lost before it" "no python3 here"
fi
fits_schema event permit
done_testing
