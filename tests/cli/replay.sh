#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl replay: traces run again on the simulator.
. tests/support/cli.sh
. tests/support/traces.sh

# same COUNT COMMAND...: the command's trace is replayed to the same replies, COUNT of them.
# A reply that comes too late while it is recorded, on a busy machine, is one more when replayed:
# recorded once more then.
same() {
    same_count=$1
    shift
    for _ in 1 2 3; do
        "$GRCTL" -q -d sim --timeout 5000 --trace "$work/trace" "$@" >"$work/out" 2>"$work/err" ||
            return 1
        exits 0 "$GRCTL" replay "$work/trace" &&
            says " $same_count equal, 0 differ, 0 missing, 0 extra" && return
        rm "$work/trace"
        grep -q ' 0 differ, 0 missing, [1-9][0-9]* extra' "$work/out" || break
    done
    return 1
}
test_case 'the simulator replies as it did'
check 'status' same 21 status
check 'a move' same '[1-9][0-9]*' move R_KNEE_P -80 200
check 'a motion' same '[1-9][0-9]*' play motions/greet.pseq
check 'servos on a bus' same 21 --wiring bus status
check 'another baud rate' same 21 -b 57600 status
check 'everything again, in less time than it took' \
    timeout 2 "$GRCTL" -q replay "$work/trace"

test_case 'robots of other families'

# same_of SERVO FAMILY [ID]: a robot of two such servos moves, and its trace is replayed.
same_of() {
    printf '%s\n' "name: two" "family: $2" joints: \
        "  - {name: a, id: ${3:-1}, servo: $1, limits_deg: [-50, 50]}" \
        "  - {name: b, id: $((${3:-1} + 1)), servo: $1, limits_deg: [-50, 50]}" >"$work/two.yaml"
    (
        export GRCTL_ROBOT="$work/two.yaml"
        same '[1-9][0-9]*' move b 3 200
    )
}
check 'Feetech' same_of STS3215 feetech
check 'Feetech SCS' same_of SCS0009 feetech
check 'AX-12' same_of AX-12A dynamixel1
check 'LX-16A' same_of LX-16A lx16a
check 'KRS' same_of KRS-3301 ics 0
check 'RS30x on a bus: not those of GR001' same_of RS301CR rs30x
of_servos() {
    GRCTL_ROBOT="$work/two.yaml" exits 2 "$GRCTL" -d tcp:127.0.0.1:1 replay "$work/trace"
}
printf '%s\n' 'name: two' 'family: feetech' joints: \
    '  - {name: a, id: 1, servo: STS3215, limits_deg: [-50, 50]}' >"$work/two.yaml"
check 'not to a real robot: its frames are not judged' both of_servos --- \
    complains 'cannot judge the frames of two before they move a real robot; without -d'

test_case 'what differs'

READ1='54 09 FA AF 01 0F 2A 02 00 26 0A' # position of servo 1, which is 0.0 deg
READ3='54 09 FA AF 03 0F 2A 02 00 24 0A' # of servo 3, 20.0 deg
make_trace >"$work/others" <<LINES
out 0 41 00
in 1000 07
out 10000 $READ1
in 15000 FD DF 01 00 2A 02 01 F6 FF 21
out 20000 $READ3
in 25000 FD DF 03 00 2A 02 01 C8 00 E2
out 30000 54 09 FA AF 63 0F 2A 02 00 44 0A
in 35000 FD DF 63 00 2A 02 01 00 00 4A
out 40000 54 09 FA AF 02 0F 2A 02 00 25 0A
out 60000 54 09 FA AF 64 0F 2A 02 00 43 0A
in 90000 12 34 FD DF 63 00 2A 02 01 00 00 4A
LINES
cat >"$work/expected" <<'TEXT'
request 2 at 10.000 ms: differ
    asked     relay 8, return 10: read No.42-43 of servo 1 (CHEST_P); sum 26 right; reply: 10 bytes
    recorded  servo 1 (CHEST_P) returns No.42-43: position -1.0 deg; sum 21 right
    replayed  servo 1 (CHEST_P) returns No.42-43: position 0.0 deg; sum 28 right
request 4 at 30.000 ms: missing
    asked     relay 8, return 10: read No.42-43 of servo 99; sum 44 right; reply: 10 bytes
    recorded  servo 99 returns No.42-43: position 0.0 deg; sum 4A right
    replayed  nothing
request 5 at 40.000 ms: extra
    asked     relay 8, return 10: read No.42-43 of servo 2 (NECK_Y); sum 25 right; reply: 10 bytes
    recorded  nothing
    replayed  servo 2 (NECK_Y) returns No.42-43: position 0.0 deg; sum 2B right
6 frames sent, 6 call for a reply: 2 equal, 1 differ, 1 missing, 1 extra, 1 silent both times
recorded: 1 replies nobody asked for, 2 bytes that are no reply
TEXT
differs() {
    exits 1 "$GRCTL" replay "$work/others" && diff "$work/expected" "$work/out"
}
check 'what differs, is missing, is extra' differs
check_json_of_others() {
    exits 1 "$GRCTL" replay --json "$work/others" && json '
        [l["verdict"] for l in lines[:3]] == ["differ", "missing", "extra"] and
        lines[0]["recorded"]["packet"]["servos"][0]["registers"]["position_deg"] == -1.0 and
        lines[1]["replayed"] is None and lines[3]["ok"] is False and lines[3]["equal"] == 2 and
        lines[3]["strays"] == {"recorded": 1, "replayed": 0} and
        lines[3]["rubbish_bytes"] == {"recorded": 2, "replayed": 0}'
}
if have_json; then
    check 'the same as JSON' check_json_of_others
else
    skip 'the same as JSON' 'no python3 to parse JSON with'
fi

many_differ() {
    for at in 1 2 3 4 5 6 7; do
        echo "out ${at}0000 $READ1"
        echo "in ${at}5000 FD DF 01 00 2A 02 01 F6 FF 21"
    done | make_trace >"$work/many"
    exits 1 "$GRCTL" replay "$work/many" && [ "$(grep -c differ$ "$work/out")" -eq 5 ] &&
        exits 1 "$GRCTL" replay -v "$work/many" && [ "$(grep -c differ$ "$work/out")" -eq 7 ]
}
check 'the first five differences, with -v all' many_differ

test_case 'bad files'

check 'no such file' fails 3 'none: no such file$' "$GRCTL" replay "$work/none"
years() {
    printf 'out 0 FA AF 01 00 00 01 00 00\nout 3000000000000 FA AF 01 00 00 01 00 00\n' |
        make_trace >"$work/years" && [ -s "$work/years" ]
}
check 'a clock that jumped is not waited for' both years --- \
    fails 3 'a trace of more than a day is not replayed' "$GRCTL" replay "$work/years"
check 'no trace' fails 3 'is not a pcapng file' "$GRCTL" replay tests/cli/replay.sh
make_trace </dev/null >"$work/empty"
check 'nothing in it' fails 3 'nothing went over the line' "$GRCTL" replay "$work/empty"
head -c 199 "$work/others" >"$work/cut"
check 'cut off' fails 3 'cut off in the middle of a block' "$GRCTL" replay "$work/cut"
check 'standard input' fails 2 'name a file' "$GRCTL" replay -
done_testing
