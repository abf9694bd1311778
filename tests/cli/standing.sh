#!/bin/sh
# SPDX-License-Identifier: MIT
# Another program has sent a joint on its way, slower than its servo tells: who says that it is
# stopped has seen it stand.
. tests/support/cli.sh

if ! have_json; then
    echo "1..0 # SKIP no python3 to be the other program"
    exit
fi
GRCTL_ROBOT=so101
export GRCTL_ROBOT
start_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }

# creep STEPS: servo 1 goes far, at so many steps a second: a frame of another program.
creep() {
    python3 - "$robot" "$1" <<'PY'
import os, struct, sys, termios, tty
line = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(line)
body = bytes([1, 10, 3, 41, 0]) + struct.pack("<HHH", 900, 0, int(sys.argv[2]))
os.write(line, b"\xff\xff" + body + bytes([~sum(body) & 0xFF]))
termios.tcdrain(line)
os.close(line)
PY
}
angle() {
    on_robot --json status | python3 -c \
        'import json, sys; print(json.loads(sys.stdin.readline())["joints"][0]["angle_deg"])'
}
moved() {
    python3 -c 'import sys; sys.exit(not abs(float(sys.argv[1]) - float(sys.argv[2])) > 0.6)' "$@"
}
# stands_after STEPS COMMAND...: it creeps; behind the command, which succeeds, it does not.
stands_after() {
    exits 0 on_robot move shoulder_pan 0 500 && creep "$1" || return 1
    shift
    before=$(angle)
    wait_for eval 'moved "$before" "$(angle)"' && exits 0 on_robot "$@" || return 1
    at=$(angle)
    begun=$(date +%s)
    wait_for eval '[ $(($(date +%s) - begun)) -ge 2 ]' && ! moved "$at" "$(angle)"
}

# A step is 0.088 degrees.
test_case "a joint that creeps is stopped"
check "3 deg/s: stop" stands_after 34 stop
check "6 deg/s: stop" stands_after 68 stop
test_case "a joint that creeps stands after an emergency stop"
check "3 deg/s: estop" stands_after 34 estop
check "it is released" exits 0 on_robot estop --reset
check "6 deg/s: estop" stands_after 68 estop

stop_sim
done_testing
