#!/bin/sh
# SPDX-License-Identifier: MIT
# docs/guide/tour.md shows what a terminal of 80x24 shows: every screen in it is made again here,
# and must differ in nothing but numbers and bars. TOUR_WRITE=yes (make captures) replaces them.
. tests/support/cli.sh
. tests/support/guide_blocks.sh
. tests/support/terminal.sh

tour=$PWD/docs/guide/tour.md
if ! have_full_screen; then
    echo "1..0 # SKIP $no_screen"
    exit
fi

# ---- the guide -----------------------------------------------------------------------------------

# alike: numbers, bars, the width of columns, what a busy machine says, and which joint was the
# latest aside.
alike() {
    LC_ALL=C.UTF-8 sed -e '/ too fast for a servo/d' \
        -e '/^largest error/s/(.*)/(JOINT)/' -e 's/-\{0,1\}[0-9][0-9.]*/N/g' \
        -e 's/[─│█░]\{1,\}/B/g' -e 's/\([A-Z_]\)N/\1 N/g' -e 's/  */ /g'
}
is_true() {
    block "$tour" "screen $1" | alike >"$work/told"
    alike <"$work/shots/$1" >"$work/seen"
    [ -s "$work/told" ] && diff "$work/told" "$work/seen"
}
# ---- a desk: the command, motions, one of them bad, a robot -------------------------------------

mkdir "$work/bin" "$work/desk" "$work/shots"
ln -s "$GRCTL" "$work/bin/grctl"
ln -s "$PWD/motions" "$work/desk/motions"
{
    head -n 1 motions/greet.m
    awk 'NR == 1 { $1 = 100; $6 = -1330; print }' motions/greet.m
} >"$work/desk/wave.m"
start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
open_screen
type_line "cd '$work/desk'; export LC_ALL=C.UTF-8 PATH='$work/bin':\$PATH GRCTL_DEVICE='$robot'"
type_line "PS1='\$ '"
until_screen '^\$'

# run COMMAND...: types it, on a clean screen.
run() {
    run_line=$*
    type_line "$run_line"
}
# shot NAME: the command and the screen as it is now, without the empty lines below.
shot() {
    { printf '$ %s\n' "$run_line" && screen; } | sed -e "s|$robot|/tmp/gr001|g" -e 's/ *$//' |
        awk '{ line[NR] = $0 } $0 != "" && $0 != "$" { last = NR }
            END { for (i = 1; i <= last; i++) print line[i] }' >"$work/shots/$1"
}
# ends PATTERN: the command has said that, and the prompt is back.
ends() {
    until_screen "$1" && until_screen '^\$$'
}

tell silent 12 on
tell temperature 13 70
tell voltage 6.4
run grctl doctor
test_case "the commands of the guide do what it says"
check "doctor" ends 'checks failed'
shot doctor
tell silent 12 off
tell temperature 13 25
tell voltage 7.4

run grctl status
check "status" ends 'L_ELBOW_P'
shot status
run grctl check wave.m
check "check" ends 'errors, '
shot check
# A busy machine may lose replies; then it is played again.
plays() {
    for plays_i in 1 2 3; do
        run grctl play motions/greet.pseq
        until_screen 'playing 2\.\|^grctl: ' || return 1
        shot playing
        ends 'largest error at\|^grctl: ' || return 1
        shot played
        grep -q '^grctl: ' "$work/shots/played" || return 0
    done
    return 1
}
check "play" plays
run grctl monitor motions/greet.pseq
check "monitor" until_screen '^12 KNEE_P .* on '
keys p
check "playing there" until_screen 'playing [1-4]\.'
keys Space
until_screen 'paused'
shot monitor
settled() {
    shot monitor
    [ "${TOUR_WRITE:-}" = yes ] || is_true monitor
}
wait_for settled
keys q
until_screen '^\$'
on_screen kill-server
stop_sim

test_case "the guide shows what they print"
for name in doctor status check playing played monitor; do
    [ "${TOUR_WRITE:-}" != yes ] || replace_block "$tour" "screen $name" "$work/shots/$name"
    check "the guide shows $name as it is" is_true $name
done
done_testing
