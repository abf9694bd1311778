#!/bin/sh
# SPDX-License-Identifier: MIT
# What a fleet is told to do, over a real broker: motions that all play, and what is refused.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

test_case "orders"

sed 's/greet/other/' motions/greet.pseq >"$work/other.pseq"
# Two files, the first at a time that is told: all are ready before it, and none begins before it.
at_a_time() {
    at_s=$(($(date +%s) + 8))
    exits 0 plays_through greet.pseq other.pseq --group one --at "$(date -d "@$at_s" +%H:%M:%S)" &&
        [ "$(date +%s)" -ge $((at_s + 2)) ] && [ "$(grep -c 'one/a: played' "$work/out")" -eq 2 ] &&
        grep -q 'all are ready; they begin in' "$work/err"
}
pushed() {
    exits 0 fleet push "$work/other.pseq" && cmp "$work/other.pseq" "$work/motions/other.pseq"
}
check "a motion is put into their folders" pushed
check "a motion that all play" both exits 0 plays_through other.pseq --group one --- \
    both says 'one/a: played' --- says 'one/b: played'
check "two, at a time that is told" at_a_time
check "a time that is none" fails 2 "--at '25:00': HH:MM or HH:MM:SS is wanted" \
    fleet play greet.pseq --group one --at 25:00
watched() {
    "$GRCTL" fleet status --watch --broker "$broker" >"$work/watched" &
    watcher=$!
    echo $watcher >>"$work/pids"
    wait_for seen_twice && kill -INT $watcher
    wait $watcher
    [ $? -eq 130 ]
}
seen_twice() {
    [ "$(grep -c '^one  *a  *up  ' "$work/watched")" -ge 2 ]
}
check "status again and again" watched
check "what is not there is refused, with the host" fails 1 'one: prepare: .*none.pseq' \
    fleet play none.pseq --group one
check "one robot that is missing keeps all" both exits 1 fleet play greet.pseq --- \
    grep -q 'two: prepare: d: is not there' "$work/err"
check "nobody of that group" fails 1 'no agent is of group three; there are all, .*left' \
    fleet play greet.pseq --group three
check "nobody at that host" fails 1 'no agent of group one at two is online' \
    fleet play greet.pseq --group one --host two
check_json "one group is listed" '[l["host"] for l in lines] == ["two"]' \
    fleet list --group arms --json
check_json "its robots are shown" '[l["robot"] for l in lines] == ["c", "d"]' \
    fleet status --group arms --json
fits_schema cmd_prepare cmd_start cmd_abort cmd_ping cmd_put ack permit ping pong
done_testing
