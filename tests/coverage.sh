#!/bin/sh
# SPDX-License-Identifier: MIT
# Which lines and branches the tests reached, of a build with --coverage whose tests have run; fails
# where a part of the tree has fewer lines than its gate. The last line is that of tests/run.sh, a
# gate each.
#
# usage: coverage.sh BUILD [NAME=PERCENT...]     (NAME: src, ports, tools)
# environment: GCOV=gcov; FILES=yes tells each file too
set -u

build=$1
shift
# What is left of a source that has gone counts nothing.
find "$build/src" "$build/ports" "$build/tools/grctl" -name '*.gcno' |
    while read -r notes; do
        source=${notes#"$build/"}
        [ ! -e "${source%.gcno}.c" ] || echo "$notes"
    done |
    xargs "${GCOV:-gcov}" -n -b -r 2>/dev/null | awk -v gates="$*" -v files="${FILES:-}" '
    function part(text) {
        match(text, /[0-9.]+% of [0-9]+/)
        split(substr(text, RSTART, RLENGTH), words, "% of ")
        all = words[2]
        return words[1] * all / 100
    }
    /^File / {
        file = substr($2, 2, length($2) - 2)
        if (file !~ /^(src|ports|tools)\/.*\.c$/) {
            file = ""
        }
        told = 0
        top = file
        sub(/\/.*/, "", top)
    }
    # Behind the last file stands the sum of all.
    /^Lines executed:/ && ++told > 1 {
        file = ""
    }
    file != "" && /^Lines executed:/ {
        hit = part($0)
        lines[top] += all
        reached[top] += hit
        if (files) {
            printf "%6.1f %% of %4d  %s\n", 100 * hit / all, all, file | "sort -k 5"
        }
    }
    file != "" && /^Taken at least once:/ {
        taken[top] += part($0)
        branches[top] += all
    }
    END {
        close("sort -k 5")
        n = split(gates, wanted, " ")
        for (i = 1; i <= n; i++) {
            split(wanted[i], gate, "=")
            top = gate[1]
            pct = lines[top] ? 100 * reached[top] / lines[top] : 0
            met = lines[top] && pct >= gate[2] + 0
            met ? passed++ : failed++
            printf "%s  %-5s  %.2f %% of %d lines, gate %s %%; %.1f %% of %d branches taken\n",
                met ? "pass" : "FAIL", top, pct, lines[top], gate[2],
                branches[top] ? 100 * taken[top] / branches[top] : 0, branches[top]
        }
        printf "%d passed, %d failed, 0 skipped\n", passed, failed
        exit failed > 0 || n == 0
    }'
