#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: each public function that takes a pointer is given NULL, or said to take it, in one of
# tests/*/test_null*.c.
gates=$(dirname "$0")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
sh "$gates/symbols.sh" --pointers >"$work/declared"
cat tests/*/test_null*.c | awk 'BEGIN { RS = ";" }
/NULL/ {
    while (match($0, /grobo_[a-z0-9_]+ *\(/)) {
        name = substr($0, RSTART, RLENGTH - 1)
        sub(/ *$/, "", name)
        print name
        $0 = substr($0, RSTART + RLENGTH)
    }
}' | sort -u >"$work/tried"
bad=0
for name in $(comm -23 "$work/declared" "$work/tried"); do
    place=$(find include -name '*.h' -exec grep -lE "(^|[^A-Za-z0-9_])$name *\(" {} + | head -n 1)
    echo "$place:1: null:" \
        "no tests/*/test_null*.c gives NULL to $name"
    bad=1
done
exit $bad
