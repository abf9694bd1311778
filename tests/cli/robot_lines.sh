#!/bin/sh
# SPDX-License-Identifier: MIT
# Commands on a line that is lost or not there, on servos without a board, and where an
# adapter returns what is sent.
. tests/support/cli.sh

start_sim || { echo "Bail out! the simulator did not start"; exit 1; }
# Between two rounds nothing is asked that could fail.
"$GRCTL" -d "$robot" --timeout 500 status --watch --interval 3600000 m5 \
    >"$work/watched" 2>"$work/err" &
watch_pid=$!
written "$work/watched" R_ELBOW_P
stop_sim
wait $watch_pid
watched=$?
lost() {
    [ $watched -eq 1 ] && grep -q '^grctl: .*: device is gone while busy with status$' "$work/err"
}
test_case "a line that is lost or not there"
check "status --watch tells of a line that is lost" lost
check "no such device" fails 1 'nowhere: no such file or device' "$GRCTL" -d "$work/nowhere" status
check "a directory" fails 1 'is a directory' "$GRCTL" -d "$work" status
: >"$work/file"
check "a file" fails 1 'is not a serial port' "$GRCTL" -d "$work/file" status
check "nobody listens" fails 1 'tcp:127.0.0.1:1: ' "$GRCTL" -d tcp:127.0.0.1:1 status

start_sim --wiring bus
test_case "servos straight on a bus"
check "somebody else on the port: servos without a board" \
    fails 1 'no robot answers; is the robot switched on' on_robot status
check "with the right wiring they answer" both exits 0 on_robot --wiring bus status m3 --- \
    says R_SHOULDER_P
check "and there is no echo" fails 1 '' \
    "$GRCTL" -d "$robot" --timeout 200 --wiring bus --echo status m3

# Torque on and R_KNEE_P to -100 degrees in 3 s: frames of another program.
moved_by_another() {
    printf '\372\257\014\000\044\001\001\001\051' >"$sim_pty"
    printf '\372\257\014\000\036\004\001\030\374\054\001\336' >"$sim_pty"
    fails 1 '(R_KNEE_P) moves, and not by this program' on_robot --wiring bus move m12 -40
}
test_case "what another program left moving is seen"
check "a joint that another program has sent" moved_by_another
check "and that stood when this one left" exits 0 on_robot --wiring bus move m12 -40
stop_sim

# Motor 7: its id in what comes back could be taken for an ACK.
start_sim --wiring bus --echo
test_case "an adapter that returns what is sent"
check "an adapter that returns what is sent" both \
    exits 0 on_robot --wiring bus --echo status m3 m7 --- says L_SHOULDER_R
check "an ACK behind the echo of one" exits 0 on_robot --wiring bus --echo servo-set 7 delay 1
check "a motion" exits 0 on_robot --wiring bus --echo init --time 200
stop_sim
check "and so in process" exits 0 "$GRCTL" -d sim --wiring bus --echo status m7
check "through a board there is none" fails 2 'echo needs --wiring bus' \
    "$GRCTL" -d sim --echo status
# A name of 13 letters shifts no column of its row.
aligned() {
    exits 0 "$GRCTL" --robot koch -d sim status && awk '
        NR == 1 { end = index($0, "temp") + 3 }
        NR > 1 && (substr($0, end, 1) !~ /[0-9]/ || substr($0, end + 1, 1) != " ") { exit 1 }' \
        "$work/out"
}
check "columns of status stand below each other" aligned
check "a voltage that all servos have is told once" both exits 0 \
    "$GRCTL" --robot pan-tilt -d sim doctor --- says '^ok    voltage     7.40 V at the servos$'
done_testing
