#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws the plots of our own motions, motions/plots/*.svg.
#
# usage: tools/plots.sh GRCTL [--check]
#   --check  touch nothing; say which plots differ from what GRCTL draws now (numbers by more than
#            0.05, which is what another machine's arithmetic may do), and fail if any does
set -u

grctl=$1
check=${2:-}
drawn=$(mktemp -d) || exit 1
trap 'rm -rf "$drawn"' EXIT

# Two drawings are the same when their words are, and their numbers nearly.
same() {
    awk '
    function split_up(line, words, numbers,    n, word) {
        n = 0
        word = ""
        while (match(line, /-?[0-9]+(\.[0-9]+)?/)) {
            word = word substr(line, 1, RSTART - 1) "#"
            numbers[++n] = substr(line, RSTART, RLENGTH) + 0
            line = substr(line, RSTART + RLENGTH)
        }
        words[0] = word line
        return n
    }
    NR == FNR { old[FNR] = $0; lines = FNR; next }
    {
        n = split_up($0, new_words, a)
        if (split_up(old[FNR], old_words, b) != n || new_words[0] != old_words[0]) exit bad = 1
        for (i = 1; i <= n; i++) if ((a[i] - b[i]) ^ 2 > 0.05 ^ 2) exit bad = 1
    }
    END { exit bad || FNR != lines }' "$1" "$2"
}

status=0
for motion in motions/*.pseq; do
    name=$(basename "$motion" .pseq)
    "$grctl" -q plot --balance -o "$drawn/$name.svg" "$motion" || exit 1
    plot=motions/plots/$name.svg
    if [ "$check" != --check ]; then
        mkdir -p motions/plots
        cp "$drawn/$name.svg" "$plot" || exit 1
    elif ! { [ -f "$plot" ] && same "$plot" "$drawn/$name.svg"; }; then
        echo "$plot is not what grctl plot draws; remake it: make plots" >&2
        status=1
    fi
done
exit $status
