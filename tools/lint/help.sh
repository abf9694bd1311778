#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: each target a person may call (.PHONY) has a ## comment, which is what `make help` prints,
# and each target with one is in .PHONY.
awk '
/^\.PHONY:/ {
    line = FNR
    text = $0
    while (text ~ /\\$/ && (getline more) > 0) {
        sub(/\\$/, "", text)
        text = text " " more
    }
    sub(/^\.PHONY:/, "", text)
    n = split(text, names, " ")
    for (i = 1; i <= n; i++) {
        phony[names[i]] = line
    }
    next
}
/^[a-z][a-z_-]*:.* ## ./ {
    name = $0
    sub(/:.*/, "", name)
    told[name] = FNR
}
END {
    for (name in phony) {
        if (name != "FORCE" && !(name in told)) {
            printf "Makefile:%d: help: target %s has no ## comment\n", phony[name], name
            bad = 1
        }
    }
    for (name in told) {
        if (!(name in phony)) {
            printf "Makefile:%d: help: target %s is not in .PHONY\n", told[name], name
            bad = 1
        }
    }
    exit bad
}' Makefile
