#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl play` on a terminal: its progress line, and the keys it takes.
. tests/support/cli.sh
. tests/support/terminal.sh

if ! have_terminal; then
    skip "keys of play" "no tmux"
    done_testing
    exit
fi

# A motion of a minute: nothing here waits for its end.
motion=$work/long.m
for t in 1000 9000 18000 27000 36000 45000 54000; do
    echo "$t  0 0 200 0 -$((t / 200)) -200 0 200 0 200 0 -400 -200 0 0 -200 0 400 200 0"
done >"$motion"

start_sim || { echo "Bail out! the simulator did not start"; exit 1; }
play="'$GRCTL' -d '$robot' --retries 10 play '$motion'; echo status \$?; stty -a"
open_screen
type_line "$play"
test_case "keys pause, speed and stop a motion"
check "the keys are told" until_screen '^space: pause'
check "the progress tells the time left" until_screen 'playing .* s, .* s left at 100 %'
keys Space
check "space pauses" until_screen 'paused .* s left'
keys Space
check "and goes on" until_screen 'playing'
keys + +
check "plus is faster" until_screen 'left at 120 %'
keys -- -
check "minus is slower" until_screen 'left at 110 %'
keys s
check "s stops, and that is no failure" until_screen '^status 0'
check "how it went is told" until_screen 'frames, .* late'
check "the terminal is as it was" until_screen ' icanon'

# Ten minutes, of which one is left.
for i in $(seq 0 60); do
    echo "$((1000 + i * 9900))  0 0 200 0 -$((i * 5)) -200 0 200 0 200 0 -400 -200 0 0 -200 0 400" \
        "200 0"
done >"$work/longer.m"
type_line "'$GRCTL' -d '$robot' --retries 10 play --speed 995 '$work/longer.m'; echo status \$?"
until_screen 'left at 995 %'
test_case "no key makes a motion faster than the most"
keys +
check "plus goes to the most" until_screen 'left at 1000 %'
keys +
keys -- -
check "and not beyond" until_screen 'left at 990 %'
keys s
until_screen '^status 0'

type_line "$play"
until_screen 'playing'
keys C-c
test_case "Ctrl-C is a signal still"
check "Ctrl-C is a signal still" until_screen 'status 130'
check "the terminal is as it was then too" until_screen ' icanon'

type_line "$play"
until_screen 'playing'
keys e
test_case "e is the emergency stop"
check "e is the emergency stop" until_screen 'play: emergency stop; .*estop --reset'
check "that is its status" until_screen '^status 4'
no_idle() {
    ! on_screen_is ' 0\.0 of .* s, '
}
check "how far it had come stays there" no_idle
check "it is braked" both exits 0 on_robot status m5 --- says ' brake '
check "other commands know" fails 4 "stopped by 'grctl estop'" on_robot init
check "until it is taken back" exits 0 on_robot estop --reset
on_screen kill-server
stop_sim
done_testing
