#!/bin/sh
# SPDX-License-Identifier: MIT
# Every block of code or shell in the documents is run by a test: C and Python here, the others
# where their mark says. A block that needs what a test has not says what: <!-- needs A ROBOT -->.
set -u

. tests/support/tap.sh
. tests/support/built.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
root=$PWD
build=${BUILD:-build}

# Each block to a file N.LANGUAGE, and a line "N LANGUAGE FILE:LINE MARK" for it.
for file in README.md CONTRIBUTING.md docs/*.md docs/guide/*.md motions/README.md ports/README.md \
    tools/python/README.md; do
    awk -v file="$file" -v work="$work" -v list="$work/list" '
    /^```/ && !open {
        open = 1
        language = substr($0, 4) == "" ? "text" : substr($0, 4)
        block = work "/" (id = file "_" NR) "." language
        gsub(/[\/]/, "_", id)
        block = work "/" id "." language
        print id, language, file ":" NR, before >>list
        next
    }
    /^```/ { open = 0; close(block); next }
    open { print >>block }
    { before = $0 ~ /^<!-- .* -->$/ ? $0 : "" }' "$file"
done

# Marks, and the tests that run what they stand before.
is_run() {
    case $3:$4 in
    *:'<!-- needs '*) ;;
    docs/guide/*:'<!-- run'* | docs/guide/*:'<!-- file '*)
        grep -q -e "${3%:*}" tests/cli/guide*.sh
        ;;
    motions/README.md:*:'<!-- run'*) grep -q -e motions/README.md tests/cli/guide.sh ;;
    docs/guide/tour.md:*:'<!-- screen '*) ;;          # tests/cli/tour.sh
    docs/guide/tour.md:*:'<!-- tour -->') ;;          # tests/cli/readme.sh
    docs/guide/safety.md:*:'<!-- deaths -->') ;;      # tests/cli/deaths.sh
    docs/guide/trace.md:*) ;;                         # tests/cli/trace.sh
    README.md:*:'<!-- example -->') ;;                # tests/cli/readme.sh
    README.md:*:'<!-- python -->') ;;                 # tests/export/python.sh
    README.md:*:'<!-- commands -->') ;;               # tests/cli/demo.sh, make check-roots
    docs/README.ja.md:*:'<!-- run -->') ;;            # tests/cli/guide_first_hour.sh
    docs/README.ja.md:*) [ -n "$4" ] ;;               # tests/cli/japanese.sh: those of README.md
    docs/guide/python.md:* | tools/python/README.md:* | *:'<!-- lerobot -->') ;; # python.sh
    *:'<!-- asyncio -->') ;;                          # here
    *) case $2 in c) ;; text) ;; *) false ;; esac ;;
    esac
}
all_run() {
    status=0
    while read -r id language place mark; do
        is_run "$id" "$language" "$place" "$mark" ||
            { echo "$place: $language block that nothing runs"; status=1; }
    done <"$work/list"
    [ "$(wc -l <"$work/list")" -ge 60 ] && return $status
}
test_that 'every block has its test' all_run
notices() {
    ! is_run x sh docs/guide/arm.md:1 '' && ! is_run x python docs/design.md:1 '' &&
        ! is_run x sh docs/guide/tour.md:1 '<!-- run -->'
}
test_that 'a block without one is noticed' notices

if [ -n "${CROSS:-}${EMULATOR:-}" ]; then
    test_case 'the blocks in C and Python'
    skip 'the blocks in C and Python' 'only for this machine'
    done_testing
    exit 0
fi

# compiles BLOCK OPTION...: alone, where it begins with its headers; a part of a program is compared
# with that by tests/export/examples.sh.
compiles() {
    block=$1
    shift
    ${CC:-cc} -std=c11 -D_GNU_SOURCE -Wall -Wextra ${WERROR:-} -Wno-unused-function -Iinclude \
        -Iports/posix/include "$block" "$@"
}
runs() {
    # shellcheck disable=SC2046
    compiles "$1" $(pkg-config --cflags libevent_core ${2:+"$2"}) -o "$work/program" \
        "$build/libgrobo.a" $(PKG_CONFIG_PATH=$build pkg-config --libs --static grobo ${2:+"$2"} |
            sed 's/-lgrobo//') &&
        timeout 60 "$work/program" >"$work/said" && grep -q ': success$' "$work/said"
}
instrumented() {
    nm "$build/libgrobo.a" 2>/dev/null | grep -q -e __asan_init -e __tsan_init -e __gcov_
}
part_of_example() {
    grep -q -e "${1%:*}" tests/export/examples.sh
}
compiled=0
while read -r id language place mark; do
    [ "$language" = c ] || continue
    case $place:$mark in
    *:'<!-- program'*)
        test_case "$place runs"
        needs=$(echo "$mark" | sed -n 's/<!-- program \(.*\) -->/\1/p')
        if [ -n "$needs" ] && ! pkg-config --exists "$needs"; then
            skip "$place runs" "no $needs (tools/setup.sh --check installs it)"
        elif instrumented; then
            skip "$place runs" 'the library is instrumented'
        else
            check "$place runs" runs "$work/$id.c" "$needs"
        fi
        ;;
    README.md:*) ;; # tests/cli/readme.sh
    *)
        if grep -q '^#include' "$work/$id.c"; then
            test_that "$place compiles" compiles "$work/$id.c" -fsyntax-only
        else
            test_that "$place is part of an example" part_of_example "$place"
        fi
        ;;
    esac
    compiled=$((compiled + 1))
done <"$work/list"
test_that 'there are blocks in C' [ $compiled -ge 8 ]

asyncio() {
    copy_build "$build" "$work/built" && make_in_copy "$work/built" python &&
        PYTHONPATH=$work/built/python timeout 60 python3 "$(ls "$work"/*your-loop*.python)" \
            >"$work/said" && grep -q "'R_ELBOW_P': -0.[78]" "$work/said"
}
test_case 'the loop of asyncio'
if ! python3 -c 'import cffi' 2>/dev/null; then
    skip 'the loop of asyncio' 'no cffi'
elif instrumented; then
    skip 'the loop of asyncio' 'the library is instrumented'
else
    check 'the loop of asyncio' asyncio
fi
cd "$root" && done_testing
