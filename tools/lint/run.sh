#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs the gates over the tree and says which rule is broken where, one line each.
#
# usage: run.sh --quick BUILD    the gates that read sources only: two seconds, after the first time
#        run.sh --all BUILD      all gates; BUILD holds the objects and the shared library
# environment: CC, CXX, NM, CPPFLAGS
set -u

gates=$(dirname "$0")
failed=
slow=
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# The names of the project's files have no blanks; the lists below are split on purpose.
# shellcheck disable=SC2046
sources() {
    find $(ls -d include src ports tools tests docs/examples 2>/dev/null) -type f -name '*.[ch]' |
        sort
}

texts() {
    sources
    find tools tests .ci -type f \( -name '*.sh' -o -name '*.awk' -o -name run \) | sort
    ls Makefile ./*.md docs/*.md 2>/dev/null | sed 's,^\./,,'
}

# gate NAME COMMAND...
gate() {
    name=$1
    shift
    "$@" || failed="$failed $name"
}

scan() {
    rules=$1
    shift
    awk -f "$gates/strip.awk" -f "$gates/$rules.awk" "$@"
}

# The same for a document that names tests.
named_tests() {
    rules=$1
    shift
    awk -f "$gates/strip.awk" -f "$gates/named_tests.awk" -f "$gates/$rules.awk" "$@"
}

# Code for every robot does not know one of them.
gr001() {
    awk -v robot=src/robots/gr001.yaml -v list="$gates/gr001.txt" -v whole=1 \
        -f "$gates/strip.awk" -f "$gates/gr001.awk" "$@"
}

# beside NAME COMMAND...: a gate that takes long, while the others run; see gather().
beside() {
    slow="$slow $1"
    (
        name=$1
        shift
        "$@" >"$work/$name" 2>&1 || echo "$name" >>"$work/$name.failed"
    ) &
}
gather() {
    wait
    for name in $slow; do
        cat "$work/$name"
        [ ! -e "$work/$name.failed" ] || failed="$failed $name"
    done
}

# Files whose last byte is not a newline.
final_newline() {
    [ "$(tail -q -c 1 "$@" 2>/dev/null | tr -cd '\n' | wc -c)" -ne $# ] || return 0
    status=0
    for file in "$@"; do
        if [ -n "$(tail -c 1 "$file")" ]; then
            echo "$file:1: text: no newline at the end"
            status=1
        fi
    done
    return $status
}

all=$(sources)
headers=$(printf '%s\n' "$all" | grep '\.h$')
library=$(printf '%s\n' "$all" | grep -E '^(include|src|ports)/')
everything=$(texts)

[ -z "${2:-}" ] || { mkdir -p "$2" && export FORMATTED="$2/.formatted"; }
# shellcheck disable=SC2086
beside format sh "$gates/format.sh" $all
if [ "$1" = --all ]; then
    beside headers sh "$gates/headers.sh"
fi
# shellcheck disable=SC2086
{
    gate text env LC_ALL=C awk -f "$gates/text.awk" $everything
    gate text final_newline $everything
    gate banned scan banned $all
    gate platform scan platform $all
    gate size scan size $all
    gate braces scan braces $all
    gate switch scan switch $library $library
    gate units scan units $headers
    gate gr001 gr001 $(printf '%s\n' "$all" | grep -E '^(include|src|ports|tools/grctl)/')
    gate help sh "$gates/help.sh"
    gate lang sh "$gates/lang.sh"
    gate tree sh "$gates/tree.sh"
    gate seed-map sh "$gates/seed_map.sh"
    gate null sh "$gates/null.sh"
    gate safety named_tests safety docs/guide/safety.md
}
if [ "$1" = --all ]; then
    if command -v python3 >/dev/null; then
        gate anchors python3 tests/mutants/anchors.py
    else
        echo 'lint: without python3 the anchors of sabotages are not checked' >&2
    fi
    gate layers sh "$gates/layers.sh" "$2"
    gate robots sh tools/robots/make.sh --check "$2/tools/robots/robots"
    gate servos sh tools/servos/make.sh --check "$2/tools/servos/servos"
    gate symbols sh "$gates/symbols.sh" "$2/libgrobo.so.1"
fi

gather

if [ -n "$failed" ]; then
    echo "lint: failed:$(printf '%s\n' $failed | sort -u | tr '\n' ' ' | sed 's/^/ /; s/ $//')" >&2
    exit 1
fi
echo 'lint: clean'
