#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes src/robots/NAME.c of each src/robots/NAME.yaml.
#
# usage: make.sh [--check] ROBOTS      ROBOTS is the program; --check compares, and writes nothing
set -eu
check=
if [ "$1" = --check ]; then
    check=y
    shift
fi
made=$(mktemp)
trap 'rm -f "$made"' EXIT
status=0
for file in src/robots/*.yaml; do
    table=$(echo "${file%.yaml}" | tr - _).c
    "$1" "$file" >"$made"
    if [ -z "$check" ]; then
        cp "$made" "$table"
        clang-format-14 -i "$table"
    elif [ "$(tr -d ' \n' <"$made")" != "$(tr -d ' \n' <"$table")" ]; then
        echo "$table: robots: differs from $file; run 'make robots'"
        status=1
    fi
done
exit $status
