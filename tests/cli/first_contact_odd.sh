#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl first-contact where something is otherwise than assumed, and where it is ended early.
. tests/support/cli.sh
. tests/support/first_contact.sh

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
check "a servo that is silent" contact 1 '' silent --robot so101 -d "$robot" \
    --timeout 500
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
done_testing
