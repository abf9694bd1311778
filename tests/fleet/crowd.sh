#!/bin/sh
# SPDX-License-Identifier: MIT
# A crowd of simulated robots of several agents at one real broker (make check-fleet): they begin
# together, stop together, and nothing moves by itself when the broker is killed and comes back.
# Order and final state are asserted. Times are reported beside a bare round trip through the same
# broker; TIMES=assert holds them against the limits of docs/guide/fleet.md.
# HOSTS=4, EACH=25 robots, RUNS=12 emergency stops in the midst of a motion.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet
have_json || { echo "1..0 # SKIP no python3 here"; exit 0; }

HOSTS=${HOSTS:-4} EACH=${EACH:-25} RUNS=${RUNS:-12}
all=$((HOSTS * EACH))
mqtt() {
    python3 tests/support/mqtt.py "$port" "$@"
}

test_case "the crowd"

mkdir -p "$work/config/grctl" "$work/motions"
cp motions/greet.pseq "$work/motions"
hosts=
for h in $(seq "$HOSTS"); do
    hosts="$hosts h$h"
done
python3 - "$HOSTS" "$EACH" >"$work/config/grctl/config.yaml" <<'EOF2'
import sys
hosts, each = map(int, sys.argv[1:])
names = ["r%d" % i for i in range(1, each + 1)]
print("groups: {%s}" % ", ".join("h%d: [%s]" % (h, ", ".join(names)) for h in range(1, hosts + 1)))
print("robots: {%s}" % ", ".join("%s: {device: sim}" % name for name in names))
EOF2
begin_open_broker
agents=
for h in $hosts; do
    begin_agent "$h"
    agents="$agents $agent"
done
all_listed() { # STATE
    [ "$(fleet list --json | grep -c "\"state\":\"$1\"")" -eq "$HOSTS" ]
}
check "$HOSTS agents with $EACH robots each" wait_for all_listed ONLINE

exec 3>&1
report() { # WORDS...: a line of the output that is no check
    echo "# $*" >&3
}
# ticks PID: of the processor; kilobytes PID: resident.
ticks() {
    sed 's/.*) //' "/proc/$1/stat" | awk '{ print $12 + $13 }'
}
kilobytes() {
    awk '/^VmRSS/ { print $2 }' "/proc/$1/status"
}
sum() { # FUNCTION PID...
    sum_of=$1
    shift
    for sum_pid in "$@"; do
        "$sum_of" "$sum_pid"
    done | awk '{ s += $1 } END { print s }'
}
floor() {
    mqtt floor 500 >"$work/floor" && report "bare round trip, $1: $(cat "$work/floor")"
}
check "a round trip by the broker alone" floor "robots stand"

test_case "they begin together"

# The last result, as Python sees it: late is the first frame behind the start, by each agent's
# clock; that clock is known to bound.
begin_together() {
    exits 0 fleet play greet.pseq --json -s 400 --spread 20 --on-link-lost finish || return 1
    python3 - "$work/out" "$all" "${TIMES:-report}" 2>&1 >&3 <<'EOF2'
import json, sys
rows = [json.loads(line) for line in open(sys.argv[1])]
late = sorted(row["late_us"] for row in rows)
bound = max(row["bound_us"] for row in rows)
n = len(rows)
p99 = late[n * 99 // 100] if n < 100 else late[int(n * 0.99) - 1]
print("# start of %d robots: %d to %d us behind the time told (p50 %d, p99 %d); clocks known to"
      " %d us" % (n, late[0], late[-1], late[n // 2], p99, bound))
assert n == int(sys.argv[2]) and all(row["ok"] for row in rows), "not all played"
assert late[0] >= 0, "one began before the time"
assert sys.argv[3] != "assert" or p99 - late[0] + bound < 5000, "the spread is 5 ms or more"
EOF2
}
check "all begin together and play to the end" begin_together

test_case "they stop together"

# plays: slowly, until it is stopped; $play is its process.
plays() {
    : >"$work/said"
    "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --spread 20 >"$work/played" \
        2>"$work/said" </dev/null &
    play=$!
    written "$work/said" 'all begin in' && wait_for all_play
}
all_play() {
    [ "$(fleet status --json | grep -c '"play":"playing"')" -eq "$all" ]
}
# Every robot says by itself that it was seen to stop, with its torque as the stop has it.
stop_once() {
    plays && exits 0 fleet estop --json || return 1
    grep '"stopped":true' "$work/out" >>"$work/stops"
    [ "$(grep -c '"stopped":true' "$work/out")" -eq "$all" ] || return 1
    wait "$play"
    exits 0 fleet reset
}
stop_often() {
    : >"$work/stops"
    for _ in $(seq "$RUNS"); do
        stop_once || return 1
    done
    python3 - "$work/stops" "${TIMES:-report}" 2>&1 >&3 <<'EOF2'
import json, sys
told = sorted(json.loads(line)["told_us"] for line in open(sys.argv[1]))
n = len(told)
p99 = told[int(n * 0.99) - 1]
print("# emergency stop in a motion: until the agent has told its robots and said so, p50 %d us, "
      "p99 %d us, longest %d us (%d robots and stops)" % (told[n // 2], p99, told[-1], n))
assert told[0] >= 0, "an agent did not say that it stops"
assert sys.argv[2] != "assert" or p99 < 50000, "50 ms or more"
EOF2
}
check "$RUNS emergency stops in the midst of a motion" stop_often

test_case "the broker dies"

# seconds of the processor and memory, while they play.
cost() {
    clock=$(getconf CLK_TCK)
    # shellcheck disable=SC2086
    agents_before=$(sum ticks $agents)
    broker_before=$(ticks "$broker_pid")
    timeout 5 python3 tests/support/mqtt.py "$port" keep /dev/null # one who reads
    # shellcheck disable=SC2086
    report "$(awk -v a="$agents_before" -v b="$(sum ticks $agents)" -v c="$broker_before" \
        -v d="$(ticks "$broker_pid")" -v hz="$clock" -v n="$all" -v kb="$(sum kilobytes $agents)" \
        -v bkb="$(kilobytes "$broker_pid")" 'BEGIN {
            printf "while playing, a robot: %.2f %% of a core and %.0f KiB in its agent ", \
                (b - a) / hz / 5 * 100 / n, kb / n
            printf "(simulator in it), %.3f %% of a core in the broker of %.1f MiB", \
                (d - c) / hz / 5 * 100 / n, bkb / 1024
        }')"
}
all_say() { # PATTERN
    for h in $hosts; do
        grep -q "$1" "$work/$h.err" || return 1
    done
}
dies() {
    for h in $hosts; do
        : >"$work/$h.err"
    done
    plays && cost && floor "robots play" && kill -9 "$broker_pid" &&
        wait_for all_say 'the permit lapsed: the motion stops' && begin_open_broker &&
        wait_for all_listed ONLINE
    dies_status=$?
    wait "$play"
    [ $dies_status -eq 0 ] || tail -n 3 "$work/said" "$work"/h*.err
    return $dies_status
}
check "the broker is killed in the midst of a motion: each agent stops its robots" dies
# A line that plays has little time for readings: angles heard first may be older than the stop.
# None may be further from where its robot rests than the motion goes (60 degrees a second) in that
# time and the stop; from there on nothing moves.
nothing_moves() {
    mqtt still 3 "$all" >"$work/still" && python3 - "$work/still" "$all" 2>&1 >&3 <<'EOF2'
import json, sys
rows = json.load(open(sys.argv[1]))
assert len(rows) == int(sys.argv[2]), len(rows)
bad = {name: row for name, row in rows.items()
       if not row["rests"] or row["busy"] or row["moved_deg"] > 0.5
       or row["came_deg"] > 60 * (row["old_ms"] / 1e3 + 0.3)}
print("# at rest they moved %.1f degrees at most; angles heard first were up to %d ms old and %.1f "
      "degrees from there" % tuple(max(row[key] for row in rows.values())
                                   for key in ("moved_deg", "old_ms", "came_deg")))
assert not bad, bad
EOF2
}
check "it comes back, and from where it stopped no robot moves for 3 s" nothing_moves
check "then they play again" begin_together

done_testing
