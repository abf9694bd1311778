#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl first-contact: what is assumed of a robot, tested on simulated ones of every family.
. tests/support/cli.sh
unset GRCTL_ROBOT
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}
# contact STATUS ANSWERS PREFIX ARGUMENTS...: lines of standard input, \n between them.
contact() {
    contact_want=$1
    printf '%b' "$2" >"$work/answers"
    contact_out=$work/$3
    shift 3
    "$GRCTL" "$@" first-contact --yes -o "$contact_out" \
        <"$work/answers" >"$work/out" 2>"$work/err"
    status_was "$contact_want" "$@"
}
# calmly ANSWERS PREFIX ...: nothing is otherwise than assumed. Half of the replies may be late on a
# machine that is busy: once more then.
calmly() {
    for _ in 1 2 3 4 5 6; do
        contact 0 "$@" >"$work/why" && return
        grep -q '^NOT as assumed  *\(latency\|line\) ' "$work/err" || break
        rm -f "$work/$2"[-.]*
    done
    cat "$work/why" "$work/err"
    return 1
}
# Where each family is assumed to answer: at once at the new rate, RS30x when they restart.
rates_of() {
    there='set to \([0-9]*\) bps, answers at \1, and again at'
    here='set to [0-9]* bps, answers at 115200, and again at 115200$'
    case $1 in
    rs30x)
        grep -q "^as assumed  *rate  .*$here" "$2" &&
            grep -q "^as assumed  *rate_restart  .*$there 115200$" "$2"
        ;;
    lx16a) grep -q '^not done  *rate  .*one rate$' "$2" ;;
    dynamixel2) grep -q "^as assumed  *rate  .*$there 57600$" "$2" ;;
    ics) grep -q "^as assumed  *rate  .*$there 115200$" "$2" ;;
    *) grep -q "^as assumed  *rate  .*$there 1000000$" "$2" ;;
    esac || { cat "$2"; return 1; }
}
describe() {
    printf 'name: t\nfamily: %s\njoints:\n' "$1"
    printf '  - {name: turn, id: 1, servo: %s, limits_deg: [-90, 90]}\n' "$2"
    printf '  - {name: lift, id: 2, servo: %s, limits_deg: [-20, 60], init_deg: 59}\n' "$2"
}

test_case "nobody to ask"
check "nobody to ask" fails 2 "asks a person at a terminal" "$GRCTL" -d sim first-contact

families='feetech:STS3215 feetech:SCS0009 dynamixel2:XL430-W250 dynamixel1:AX-12A rs30x:RS302CD
    lx16a:LX-16A ics:KRS-3301'
here=$work
# contact_of FAMILY:SERVO: what it found is in a folder of that servo's name. They wait most of the
# time, and do so beside each other.
contact_of() (
    work=$here/${1#*:}
    mkdir "$work"
    sim_place="--link $work/robot"
    sim_pid=
    trap stop_sim EXIT
    describe "${1%:*}" "${1#*:}" >"$work/arm.yaml"
    start_sim --robot "$work/arm.yaml" && calmly 'y\ny\nyes\ny\ny\n' found \
        --robot "$work/arm.yaml" -d "$robot" --timeout 500 && : >"$work/ended"
    "$GRCTL" --robot "$work/arm.yaml" -d "$robot" --timeout 500 status >"$work/after"
)
to_the_end() {
    [ -e "$1/ended" ] && return
    cat "$1.log"
    return 1
}
for one in $families; do
    contact_of "$one" >"$here/${one#*:}.log" 2>&1 &
done
wait
for one in $families; do
    found=$here/${one#*:}
    test_case "$one, to the end"
    check "$one, to the end" to_the_end "$found"
    check "takes another rate and comes back" rates_of "${one%:*}" "$found/found.txt"
    check "turns back where its limit is near" \
        grep -q '^as assumed  *move .* by -2 deg to 5[67]\.' "$found/found.txt"
    check "and is as it was found" \
        grep -q '^ *2  lift  *\(58.[89]\|59.[01]\) .* off ' "$found/after"
done

start_sim
test_case "GR001's board is read without a yes"
check "without a yes it reads only" calmly '\n' shy -d "$robot" --timeout 500
check "a board that stores and forwards" said '^as assumed  *board .*stores a frame'
check "all servos" said '^as assumed  *ping .*20 of 20 servos answer'
check "the rest is not done" \
    [ "$(grep -c '^not done  *\(torque_on\|move\) ' "$work/shy.txt")" -eq 2 ]
traced() { # on a busy machine a reply may be cut
    "$GRCTL" decode "$work/shy-read.pcapng" 2>/dev/null | grep -q 'servo 8 (L_ELBOW_P) returns'
}
check "there is a trace of the reading" traced
check "and of nothing else" [ ! -e "$work/shy-move.pcapng" ]
check "a report is not written over" contact 2 '\n' shy -d "$robot"
if have_json; then
    check_json "the report as JSON" \
        'lines[0]["robot"] == "gr001" and len(lines[0]["servos"]) == 20 and
        lines[0]["servos"][3]["registers"]["id"] == 12 and lines[0]["not_as_assumed"] == 0 and
        {s["name"] for s in lines[0]["steps"]} > {"ping", "models", "latency", "board", "echo"}' \
        on_robot --json first-contact --yes -o "$work/told"
fi
stop_sim

start_sim --latency 20
test_case "late replies and echoes are told"
check "late replies are told" contact 1 '' late -d "$robot" --timeout 500
check "as what they are" said '^NOT as assumed  *latency '
stop_sim
start_sim --wiring bus --echo
check "an echo that nobody expected" contact 1 '' echo --wiring bus -d "$robot" --timeout 500
check "is told" said '^NOT as assumed  *echo .*--echo'
stop_sim
start_sim --robot so101 --echo
check "one that looks like replies" contact 1 '' alike --robot so101 -d "$robot" --timeout 500
check "is told, too" said '^NOT as assumed  *echo .*--echo'
stop_sim
start_told_sim --robot so101
tell cable 3 out
test_case "a servo that is silent, and an end while it moves"
check "a servo that is silent" contact 1 '' silent --robot so101 -d "$robot"
check "is told too" said '^NOT as assumed  *ping .*5 of 6'
tell cable 3 in

# Ended while the joint has torque: the exit policy, and the report of what was found until then.
cut_short() {
    printf 'y\ny\n' >"$work/answers"
    "$GRCTL" --robot so101 -d "$robot" --timeout 500 first-contact --yes -o "$work/short" \
        elbow_flex <"$work/answers" >"$work/out" 2>"$work/err" &
    cut_pid=$!
    wait_for [ -s "$work/short-move.pcapng" ] && wait_for sim_shows elbow_flex 'torque on'
    kill -TERM $cut_pid
    wait $cut_pid
    cut_got=$?
    [ $cut_got -eq 143 ] && return
    echo "status $cut_got"
    cat "$work/err"
    return 1
}
check "ended while it moves" cut_short
check "has a report all the same" grep -q 'torque_on' "$work/short.txt"
check "and holds" both exits 0 "$GRCTL" --robot so101 -d "$robot" --timeout 500 status elbow_flex \
    --- says '^ *3 .* on '
stop_sim

# Ctrl-C at a question, which is heard though a shell has it ignored by what it starts behind it;
# nothing is asked any more, and there is a report.
ctrl_c_at_a_question() {
    : >"$work/err"
    mkfifo "$work/fifo"
    "$GRCTL" --robot so101 -d sim first-contact --yes -o "$work/asked" <"$work/fifo" \
        >"$work/out" 2>"$work/err" &
    asked_pid=$!
    exec 7>"$work/fifo"
    written "$work/err" 'Switch the torque' && kill -INT $asked_pid
    wait_for gone $asked_pid || kill -KILL $asked_pid
    exec 7>&-
    wait $asked_pid
    status_was 130 first-contact && [ "$(grep -c '\[n\]' "$work/err")" -eq 1 ]
}
gone() {
    ! kill -0 "$1" 2>/dev/null
}
test_case "Ctrl-C at a question ends it"
check "Ctrl-C at a question ends it" ctrl_c_at_a_question
check "with a report" grep -q '^not done  *move ' "$work/asked.txt"

describe rs30x RS302CD >"$work/arm.yaml"
start_sim --robot "$work/arm.yaml" --baud-at-once
test_case "a rate that holds at once"
check "a rate that holds at once" contact 1 'n\ny\nn\n' at_once --robot "$work/arm.yaml" \
    -d "$robot" --timeout 500
check "is told" said '^NOT as assumed  *rate  .* 76800 bps, answers at 76800, and again at 115200'
check "behind it a restart, when it is wanted" said '^not done  *rate_restart '
stop_sim

# A flash write and a restart take 1.5 s each way: what comes when its trace begins comes between.
start_told_sim --robot "$work/arm.yaml"
restarting() {
    printf 'n\nn\ny\n' >"$work/answers"
    rm -f "$work/restart"[-.]*
    "$GRCTL" --robot "$work/arm.yaml" -d "$robot" --timeout 500 first-contact --yes \
        -o "$work/restart" <"$work/answers" >"$work/out" 2>"$work/err" &
    restart_pid=$!
    wait_for in_flash
}
in_flash() {
    "$GRCTL" --robot "$work/arm.yaml" decode "$work/restart-rate_restart.pcapng" 2>/dev/null |
        grep -q flash
}
ended_in_flash() {
    restarting
    kill -TERM $restart_pid
    wait $restart_pid
    status_was 143 first-contact
}
test_case "ended while the rate is another one"
check "ended while the rate is another one" ended_in_flash
check "it is back first" both grep -q 'rate_restart .* again at 115200$' "$work/restart.txt" --- \
    both exits 0 "$GRCTL" --robot "$work/arm.yaml" -d "$robot" --timeout 500 servo-get 2 baud --- \
    says ' 115200 bps$'
lost_in_flash() {
    restarting
    tell cable 2 out
    wait $restart_pid
    status_was 1 first-contact
}
test_case "a robot that is lost at another rate"
check "one that is lost meanwhile" lost_in_flash
check "is told" said '^NOT as assumed  *rate_restart .* not back at 115200 bps'
check "and how it is found again" \
    [ "$(grep -c '^if the servo is lost: .* --all-baud --first 2 --last 2' "$work/err")" -eq 3 ]
tell cable 2 in
check "there it is" both wait_for exits 0 "$GRCTL" --robot "$work/arm.yaml" -d "$robot" \
    scan --all-baud --first 2 --last 2 --- says '^ *2 '
stop_sim
done_testing
