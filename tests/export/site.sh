#!/bin/sh
# SPDX-License-Identifier: MIT
# The reference site: made without a warning, all links lead somewhere, nothing is fetched, and each
# public function has its place and its man page.
set -u

. tests/support/tap.sh
links=$PWD/tools/site/links.awk
map=$PWD/src/libgrobo.map
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

leave() {
    test_case 'the reference site'
    skip 'the reference site' "$1"
    done_testing
    exit 0
}
[ -z "${CROSS:-}${EMULATOR:-}" ] || leave 'the same for all machines'
command -v doxygen >/dev/null || leave 'no doxygen (tools/setup.sh --check installs it)'
leads() {
    (cd "$work/site/html" && awk -f "$links" -- *.html)
}
# Broken ways, to a file, to a place and to another machine, are found.
notices() {
    for bad in ' href="none.html"' ' href="index.html#none"' ' src="https://example.org/a.js"'; do
        echo "<a$bad>" >"$work/site/html/zzz.html"
        leads >"$work/said" && return 1
        grep -q 'zzz.html' "$work/said" || return 1
    done
    rm "$work/site/html/zzz.html"
}
functions() {
    sed -n 's/^ *\(grobo_[a-z0-9_]*\);$/\1/p' "$map"
}
described() {
    functions | while read -r name; do
        [ -e "$work/site/man/man3/$name.3" ] || case $name in
        grobo_*_sized | *_[0-9]*) ;; # what a macro calls
        *) echo "no man page of $name" && exit 1 ;;
        esac
    done
}
tasks() {
    for page in your-loop bare-metal own-robot own-servo from-original glossary; do
        grep -q "page_$page.html" "$work/site/html/index.html" || { echo "no $page"; return 1; }
    done
}
test_that 'it is made without a warning' tools/site/make.sh "$work/site"
test_that 'all links lead somewhere' leads
check 'a broken link is noticed' notices
test_that 'each public function has a man page' described
test_that 'the first page leads to each task' tasks
done_testing
