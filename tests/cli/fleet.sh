#!/bin/sh
# SPDX-License-Identifier: MIT
# Agents and a fleet over a real broker: orders, stops, a broker that hangs, dies and comes back,
# and messages of strangers. A crowd of robots is in tests/fleet/crowd.sh.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker

test_case "agents"

mkdir -p "$work/config/grctl" "$work/motions"
cp motions/greet.pseq "$work/motions"
cat >"$work/config/grctl/config.yaml" <<EOF2
groups: {one: [a, b], two: [c, d]}
robots: {a: {device: sim}, b: {device: sim}, c: {device: sim}, d: {device: $work/none}}
EOF2

keeps_all=
keep_all() { # what is said; another one for a broker that came back
    python3 tests/support/mqtt.py "$port" keep "$work/kept.$1" >"$work/keep.out" 2>&1 3>&- &
    echo $! >>"$work/pids"
}
if python3 -c 'import jsonschema' 2>/dev/null; then
    keeps_all=yes
    keep_all 1
    wait_for test -e "$work/kept.1"
fi
begin_agent one
agent_one=$agent
begin_agent two --label arms,left --cockpit 'https://stage.local/%/'
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

test_case "orders"

# plays_through FILE [OPTIONS]: to the end, though permits come late on a busy machine.
plays_through() {
    fleet play "$@" -s 400 --on-link-lost finish
}
sed 's/greet/other/' motions/greet.pseq >"$work/other.pseq"
# Two files, the first at a time that is told: all are ready before it, and none begins before it.
at_a_time() {
    at_s=$(($(date +%s) + 12))
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
# A name that is mistyped stops nobody: that is no success.
mistyped() {
    exits 1 fleet stop --group tree &&
        complains 'no agent is of group tree; there are all, .*left.*: nothing was seen to stop' &&
        exits 1 fleet reset --group tree && complains 'no agent is of group tree'
}
check "a stop of a group that there is not" mistyped
check_json "one group is listed" '[l["host"] for l in lines] == ["two"]' \
    fleet list --group arms --json
check_json "its robots are shown" '[l["robot"] for l in lines] == ["c", "d"]' \
    fleet status --group arms --json

# plays [OPTIONS]: with group one, slowly; returns when it was begun.
plays() {
    : >"$work/said" # what one before said is not taken for its words
    "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group one "$@" \
        >"$work/played" 2>"$work/said" </dev/null &
    play=$!
    written "$work/said" 'all begin in' && wait_for moves
}
# looks: at what all do; an answer that came too late is none.
looks() {
    fleet status --json >"$work/look" && grep -q '"play": *"' "$work/look"
}
moves() {
    looks && grep -q '"play": *"playing"' "$work/look"
}
rests() {
    looks && ! grep -q '"play": *"playing"' "$work/look" && grep -q '"play": *"idle"' "$work/look"
}
ended() {
    ended_with "$1" "$play"
}
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
leader_killed() {
    plays "$@" && kill -9 "$play" && { wait "$play"; written "$work/one.err" "$lapsed"; }
}
lapsed='the permit lapsed: the motion stops'
check "a motion stops softly when who leads it dies" both leader_killed --- wait_for rests
lapsed='the permit lapsed: the motion goes on'
goes_on() {
    leader_killed --on-link-lost finish && moves && exits 0 fleet stop --group one &&
        wait_for rests && exits 0 fleet reset --group one
}
check "or goes on, where that was said" goes_on

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
[ -z "$keeps_all" ] || keep_all 2
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
[ -z "$keeps_all" ] || keep_all 3
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

test_case "strangers"

id=00112233445566778899aabbccddeeff
epoch=$(mosquitto_sub -h 127.0.0.1 -p "$port" -C 1 -t grobo/v1/one/connection |
    sed 's/.*"epoch":"\([0-9a-f]*\).*/\1/')
# says_to VERB JSON [OPTIONS]: as an order of $id.
says_to() {
    says_verb=$1 says_text=$2
    shift 2
    publish -V 5 -q 1 -t "grobo/v1/one/cmd/$says_verb" -m "$says_text" \
        -D publish response-topic "grobo/v1/ack/$id" "$@"
}
# an_order EPOCH: of prepare.
an_order() {
    printf '{"v":1,"id":"%s","from":"%s","epoch":"%s","issued_us":1,"deadline_us":2,"file":"%s"}' \
        "$id" "$id" "$1" "${2:-greet.pseq}"
}
# answers PATTERN COMMAND...: the next answer to $id is like that.
answers() {
    answers_pattern=$1
    shift
    mosquitto_sub -h 127.0.0.1 -p "$port" -W 30 -C 1 -t "grobo/v1/ack/$id" >"$work/answer" &
    answers_pid=$!
    wait_for subscribed
    "$@"
    wait $answers_pid
    grep -q -e "$answers_pattern" "$work/answer" || { cat "$work/answer"; return 1; }
}
subscribed() {
    tail -n 20 "$work/broker.log" | grep -q "ack/$id (QoS"
}
refused() { # PATTERN COMMAND...: noted by the agent
    : >"$work/one.err"
    refused_pattern=$1
    shift
    "$@" && written "$work/one.err" "$refused_pattern"
}
check "an order of an earlier life" answers '"code":"stale".*another life' \
    says_to prepare "$(an_order "$id")"
check "one whose sender has no clock" answers '"code":"stale".*clock of its sender' \
    says_to prepare "$(an_order "$epoch")"
check "the same again is answered, not done" answers '"code":"stale".*clock of its sender' \
    says_to prepare "$(an_order "$epoch")"
check "rubbish" refused 'refused: it is no object' says_to prepare '{"v":1'
check "an order without an id" refused 'refused: it has no id' says_to prepare '{"v":1}'
check "an answer that would go elsewhere" refused 'its answer would go elsewhere' \
    publish -V 5 -q 1 -t grobo/v1/one/cmd/prepare -m "$(an_order "$epoch")" \
    -D publish response-topic grobo/v1/group/one/latch
check "a retained order" refused 'a retained message is no order' \
    publish -q 1 -r -t grobo/v1/one/cmd/prepare -m "$(an_order "$epoch")"
large() {
    head -c 1500000 /dev/zero | tr '\0' x >"$work/large"
    publish -q 1 -t grobo/v1/one/cmd/put -f "$work/large" &&
        fleet list | grep -q '^one  *ONLINE'
}
check "a message of 1.5 MB" large

# A stranger who has a clock: its orders are good but for one thing.
orders() { # HOST VERB BODY [KEY=VALUE...]: the answers are in $work/out
    python3 tests/support/mqtt.py "$port" order "$@" >"$work/out" 2>"$work/err" || {
        cat "$work/err"
        return 1
    }
}
answered() { # EXPRESSION HOST VERB BODY...
    answered_expression=$1
    shift
    orders "$@" && json "$answered_expression"
}
done_once() {
    answered 'lines[0]["ok"] and lines[1] == lines[0]' one put '{"file":"x.m","text":"first"}' \
        'twice={"file":"x.m","text":"second"}' && [ "$(cat "$work/motions/x.m")" = first ]
}
# While another plays: none of its orders and none of its permits is heard.
two_at_once() {
    plays && answered '"another motion is played" in lines[0]["message"]' one prepare \
        '{"file":"greet.pseq"}' &&
        answered '"nothing was prepared" in lines[0]["message"]' one start \
            '{"of":"00112233445566778899aabbccddeeff"}' at_ms=500 &&
        answered '"nothing was prepared" in lines[0]["message"]' one abort \
            '{"of":"00112233445566778899aabbccddeeff"}' &&
        answered '"nothing was prepared" in lines[0]["message"]' one abort '{}' &&
        answered 'lines[0]["code"] == "busy"' one put '{"file":"y.m","text":""}' && moves
    two_status=$?
    kill -INT "$play"
    ended 130 && wait_for rests && return $two_status
}
if have_json; then
    check "an order that comes twice is done once" done_once
    check "one that comes late" answered '"too late" in lines[0]["message"]' \
        one put '{"file":"y.m","text":""}' issued_ms=-5000
    check "one from the future" answered '"from the future" in lines[0]["message"]' \
        one put '{"file":"y.m","text":""}' issued_ms=5000
    check "one that would be valid for long" \
        answered '"valid for too long" in lines[0]["message"]' \
        one put '{"file":"y.m","text":""}' life_ms=60000
    check "a start before its preparation" \
        answered '"nothing was prepared" in lines[0]["message"]' \
        one start '{"of":"00112233445566778899aabbccddeeff"}' at_ms=500
    check "a group that it is not of" answered '"none of this agent" in lines[0]["message"]' \
        one prepare '{"file":"greet.pseq","group":"two"}'
    check "a file of another folder" answered 'lines[0]["code"] == "arg"' \
        one put '{"file":"../y.m","text":""}'
    check "a file that is no motion" answered 'lines[0]["code"] == "arg"' \
        one put '{"file":"y.txt","text":""}'
    check "an order that there is not" answered 'lines[0]["code"] == "unsupported"' one dance '{}'
    check "two who would lead" two_at_once
    check "none of these was done" [ -z "$(ls "$work/motions" | grep '^y')" ]
else
    skip "a stranger who has a clock" "no python3 here"
fi
check "and all of that moved nothing" rests
check "the agent is the same" kill -0 "$agent_one"

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

test_case "the schema"

fit() {
    cat "$work/kept.1" "$work/kept.2" "$work/kept.3" >"$work/kept"
    python3 tests/support/mqtt.py 0 fits "$work/kept"
}
if [ -n "$keeps_all" ]; then
    check "all that was said is as docs/fleet.schema.json says" fit
else
    skip "all that was said is as docs/fleet.schema.json says" "no python3-jsonschema"
fi

# What a stranger at the broker says of itself is a line, whatever it contains.
clean() {
    for what in connection factsheet; do
        publish -q 1 -r -t grobo/v1/stranger/$what -m '{"v":1,"state":"ON\u001b[2J",
            "epoch":"'$id'","groups":["all"],"robots":[{"name":"a\nb","model":"m\u009bx"}]}'
    done
    wait_for is_listed stranger ON && fleet list >"$work/out" || return 1
    ! tr -d '\n' <"$work/out" | LC_ALL=C grep '[[:cntrl:]]' &&
        says '^stranger  *ON?\[2J  *a?b  *m??x$'
}
check "a stranger writes no control characters to a terminal" clean
done_testing
