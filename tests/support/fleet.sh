#!/bin/sh
# SPDX-License-Identifier: MIT
# For tests of agents and fleets: a broker of this test alone on a free port, and agents. Sourced
# behind cli.sh. $port, $broker: where.

has_no_mqtt() {
    "$GRCTL" fleet list --broker mqtt://127.0.0.1:1 2>&1 | grep -q 'no MQTT in it'
}

need_fleet() {
    for fleet_tool in mosquitto mosquitto_pub mosquitto_sub "$@"; do
        command -v "$fleet_tool" >/dev/null || { echo "1..0 # SKIP no $fleet_tool here"; exit 0; }
    done
    if has_no_mqtt; then
        echo "1..0 # SKIP this grctl has no MQTT in it"
        exit 0
    fi
    find_port
    broker=mqtt://127.0.0.1:$port
}

# find_port: $port is one that nobody listens at, outside of those that the system gives to clients:
# they would connect with themselves while the broker is away.
find_port() {
    for find_n in 1 2 3 4 5 6 7 8 9; do
        port=$((12000 + ($$ + find_n * 4999) % 20000))
        timeout 5 mosquitto_pub -h 127.0.0.1 -p "$port" -t x -m x 2>&1 | grep -qi refused && return
    done
    echo "Bail out! no port is free"
    exit 1
}

# publish OPTION...: to the broker; localhost is a name that not every root has.
publish() {
    mosquitto_pub -h 127.0.0.1 -p "$port" "$@"
}

# begin_broker: with $work/broker.conf, or without one of its own for anybody; $broker_pid is it.
begin_broker() {
    [ -e "$work/broker.conf" ] || printf '%s\n' "listener $port 127.0.0.1" 'allow_anonymous true' \
        'persistence false' 'set_tcp_nodelay true' 'max_packet_size 2000000' 'log_type all' \
        >"$work/broker.conf"
    mosquitto -c "$work/broker.conf" >>"$work/broker.log" 2>&1 3>&- &
    broker_pid=$!
    echo $broker_pid >>"$work/pids"
}
begin_open_broker() {
    begin_broker
    wait_for publish -t x -m x && return
    echo "Bail out! the broker did not start"
    cat "$work/broker.log"
    exit 1
}

# begin_agent HOST [OPTIONS]: $agent is its process; of the group of that name.
begin_agent() {
    agent_host=$1
    shift
    "$GRCTL" -d "$agent_host" agent --broker "$broker" --host "$agent_host" \
        --motions "$work/motions" "$@" >"$work/$agent_host.out" 2>"$work/$agent_host.err" 3>&- &
    agent=$!
    echo $agent >>"$work/pids"
}
fleet() {
    fleet_verb=$1
    shift
    "$GRCTL" fleet "$fleet_verb" --broker "$broker" "$@"
}
# comes_to_move [HOST]: `moves` is true at last; not where the play that is begun has ended before.
comes_to_move() {
    wait_for moves_or_is_over "$@" && kill -0 "$play" 2>/dev/null && return
    echo "the motion ended before it was seen"
    cat "$work/said"
    return 1
}
moves_or_is_over() {
    moves "$@" || ! kill -0 "$play" 2>/dev/null
}
is_listed() {
    fleet list | grep -q "^$1  *$2"
}
