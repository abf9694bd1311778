#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands of the guides do what these say, on files that they show.
. tests/support/cli.sh

here=$(pwd)
mkdir "$work/bin" "$work/desk"
ln -s "$GRCTL" "$work/bin/grctl"
ln -s "$here/motions" "$work/desk/motions"

# Files after "<!-- file NAME -->" and commands after "<!-- run -->", in the order of the guide.
python=
have_json && python=yes
# parts COMMANDS GUIDE...
parts() {
    parts_commands=$1
    shift
    awk -v desk="$work/desk" -v commands="$parts_commands" -v python=$python '
    /^<!-- file / { file = desk "/" $3 }
    /^<!-- run -->/ { file = commands }
    /^<!-- run python3 -->/ && python { file = commands }
    /^```/ { open = !open && file != ""; if (!open) { close(file); file = "" }; next }
    open { print >>file }' "$@"
}
parts "$work/commands" docs/guide/motions.md docs/guide/whole-body.md docs/guide/scripts.md \
    docs/guide/own-robot.md docs/guide/own-servo.md docs/guide/first-hour.md motions/README.md
parts "$work/commands" docs/README.ja.md docs/guide/first-hour.ja.md
parts "$work/arm-commands" docs/guide/arm.md docs/guide/lerobot.md # with an SO-101

test_case "the commands of the guide work"
check "the guide has commands and a file" [ -s "$work/commands" ] && [ -s "$work/desk/no.pseq" ]
PATH=$work/bin:$PATH
export PATH
run() {
    cd "$work/desk" && eval "$1" </dev/null
}
while read -r command; do
    check "$command" run "$command" 3<&-
done <"$work/commands"
export GRCTL_ROBOT=so101
while read -r command; do
    check "$command" run "$command" 3<&-
done <"$work/arm-commands"
unset GRCTL_ROBOT
drawn() {
    [ -s "$work/desk/greet.svg" ] && [ -s "$work/desk/no.svg" ] && [ -s "$work/desk/step.svg" ] &&
        [ -s "$work/desk/greet.m" ]
}
test_case "what the commands of the guide leave"
check "its files are there" drawn
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
