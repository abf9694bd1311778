#!/bin/sh
# SPDX-License-Identifier: MIT
# The programs under docs/examples do what they say.
. tests/support/tap.sh

# short NAME LINE...: the program ends well, prints these lines among others (patterns), and has at
# most 40 lines itself.
short() {
    name=$1
    shift
    output=$(${EMULATOR:-} "$BUILD/docs/examples/$name") || return 1
    for line in "$@"; do
        printf '%s\n' "$output" | grep -q -x -e "$line" || { printf '%s\n' "$output"; return 1; }
    done
    [ "$(wc -l <"docs/examples/$name.c")" -le 40 ]
}
# idea NAME LINE...
idea() {
    test_that "example: $1" short "$@"
    ideas="${ideas:-} $1"
}
idea read_joints 'R_ELBOW_P *-20\.0 deg' 'R_SHOULDER_P *20\.0 deg'
idea move_two 'move: success'
idea play '10 postures' 'play: success'
idea watch_events 'line sim: success' 'job [0-9]*: success' 'safety stop: emergency stop'
idea two_robots 'robot 1: success' 'robot 2: success'
idea own_loop 'torque of joint 0: success'
idea threads 'move: success' 'looked 5 times'
idea follow followed
idea own_model 'HEAD: success'
idea robot_file 'SO-101 follower: success'
idea pump 'there after [0-9]* ms'
test_that 'a stabilizer: it moves with the gripper level' short stabilizer \
    'wrist_flex -0\.5 rad: success'
ideas="$ideas stabilizer"
# Upright, then bent ahead by 6 degrees: the ankle is at -20 degrees, turns with it, and on
# while it stays: by 0.24 degrees a line.
balances() {
    output=$({ echo 0 0 0 0 0; i=0; while [ $i -lt 60 ]; do
        echo 0 6 0 0 0
        sleep 0.05
        i=$((i + 1))
    done; } | ${EMULATOR:-} "$BUILD/docs/examples/balance")
    [ "$output" = 'R_ANKLE_P -4 deg: success' ] || { printf '%s\n' "$output"; return 1; }
}
test_that 'a stabilizer with an IMU: the ankles lean against it' balances
ideas="$ideas balance"
no_other() {
    for file in docs/examples/*.c; do
        case "$ideas " in
        *" $(basename "$file" .c) "*) ;;
        *) echo "$file is not run"; return 1 ;;
        esac
    done
}
test_that 'every example is run' no_other

# guide_is_true PROGRAM... GUIDE: each C block of the guide stands in a program, word for word.
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
    ' "$@"
}
test_that "a robot of one's own: the guide shows what is built" guide_is_true \
    docs/examples/own_model.c docs/examples/stabilizer.c docs/guide/own-robot.md
test_that "a microcontroller: the guide shows what is built" guide_is_true \
    docs/examples/firmware/player.c docs/guide/bare-metal.md

done_testing
