#!/bin/sh
# SPDX-License-Identifier: MIT
# A broker that ends who connects by what it says: it ends the process of the connection, and no
# program that has a robot or a STOP. What that process is, and what becomes of it.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
have_json || { echo "1..0 # SKIP no python3 here"; exit 0; }

mkdir -p "$work/config/grctl" "$work/motions"
cp motions/greet.pseq "$work/motions"
start_sim
printf 'robots: {one: {device: %s}}\n' "$robot" >"$work/config/grctl/config.yaml"

# process_of PID: of its connection.
process_of() {
    for process_of_one in $(ps -o pid= --ppid "$1" 2>/dev/null); do
        if [ "$(ps -o args= -p "$process_of_one")" = 'grctl broker' ]; then
            echo "$process_of_one"
            return
        fi
    done
    return 1
}

test_case "a hostile broker"

python3 tests/support/mqtt.py "$port" hostile >"$work/hostile.out" 2>&1 3>&- &
hostile=$!
echo $hostile >>"$work/pids"
check "a hostile broker" written "$work/hostile.out" ready
begin_agent one --group stage
agent_one=$agent
lives() { # through several of its sessions
    lives_from=$(grep -c served "$work/hostile.out")
    served_more() {
        [ "$(grep -c served "$work/hostile.out")" -ge $((lives_from + $1)) ]
    }
    wait_for served_more 3 && kill -0 "$agent_one" &&
        grep -q 'the broker is away: ' "$work/one.err"
}
check "an agent lives on, and says that the broker is away" lives
for verb in list stop estop; do
    switches=$([ $verb = list ] || echo '.*use the switches')
    ends() {
        "$GRCTL" fleet $verb --broker "$broker" >"$work/out" 2>"$work/err"
        ends_status=$?
        cat "$work/err"
        [ $ends_status -eq 1 ] && grep -q "^grctl: fleet: .*$switches" "$work/err"
    }
    check "fleet $verb says so and ends as it should" ends
done
"$GRCTL" serve --broker "$broker" --port 0 >"$work/serve.out" 2>"$work/serve.err" 3>&- &
serve=$!
echo $serve >>"$work/pids"
page_stops() {
    written "$work/serve.out" 'http://' || return 1
    python3 - "$work/serve.out" <<'EOF2' && kill -0 $serve
import json, re, sys, urllib.error, urllib.request
link = re.search(r"http://\S+", open(sys.argv[1]).read()).group()
host = link.split("#")[0].rstrip("/")
fleet = json.load(urllib.request.urlopen(host + "/api/fleet"))
stop = "http://127.0.0.1:%d/stop" % fleet["stop_port"]
for url in (host + "/api/stop", stop) * 5:
    ask = urllib.request.Request(url, b"{}", {"Content-Type": "application/json"})
    try:
        urllib.request.urlopen(ask)
    except urllib.error.HTTPError as no:
        said = json.load(no)["error"]["message"]
        assert no.code == 503 and "use the switches" in said, (no.code, said)
EOF2
}
check "the page's STOP answers" page_stops

test_case "a good one in its place"

kill $hostile
wait $hostile 2>/dev/null
begin_open_broker
check "the agent is there when a good one is" wait_for is_listed one ONLINE
stands() {
    mosquitto_sub -h 127.0.0.1 -p "$port" -W 1 -C 1 -t grobo/v1/group/all/latch |
        grep -q '"stopped":true'
}
check "the page's STOP comes with it" wait_for stands
kill $serve
wait $serve
released() { # once the page's stop has come to the end of its tries
    fleet reset 2>"$work/err"
}
check "and is released" wait_for released
kill "$agent_one"
wait "$agent_one"
check "who is ended says goodbye" wait_for is_listed one OFFLINE

test_case "the process"

begin_agent one --group stage
agent_one=$agent
check "another agent" wait_for is_listed one ONLINE
has_no_line() {
    has_pid=$(process_of "$agent_one") || return 1
    ls -l "/proc/$has_pid/fd" >"$work/fds"
    ls -l "/proc/$agent_one/fd" | grep -q "$(readlink -f "$robot")" &&
        grep -q ' 0 -> socket:' "$work/fds" && ! grep -e '-> /' "$work/fds" | grep -v /dev/null
}
if [ -d /proc/self/fd ] && [ -z "${EMULATOR:-}" ]; then
    check "its process has sockets and no line, and no other file" has_no_line
else
    skip "its process has sockets and no line, and no other file" "no /proc here"
fi
plays() {
    "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group stage --spread 50 \
        >"$work/played" 2>"$work/said" </dev/null 3>&- &
    play=$!
    echo $play >>"$work/pids"
    written "$work/said" 'all begin in' && wait_for plays_now && return
    cat "$work/said"
    return 1
}
plays_now() {
    fleet status --json | grep -q '"play": *"playing"'
}
rests_now() {
    fleet status --json | grep -q '"play": *"idle"'
}
# A process of the connection that dies or hangs is a broker that is lost.
becomes() { # SIGNAL
    : >"$work/one.err"
    plays && kill -"$1" "$(process_of "$agent_one")" &&
        written "$work/one.err" 'the permit lapsed: the motion stops' &&
        written "$work/one.err" 'the broker is away: the process of the connection' &&
        kill -0 "$agent_one" && wait_for is_listed one ONLINE && wait_for rests_now
    becomes_status=$?
    kill "$play" 2>/dev/null
    wait "$play"
    return $becomes_status
}
check "where it dies a motion stops, and it is started again" becomes KILL
check "so where it hangs" becomes STOP
gone() {
    ! kill -0 "$1" 2>/dev/null
}
leaves_nobody() {
    orphan=$(process_of "$agent_one") && kill -9 "$agent_one" && wait_for gone "$orphan" &&
        wait_for is_listed one CONNECTIONBROKEN
}
check "an agent that is killed leaves none, and says no goodbye" leaves_nobody
alone=$GRCTL-fleet
[ -x "$alone" ] || alone=$GRCTL
check "nobody else starts one" fails 2 'broker: is started by grctl itself' "$alone" broker
done_testing
