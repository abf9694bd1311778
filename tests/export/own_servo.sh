#!/bin/sh
# SPDX-License-Identifier: MIT
# A family of servos as a stranger adds one (docs/guide/own-servo.md): its directory and a line of
# src/servo/families.list. tests/families/acme is invented; here it is put into a copy of this tree,
# made, judged by the rule of layers, and then driven, simulated, decoded and scanned.
. tests/support/cli.sh

acme=tests/families/acme
build=${BUILD:-build}
if [ -n "${EMULATOR:-}${NATIVE_GRCTL:-}" ]; then
    skip "a family of one's own" "the tree is made for this machine"
    done_testing
    exit
fi
case $build in
/*)
    skip "a family of one's own" "needs a build directory within the tree"
    done_testing
    exit
    ;;
esac

test_case "a directory and a line of the list"
tree=$work/tree
files() {
    [ "$(find "$acme" -name '*.[ch]' | wc -l)" -le 9 ]
}
check "it has at most 9 files" files

# The sources are links to those here, what is made of them a copy: make builds what is new.
plant() {
    mkdir -p "$tree/$build" || return 1
    for name in *; do
        case $name in
        src | build) ;;
        *) ln -s "$PWD/$name" "$tree/$name" || return 1 ;;
        esac
    done
    cp -rs "$PWD/src" "$tree/src" || return 1
    rm "$tree/src/servo/families.list"
    cp src/servo/families.list "$tree/src/servo/families.list" &&
        echo 'FAMILY(acme, acme)' >>"$tree/src/servo/families.list"
    mkdir "$tree/src/servo/acme" && cp "$acme"/*.[ch] "$tree/src/servo/acme"
    (cd "$build" && cp -p .flags .bindir .datadir "$tree/$build") &&
        cp -rp "$build/src" "$build/ports" "$build/tools" "$tree/$build"
}
check "they are all that is added" plant

# Variables of the command line are those of the make that runs the tests, its jobs are not.
# made TARGET...
made() {
    case ${MAKEFLAGS:-} in
    *' -- '*) vars="-- ${MAKEFLAGS#* -- }" ;;
    *) vars= ;;
    esac
    sed -n 's/^\([A-Z]*\) = \(.*\)$/\1=\2/p' "$build/.flags" >"$work/flags"
    set -- "$@" "BUILD=$build"
    while read -r flag; do
        set -- "$@" "$flag"
    done <"$work/flags"
    (cd "$tree" && MAKEFLAGS=$vars MAKELEVEL= make -j2 "$@") >"$work/made" 2>&1 && return
    tail -20 "$work/made"
    return 1
}
check "it is made" made "$build/grctl" "$build/libgrobo-core.a"
quietly() {
    ! grep -i warning "$work/made"
}
check "without a warning" quietly
little() {
    [ "$(grep -c '^  CC ' "$work/made")" -lt 60 ] || { cat "$work/made"; return 1; }
}
check "of what was there already little is made again" little
layered() {
    (cd "$tree" && sh tools/lint/layers.sh "$build")
}
check "its files use what theirs may" layered
in_core() {
    nm "$tree/$build/libgrobo-core.a" | grep -q grobo_i_acme_driver_init
}
check "its driver is in the core" in_core

# A program that names the driver of a family alone, as firmware does.
linked() {
    cat >"$work/firmware.c" <<C
#include <grobo/robot_file.h>
extern const grobo_robot_family $1;
int main(void)
{
    static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    return $1.init[$1.wiring](&driver, 0) < 0;
}
C
    sanitizers=$(sed -n 's/^SAN = \(..*\)/-fsanitize=\1/p' "$build/.flags")
    # shellcheck disable=SC2086
    "${CC:-cc}" -Iinclude $sanitizers -o "$work/firmware" "$work/firmware.c" \
        "$tree/$build/libgrobo-core.a" -lm || return 1
    nm "$work/firmware" >"$work/names"
    grep -q "$1" "$work/names" || return 1
    ! grep -e ' grobo_sim_' -e ' grobo_i_sim_' -e ' grobo_i_words_' "$work/names"
}
test_case "firmware links neither simulated servos nor words"
for family in rs30x dynamixel2 dynamixel1 feetech lx16a ics acme; do
    check "$family" linked "grobo_i_family_$family"
done

GRCTL=$tree/$build/grctl
simulator=$GRCTL
test_case "it is driven and simulated"
check "its servos are listed" both exits 0 "$GRCTL" robot servos acme --- says ACME-2
check "a robot's file is checked" exits 0 "$GRCTL" robot check "$acme/crane.yaml"
check "a simulated robot moves" exits 0 "$GRCTL" -d sim --robot "$acme/crane.yaml" \
    move turn 30 300
start_sim --robot "$acme/crane.yaml"
check "the robot is initialised" exits 0 on_robot --robot "$acme/crane.yaml" init
check "it moves" exits 0 on_robot --robot "$acme/crane.yaml" move lift -20 300
check "it is there" both exits 0 on_robot --robot "$acme/crane.yaml" status --- says 'lift .*-20'
check "a register is read" both exits 0 on_robot --robot "$acme/crane.yaml" \
    servo-get 2 goal_position --- says goal_position

test_case "it is found on a line, and its frames are decoded"
check "scan finds its servos" both exits 0 on_robot scan --family acme --last 5 --- says ACME-1
check "a request" both exits 0 "$GRCTL" decode --family acme C5 02 03 02 18 02 43 --- \
    says 'read present_position of servo 2; sum 43 right; reply: 7 bytes'
check "a write" both exits 0 "$GRCTL" decode --family acme C5 01 04 03 12 DC 05 97 --- \
    says 'write servo 1: goal_position 0.0 deg'
check "a trace of a session" exits 0 on_robot --robot "$acme/crane.yaml" --trace "$work/t.pcapng" \
    move turn 0 200
check "is decoded" both exits 0 "$GRCTL" --robot "$acme/crane.yaml" decode "$work/t.pcapng" --- \
    says 'servo 1 (turn).*goal_position'
all_answered() {
    grep -q ' 0 with a wrong sum, 0 cut off, 0 bytes of rubbish' "$work/err"
}
check "every frame of it" all_answered
check "for scripts too" both exits 0 "$GRCTL" --robot "$acme/crane.yaml" --json \
    decode "$work/t.pcapng" --- says '"kind":"return"'
done_testing
