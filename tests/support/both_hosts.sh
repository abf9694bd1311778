# SPDX-License-Identifier: MIT
# For tests of stops of a fleet: the hosts one and two, both of the group both, with a motion of
# them, and what the broker was told. Sourced behind fleet.sh.

mkdir -p "$work/config/grctl" "$work/motions"
cp motions/greet.pseq "$work/motions"
cat >"$work/config/grctl/config.yaml" <<EOF2
groups: {one: [a, b], two: [c]}
robots: {a: {device: sim}, b: {device: sim}, c: {device: sim}}
EOF2
begin_agent one --label both
begin_agent two --label both
agent_two=$agent
wait_for is_listed one ONLINE && wait_for is_listed two ONLINE || {
    echo "Bail out! the agents did not start"
    exit 1
}

# plays [OPTIONS]: both hosts, slowly, though permits come late on a busy machine; returns when it
# was begun. $play is who leads.
plays() {
    : >"$work/said"
    "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group both --spread 50 \
        --on-link-lost finish "$@" \
        >"$work/played" 2>"$work/said" </dev/null 3>&- &
    play=$!
    echo $play >>"$work/pids"
    written "$work/said" 'all begin in' && comes_to_move one && comes_to_move two
}
looks() { # HOST: what its robots do is in $work/look
    fleet status --json | grep "\"host\":\"$1\"" >"$work/look" && grep -q '"play": *"' "$work/look"
}
moves() {
    looks "$1" && grep -q '"play": *"playing"' "$work/look"
}
rests() {
    looks "$1" && ! grep -q '"play": *"playing"' "$work/look" &&
        grep -q '"play": *"idle"' "$work/look"
}
ended() {
    ended_with "$1" "$play"
}

# said_first PATTERN: by the log of the broker, of the client that published the latch last: no
# subscription stands before it.
said_first() {
    client=$(sed -n "s/.*Received PUBLISH from \([0-9a-f]*\) .*grobo.v1.group.$1.latch.*/\1/p" \
        "$work/broker.log" | tail -n 1)
    [ -n "$client" ] && grep "Received [A-Z]* from $client" "$work/broker.log" |
        grep -v PINGREQ | head -n 1 | grep -q "PUBLISH.*/latch"
}
latch_is() { # PATTERN
    mosquitto_sub -h 127.0.0.1 -p "$port" -W 1 -C 1 -t grobo/v1/group/both/latch |
        grep -q -e "$1"
}
