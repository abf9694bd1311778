#!/bin/sh
# SPDX-License-Identifier: MIT
# Every command that drives or reads a robot, with every robot that is built in and files of 1, 6
# and 20 joints of each kind of servo, piped and on a terminal, plain and with --json: every pair of
# command and kind of robot. MATRIX=all takes all combinations and more sizes (make nightly). What
# is refused stands with its reason in tests/support/matrix.tsv.
. tests/support/cli.sh

if ! have_json; then
    echo "1..0 # SKIP no python3 for a terminal"
    exit
fi
if [ -n "${NATIVE_GRCTL:-}" ]; then
    echo "1..0 # SKIP a pseudo-terminal is no console of Windows"
    exit
fi

mkdir "$work/matrix"
test_that "each cell ends as documented" \
    python3 tests/support/matrix.py "$GRCTL" "$work/matrix" \
    tests/support/matrix.tsv ${MATRIX:+"$MATRIX"}
printf '%s\n' "$tap_output" | grep '^# [0-9]* cells'
done_testing
