#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes the tables of servo models, each of a folder of src/servo/models.
#
# usage: make.sh [--check] SERVOS      SERVOS is the program; --check compares, and writes nothing
set -eu
check=
if [ "$1" = --check ]; then
    check=y
    shift
fi
made=$(mktemp)
trap 'rm -f "$made"' EXIT
status=0
for file in src/servo/models/*/table.yaml; do
    folder=${file%/table.yaml}
    table=$(sed -n 's/^file: //p' "$file")
    "$1" "$folder" >"$made"
    if [ -z "$check" ]; then
        cp "$made" "$table"
        clang-format-14 -i "$table"
    elif [ "$(tr -d ' \n' <"$made")" != "$(tr -d ' \n' <"$table")" ]; then
        echo "$table: servos: differs from $folder; run 'make servos'"
        status=1
    fi
done
exit $status
