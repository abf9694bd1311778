#!/bin/sh
# SPDX-License-Identifier: MIT
# Messages of strangers at the broker of a fleet: none is carried out, and none harms a terminal.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
begin_open_broker
. tests/support/two_hosts.sh
begin_hosts

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
fits_schema ack cmd_put

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
