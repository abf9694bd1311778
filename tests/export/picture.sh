#!/bin/sh
# SPDX-License-Identifier: MIT
# The picture of README.md is what the simulator plays now, moves, and needs nothing but itself.
set -u

. tests/support/tap.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
picture="${EMULATOR:-} $BUILD/tools/picture/picture"

# A picture with one number changed by a pixel, and one with a word changed, are others.
notices() {
    mkdir -p "$work/docs" && ln -sf "$PWD/tools" "$PWD/motions" "$work" || return 1
    cp docs/robot.svg "$work/docs" &&
        (cd "$work" && tools/picture.sh "$absolute" --check) || return 1
    for change in 's/M1\([0-9.]*\) /M2\1 /' 's/NECK_Y/NECK_P/' '/NECK_Y/d'; do
        sed "$change" docs/robot.svg >"$work/docs/robot.svg"
        (cd "$work" && tools/picture.sh "$absolute" --check) 2>/dev/null && return 1
    done
    return 0
}
absolute="${EMULATOR:-} $(cd "$BUILD" && pwd)/tools/picture/picture"
test_case 'docs/robot.svg is what is drawn now'
if [ -x "$BUILD/tools/picture/picture" ]; then
    check 'docs/robot.svg is what is drawn now' tools/picture.sh "$picture" --check
    check 'a changed one is noticed' notices
else
    skip 'docs/robot.svg is what is drawn now' 'a program for Windows ends lines in its own way'
fi
test_case 'the picture moves, is small, needs nothing else'
check 'it moves' [ "$(grep -c '<animate ' docs/robot.svg)" -ge 20 ]
alone() {
    ! grep -n -i -e '<script' -e '<image' -e 'url(' -e 'href="[^#]' docs/robot.svg
}
check 'it needs nothing else' alone
check 'it is small' [ "$(wc -c <docs/robot.svg)" -lt 150000 ]
check 'README.md shows it' grep -q '](docs/robot.svg)' README.md
done_testing
