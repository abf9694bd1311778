#!/bin/sh
# SPDX-License-Identifier: MIT
# What gcc -fanalyzer and clang-tidy say of library, ports and command: nothing that
# tools/lint/reviewed has not looked at. A row there that nothing says any more is told too.
#
# usage: analyzer.sh BUILD      environment: MAKE, TIDY (clang-tidy-14)
. tests/support/tap.sh

build=$1
mkdir -p "$build"
# what_of WORD BEGIN: files and what is said of them, of lines FILE:LINE:COLUMN: WORD: ... [WHAT,...]
what_of() {
    sed "s|^$PWD/||; s|^\./||" | sed -n "s|^\([a-z][^:]*\):.*: $1: .*\[\($2[^],]*\).*\]\$|\1 \2|p" |
        sort -u
}
# Each file is compiled, whatever was built before; a file that is no C of ours has no row.
said_by_gcc() {
    rm -rf "$build/gcc"
    ${MAKE:-make} -s -k BUILD="$build/gcc" CC=gcc CFLAGS='-O1 -fanalyzer' WERROR= \
        lib "$build/gcc/grctl" "$build/gcc/grctl-serve" "$build/gcc/grctl-fleet" \
        >"$build/gcc.log" 2>&1 || { tail -n 5 "$build/gcc.log"; return 1; }
    what_of warning '-Wanalyzer' <"$build/gcc.log" >"$build/gcc.said"
}
said_by_tidy() {
    git ls-files 'src/*.c' 'ports/common/*.c' 'ports/posix/*.c' 'tools/grctl/*.c' |
        grep -v /win32/ | xargs -n 8 -P 2 sh -c '"$0" --quiet "$@" -- -std=c11 -Iinclude \
        -Iports/posix/include -I. -D_DEFAULT_SOURCE -D_XOPEN_SOURCE=700 -D_FILE_OFFSET_BITS=64' \
        "${TIDY:-clang-tidy-14}" >"$build/tidy.log" 2>/dev/null
    what_of error '[a-z]' <"$build/tidy.log" >"$build/tidy.said"
}
# new_of WHAT PATTERN: lines of what was said that no row of the list has, and the other way round.
new_of() {
    awk -v kind="$2" 'NF && !/^#/ && $2 ~ kind { print $1, $2 }' tools/lint/reviewed | sort -u \
        >"$build/$1.known"
    diff "$build/$1.known" "$build/$1.said" >"$build/$1.diff" && return
    sed -n 's/^>/not reviewed:/p; s/^</said no more:/p' "$build/$1.diff"
    return 1
}
gcc_has_nothing() {
    said_by_gcc && new_of gcc '^-Wanalyzer'
}
tidy_has_nothing() {
    said_by_tidy
    new_of tidy '^[a-z]'
}
check "gcc -fanalyzer has nothing new to say" gcc_has_nothing
if command -v "${TIDY:-clang-tidy-14}" >/dev/null; then
    check "clang-tidy has nothing new to say" tidy_has_nothing
else
    skip "clang-tidy has nothing new to say" "clang-tidy is not installed"
fi
done_testing
