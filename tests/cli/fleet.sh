#!/bin/sh
# SPDX-License-Identifier: MIT
# Agents over a real broker, and what is said of them. A crowd of robots is in tests/fleet/crowd.sh.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

test_case "agents"

check "agents are listed" both wait_for is_listed one ONLINE --- wait_for is_listed two ONLINE
check "a robot that is not there is said once" grep -q '^d: .*none: no such file' "$work/two.err"
check_json "their robots and groups" \
    '[(l["host"], [r["name"] for r in l["robots"]], l["groups"]) for l in
      sorted(lines, key=lambda l: l["host"])] ==
     [("one", ["a", "b"], ["all", "one"]), ("two", ["c", "d"], ["all", "two", "arms", "left"])]' \
    fleet list --json
check_json "and a page of each, where there is one" \
    '[[r.get("cockpit") for r in l["robots"]] for l in sorted(lines, key=lambda l: l["host"])] ==
     [[None, None], ["https://stage.local/c/", "https://stage.local/d/"]]' fleet list --json
check_json "how they are" \
    '{(l["host"], l["robot"]): l["up"] for l in lines} ==
     {("one", "a"): True, ("one", "b"): True, ("two", "c"): True, ("two", "d"): False}' \
    fleet status --json
check "a broker that is not there" fails 1 'fleet: 127.0.0.1: ' \
    "$GRCTL" fleet list --broker mqtt://127.0.0.1:1
lonely() { # said once, however often it is tried again
    "$GRCTL" -d one agent --broker mqtt://127.0.0.1:1 --host lonely 2>"$work/lonely.err" 3>&- &
    lonely=$!
    echo $lonely >>"$work/pids"
    written "$work/lonely.err" 'the broker is away: '
    lonely_status=$?
    kill -TERM "$lonely"
    wait "$lonely"
    [ $lonely_status -eq 0 ] && [ "$(grep -c 'is away' "$work/lonely.err")" -eq 1 ]
}
check "an agent says so, and keeps trying" lonely
signs_off() { # a broker that takes who comes, and says at once that it shuts down
    off_port=$(find_port && echo $port)
    python3 tests/support/mqtt.py "$off_port" goodbye >"$work/off.out" 2>&1 3>&- &
    echo $! >>"$work/pids"
    "$GRCTL" -d one agent --broker "mqtt://127.0.0.1:$off_port" --host off 2>"$work/off.err" 3>&- &
    off=$!
    echo $off >>"$work/pids"
    written "$work/off.err" 'is away: Server shutting down'
    off_status=$?
    kill -TERM "$off"
    wait "$off"
    ! grep -e '\[warn\]' "$work/off.err" && return $off_status
}
if have_json; then
    check "what a broker says at its end is told, and nothing else" signs_off
else
    skip "what a broker says at its end" "no python3 here"
fi
check "a broker that is none" fails 2 'is wanted' "$GRCTL" fleet list --broker http://x
check "TLS wants certificates to check by" fails 2 '--ca names the file' \
    "$GRCTL" fleet list --broker mqtts://127.0.0.1
check "no such order" fails 2 'there are list, status' fleet dance
check "a file is missing" fails 2 'fleet push needs FILE' fleet push
check "so for a motion" fails 2 'fleet play needs FILE' fleet play
check "a group without its option resets nothing" \
    fails 2 "fleet reset: 'one' is one argument too many; a group is --group one" fleet reset one
check "an agent has robots of the configuration" fails 2 'agent: -d names a robot or a group' \
    "$GRCTL" -d sim agent --broker "$broker"

check "a page is a link" fails 2 "--cockpit 'javascript:x': http:// or https://" \
    "$GRCTL" -d one agent --broker "$broker" --cockpit javascript:x
check "a label is a name" fails 2 "at most 8 names of letters" \
    "$GRCTL" -d one agent --broker "$broker" --label a,b/c
fits_schema connection factsheet state last
kinds() {
    python3 -c 'import json; print("\n".join(json.load(open("docs/fleet.schema.json"))["$defs"]))' |
        sort >"$work/kinds"
    cat tests/cli/fleet*.sh | sed -n 's/^fits_schema //p' | tr ' ' '\n' | sort -u |
        diff "$work/kinds" -
}
if have_json; then
    test_that "each kind of message is held against the schema by some script" kinds
fi
done_testing
