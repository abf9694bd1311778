#!/bin/sh
# SPDX-License-Identifier: MIT
# The simulator is driven by a program that knows the reference document's frames and nothing of
# ours.
. tests/support/cli.sh

if ! command -v python3 >/dev/null; then
    echo "1..0 # SKIP no python3 for a client of the bytes alone"
    exit 0
fi
start_sim
check "a client of the bytes alone drives the simulator" \
    exits 0 timeout 60 python3 tests/support/stranger.py "$robot"
for did in check torque posture joint; do
    check "it was as described: $did" says "^$did\$"
done
check "and it is as our own command sees it" both exits 0 on_robot status m3 --- \
    says ' 90\.0 .* on '
done_testing
