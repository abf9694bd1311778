#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl doctor` on servos that are ill in a known way: each illness named, with what helps.
. tests/support/cli.sh
. tests/support/doctor.sh

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
    exits 1 "$GRCTL" -d "$robot" --timeout 500 doctor --json || return 1
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
tell id 10 9
check "two servos with one id" finds 'two servos with id 9' 'servo-set 9 id NEW'
tell id 10 10
tell id 3 4
check "a servo under another's id" finds 'R_SHOULDER_P does not answer' 'grctl scan'
tell id 3 3
check "well again" exits 0 doctor

stop_sim
done_testing
