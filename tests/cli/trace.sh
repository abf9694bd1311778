#!/bin/sh
# SPDX-License-Identifier: MIT
# --trace FILE: every byte of a command's line, read back by grctl decode.
. tests/support/cli.sh
. tests/support/traces.sh

# frames FILE TEXT: how many frames of it say that.
frames() {
    "$GRCTL" decode -q "$1" | grep -c -- "$2"
}

# A busy machine may make the host ask again.
status_is_traced() {
    "$GRCTL" -d sim --timeout 5000 --trace "$work/status" status >/dev/null || return 1
    [ "$(frames "$work/status" ' host .*check the board; reply: ACK')" -ge 1 ] &&
        [ "$(frames "$work/status" ' robot .*ACK; .* ms after its request')" -ge 1 ] &&
        [ "$(frames "$work/status" ' host .*read No.30-53 of servo')" -ge 20 ] &&
        [ "$(frames "$work/status" ' robot .*returns No.30-53: .* its request')" -ge 20 ] &&
        [ "$(frames "$work/status" 'rubbish\|cut\|wrong\|nobody')" -eq 0 ]
}
test_that 'status: twenty questions, twenty answers' status_is_traced

says_what_it_is() {
    "$GRCTL" decode --json "$work/status" | head -n 1 >"$work/head"
    cat "$work/head"
    year=$(date -u +%Y)
    grep -q '^{"trace":{"comment":"grctl status","device":"sim",' "$work/head" &&
        grep -q '"line":"GR001 through its board","baud_bps":115200,"started":"'"$year" \
            "$work/head"
}
check 'the trace says what it is of, and when' says_what_it_is

torque_on_is_traced() {
    "$GRCTL" -d sim --wiring bus --trace "$work/bus" servo on R_KNEE_P 2>/dev/null || return 1
    "$GRCTL" decode --json "$work/bus" | grep -q '"line":"servos on a bus"' &&
        [ "$(frames "$work/bus" 'write servo 12 (R_KNEE_P): torque on\|torque; sum')" -ge 1 ] &&
        [ "$(frames "$work/bus" 'relay\|rubbish\|cut\|wrong')" -eq 0 ]
}
test_that 'servos straight on a bus' torque_on_is_traced

start_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# refused FILE COMPLAINT: exit 3 with one line, and nothing was asked of the robot.
refused() {
    fails 3 "$2" "$GRCTL" -d "$robot" --timeout 500 --trace "$1" servo on || return 1
    "$GRCTL" -d "$robot" --timeout 500 status >"$work/out" || return 1
    ! says ' on ' >/dev/null && says ' off '
}
test_that 'no such folder: nothing is done' refused "$work/none/trace" 'no such folder$'
test_that 'a folder: nothing is done' refused "$work" ': is a directory$'
# So would one for whom --trace needs no FILE.
no_trace() {
    cp motions/sit.pseq "$work/mine.pseq"
    refused "$work/mine.pseq" 'it is no trace; name another file$' &&
        fails 3 'it is no trace' "$GRCTL" play --dry-run --trace "$work/mine.pseq" \
            motions/greet.pseq && cmp motions/sit.pseq "$work/mine.pseq"
}
test_that 'a file that is no trace: it stays, and nothing is done' no_trace
test_case 'a full disk: nothing is done'
if [ -c /dev/full ]; then
    check 'a full disk: nothing is done' refused /dev/full 'no room left on the disk$'
else
    skip 'a full disk: nothing is done' 'no /dev/full here'
fi

a_watcher_goes() {
    mkfifo "$work/pipe" || return 1
    head -c 400 <"$work/pipe" >"$work/some" &
    "$GRCTL" -d sim --timeout 500 --trace "$work/pipe" status >"$work/out" 2>"$work/err"
    status=$?
    wait $!
    [ $status -eq 3 ] && complains 'the trace cannot be written: Broken pipe' &&
        [ "$(wc -l <"$work/out")" -eq 21 ]
}
test_that 'a trace that breaks off: the command is done, and it is told' a_watcher_goes

over_a_pty() {
    "$GRCTL" -d "$robot" --timeout 500 --trace "$work/pty" status >/dev/null || return 1
    "$GRCTL" decode --json "$work/pty" | grep -qF '"device":"'"$robot"'"' &&
        [ "$(frames "$work/pty" 'returns No.30-53')" -ge 20 ]
}
test_that 'a robot behind a port' over_a_pty

# The goal of the long move stands in the trace.
is_moving() {
    "$GRCTL" decode -q "$work/ended" 2>/dev/null | grep -q 'goal_time 60000 ms'
}

# The file has no fault; the last reply on the line may be cut off (status 3), since joints are read
# while they move.
is_whole() {
    "$GRCTL" decode -q "$work/ended" >"$work/text" 2>"$work/err"
    whole_status=$?
    cat "$work/err"
    [ ! -s "$work/err" ] && { [ $whole_status -eq 0 ] || [ $whole_status -eq 3 ]; }
}

# interrupted SIGNAL: a long move is ended by a signal; what is left of its trace in $work/ended.
interrupted() {
    rm -f "$work/ended"
    "$GRCTL" -d "$robot" --timeout 500 --trace "$work/ended" init --time 60000 2>/dev/null &
    mover=$!
    wait_for is_moving
    kill -s "$1" $mover
    wait $mover 2>/dev/null
}

ends_by_a_signal() {
    interrupted "$1"
    status=$?
    echo "status $status"
    [ $status -eq "$2" ] && is_whole &&
        grep -q 'write 20 servos: goal, goal_time; sum .. right' "$work/text"
}
test_that 'Ctrl-C: the trace is whole' ends_by_a_signal INT 130
test_that 'SIGTERM: the trace is whole' ends_by_a_signal TERM 143

killed() {
    interrupted KILL
    is_whole && grep -q 'goal_time 60000 ms' "$work/text"
}
test_that 'killed: the trace is whole up to then' killed

sim_is_traced() {
    stop_sim
    start_sim --trace "$work/sim" || return 1
    "$GRCTL" -d "$robot" --timeout 500 --trace "$work/host" status m12 >/dev/null || return 1
    stop_sim
    for side in host sim; do
        "$GRCTL" decode -q "$work/$side" |
            sed 's/^ *[0-9.]*//; s/; [0-9.]* ms after.*//' >"$work/$side.text"
    done
    [ -s "$work/sim.text" ] && diff "$work/host.text" "$work/sim.text"
}
test_that 'sim --trace: what the host sees' sim_is_traced

dry_run() {
    "$GRCTL" play --dry-run --trace "$work/dry" motions/greet.pseq >"$work/out" || return 1
    [ "$(frames "$work/dry" 'write 20 servos: goal, goal_time')" -ge "$(wc -l <"$work/out")" ] ||
        return 1
    "$GRCTL" replay "$work/dry" >"$work/out"
    says ' equal, 0 differ, 0 missing' # it may end between a question and its answer
}
test_that 'play --dry-run --trace: all that would go over the line' dry_run
test_that 'a command that talks to no robot says so' both exits 0 "$GRCTL" --trace "$work/not" \
    decode 4100 --- both complains 'nothing was traced' --- test ! -e "$work/not"

cut_trace() {
    head -c 1001 "$work/status" >"$work/cut"
    "$GRCTL" decode -q "$work/cut" >"$work/text" 2>"$work/err"
    status=$?
    cat "$work/err"
    [ $status -eq 3 ] && grep -q 'check the board' "$work/text" &&
        grep -q "^grctl: $work/cut: cut off in the .* of a block (byte 1001)\$" "$work/err"
}
test_that 'a trace cut off: all before it is shown, exit 3' cut_trace

hand_made() {
    make_trace >"$work/made" <<'LINES'
out 1000 41
out 1500 00 53 0C FA AF
in 1700 07
out 2000 03 00 1E 04 01 84 03 0A 00 95
in 3000 FD DF 01
out 900000 41 00
in 901000 99
LINES
    cat >"$work/expected" <<'TEXT'
     0.000  host     check the board; reply: ACK
     0.700  robot    ACK; 0.700 ms after its request
     0.500  host     relay 12: write servo 3 (R_SHOULDER_P): goal 90.0 deg, goal_time 100 ms;
     2.000  robot    cut off: FD DF 01
   899.000  host     check the board; reply: ACK
   900.000  robot    rubbish: 99
TEXT
    "$GRCTL" decode -q "$work/made" | sed 's/ sum 95 right; no reply//' |
        diff "$work/expected" -
}
test_that 'frames split over chunks, rubbish, a reply that never ends' hand_made
# The blocks of the guide marked sh are run, line by line. Status 1 of replay is fine: on a busy
# machine a servo may say that its motion has lasted for another step of 10 ms.
guide() {
    mkdir "$work/guide" "$work/bin" && ln -s "$(realpath "$GRCTL")" "$work/bin/grctl" || return 1
    ln -s "$PWD/motions" "$work/guide/motions"
    awk '/^```/ { open = $0 == "```sh"; next }
        open { print $0 (/^grctl replay/ ? " || [ $? -eq 1 ]" : "") }
        ' docs/guide/trace.md >"$work/guide.sh"
    [ "$(wc -l <"$work/guide.sh")" -ge 7 ] || return 1
    (cd "$work/guide" && PATH=$work/bin:$PATH sh -eux "$work/guide.sh" >"$work/guide.out" 2>&1) &&
        grep -q '^[1-9][0-9]* frames sent, .* 0 missing, 0 extra' "$work/guide.out" && return
    tail -n 20 "$work/guide.out"
    return 1
}
test_that "the guide's commands" guide
done_testing
