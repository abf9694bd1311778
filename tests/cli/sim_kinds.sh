#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl sim: a robot for other programs, as it was asked for.
. tests/support/cli.sh
own_sim

test_case "what it is"

start_sim --start zero
check "--start zero" both exits 0 on_robot status m12 --- says 'R_KNEE_P  *0\.0 '
stop_sim
limp() {
    start_sim --start limp --seed "$1" && on_robot status | cut -c 1-26 >"$work/limp$2"
    stop_sim
}
limp 7 a && limp 7 b && limp 8 c
check "--start limp: the seed tells where" cmp "$work/limpa" "$work/limpb"
check "another seed, elsewhere" eval '! cmp -s "$work/limpa" "$work/limpc"'
start_sim --start limp --seed 7
check_json "init from anywhere: all there" \
    'lines[0]["max_error_deg"] <= 0.1 and len(lines[0]["joints"]) == 20' \
    on_robot --json init
stop_sim
start_sim --no-pacing
check "--no-pacing" exits 0 on_robot status
stop_sim
start_sim --wiring bus -b 460800
check "a bus at another rate" both \
    exits 0 "$GRCTL" -d "$robot" --timeout 60 --wiring bus -b 460800 status m3 --- says R_SHOULDER_P
stop_sim
start_sim --fault drop=0.002,flip=0.002,delay=0.01 --seed 3
check "a poor line is made up for" exits 0 "$GRCTL" -d "$robot" --timeout 500 --retries 10 \
    play --speed 500 motions/greet.pseq
stop_sim

test_case "any chain of servos"

start_sim --servo 1=RS304MD,127=rs302cd,3=RS303MR,4=RS301CR
for id_type in 1=RS304MD 127=RS302CD 3=RS303MR 4=RS301CR; do
    check "--servo: $id_type, on a bus" both \
        exits 0 "$GRCTL" -d "$robot" --timeout 60 --wiring bus servo-get "${id_type%=*}" model --- \
        says "${id_type#*=}"
done
check "their registers are there" both \
    exits 0 "$GRCTL" -d "$robot" --timeout 60 --wiring bus servo-set 127 delay 2 --- \
    exits 0 "$GRCTL" -d "$robot" --timeout 60 --wiring bus servo-get 127 delay
check "and keep what is written" says '200 us'
stop_sim
start_sim --servo 5=RS304MD -b 460800
check "--servo at another rate" both exits 0 "$GRCTL" -d "$robot" --timeout 60 --wiring bus \
    -b 460800 \
    servo-get 5 model --- says RS304MD
stop_sim
for wrong in 1=RS999 0=RS301CR 128=RS301CR 1=RS301CR,1=RS302CD 1 1= =RS301CR "1=RS301CR," \
    x=RS301CR; do
    check "--servo '$wrong'" fails 2 '^grctl: sim: --servo: ' timeout 5 "$GRCTL" sim \
        --servo "$wrong"
done
check "an unknown type: the known ones are named" fails 2 \
    "'1=RS204MD': unknown type; did you mean RS304MD? 'grctl robot servos' lists all" \
    timeout 5 "$GRCTL" sim --servo 1=RS204MD
check "help names them too" both exits 0 "$GRCTL" help sim --- says 'RS301CR, XL330-M288'
others() {
    printf 'turn m2 45\nid m1 200\nlook\nquit\n' |
        timeout 20 "$GRCTL" sim --servo 1=XL330-M288,2=sts3215 >"$work/out" 2>&1
}
check "servos of other families" both others --- says 'SERVO_2  *45\.0 deg'
for wrong in "--state $work/other.state" '--wiring board'; do
    # shellcheck disable=SC2086
    check "$wrong is for RS30x" fails 2 "^grctl: sim: ${wrong%% "$work"*}: " \
        timeout 5 "$GRCTL" sim --servo 1=STS3215 $wrong
done
# The knee's stop is at 0: a hand turns it beyond only without stops.
turned() {
    printf 'turn m12 45\nlook m12\nquit\n' | timeout 20 "$GRCTL" sim "$@" >"$work/out" 2>&1
}
check "a stop" both turned --- says 'R_KNEE_P  *0\.0 deg'
check "--no-stops" both turned --no-stops --- says 'R_KNEE_P  *45\.0 deg'
named() {
    printf 'look SERVO_7\nlook m7\nquit\n' |
        timeout 20 "$GRCTL" sim --servo 7=RS301CR >"$work/out" 2>&1
    [ "$(grep -c '^  7  SERVO_7 ' "$work/out")" = 2 ]
}
check "the console names servos of a chain" named

check "a fault that is none" fails 2 "'gremlin=1' is not a list" timeout 5 "$GRCTL" sim \
    --fault gremlin=1
check "a rate above 1" fails 2 "is not a list" timeout 5 "$GRCTL" sim --fault drop=2
check "a start that is none" fails 2 '(init|zero|limp)' timeout 5 "$GRCTL" sim --start high
check "too many robots" fails 2 'from 1 to 16' timeout 5 "$GRCTL" sim --robots 17
done_testing
