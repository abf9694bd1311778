#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands of the guides on motions and scripts do what these say, on files that they show.
. tests/support/guide.sh

guides_work "the commands of the guides on motions and scripts" docs/guide/motions.md \
    docs/guide/whole-body.md docs/guide/scripts.md motions/README.md
drawn() {
    [ -s "$work/desk/no.pseq" ] && [ -s "$work/desk/greet.svg" ] && [ -s "$work/desk/no.svg" ] &&
        [ -s "$work/desk/step.svg" ] && [ -s "$work/desk/greet.m" ]
}
test_that "what the commands of the guide leave" drawn
test_case "a morning by a script of the guide"
if have_json; then
    morning() {
        cp "$work/desk/morning.json" "$work/out" &&
            json '[(l["line"], l["status"]) for l in lines if "line" in l] ==
                [(1, 0), (2, 0), (3, 0), (4, 0)]'
    }
    check "each line of a script is marked" morning
else
    skip "each line of a script is marked, and nod.py" "no python3"
fi
done_testing
