#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds and tests for every machine that can be had here: `make check-ports`. Ends with a table,
# and one line that adds it up:
#   N passed, N failed, N skipped
#
# usage: tools/ports.sh [NAME...]     (without a name: all of them)
# environment: BUILD=build, below which each has a log in logs/ports
#
# What is left out is told and counted as skipped: where this machine cannot install what a row
# needs, and the rings of tests that would make the whole longer than half an hour.
set -u
cd "$(dirname "$0")/.." || exit 1

build=${BUILD:-build}
logs=$build/logs/ports
all='size firmware arm64 armhf riscv64 s390x musl musl-arm64 win64 macos freebsd drivers'
[ $# -gt 0 ] || set -- $all
mkdir -p "$logs" || exit 1
: >"$logs/table"

# rings TARGET: one machine runs every ring, the others those in which they may differ.
rings() {
    case $1 in
    arm64) echo 'unit engine fuzz link fault port cli export' ;;
    armhf) echo 'unit engine fuzz link fault port export' ;;
    riscv64) echo 'unit engine fuzz port export' ;;
    s390x) echo 'unit engine fuzz port export' ;; # big-endian
    musl) echo 'unit engine fuzz port cli' ;;
    musl-arm64) echo 'unit engine' ;;
    esac
}

build_only() {
    case $1 in macos | freebsd | netbsd | openbsd) return 0 ;; esac
    return 1
}

quick_make() {
    env -u MAKEFLAGS -u MAKELEVEL make -j2 --no-print-directory BUILD="$build" "$@"
}

# brings NAME: what it needs is here, or was installed.
brings() {
    case $1 in
    size | firmware) tools/setup.sh --cross baremetal ;;
    drivers) tools/setup.sh --drivers ;;
    *) tools/cross/libs.sh "$1" ;;
    esac
}

runs() {
    case $1 in
    size) quick_make size ;;
    firmware | drivers) quick_make "check-$1" ;;
    *)
        if build_only "$1"; then
            quick_make cross TARGET="$1"
        elif [ -n "$(rings "$1")" ]; then
            quick_make check-cross TARGET="$1" RING="$(rings "$1")"
        else
            quick_make check-cross TARGET="$1"
        fi
        ;;
    esac
}

# row NAME PASSED FAILED SKIPPED SECONDS REMARK
row() {
    printf '%-11s %6d %6d %7d %5d s  %s\n' "$@"
}

# tried NAME: the row of one.
tried() {
    log=$logs/$1.log
    begin=$(date +%s)
    if ! brings "$1" >"$log" 2>&1; then
        row "$1" 0 0 1 0 "left out: $(tail -n 1 "$log")"
        return
    fi
    runs "$1" >>"$log" 2>&1
    status=$?
    took=$(($(date +%s) - begin))
    counts=$(grep -E '^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' "$log" | tail -n 1 |
        tr -cd '0-9 ')
    remark=$(rings "$1")
    build_only "$1" && remark='compiled and linked, tests too; nothing here can run it'
    if [ -z "$counts" ]; then
        # It has no tests of its own, or did not come to them.
        [ $status -eq 0 ] && counts='1 0 0' || counts='0 1 0'
    elif [ $status -ne 0 ] && [ "${counts#* 0 }" != "$counts" ]; then
        counts='0 1 0'
    fi
    # $counts is three words.
    # shellcheck disable=SC2086
    row "$1" $counts $took "$remark"
    [ $status -eq 0 ] || awk '/^FAIL/ { shown = 1 } /^pass/ { shown = 0 } shown' "$log" |
        head -n 60 >&2
    [ $status -eq 0 ] || grep -E 'error:|Error [0-9]' "$log" | head -n 20 >&2
}

for name in "$@"; do
    echo "== $name"
    tried "$name" >>"$logs/table"
    tail -n 1 "$logs/table"
done

echo
printf '%-11s %6s %6s %7s %7s  %s\n' where passed failed skipped took rings
cat "$logs/table"
awk '{ passed += $2; failed += $3; skipped += $4 }
    END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped; exit failed > 0 }
    ' "$logs/table"
