#!/bin/sh
# SPDX-License-Identifier: MIT
# docs/guide/from-original.md has each member of docs/seed-map.md, and its C compiles.
set -u

. tests/support/tap.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
guide=docs/guide/from-original.md

members() {
    sed -n 's/^| \([A-Z][A-Z][0-9][0-9]\) |.*/\1/p' "$1"
}
all_members() {
    members docs/seed-map.md >"$work/map" && members $guide >"$work/guide" &&
        [ "$(wc -l <"$work/map")" -eq 190 ] && diff "$work/map" "$work/guide"
}
# The statement of each row uses a symbol of the map's row, or a field that it has.
same_symbols() {
    awk -F' [|] ' '
    { sub(/^[|] /, "") }
    FNR == NR { if ($1 ~ /^[A-Z][A-Z][0-9][0-9]$/) here[$1] = $3; next }
    $1 in here {
        n = split(here[$1], names, /[` ,]+/)
        found = 0
        for (i = 1; i <= n; i++) {
            word = names[i]
            sub(/^(grobo_[a-z_0-9]*|[A-Z][A-Za-z0-9]*)[.]/, "", word)
            if (word != "" && index($3, word)) found = 1
        }
        if (!found) { print $1 ": " $3 " has none of " here[$1]; bad = 1 }
    }
    END { exit bad }' docs/seed-map.md $guide
}
# Each call in C++ has as many arguments as a function of that name in the reference document.
same_arguments() {
    awk '
    function arguments(text) {
        gsub(/"[^"]*"/, "s", text)
        return text ~ /^ *$/ ? 0 : gsub(/,/, "", text) + 1
    }
    FNR == NR {
        if (match($0, /[A-Za-z_0-9]+\([^()]*\)/) && $0 ~ /(;|= 0;|\{)[ \r]*$/) {
            call = substr($0, RSTART, RLENGTH)
            at = index(call, "(")
            sub(/\)$/, "", call)
            known[substr(call, 1, at - 1), arguments(substr(call, at + 1))] = 1
        }
        next
    }
    /^\| [A-Z][A-Z][0-9][0-9] \| `[a-z]\.[A-Za-z_0-9]+\([^()]*\)/ {
        split($0, cell, " [|] ")
        call = cell[2]
        sub(/^`[a-z]\./, "", call)
        sub(/\).*/, "", call)
        at = index(call, "(")
        if (call ~ /\.\.\./) next
        calls++
        if (!((substr(call, 1, at - 1), arguments(substr(call, at + 1))) in known)) {
            print cell[1] ": " call ")"
            bad = 1
        }
    }
    END { exit bad || calls < 100 }' "$reference" $guide
}
sources() {
    cat tests/export/original.c
    sed -n 's/^| \([A-Z][A-Z][0-9][0-9]\) | `.*` | `\(.*\)` |$/void \1(void);\
void \1(void)\
{\
    \2\
}/p' $guide
}
compiles() {
    sources >"$work/original.c" && [ "$(grep -c '(void);$' "$work/original.c")" -eq 190 ] &&
        ${CC:-cc} -std=c11 -Wall -Wextra ${WERROR:-} -Wno-unused-variable \
            -Wno-unused-but-set-variable -Iinclude -Iports/posix/include -c \
            -o "$work/original.o" "$work/original.c"
}
test_that 'it has each of the 190 members' all_members
test_that 'each is served by what the map says' same_symbols
reference=${GROBO_SHARED:-../shared}/seed/class-reference.ja.txt
if [ -r "$reference" ]; then
    test_that 'its calls in C++ have the arguments of the reference document' same_arguments
else
    test_case 'its calls in C++'
    skip 'its calls in C++' "no $reference: reference material beside the checkout"
fi
test_case 'its C compiles'
if [ -n "${CROSS:-}" ]; then
    skip 'its C compiles' 'the same for all machines'
elif [ -n "${CC:-}" ] || command -v cc >/dev/null; then
    check 'its C compiles' compiles
else
    skip 'its C compiles' 'no C compiler'
fi
done_testing
