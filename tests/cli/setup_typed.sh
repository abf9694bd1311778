#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl setup as the owner of a new SO-101 types it: on a terminal, against six servos with id 1.
. tests/support/cli.sh
unset GRCTL_ROBOT
own_sim
GRCTL=$(cd "$(dirname "$GRCTL")" && pwd)/${GRCTL##*/}

test_case "a new SO-101, typed on a terminal"
have_json || {
    skip "typed on a terminal" "no python3"
    done_testing
    exit
}
start_told_sim --servo 11=STS3215,12=STS3215,13=STS3215,14=STS3215,15=STS3215,16=STS3215 || {
    echo "Bail out! the simulator did not start"
    exit 1
}
for number in 11 12 13 14 15 16; do
    tell id $number 1
    tell silent $number on
done
top=$PWD
walk() {
    cd "$work" && python3 "$top/tests/support/typed_setup.py" "$GRCTL" "$robot" \
        "$work/sim.log" "$top/motions/so101-wave.yaml" >"$work/walk" 2>&1 && return
    cat "$work/walk"
    return 1
}
check "the walk" walk
sed 's/^/# /' "$work/walk"
stop_sim
done_testing
