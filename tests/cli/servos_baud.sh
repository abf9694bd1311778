#!/bin/sh
# SPDX-License-Identifier: MIT
# A servo on a bus that changes its rate when it restarts: the command finds out where it answers.
. tests/support/cli.sh
. tests/support/two_servos.sh

test_case "on a bus of servos"

scan() {
    "$GRCTL" -d "$robot" --timeout 100 scan "$@"
}
start_sim --wiring bus --baud 57600
check "--all-baud finds the rate" both exits 0 scan --wiring bus --all-baud --first 3 \
    --last 4 --- says '^  3 .*  57600 bps  R_SHOULDER_P$'
check "and no other" [ "$(grep -c R_SHOULDER_P "$work/out")" -eq 1 ]
stop_sim

start_told_sim --robot "$work/two.yaml"
check "a baud rate without --flash" both exits 0 on_bus servo-set 2 baud 57600 --- \
    said '(57600 bps); takes effect at a restart, and is lost there .*; it answers at 115200 bps$'
check_json "in JSON" 'lines[0]["flash"] is False and lines[0]["baud_bps"] == 115200' \
    on_bus --json servo-set 2 baud 57600
follows 'at the restart'
tell cable 2 out
tell cable 2 in
# It starts for half a second.
check "its power does not take the rate away" wait_for exits 0 on_bus servo-get 2 baud
exits 0 on_bus servo on m12
check "a servo that holds is not restarted" fails 4 'servo 12 holds, and would restart limp' \
    on_bus servo-set 12 baud 57600 --flash
check "and keeps its rate" both exits 0 on_bus servo-get 12 baud --- says ' 115200 bps$'
check "without --flash it goes on holding" exits 0 on_bus servo-set 12 baud 57600
stop_sim
done_testing
