#!/bin/sh
# SPDX-License-Identifier: MIT
# The programs under docs/examples do what they say.
. tests/support/tap.sh

own_robot() {
    # The emulator, where there is one, is a command with its options.
    output=$(${EMULATOR:-} "$BUILD/docs/examples/own_robot") || return 1
    expected='BASE     motor 11    45.0 deg
SHOULDER motor 12    20.0 deg
ELBOW    motor 13    30.0 deg
WRIST    motor 14   -50.0 deg'
    [ "$output" = "$expected" ] || { printf '%s\n' "$output"; return 1; }
}
check "a robot of one's own: reaches, with the gripper level" own_robot

# guide_is_true PROGRAM GUIDE: each C block of the guide stands in the program, word for word.
guide_is_true() {
    awk '
    FILENAME ~ /\.c$/ { program = program $0 "\n"; next }
    /^```c$/ { block = ""; first = FNR + 1; inside = 1; next }
    /^```$/ && inside {
        inside = 0
        blocks++
        if (index(program, block) == 0) {
            print FILENAME ":" first ": not in the program"
            bad = 1
        }
        next
    }
    inside { block = block $0 "\n" }
    END { exit bad || blocks == 0 }
    ' "$1" "$2"
}
check "a robot of one's own: the guide shows what is built" guide_is_true \
    docs/examples/own_robot.c docs/guide/own-robot.md
check "a microcontroller: the guide shows what is built" guide_is_true \
    docs/examples/firmware/player.c docs/guide/bare-metal.md

done_testing
