#!/bin/sh
# SPDX-License-Identifier: MIT
# The unit that runs an agent: systemd takes it, it is locked in, and grctl knows its options.
. tests/support/cli.sh
. tests/support/fleet.sh

unit=tools/systemd/grctl-agent@.service
command=$(sed -n 's/^ExecStart=//p' "$unit")
knows() {
    # The words of the unit, as systemd would split them.
    # shellcheck disable=SC2086
    fails 2 'agent: -d names a robot or a group' "$GRCTL" ${line#* }
}
line=$(echo "$command" | sed 's/%i/sim/; s|${BROKER}|mqtt://127.0.0.1:1|; s/ \$OPTIONS//')
test_case "the unit gives grctl a line that it knows"
if has_no_mqtt; then
    skip "grctl knows the line of the unit" "this grctl has no MQTT in it"
else
    check "grctl knows the line of the unit" knows
fi

test_case "systemd takes the unit"
if command -v systemd-analyze >/dev/null; then
    mkdir "$work/unit"
    made=$work/unit/grctl-agent@stage.service
    sed "s|^ExecStart=/usr/bin/grctl|ExecStart=$GRCTL|" "$unit" >"$made"
    check "systemd takes it" exits 0 systemd-analyze verify --man=no "$made"
    check "it says nothing" test ! -s "$work/err"
    check "little of the machine is open to it" exits 0 systemd-analyze security --offline=true \
        --threshold=25 "$made"
else
    skip "systemd takes it" "no systemd-analyze here"
fi
done_testing
