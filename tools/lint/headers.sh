#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: each header compiles alone, a public one as C11 and as C++11; grobo.h includes all of the
# main shelf, which is small enough to be read.
#
# usage: headers.sh        (CC, CXX and CPPFLAGS from the environment; run at the top)
set -u

cc=${CC:-gcc}
cxx=${CXX:-g++}
flags="-Iinclude -Iports/posix/include ${CPPFLAGS:-}"
warnings="-Wall -Wextra -Wpedantic ${WERROR:-}"
bad=0
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# try HEADER LANGUAGE COMPILER...: a file that includes it and nothing else must compile.
try() {
    header=$1
    language=$2
    shift 2
    printf '#include "%s"\ntypedef int not_empty;\n' "$header" >"$work/alone"
    if ! "$@" -fsyntax-only - <"$work/alone" 2>"$work/errors"; then
        echo "$header:1: headers: does not compile alone as $language"
        sed 's/^/    /' "$work/errors" | head -n 8
        bad=1
    fi
}

# The lists of flags are meant to be split.
# shellcheck disable=SC2086
for header in include/grobo/*.h include/grobo/*/*.h ports/*/include/grobo/*/*.h; do
    [ -f "$header" ] || continue
    try "$header" C11 $cc -x c -std=c11 $warnings -Wstrict-prototypes $flags -I.
    if command -v "${cxx%% *}" >/dev/null 2>&1; then
        try "$header" C++11 $cxx -x c++ -std=c++11 $warnings $flags -I.
    fi
done
# The umbrella is for those who do not want to know which header of the main shelf; export.h comes
# with any of them.
if [ -f include/grobo/grobo.h ]; then
    for header in include/grobo/*.h; do
        name=${header##*/}
        case $name in grobo.h | export.h) continue ;; esac
        grep -q "<grobo/$name>" include/grobo/grobo.h && continue
        echo "include/grobo/grobo.h:1: headers: does not include <grobo/$name>"
        bad=1
    done
    functions=$(cat include/grobo/*.h | grep -c '^GROBO_API')
    lines=$(cat include/grobo/*.h | wc -l)
    [ "$functions" -le 200 ] && [ "$lines" -le 4500 ] || {
        echo "include/grobo/grobo.h:1: headers: $functions functions and $lines lines on the main" \
            "shelf, more than 200 and 4500: what few programs need goes to include/grobo/core"
        bad=1
    }
fi
# shellcheck disable=SC2044,SC2086 # names here have no spaces
for header in $(find src ports tools tests -name '*.h' ! -path '*/include/grobo/*'); do
    system=
    case $header in
    src/link/*) system='-D_DEFAULT_SOURCE -D_XOPEN_SOURCE=700' ;;
    src/*) ;;
    *) system='-D_DEFAULT_SOURCE -D_XOPEN_SOURCE=700' ;;
    esac
    # A port's own headers want its system.
    case $header in
    ports/win32/*)
        command -v x86_64-w64-mingw32-gcc >/dev/null 2>&1 || continue
        try "$header" C11 x86_64-w64-mingw32-gcc -x c -std=c11 $warnings -Iinclude \
            -Iports/win32/include -I.
        continue
        ;;
    esac
    try "$header" C11 $cc -x c -std=c11 $warnings $system $flags -I.
done
exit $bad
