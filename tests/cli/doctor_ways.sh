#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl doctor` where something holds the robot or its port, and on the way to the robot.
. tests/support/cli.sh
. tests/support/doctor.sh

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
exits 0 on_robot estop
test_case "what holds the robot or its port is found"
check "an emergency stop that stands" finds 'an emergency stop stands' 'estop --reset'
exits 0 on_robot estop --reset

"$GRCTL" -d "$robot" --timeout 500 status --watch --interval 3600000 >"$work/watch" &
watcher=$!
wait_for test -s "$work/watch"
check "somebody else has the port" finds "$known_as (pid $(known_pid $watcher)) holds it" \
    "kill \(/f /pid \)*$(known_pid $watcher)"
kill $watcher
wait $watcher 2>/dev/null

robot=$sim_pty
chmod 600 "$robot"
if [ "$(id -u)" -eq 0 ] && command -v setpriv >/dev/null 2>&1; then
    cp "$GRCTL" "$work/grctl"
    chmod 755 "$work" "$work/grctl"
    as_nobody() {
        exits 1 setpriv --reuid 65534 --clear-groups "$work/grctl" -d "$robot" doctor &&
            says '^BAD   permission .*mode 600: .* may not open it' && says ' -> sudo'
    }
    check "no permission" as_nobody
else
    skip "no permission" "only root can be somebody else"
fi
stop_sim
exec 5>&-
robot=$work/none
test_case "faults of the way to the robot are found"
check "no such device" finds 'is not there' "'grctl ports'"
robot=$work
check "a directory" finds 'is not a serial port' "'grctl ports'"
robot=tcp:127.0.0.1:1
check "nobody listens" finds 'tcp:127.0.0.1:1' 'start a serial server there'

start_sim --baud 57600
check "another baud rate" finds 'there is one at 57600 bps' "-b 57600"
stop_sim
start_sim --wiring bus
check "another wiring" finds 'straight on the line' "--wiring bus"
check "as it should be asked" exits 0 doctor --wiring bus
stop_sim
start_sim --wiring bus --echo
test_case "an echo nobody reckons with"
check "an echo nobody reckons with" finds 'returns what is sent' '--wiring bus --echo' --wiring bus
check "one that is expected" exits 0 doctor --wiring bus --echo
stop_sim
# Of Feetech what was sent is a packet, and of KRS, which have no sums, it hides the replies.
cat >"$work/krs.yaml" <<'YAML'
name: t
family: ics
joints:
  - {name: turn, id: 1, servo: KRS-3301, limits_deg: [-90, 90]}
YAML
for bus in so101 "$work/krs.yaml"; do
    start_sim --robot "$bus" --echo
    check "an echo: ${bus##*/}" finds 'returns what is sent' '--wiring bus --echo' --robot "$bus"
    check "and beside it nothing" [ "$(grep -c '^BAD' "$work/out")" -eq 1 ]
    stop_sim
done
# Servos that tell no voltage, and servos in the cold.
test_case "the warmest servo"
robot=sim
check "of KRS" both exits 0 doctor --robot "$work/krs.yaml" --- says 'the warmest has 27 C$'
start_told_sim
for motor in $(seq 1 20); do
    tell temperature "$motor" $((-4 - motor))
done
check "below zero" both exits 0 doctor --- says 'the warmest has -[1-5] C$'
stop_sim
done_testing
