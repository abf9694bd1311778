#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl doctor` on robots that are ill in a known way: each illness named, with what mends it.
. tests/support/cli.sh

doctor() {
    # On a busy machine the simulator answers late.
    "$GRCTL" -d "$robot" --timeout 100 doctor "$@"
}

# finds PATTERN FIX [OPTIONS]: exit status 1, a check that failed like that, and the line under it.
finds() {
    finds_message=$1
    finds_fix=$2
    shift 2
    exits 1 doctor "$@" || return 1
    grep -A 1 "^BAD .*$finds_message" "$work/out" | grep -q -e "-> .*$finds_fix" && return
    cat "$work/out"
    return 1
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
test_case "a healthy robot"
check "a healthy robot" both exits 0 doctor --- says '^ok .*all 20 answer'
check "every servo with -v" both exits 0 doctor -v --- \
    says '^ok .*servo_12 .*R_KNEE_P: RS301CR, 25 C'
check_json "as JSON" 'lines[0]["ok"] and len(lines[0]["checks"]) in (25, 26) and
     all(c["ok"] and c["fix"] is None for c in lines[0]["checks"])' doctor --json
tell silent 12 on
test_case "faults of servos are found, with what helps"
check "a silent servo" finds 'R_KNEE_P does not answer' 'push its cable in'
json_silent() {
    exits 1 doctor --json || return 1
    json 'not lines[0]["ok"] and [(c["name"], "cable" in c["fix"]) for c in lines[0]["checks"]
          if not c["ok"]] == [("servo_12", True)]'
}
if have_json; then
    check "a silent servo as JSON" json_silent
else
    skip "a silent servo as JSON" "no python3 to parse JSON with"
fi
tell silent 12 off
tell temperature 13 70
check "a hot servo" finds 'R_ANKLE_P is hot: \(69\|70\) C, at most 65' 'servo off m13'
tell temperature 13 25
tell voltage 6.4
check "a low battery" finds '6.38 V at the servos: low' 'charge the battery'
tell voltage 7.4
tell fault dupid=1
check "two servos with one id" finds 'two servos with id 9' 'servo-set 9 id NEW'
tell fault dupid=0
tell id 3 4
check "a servo under another's id" finds 'R_SHOULDER_P does not answer' 'grctl scan'
tell id 3 3
check "well again" exits 0 doctor

exits 0 "$GRCTL" -d "$robot" estop
test_case "what holds the robot or its port is found"
check "an emergency stop that stands" finds 'an emergency stop stands' 'estop --reset'
exits 0 "$GRCTL" -d "$robot" estop --reset

"$GRCTL" -d "$robot" status --watch --interval 3600000 >"$work/watch" &
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
done_testing
