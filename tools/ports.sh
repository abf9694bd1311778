#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds and tests for every machine that can be had here: `make check-ports`. Ends with a table,
# and one line that adds it up:
#   N passed, N failed, N skipped
#
# usage: tools/ports.sh [NAME...]     (without a name: all of them)
# environment: BUILD=build, below which each has a log in logs/ports
#   MINUTES=n: no row begins when these are over
#
# What is left out is told and counted as skipped: where this machine cannot install what a row
# needs, where the time is over, and the rings of tests that would make the whole longer than half
# an hour.
set -u
cd "$(dirname "$0")/.." || exit 1

build=${BUILD:-build}
logs=$build/logs/ports
started=$(date +%s)
all='size firmware arm64 armhf riscv64 s390x musl musl-arm64 win64 macos freebsd drivers'
[ $# -gt 0 ] || set -- $all
for name in "$@"; do
    case " $all openbsd " in
    *" $name "*) ;;
    *)
        echo "ports: no machine is called $name; there are $all openbsd" >&2
        exit 2
        ;;
    esac
done
mkdir -p "$logs" || exit 1
: >"$logs/table"

# rings TARGET: those in which machines may differ. The command's own tests, in real time, are left
# to `make check-cross`: an emulator on a busy machine is late too often.
rings() {
    case $1 in
    arm64) echo 'unit engine fuzz link fault port export' ;;
    armhf) echo 'unit engine fuzz link fault port export' ;;
    riscv64) echo 'unit engine fuzz port export' ;;
    s390x) echo 'unit engine fuzz port export' ;; # big-endian
    musl) echo 'unit engine fuzz port cli' ;;
    musl-arm64) echo 'unit engine' ;;
    esac
}

build_only() {
    case $1 in macos | freebsd | openbsd) return 0 ;; esac
    return 1
}

quick_make() {
    env -u MAKEFLAGS -u MAKELEVEL make -j2 --no-print-directory BUILD="$build" "$@"
}

# brings NAME: what it needs is here, or was installed.
brings() {
    case $1 in
    size | firmware) tools/setup.sh --cross baremetal ;;
    drivers) tools/setup.sh --drivers && sh tests/drivers/fetch.sh "$build/drivers/debian" ;;
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

# attempt NAME: $counts is what it passed, failed and skipped.
attempt() {
    runs "$1" >"$log.run" 2>&1
    status=$?
    cat "$log.run" >>"$log"
    counts=$(awk '/^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$/ { n = $1 " " $3 " " $5 }
        END { print n }' "$log.run")
    # What has no tests, or did not come to them, is one thing that passed or failed.
    case "$status $counts" in
    '0 ') counts='1 0 0' ;;
    [1-9]*' 0 '* | [1-9]*' ') counts='0 1 0' ;;
    esac
    [ $status -eq 0 ]
}

# why: what a failed run said.
why() {
    awk '/^FAIL/ { shown = 1 } /^pass/ { shown = 0 } shown || /error:|Error [0-9]/' "$log.run" |
        head -n 60 >&2
}

time_is_over() {
    [ -n "${MINUTES:-}" ] && [ $(($(date +%s) - started)) -ge $((MINUTES * 60)) ]
}

# tried NAME: the row of one. Some tests keep time, and an emulator may stall: who fails runs again.
tried() {
    log=$logs/$1.log
    begin=$(date +%s)
    if time_is_over; then
        row "$1" 0 0 1 0 "left out: $MINUTES minutes are over"
        return
    fi
    if ! brings "$1" >"$log" 2>&1; then
        row "$1" 0 0 1 0 "left out: $(tail -n 1 "$log")"
        return
    fi
    remark=$(rings "$1")
    build_only "$1" && remark='compiled and linked, tests too; nothing here can run it'
    if ! attempt "$1"; then
        why
        attempt "$1" || why
        remark="$remark; the second try"
    fi
    rm -f "$log.run"
    # $counts is three words.
    # shellcheck disable=SC2086
    row "$1" $counts $(($(date +%s) - begin)) "$remark"
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
