#!/bin/sh
# SPDX-License-Identifier: MIT
# A servo on a bus that changes its rate at once; a rate that cannot be changed from here.
. tests/support/cli.sh
. tests/support/two_servos.sh

test_case "a rate that holds at once"

start_sim --robot "$work/two.yaml" --baud-at-once
check "--baud-at-once, without --flash" both exits 0 on_bus servo-set 2 baud 57600 --- \
    said '(57600 bps); lost at power-off without --flash; it answers at 57600 bps$'
check "and back" both exits 0 on_bus -b 57600 servo-set 2 baud 115200 --- said 'at 115200 bps$'
follows '--baud-at-once'
stop_sim
check_json "in process" 'lines[0]["flash"] and lines[0]["baud_bps"] == 9600' \
    "$GRCTL" -d sim --wiring bus --timeout 500 --json servo-set 2 baud 9600 --flash
start_sim --robot "$work/two.yaml" --tcp 0
written "$work/sim.log" '^also at '
tcp=$(sed -n 's/^also at //p' "$work/sim.log")
check "behind TCP" fails 4 'the rate of a line behind TCP is not set from here' \
    "$GRCTL" -d "$tcp" --robot "$work/two.yaml" --timeout 500 servo-set 2 baud 57600
check "nothing was written" both exits 0 on_bus servo-get 2 baud --- says ' 115200 bps$'
check "--all-baud behind TCP" fails 2 'the rate of a line behind TCP' \
    "$GRCTL" -d "$tcp" --robot "$work/two.yaml" scan --all-baud
stop_sim
done_testing
