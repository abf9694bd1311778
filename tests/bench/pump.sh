#!/bin/sh
# SPDX-License-Identifier: MIT
# Instructions of a pump of the engine on a Cortex-M0 and a Cortex-M4, counted by QEMU (pump.c).
#
# usage: tests/bench/pump.sh FOLDER, with FOLDER/cortex-m0/pump.elf; `make bench-pump` builds them
#   prints for each the processor and its instructions: a pump on average, one that sends a frame of
#   20 joints, the most of one. What is missing here is said, and is no failure.
set -u

folder=$1
qemu=qemu-system-arm

if ! command -v "$qemu" >/dev/null; then
    echo "pump: $qemu is missing; nothing is counted" >&2
    exit 0
fi
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT

# count CPU MACHINE: the firmware never ends, so it is ended when it has said all.
count() {
    if [ ! -e "$folder/$1/pump.elf" ]; then
        echo "pump: no $folder/$1/pump.elf: tools/setup.sh --cross baremetal" >&2
        return 0
    fi
    timeout 60 "$qemu" -M "$2" -nographic -monitor none -icount shift=10,sleep=off,align=off \
        -serial "file:$out/said" -kernel "$folder/$1/pump.elf" </dev/null >"$out/log" 2>&1 &
    machine=$!
    while kill -0 "$machine" 2>/dev/null && ! grep -q '\.$' "$out/said" 2>/dev/null; do
        sleep 0.1
    done
    kill "$machine" 2>/dev/null
    wait "$machine" 2>/dev/null
    if ! grep -q '\.$' "$out/said"; then
        cat "$out/log" "$out/said"
        return 1
    fi
    awk -v cpu="$1" '{ sub(/\.$/, ""); print cpu, $0 }' "$out/said"
    rm -f "$out/said"
}

# What is built for a Cortex-M0 runs on a Cortex-M3 as well.
count cortex-m0 mps2-an385 && count cortex-m4 mps2-an386
