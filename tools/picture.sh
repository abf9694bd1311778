#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws the moving picture of README.md, docs/robot.svg.
#
# usage: tools/picture.sh PICTURE [--check]
#   --check  touch nothing; fail where the picture is not what PICTURE draws now. Numbers may differ
#            by 0.35: a goal that another machine rounds to the next 0.1 degree moves a hand so far
set -u

drawn=$(mktemp) || exit 1
trap 'rm -f "$drawn"' EXIT
# A command with its options, where an emulator runs it.
# shellcheck disable=SC2086
$1 motions/greet.pseq motions/squat.pseq >"$drawn" || exit 1
if [ "${2:-}" != --check ]; then
    cat "$drawn" >docs/robot.svg
elif ! awk -v near=0.35 -f tools/near.awk docs/robot.svg "$drawn"; then
    echo 'docs/robot.svg is not what is drawn now; remake it: make picture' >&2
    exit 1
fi
