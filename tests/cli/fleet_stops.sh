#!/bin/sh
# SPDX-License-Identifier: MIT
# Stops of a fleet: what is said first, to a broker that is there, dead or mute; what calls a motion
# off, and who may; a stop whose retained message is gone.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker

mkdir -p "$work/config/grctl" "$work/motions"
cp motions/greet.pseq "$work/motions"
cat >"$work/config/grctl/config.yaml" <<EOF2
groups: {one: [a, b], two: [c]}
robots: {a: {device: sim}, b: {device: sim}, c: {device: sim}}
EOF2
begin_agent one --label both
begin_agent two --label both
agent_two=$agent
test_case "agents are there"
check "agents are there" both wait_for is_listed one ONLINE --- wait_for is_listed two ONLINE

# plays [OPTIONS]: both hosts, slowly, though permits come late on a busy machine; returns when it
# was begun. $play is who leads.
plays() {
    : >"$work/said"
    "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group both --spread 50 \
        --on-link-lost finish "$@" \
        >"$work/played" 2>"$work/said" </dev/null 3>&- &
    play=$!
    echo $play >>"$work/pids"
    written "$work/said" 'all begin in' && wait_for moves one && wait_for moves two
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

test_case "the stop before anything else"

# said_first PATTERN: by the log of the broker, of the client that published the latch last: no
# subscription stands before it.
said_first() {
    client=$(sed -n "s/.*Received PUBLISH from \([0-9a-f]*\) .*grobo.v1.group.$1.latch.*/\1/p" \
        "$work/broker.log" | tail -n 1)
    [ -n "$client" ] && grep "Received [A-Z]* from $client" "$work/broker.log" |
        grep -v PINGREQ | head -n 1 | grep -q "PUBLISH.*/latch"
}
check "a stop is published before anything is asked" \
    both exits 0 fleet stop --group both --- said_first both
check "so is an emergency stop" both exits 0 fleet estop --group both --- said_first both
check "and is taken back" exits 0 fleet reset --group both
# A host that is online by what the broker keeps, and never said what it has.
ghost() {
    publish -q 1 -r -t grobo/v1/ghost/connection \
        -m '{"v":1,"state":"ONLINE","epoch":"00112233445566778899aabbccddeeff"}'
    exits 1 fleet estop --group both &&
        grep -q 'ghost: is online and never said which robots.*use their switches' "$work/err" &&
        said_first both && grep -q 'one/a: stopped' "$work/err" &&
        ! grep -q 'all stopped' "$work/err"
}
check "a ghost delays no stop, and is no success" ghost
publish -q 1 -r -n -t grobo/v1/ghost/connection
check "without it all stopped" both exits 0 fleet stop --group both --- \
    grep -q 'all stopped' "$work/err"
check "so the reset" exits 0 fleet reset --group both

test_case "a stop that is newer than a reset, and one that a robot does not carry out"

# Where a ghost is online, a reset listens for seconds; another stop comes in that time.
asked_latch() { # of a client that came behind that line
    tail -n +"$broker_line" "$work/broker.log" | grep -q 'grobo/v1/group/both/latch (QoS'
}
newer_stop() {
    exits 0 fleet stop --group both && publish -q 1 -r -t grobo/v1/ghost/connection \
        -m '{"v":1,"state":"ONLINE","epoch":"00112233445566778899aabbccddeeff"}' || return 1
    broker_line=$(($(wc -l <"$work/broker.log") + 1))
    : >"$work/said"
    "$GRCTL" fleet reset --group both --broker "$broker" >"$work/played" 2>"$work/said" \
        </dev/null 3>&- &
    reset=$!
    echo $reset >>"$work/pids"
    wait_for asked_latch && publish -q 1 -r -t grobo/v1/group/both/latch -m '{"v":1,"stopped":true,
        "how":"stop","id":"0123456789abcdef0123456789abcdef","by":"Ben","at_ms":1}' &&
        ended_with 1 $reset && publish -q 1 -r -n -t grobo/v1/ghost/connection &&
        grep -q 'another stop was given meanwhile: it stands' "$work/said" &&
        fails 1 'a stop of group both stands' fleet play greet.pseq --group one &&
        latch_is '"by":"Ben"'
}
latch_is() { # PATTERN
    mosquitto_sub -h 127.0.0.1 -p "$port" -W 1 -C 1 -t grobo/v1/group/both/latch |
        grep -q -e "$1"
}
check "a reset releases no stop that was given after it began" newer_stop
check "one that begins after it does" both exits 0 fleet reset --group both --- \
    latch_is '"stopped":false'
# A servo whose line is cut hears no stop. Its robot is named, and the others are stopped.
not_stopped() {
    tell cable 5 out && exits 1 fleet "$1" --group hard &&
        grep -q '^grctl: hard/d: NOT seen to stop; use its switch$' "$work/err" &&
        grep -q '^hard/e: stopped$' "$work/err" && ! grep -q 'all stopped' "$work/err"
}
not_stopped_json() {
    exits 1 fleet estop --group hard --json &&
        grep -q '"host":"hard","robot":"d","stopped":false' "$work/out" &&
        grep -q '"host":"hard","robot":"e","stopped":true' "$work/out"
}
if by_tcp; then
    skip "a robot that could not be stopped is named" "needs the simulator's console"
else
    own_sim
    start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
    sed -i "s|^groups: {|&hard: [d, e], |; s|^robots: {|&d: {device: $robot}, e: {device: sim}, |" \
        "$work/config/grctl/config.yaml"
    begin_agent hard
    hard_agent=$agent
    check "a robot on a line is there" wait_for is_listed hard ONLINE
    check "it is stopped as the others are" both exits 0 fleet estop --group hard --- \
        grep -q '^hard/d: stopped$' "$work/err"
    check "a robot that could not be stopped is named" not_stopped estop
    check "so in JSON" not_stopped_json
    soft_not_stopped() { # in the middle of a motion
        tell cable 5 in && exits 0 fleet reset --group hard || return 1
        "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group hard --spread 50 \
            --on-link-lost finish >"$work/played" 2>"$work/said" </dev/null 3>&- &
        play=$!
        echo $play >>"$work/pids"
        written "$work/said" 'all begin in' && wait_for moves hard && not_stopped stop
        soft_status=$?
        wait $play
        return $soft_status
    }
    check "so after a soft stop" soft_not_stopped
    kill $hard_agent
    wait $hard_agent
    stop_sim
fi

test_case "a stop whose message is gone"

deleted() {
    exits 0 fleet estop --group both && publish -q 1 -r -n -t grobo/v1/group/both/latch &&
        wait_for latch_is '"stopped":true' && exits 0 fleet reset --group both &&
        exits 0 fleet play greet.pseq --group one -s 400 --spread 50 --on-link-lost finish
}
check "a stop whose retained message was deleted is told again, and released" deleted
overwritten() { # by the release of another stop, or by what cannot be read
    exits 0 fleet stop --group both && publish -q 1 -r -t grobo/v1/group/both/latch -m "$1" &&
        wait_for latch_is '"stopped":true' && exits 0 fleet reset --group both
}
check "so where another's release is in its place" overwritten \
    '{"v":1,"stopped":false,"id":"00112233445566778899aabbccddeeff","by":"x","at_ms":1}'
check "so where rubbish is" overwritten '{"v":1'

test_case "a broker that is not there"

# says_switches PORT WHY: that, while it still tries; $stopper is it.
says_switches() {
    : >"$work/err"
    "$GRCTL" fleet estop --group both --broker "mqtt://127.0.0.1:$1" 2>"$work/err" 3>&- &
    stopper=$!
    echo $stopper >>"$work/pids"
    written "$work/err" "127.0.0.1: $2: nothing is stopped; use the switches" &&
        kill -0 $stopper
}
"$GRCTL" fleet log --broker "$broker" >"$work/log.out" 2>"$work/log.err" </dev/null 3>&- &
log=$!
echo $log >>"$work/pids"
logs() { # what it hears is told; a stop is heard
    fleet stop --group both >/dev/null 2>&1 && fleet reset --group both >/dev/null 2>&1 &&
        grep -q '^one: released' "$work/log.out"
}
check "a log hears what agents say" wait_for logs
kill "$broker_pid"
wait "$broker_pid"
check "and says that the broker is away" written "$work/log.err" 'the broker is away: '
kill -INT $log
wait $log
dead() {
    says_switches "$port" 'the broker cannot be reached' && begin_open_broker && {
        wait "$stopper"
        said_first both && latch_is '"how":"estop"'
    }
}
check "a dead broker is told at once, and hears of the stop when it comes" dead
mute() {
    mute_port=$(find_port && echo $port)
    python3 tests/support/mqtt.py "$mute_port" mute >"$work/mute.out" 2>&1 3>&- &
    echo $! >>"$work/pids"
    written "$work/mute.out" ready && says_switches "$mute_port" 'the broker does not answer'
    mute_status=$?
    wait $stopper
    [ $? -eq 1 ] && [ $mute_status -eq 0 ]
}
if have_json; then
    check "so is one that does not answer" mute
else
    skip "one that does not answer" "no python3 here"
fi
done_testing
