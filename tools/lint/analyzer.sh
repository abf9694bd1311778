#!/bin/sh
# SPDX-License-Identifier: MIT
# What gcc -fanalyzer says of library, ports and command: nothing that tools/lint/reviewed has not
# looked at. A row there that nothing says any more is told too.
#
# usage: analyzer.sh BUILD      environment: MAKE
. tests/support/tap.sh

build=$1
mkdir -p "$build"
# Each file is compiled, whatever was built before; a file that is no C of ours has no row.
said_by_gcc() {
    rm -rf "$build/gcc"
    ${MAKE:-make} -s -k BUILD="$build/gcc" CC=gcc CFLAGS='-O1 -fanalyzer' WERROR= \
        lib "$build/gcc/grctl" "$build/gcc/grctl-serve" "$build/gcc/grctl-fleet" \
        >"$build/gcc.log" 2>&1 || { tail -n 5 "$build/gcc.log"; return 1; }
    sed 's|^\./||' "$build/gcc.log" |
        sed -n 's|^\([a-z][^:]*\):.*: warning: .*\[\(-Wanalyzer[^]]*\)\]$|\1 \2|p' |
        sort -u >"$build/gcc.said"
}
# Lines of what was said that no row of the list has, and the other way round.
has_nothing() {
    said_by_gcc || return 1
    awk 'NF && !/^#/ { print $1, $2 }' tools/lint/reviewed | sort -u >"$build/gcc.known"
    diff "$build/gcc.known" "$build/gcc.said" >"$build/gcc.diff" && return
    sed -n 's/^>/not reviewed:/p; s/^</said no more:/p' "$build/gcc.diff"
    return 1
}
check "gcc -fanalyzer has nothing new to say" has_nothing
done_testing
