#!/bin/sh
# SPDX-License-Identifier: MIT
# The firmware of docs/examples/firmware in an emulated microcontroller: grctl at the UART of one
# that is a robot, a simulated robot at the UART of one that plays.
# $FIRMWARE is the folder that has it for each processor, as `make firmware` builds it.
. tests/support/cli.sh

qemu=qemu-system-arm
qemu_pid=

stop_machine() {
    exec 9>&-
    [ -z "$qemu_pid" ] && return
    kill "$qemu_pid" 2>/dev/null
    wait "$qemu_pid" 2>/dev/null
    qemu_pid=
}
trap 'stop_machine; end_cli_test' EXIT

# start_machine MACHINE FIRMWARE SERIAL: as QEMU names what the UART is connected to.
start_machine() {
    timeout 200 "$qemu" -M "$1" -nographic -monitor none -serial "$3" -kernel "$2" \
        >"$work/qemu.log" 2>&1 </dev/null &
    qemu_pid=$!
}

# start_robot MACHINE FIRMWARE: $pty is its UART.
start_robot() {
    start_machine "$1" "$2" pty
    written "$work/qemu.log" 'redirected to' || return 1
    pty=$(sed -n 's,.*redirected to \([^ ]*\).*,\1,p' "$work/qemu.log")
    # QEMU looks once a second whether somebody has the other end: so somebody has it always.
    exec 9<>"$pty"
}

# With patience: the emulator is one of several programs on this machine.
ask() {
    "$GRCTL" -d "$pty" --timeout 300 --retries 5 "$@"
}

# Until QEMU has looked, bytes go nowhere.
answers() {
    wait_for exits 0 "$GRCTL" -d "$pty" --retries 0 status m1 && return
    cat "$work/err" "$work/qemu.log"
    return 1
}

finds_all() {
    exits 0 ask scan --last 22 || return 1
    [ "$(grep -c RS30 "$work/out")" -eq 20 ] || { cat "$work/out"; return 1; }
}

# On a machine that is too busy for it, a motion is stopped for safety: then once more.
plays() {
    for _ in 1 2 3; do
        exits 0 ask --on-exit hold play --table motions/greet.pseq &&
            says 'largest error at the end 0\.' && return
    done
    return 1
}

# Started by Ctrl-C; the exit policy is carried out.
stops_smoothly() {
    timeout --preserve-status -s INT 3 "$GRCTL" -d "$pty" --on-exit off play -n 20 \
        motions/greet.pseq >"$work/out" 2>&1
    [ $? -eq 130 ] || { cat "$work/out"; return 1; }
}

# A move of eight seconds whose program dies: the servo goes on by itself, until it is stopped.
stops_on_the_way() {
    exits 0 ask move R_ELBOW_P 0 500 || return 1
    timeout -s KILL 2 "$GRCTL" -d "$pty" move R_ELBOW_P -80 8000 >"$work/out" 2>&1
    exits 0 ask estop || return 1
    exits 0 ask status R_ELBOW_P && says ' brake  *0 ' || return 1 # its speed
    angle=$(awk '$2 == "R_ELBOW_P" { print int($3) }' "$work/out")
    [ "$angle" -lt 0 ] && [ "$angle" -gt -70 ] || { cat "$work/out"; return 1; }
}

# The elbow stands where the wave of player.c ends.
waves() {
    wait_for sim_shows R_ELBOW_P '-50\.0 deg  to   -50\.0  torque on .* C$' && return
    cat "$work/sim.log" "$work/qemu.log"
    return 1
}

waved() {
    cat "$work/waves"
    return $waved
}

# What is linked: nothing that allocates, prints or asks an operating system.
links_bare() {
    foreign=$("${BARE_PREFIX}nm" "$1/gr001.elf" "$1/player.elf" |
        grep -E ' _?(malloc|calloc|realloc|free|sbrk|[fsv]*n?printf|puts|abort|exit)(_r)?$')
    [ -z "$foreign" ] || { echo "$foreign"; return 1; }
}

# What the core leaves open, beside itself: mem*, math, and what the compiler brings.
core_asks_little() {
    "${BARE_PREFIX}nm" --defined-only "$1/libgrobo-core.a" | awk 'NF == 3 { print $3 }' |
        sort -u >"$work/defined"
    open=$("${BARE_PREFIX}nm" -u "$1/libgrobo-core.a" | awk '/ U / { print $2 }' | sort -u |
        comm -23 - "$work/defined" |
        grep -vxE 'mem(cpy|move|set|cmp|chr)|strlen' |
        grep -vxE '__(aeabi|gnu_thumb1)_.*|__[a-z]+[dst][fi][0-9]?' |
        grep -vxE 'a?(sin|cos|tan)|atan2|sqrt|exp2?|log2?|pow|fabs|fmin|fmax|floor|ceil|l?round')
    [ -z "$open" ] || { echo "$open"; return 1; }
}

# try CPU MACHINE
try() {
    test_case "$1: the firmware asks for little"
    check "$1: the core asks for mem*, math and the compiler's library" core_asks_little \
        "$FIRMWARE/$1"
    check "$1: no malloc and no stdio in the firmware" links_bare "$FIRMWARE/$1"
    test_case "$1: a robot is driven by it in $2"
    if ! command -v "$qemu" >/dev/null; then
        skip "$1: in $2" "$qemu is missing"
        return
    fi
    start_robot "$2" "$FIRMWARE/$1/gr001.elf"
    check "$1: answers in $2" answers
    check "$1: scan finds 20 servos" finds_all
    check "$1: status" both exits 0 ask status --- says 'R_KNEE_P  *-40\.0'
    check "$1: a register is written and read back" both \
        exits 0 ask servo-set 12 max_torque 55 --- both \
        exits 0 ask servo-get 12 max_torque --- says 55
    check "$1: plays a motion" plays
    grep ' frames, ' "$work/out" | sed "s/^/# $1: deadlines: /"
    check "$1: Ctrl-C stops it smoothly and lets it go" both stops_smoothly --- both \
        exits 0 ask status m12 --- says ' off '
    check "$1: emergency stop brakes a joint on its way" stops_on_the_way
    check "$1: after it no move" exits 4 ask move m5 10 500
    check "$1: until it is taken back" both exits 0 ask estop --reset --- \
        exits 0 ask move m5 10 500
    stop_machine

    for _ in 1 2 3; do
        start_told_sim --tcp 0
        start_machine "$2" "$FIRMWARE/$1/player.elf" "$(sed -n 's/^also at //p' "$work/sim.log")"
        waves >"$work/waves"
        waved=$?
        stop_machine
        stop_sim
        [ $waved -ne 0 ] || break
    done
    test_that "$1: plays a motion itself, on a simulated robot" waved
}

if [ ! -e "$FIRMWARE/cortex-m0/gr001.elf" ]; then
    skip "firmware" "no compiler for it: tools/setup.sh --cross baremetal"
else
    # What is built for a Cortex-M0 runs on a Cortex-M3 as well.
    try cortex-m0 mps2-an385
    try cortex-m4 mps2-an386
fi
done_testing
