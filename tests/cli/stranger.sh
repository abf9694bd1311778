#!/bin/sh
# SPDX-License-Identifier: MIT
# The simulator is driven by programs that know frames and packets and nothing of ours.
. tests/support/cli.sh

if ! command -v python3 >/dev/null; then
    echo "1..0 # SKIP no python3 for a client of the bytes alone"
    exit 0
fi
start_sim
test_case "a client of the bytes alone drives the simulator"
check "a client of the bytes alone drives the simulator" \
    exits 0 timeout 60 python3 tests/support/stranger.py "$sim_pty"
for did in check torque posture joint; do
    check "it was as described: $did" says "^$did\$"
done
check "and it is as our own command sees it" both exits 0 on_robot status m3 --- \
    says ' 90\.0 .* on '
stop_sim

# has HABIT: a client of the bus with that habit gets what it needs.
has() {
    exits 0 timeout 60 python3 tests/support/habits.py "$sim_pty" "$1"
}
start_sim --wiring bus
test_case "clients with habits of their own"
check "a client that writes and reads byte by byte" has byte_by_byte
stop_sim
start_sim --wiring bus --baud-at-once
check "one that changes rates" has other_rate
check "one that never reads" has never_reads
check "and the servos are there for the next one" both \
    exits 0 on_robot --wiring bus status m3 --- says R_SHOULDER_P
stop_sim
start_sim --wiring bus --latency 16
check "one that takes the first read for the reply" has one_read
stop_sim
start_sim --wiring bus --echo
check "one that reads its own packets back" has one_wire
stop_sim
done_testing
