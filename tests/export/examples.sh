#!/bin/sh
# SPDX-License-Identifier: MIT
# The programs under docs/examples do what they say.
. tests/support/tap.sh

own_robot() {
    output=$("$BUILD/docs/examples/own_robot") || return 1
    expected='BASE     motor 11    45.0 deg
SHOULDER motor 12    20.0 deg
ELBOW    motor 13    30.0 deg
WRIST    motor 14   -50.0 deg'
    [ "$output" = "$expected" ] || { printf '%s\n' "$output"; return 1; }
}
check "a robot of one's own: reaches, with the gripper level" own_robot

done_testing
