#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl scan finds each servo on any line: board or bus, with an echo or none, behind an adapter
# that holds bytes back, with a round trip of 60 ms, on a busy machine. The whole matrix is long;
# without SCAN_MATRIX=all it is a part of it. SCAN_RUNS: how often each.
. tests/support/cli.sh

renice -n 5 -p $$ >/dev/null # it makes this machine busy, and other tests run beside it
runs=${SCAN_RUNS:-1}
burners=
line_pid=

end_scan_test() {
    burn_no_more
    far_no_more
    end_cli_test
}
trap end_scan_test EXIT

burn() {
    for one in 1 2 3; do
        (trap - EXIT; while :; do :; done) &
        burners="$burners $!"
    done
}
burn_no_more() {
    # $burners is a list of words.
    # shellcheck disable=SC2086
    [ -z "$burners" ] || kill $burners
    burners=
}

# go_far: $robot is 30 ms away from here on.
go_far() {
    mkfifo "$work/far"
    python3 tests/support/delay_line.py "$robot" 30 >"$work/far" &
    line_pid=$!
    read -r robot <"$work/far"
    rm "$work/far"
}
far_no_more() {
    [ -z "$line_pid" ] || kill "$line_pid"
    [ -z "$line_pid" ] || wait "$line_pid" 2>/dev/null
    line_pid=
}

finds() {
    [ "$(grep -c ' bps  ' "$work/out")" -eq "$1" ] && ! grep -q 'answers, but' "$work/err" && return
    cat "$work/out" "$work/err"
    return 1
}
scan_finds_all() {
    for run in $(seq "$runs"); do
        # $options is a list of words.
        # shellcheck disable=SC2086
        both exits 0 "$GRCTL" -d "$robot" $options scan --last "$last" --- finds 20 ||
            { echo "run $run"; return 1; }
    done
}

# cell OPTIONS LATENCY near|far idle|busy
cell() {
    options=$1
    # shellcheck disable=SC2086
    start_sim $options --latency "$2" || { echo "Bail out! the simulator did not start"; exit 1; }
    [ "$3" = near ] || go_far
    [ "$4" = idle ] || burn
    test_that "$1, $2 ms of latency, $3, $4" scan_finds_all
    burn_no_more
    far_no_more
    stop_sim
}

lines='--wiring=board|--wiring=bus|--wiring=bus --echo'
if ! command -v python3 >/dev/null 2>&1; then
    test_case "lines that are far away"
    skip "lines that are far away" "no python3"
    last=24
    cell '--wiring=bus --echo' 16 near busy
elif [ "${SCAN_MATRIX:-}" = all ]; then
    last=127
    for load in idle busy; do
        for place in near far; do
            for latency in 0 4 16; do
                IFS='|'
                for line in $lines; do
                    unset IFS
                    cell "$line" $latency $place $load
                done
            done
        done
    done
else
    last=24
    cell '--wiring=board' 0 far idle
    cell '--wiring=board' 16 near busy
    cell '--wiring=bus' 4 far busy
    cell '--wiring=bus --echo' 16 near idle
    cell '--wiring=bus --echo' 0 far busy
fi

test_case "one servo of an arm of six"
start_sim --servo 1=STS3215 || { echo "Bail out! the simulator did not start"; exit 1; }
# Only the five silent ids of the arm need patience.
check_json "all ids are asked" 'len(lines[0]["servos"]) == 1 and lines[0]["sure"] and
    lines[0]["silent"] == 253' "$GRCTL" -d "$robot" --robot so101 --trace "$work/arm" --json scan
# In the same run, what is waited behind the last request for each id: half of it for most. Where
# the machine makes the line slow all get patience, in three rounds: their number is bounded.
waits_for_the_arm() {
    "$GRCTL" decode --json "$work/arm" >"$work/out" # 1 where a reply came too late
    python3 - "$work/out" <<'PY'
import json, statistics, sys
sent = [line for line in map(json.loads, open(sys.argv[1])) if line.get("from") == "host"]
waited = {}
for request, later in zip(sent, sent[1:]):
    waited[int(request["hex"].split()[2], 16)] = later["time_ms"] - request["time_ms"]
arm = statistics.median(waited[i] for i in range(2, 7))
others = statistics.median(ms for i, ms in waited.items() if i > 6)
print(f"{len(sent)} requests, {others:.1f} ms for most, {arm:.1f} ms for the arm")
sys.exit(not (250 <= len(sent) <= 3 * 254 + 15 and (len(sent) > 400 or 2 * others < arm)))
PY
}
if have_json; then
    check "the others are not waited for so long" waits_for_the_arm
else
    skip "the others are not waited for so long" "no python3"
fi
stop_sim

# least_ms FIRST: the shortest of five scans of FIRST to 120; nothing that a busy machine adds.
least_ms() {
    for run in 1 2 3 4 5; do
        "$GRCTL" -d "$robot" --robot so101 --json scan --first "$1" --last 120
        echo
    done | sed -n 's/.*"took_ms":\([0-9.]*\).*/\1/p' | sort -n | head -n 1
}
# Twenty silent ids each: where one more answers first, the line's replies are known.
is_shorter_where_one_answers() {
    known=$(least_ms 100)
    unknown=$(least_ms 101)
    echo "$known ms where one answers, $unknown where none does"
    awk -v a="$known" -v b="$unknown" 'BEGIN { exit !(a > 0 && a + 60 < b) }'
}
test_case "a line whose replies are known"
start_sim --servo 100=STS3215 || { echo "Bail out! the simulator did not start"; exit 1; }
check "it is listened to for no longer than they take" is_shorter_where_one_answers
stop_sim

# stranger: id 3 of a bus of STS3215; when 250 is asked a second master asks it, too.
stranger() {
    cat >"$work/stranger.py" <<'PY'
import os
import tty

near, far = os.openpty()
tty.setraw(far)
print(os.ttyname(far), flush=True)
reply = bytes.fromhex("FF FF 03 07 00 03 09 00 09 03 DD")
heard = b""
while True:
    heard += os.read(near, 4096)
    while len(heard) >= 8:
        if heard[2] in (3, 250):
            os.write(near, reply)
        heard = heard[8:]
PY
    mkfifo "$work/far"
    python3 "$work/stranger.py" >"$work/far" &
    line_pid=$!
    read -r robot <"$work/far"
    rm "$work/far"
}
# Waiting as long as those replies seem late took a quarter of an hour.
ends_beside_a_stranger() {
    timeout 120 "$GRCTL" -d "$robot" --robot so101 scan >"$work/out" 2>"$work/err"
    [ $? -lt 2 ] && grep -q '^ *3  STS3215 ' "$work/out" && return
    cat "$work/out" "$work/err"
    return 1
}
test_case "another master asks a servo on the line"
if command -v python3 >/dev/null 2>&1 && ! by_tcp; then
    stranger
    check "another master asks a servo on the line" ends_beside_a_stranger
    far_no_more
else
    skip "another master asks a servo on the line" "no python3, or no ptys"
fi
done_testing
