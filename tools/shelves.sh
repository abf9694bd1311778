#!/bin/sh
# SPDX-License-Identifier: MIT
# Prints the functions of each shelf of headers, by header: `make shelves`. The last lines count
# them.
#
# usage: tools/shelves.sh        (run at the top)
set -u

# functions HEADER: the names that it exports, one a line.
functions() {
    awk '
        /^GROBO_(CLASSIC_)?API/ { said = ""; open = 1 }
        open {
            said = said " " $0
            at = index(said, "(")
            if (at) {
                n = split(substr(said, 1, at - 1), words, /[ *]+/)
                print words[n]
                open = 0
            }
        }' "$1"
}

# shelf NAME HEADER...: its headers with their functions, and one line for the sums.
shelf() {
    name=$1
    shift
    echo "== $name"
    for header in "$@"; do
        functions "$header" | awk -v header="${header#include/}" '
            { names = names "\n    " $0 }
            END { printf "%s: %d%s\n", header, NR, names }'
    done
    count=$(for header in "$@"; do functions "$header"; done | wc -l)
    sums="$sums$name: $count functions, $(cat "$@" | wc -l) lines, $# headers
"
}

sums=
shelf main include/grobo/*.h
shelf classic include/grobo/classic/*.h
shelf core include/grobo/core/*.h
printf '%s' "$sums"
