#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl follow: a simulated SO-101 whose shafts are turned from outside leads another one.
. tests/support/cli.sh
own_sim
by_tcp && { echo "1..0 # SKIP needs ptys"; exit; }

# The marks of emergency stops are the test's own: a pty may have had the name of one of another's.
XDG_RUNTIME_DIR=$work/run
export XDG_RUNTIME_DIR
mkdir -m 700 "$XDG_RUNTIME_DIR"

start_told_sim --robot so101-leader || { echo "Bail out! no leader"; exit 1; }
leader=$robot
# The follower: told by descriptor 7, as the leader is by 5.
mkfifo "$work/tell7"
"$simulator" sim --robot so101 --link "$work/follower" <"$work/tell7" >"$work/ready7" \
    2>"$work/follower.log" &
follower_pid=$!
exec 7>"$work/tell7"
follower=$work/follower
end_follow_test() {
    kill "$follower_pid" ${follow_pid:+"$follow_pid"} 2>/dev/null
    wait "$follower_pid" 2>/dev/null
    end_cli_test
}
follow_pid=
trap end_follow_test EXIT
written "$work/follower.log" SIMULATED || { echo "Bail out! no follower"; exit 1; }

# follow [OPTION...]: begins it; what it says is in $work/events and $work/said.
# shellcheck disable=SC2120 # options are for some calls
follow() {
    : >"$work/events"
    seen=0
    "$GRCTL" --json --timeout 500 "$@" follow "so101-leader@$leader" "so101@$follower" \
        >"$work/events" 2>"$work/said" </dev/null &
    follow_pid=$!
}
# becomes STATE...: it becomes one after the other, from the last change that was waited for on. A
# busy machine may lose the leader for a moment.
seen=0
in_order() {
    tail -n +"$((seen + 1))" "$work/events" | awk -v wanted="$*" '
        BEGIN { n = split(wanted, state, " "); at = 1 }
        index($0, "\"state\":\"" state[at] "\"") { at++ }
        END { exit at <= n }'
}
becomes() {
    wait_for in_order "$@" || { cat "$work/events" "$work/said"; return 1; }
}
now_on() {
    seen=$(wc -l <"$work/events")
}
# ended: waits for it.
ended() {
    wait "$follow_pid"
    follow_got=$?
    follow_pid=
}
with_status() {
    [ "$follow_got" -eq "$1" ] && return
    echo "status $follow_got, not $1"
    cat "$work/events" "$work/said"
    return 1
}
# shows JOINT PATTERN: what the follower's simulator says of a joint.
shows_now() {
    shows_lines=$(wc -l <"$work/follower.log")
    echo "look $1" >&7
    wait_for shows_more && tail -n +"$((shows_lines + 1))" "$work/follower.log" | grep -q -e "$2"
}
shows_more() {
    [ "$(wc -l <"$work/follower.log")" -gt "$shows_lines" ]
}
shows() {
    wait_for shows_now "$@" || { tail -n 3 "$work/follower.log"; return 1; }
}
# turned JOINT DEG PATTERN: the leader's shaft is turned, the follower's goes there.
turned() {
    tell turn "$1" "$2" 500 && shows "$1" "$3"
}
# took STATE FROM MS: the last change to it took at least so long since the one before it.
took() {
    sed -n 's/.*"state":"\([a-z]*\)","t_ms":\([0-9]*\).*/\1 \2/p' "$work/events" |
        awk -v state="$1" -v least="$2" '
            { took = $2 - before; before = $2; last = $1 }
            END { if (last != state || took < least) { print last, took; exit 1 } }'
}

test_case "a follower goes where the leader is turned"
check "the leader had torque" exits 0 "$GRCTL" --robot so101-leader -d "$leader" servo on
follow
check "it follows" becomes follow
check "the leader is limp" sim_shows shoulder_pan 'torque off'
check "the follower holds" shows shoulder_pan 'torque on'
check "a joint is turned" turned shoulder_pan 30 ' \(30.0\|29.9\|30.1\) deg'
check "another one" turned gripper 50 ' \(50.0\|49.9\|50.1\) deg'
check "within the follower's limits" turned wrist_flex 100 ' \(95.0\|94.9\|95.1\) deg'
check "and back" turned wrist_flex 10 ' \(10.0\|9.9\|10.1\) deg'

now_on
test_case "a leader that jumps is approached slowly"
check "the leader jumps" tell turn shoulder_pan -60
check "it is approached, and followed again" becomes approach follow
check "slowly: 90 degrees at 60 a second" took follow 1000
check "it is there" shows shoulder_pan '-\(60.0\|59.9\|60.1\) deg'

now_on
test_case "a lost leader: the follower holds, and approaches it again"
check "the leader is unplugged" tell plug out
check "that is said" becomes lost
check "the shaft turns meanwhile" tell turn shoulder_pan 20
check "the follower holds where it was" shows shoulder_pan '-\(60.0\|59.9\|60.1\) deg.*torque on'
check "the leader comes back" tell plug in
check "it is approached, and followed again" becomes lost approach follow
check "there it is" shows shoulder_pan ' \(20.0\|19.9\|20.1\) deg'

kill -s INT "$follow_pid"
ended
test_case "Ctrl-C leaves the follower holding"
check "Ctrl-C" with_status 130
check "the follower is left holding" shows shoulder_pan 'torque on'
check "the leader is left limp" sim_shows shoulder_pan 'torque off'
check "what it did is told" grep -q '"done":true.*"rate_hz":.*"late_us":{"p50":' "$work/events"

follow
test_case "a hot follower ends it"
check "it follows once more" becomes follow
echo "temperature shoulder_pan 64" >&7
ended
check "a hot follower ends it" with_status 4
check "and says why" grep -q 'stopped for safety: .*shoulder_pan' "$work/said"
echo "temperature shoulder_pan 25" >&7
check "it has cooled down" shows shoulder_pan ' 2[0-9]\.[0-9] C'

follow
test_case "a lost follower ends it"
check "and again" becomes follow
echo "plug out" >&7
ended
check "an unplugged follower ends it" with_status 1
echo "plug in" >&7
echo "cable elbow_flex out" >&7
out() {
    exits 1 "$GRCTL" --robot so101 -d "$follower" --timeout 500 status elbow_flex
}
test_case "it does not begin where a servo is out"
check "a servo of the follower is out" wait_for out
check "it does not begin" fails 1 'elbow_flex' "$GRCTL" --timeout 500 follow \
    "so101-leader@$leader" "so101@$follower"

trace_of_one() {
    exits 0 "$GRCTL" --trace "$work/follow.pcapng" follow so101-leader@sim so101@sim --for 0.3 &&
        exits 0 "$GRCTL" --robot so101 decode "$work/follow.pcapng" && says 'sync write 6 servos'
}
test_case "a trace is whole"
check "a trace of it is whole, and the follower's" trace_of_one
test_case "which robots may follow which"
check "for some time" exits 0 "$GRCTL" follow so101-leader@sim so101@sim --for 0.3
check "no such robot" fails 2 "no robot called 'so102'" "$GRCTL" follow so102@sim so101@sim
check "two robots with nothing in common" fails 2 'no joint of GR001 has the name' \
    "$GRCTL" follow gr001@sim so101@sim
check "one robot is not enough" fails 2 'LEADER' "$GRCTL" follow so101@sim
stop_sim
done_testing
