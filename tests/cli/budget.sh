#!/bin/sh
# SPDX-License-Identifier: MIT
# What the line carries, of every model of every family: a full reading is never faster than an
# angle alone, and a delay before each reply is named with the command that ends it.
. tests/support/cli.sh
unset GRCTL_ROBOT

test_case "every model of every family"

two_of() {
    cat <<END
name: two
family: $1
joints:
  - {name: a, id: 1, servo: $2, limits_deg: [-90, 90]}
  - {name: b, id: 2, servo: $2, limits_deg: [-90, 90]}
END
}
# Lines of the text: of the wire, then of a second.
slower() {
    awk '/^one joint, full/ { full = $(NF - 1) } /^one joint, angle only/ { angle = $(NF - 1) }
        /^all joints, full/ { f[0] = $4; f[1] = $11 } /^all joints, angle/ { a[0] = $5; a[1] = $12 }
        END { exit !(angle > 0 && full >= angle && a[0] >= f[0] && a[1] >= f[1] && f[0] > 0) }' \
        "$work/out"
}
every_model() {
    "$GRCTL" robot servos --json >"$work/servos" || return 1
    python3 - "$work/servos" >"$work/models" <<'END' || return 1
import json, sys
for line in open(sys.argv[1]):
    for servo in json.loads(line)["servos"]:
        if servo["joint"]:
            print(servo["family"], servo["model"])
END
    n=0
    while read -r family servo; do
        two_of "$family" "$servo" >"$work/two.yaml"
        for rate in 0 50; do
            "$GRCTL" --robot "$work/two.yaml" budget --rate $rate >"$work/out" 2>&1 && slower ||
                { echo "$servo at $rate Hz:"; cat "$work/out"; return 1; }
        done
        n=$((n + 1))
    done <"$work/models"
    [ $n -gt 50 ]
}
check "a full reading is never faster than an angle alone" every_model

test_case "delays of replies"
check "budget names them" both exits 0 "$GRCTL" --robot koch budget --- \
    says '^of each reply 0.50 ms is .*: grctl servo-set ID return_delay 0 --flash$'
no_delay() {
    ! grep -q 'return_delay 0' "$work/out"
}
check "not of a family that leaves its factory without" \
    both exits 0 "$GRCTL" --robot so101 budget --- no_delay
start_sim --robot koch
of() {
    "$GRCTL" --robot koch -d "$robot" --timeout 300 "$@"
}
check "doctor names them" both exits 0 of doctor --- \
    says '^ok *delay .* up to 500 us (servo 1); .*: grctl servo-set 1 return_delay 0 --flash$'
obeyed() {
    for id in 1 2 3 4 5 6; do
        of servo-set $id return_delay 0 --flash >"$work/set" 2>&1 || { cat "$work/set"; return 1; }
    done
    exits 0 of doctor && no_delay
}
check "and no longer where that was done" obeyed
stop_sim
done_testing
