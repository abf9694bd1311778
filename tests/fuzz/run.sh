#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs libFuzzer on each target, two at a time, and ends with the line of tests/run.sh.
#
# usage: [FUZZ_SEED=N] run.sh BUILD SECONDS NAME...     (0 or none: another seed each time)
#   BUILD/tests/fuzz/fuzz_NAME.fuzzer is run for SECONDS. It begins with tests/fuzz/corpus/NAME and
#   BUILD/corpus/NAME, where it adds what it finds; an input that fails is kept as BUILD/NAME-*.
set -u

if [ "$1" = --one ]; then
    build=$2
    seconds=$3
    name=$4
    mkdir -p "$build/corpus/$name"
    "$build/tests/fuzz/fuzz_$name.fuzzer" -max_total_time="$seconds" -seed="${FUZZ_SEED:-0}" \
        -verbosity=0 -print_final_stats=1 -artifact_prefix="$build/$name-" "$build/corpus/$name" \
        "tests/fuzz/corpus/$name" >"$build/$name.log" 2>&1 </dev/null
    status=$?
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$name.log")
    # A run of nothing is no success.
    if [ $status -eq 0 ] && [ "${runs:-0}" -gt 0 ]; then
        echo "pass  fuzz_$name ($runs runs in $seconds s)"
    else
        echo "FAIL  fuzz_$name: exit status $status"
        tail -n 30 "$build/$name.log"
    fi
    exit 0
fi

build=$1
seconds=$2
shift 2
for name in "$@"; do
    echo "$name"
done | xargs -P 2 -n 1 sh "$0" --one "$build" "$seconds" | awk '
    { print }
    /^pass/ { passed++ }
    /^FAIL/ { failed++ }
    END {
        printf "%d passed, %d failed, 0 skipped\n", passed, failed
        exit failed > 0 || passed == 0
    }'
