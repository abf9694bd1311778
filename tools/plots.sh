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

status=0
for motion in motions/*.pseq; do
    name=$(basename "$motion" .pseq)
    "$grctl" -q plot --balance -o "$drawn/$name.svg" "$motion" || exit 1
    plot=motions/plots/$name.svg
    if [ "$check" != --check ]; then
        mkdir -p motions/plots
        cp "$drawn/$name.svg" "$plot" || exit 1
    elif ! { [ -f "$plot" ] && awk -f tools/near.awk "$plot" "$drawn/$name.svg"; }; then
        echo "$plot is not what grctl plot draws; remake it: make plots" >&2
        status=1
    fi
done
exit $status
