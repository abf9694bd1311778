#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl decode: hex and text in, words and JSON out. (Traces: tests/cli/trace.sh.)
. tests/support/cli.sh

# A line that ends in a backslash goes on in the next, behind its blanks.
joined() {
    sed -e ':again' -e '/\\$/{' -e N -e 's/\\\n *//' -e 'b again' -e '}'
}

# prints STATUS ARGUMENTS... <<TEXT: exactly that on standard output, and the status.
prints() {
    printed_status=$1
    shift
    joined >"$work/expected"
    exits "$printed_status" "$GRCTL" decode "$@" || return 1
    diff "$work/expected" "$work/out"
}
decodes() {
    prints 0 "$@"
}
# faulty ARGUMENTS...: as decodes, and a sum was wrong or a frame cut off.
faulty() {
    prints 3 "$@"
}

# reads FILE <<TEXT: the same of a file that is given on standard input.
reads() {
    joined >"$work/expected"
    "$GRCTL" decode <"$1" >"$work/got" 2>"$work/err" || return 1
    diff "$work/expected" "$work/got"
}

# refuses STATUS COMPLAINT ARGUMENTS...: that status, one line with that in it.
refuses() {
    refuses_status=$1
    refuses_complaint=$2
    shift 2
    fails "$refuses_status" "$refuses_complaint" "$GRCTL" decode "$@"
}

test_case 'other families'

check 'DYNAMIXEL 2.0: which registers a reply brings, its request says' \
    decodes --family dynamixel2 \
    FFFFFD000107000284000400 1D15 FFFFFD000108005500A60000008CC0 <<'TEXT'
read present_position of servo 1; CRC 151D right; reply: 15 bytes
servo 1 returns present_position -165.4 deg; CRC C08C right
TEXT
check 'without it, in bytes' decodes --family dynamixel2 FFFFFD000108005500A60000008CC0 <<'TEXT'
servo 1 returns 4 bytes A6 00 00 00; CRC C08C right
TEXT
check 'a ping tells the model, whose registers are told from then on' decodes --family dynamixel2 \
    FFFFFD0001030001194E FFFFFD00010700550006042665 5D FFFFFD00010700027E0002003549 <<'TEXT'
ping servo 1; CRC 4E19 right; reply: 14 bytes
servo 1 returns model XM430-W210, firmware 38; CRC 5D65 right
read present_current of servo 1; CRC 4935 right; reply: 13 bytes
TEXT
check 'a servo a line' decodes --family dynamixel2 \
    FFFFFD00FE130083400001000100020003000400050006 0056FD <<'TEXT'
sync write 6 servos: torque; CRC FD56 right; no reply
    servo 1: torque off
    servo 2: torque off
    servo 3: torque off
    servo 4: torque off
    servo 5: torque off
    servo 6: torque off
TEXT
check 'a wrong CRC' faulty --family dynamixel2 FFFFFD000309000374000008000069C8 <<'TEXT'
write servo 3: goal_position 0.0 deg; CRC C869 wrong, should be C969
TEXT
check 'a length that there is not' decodes --family dynamixel2 \
    FFFFFD000102005500A60000008CC0 <<'TEXT'
rubbish: FF FF FD 00 01 02 00 55 00 A6 00 00 00 8C C0 (no frame has this length)
TEXT
check 'parameters that are missing' decodes --family dynamixel2 \
    FFFFFD00FE0E00837400040001000000000200C346 <<'TEXT'
sync write 1 servos: goal_position; its last servo is cut; CRC 46C3 right; no reply
    servo 1: goal_position -180.0 deg
TEXT
check 'DYNAMIXEL 1.0: a value out of range' decodes --family dynamixel1 FFFF0105031E0004D4 <<'TEXT'
write servo 1: goal_position 150.1 deg, 1024 is outside 0..1023; sum D4 right; reply: 6 bytes
TEXT
check 'Feetech, and what a servo reports' decodes --family feetech \
    FFFF0104023802BE FFFF01042400 08CE <<'TEXT'
read present_position of servo 1; sum BE right; reply: 8 bytes
servo 1 returns present_position 0.0 deg; too hot, overload; sum CE right
TEXT
check 'an instruction that these servos do not have' decodes --family scs \
    FFFFFE0682380201023C <<'TEXT'
sync read present_position of servo 1, servo 2; these servos have no sync read; sum 3C right; \
    reply: 16 bytes
TEXT
check 'what another protocol has at that place' decodes --family dynamixel1 \
    FFFF01058A01020369 <<'TEXT'
fast sync read servo 1: 3 bytes 01 02 03; these servos have no fast sync read; sum 69 right; \
    reply: 6 bytes
TEXT
check 'the same of Feetech' decodes --family feetech FFFF0106920002011E45 <<'TEXT'
bulk read servo 1: 4 bytes 00 02 01 1E; these servos have no bulk read; sum 45 right; \
    reply: 8 bytes
TEXT
check 'the same of DYNAMIXEL 2.0' decodes --family dynamixel2 FFFFFD000103000B254E <<'TEXT'
calibrate servo 1; these servos have no calibrate; CRC 4E25 right; reply: 11 bytes
TEXT
check 'a list of nothing' decodes --family dynamixel2 fffffd00fe090082840000000102cd2a \
    fffffd00fe090083840000000102deab <<'TEXT'
sync read nothing at 132 of servo 1, servo 2; it reads nothing; CRC 2ACD right; reply: 22 bytes
sync write 2 servos: nothing at 132; it writes nothing; CRC ABDE right; no reply
    servo 1: nothing at 132
    servo 2: nothing at 132
TEXT
check 'Hiwonder' decodes --family lx16a 555501031CDF 555501051CF401E8 5555010328D3 <<'TEXT'
read present_position of servo 1; sum DF right; reply: 8 bytes
servo 1 returns present_position 0.0 deg; sum E8 right
unknown instruction 28 to servo 1; sum D3 right; no reply
TEXT
check 'Hiwonder: of all, only the ids are answered' decodes --family lx16a \
    5555FE031CE2 5555FE030EF0 <<'TEXT'
read present_position of all servos; sum E2 right; no reply
read id of all servos; sum F0 right; reply: of each that is there
TEXT
check 'Kondo: there is no sum' decodes --family ics 813A4C 013A4C 810000 <<'TEXT'
write servo 1: position 0.0 deg; reply: 3 bytes
servo 1 returns present_position 0.0 deg
free servo 1; reply: 3 bytes
TEXT
check 'a family that is none' refuses 2 "invalid value 'futaba' (rs30x" --family futaba 00
check_json 'a request in JSON' 'lines[0]["packet"]["action"] == "read" and
    lines[0]["packet"]["servos"][0]["address"] == 132 and lines[0]["reply"]["bytes"] == 15' \
    "$GRCTL" decode --json --family dynamixel2 FFFFFD00010700028400 04001D15
check_json 'and a reply' 'lines[1]["packet"]["servos"] == [{"id": 1, "name": None,
    "registers": {"present_position_deg": -165.4}}] and lines[1]["asked_for"]' \
    "$GRCTL" decode --json --family dynamixel2 FFFFFD00010700028400 04001D15 \
    FFFFFD000108005500A60000008CC0

test_case 'frames in words'

check 'a goal, byte by byte' decodes 53 0C FA AF 03 00 1E 04 01 F6 FF 00 00 11 <<'TEXT'
relay 12: write servo 3 (R_SHOULDER_P): goal -1.0 deg, goal_time 0 ms (full speed); \
    sum 11 right; no reply
TEXT
check 'a goal in one word' decodes 530cfaaf03001e040184030a0095 <<'TEXT'
relay 12: write servo 3 (R_SHOULDER_P): goal 90.0 deg, goal_time 100 ms; sum 95 right; no reply
TEXT
check 'prefixes and commas' decodes 0x41,0x00 <<'TEXT'
check the board; reply: ACK
TEXT
check 'a read and its reply' \
    decodes '54 09 FA AF 01 0F 2A 02 00 26 0A' FD DF 01 00 2A 02 01 F6 FF 21 <<'TEXT'
relay 8, return 10: read No.42-43 of servo 1 (CHEST_P); sum 26 right; reply: 10 bytes
servo 1 (CHEST_P) returns No.42-43: position -1.0 deg; sum 21 right
TEXT
check 'a board that is told another number of bytes than the servo returns' \
    decodes 54 09 FA AF 01 0F 24 12 00 38 0A <<'TEXT'
relay 8, return 10: read No.36-53 of servo 1 (CHEST_P); sum 38 right; \
    but the packet is answered by 26 bytes
TEXT
check 'a wrong sum, and what it should be' faulty FA AF 03 00 24 01 01 01 27 <<'TEXT'
write servo 3 (R_SHOULDER_P): torque on; sum 27 wrong, should be 26
TEXT
check 'the other frames of the board' decodes 4100 504D07 505303 <<'TEXT'
check the board; reply: ACK
play motion slot 7; no reply
play scenario 3; no reply
TEXT
check 'a long packet, a servo a line' \
    decodes 53 0E FA AF 00 00 24 02 03 01 00 02 01 03 02 26 <<'TEXT'
relay 14: write 3 servos: torque; sum 26 right; no reply
    servo 1 (CHEST_P): torque off
    servo 2 (NECK_Y): torque on
    servo 3 (R_SHOULDER_P): torque brake
TEXT
check 'what servos do to themselves' \
    decodes FAAF0540FF0000BA FAAF0520FF0000DA FAAF0560FF00009A FAAF0510FFFF0015 <<'TEXT'
flash servo 5 (R_ELBOW_P); sum BA right; no reply
reboot servo 5 (R_ELBOW_P); sum DA right; no reply
flash and reboot servo 5 (R_ELBOW_P); sum 9A right; no reply
factory reset servo 5 (R_ELBOW_P); sum 15 right; no reply
TEXT
check 'a write that goes to flash at once, and data that is none' \
    decodes FAAF016006010104 63 FAAF0540070101 02 40 FAAF0510FF0101FF15 <<'TEXT'
write servo 1 (CHEST_P): baud 38400 bps, then flash and reboot; sum 63 right; no reply
write servo 5 (R_ELBOW_P): delay 200 us, then flash; sum 40 right; no reply
factory reset servo 5 (R_ELBOW_P); sum 15 right; no reply
TEXT
cat >"$work/echo" <<'JSON'
{"time_ms": 0, "from": "host", "hex": "FA AF 07 09 00 00 01 0F"}
{"time_ms": 1, "from": "robot", "hex": "FA AF 07 09 00 00 01 0F"}
{"time_ms": 2, "from": "host", "hex": "FA AF 00 00 24 02 01 02 01 24"}
{"time_ms": 3, "from": "robot", "hex": "FA AF 00 00 24 02 01 02 01 24"}
JSON
check 'what an adapter returns of what was sent' decodes "$work/echo" <<'TEXT'
     0.000  host     read No.42-59 of servo 7 (L_SHOULDER_R); sum 0F right; reply: 26 bytes
     1.000  robot    echo: read No.42-59 of servo 7 (L_SHOULDER_R); sum 0F right
     2.000  host     write 1 servos: torque; sum 24 right; no reply
    servo 2 (NECK_Y): torque on
     3.000  robot    echo: write 1 servos: torque; sum 24 right
TEXT
check 'requests of blocks and of an ACK' \
    decodes FA AF 7F 09 00 00 01 77 FAAF0101FF0000FF FAAF010B0000010B <<'TEXT'
read No.42-59 of servo 127; sum 77 right; reply: 26 bytes
ping servo 1 (CHEST_P); sum FF right; reply: ACK
read No.30-41 of servo 1 (CHEST_P); sum 0B right; reply: 20 bytes
TEXT
check 'a servo in trouble' decodes FD DF 63 A2 32 04 01 46 00 E2 02 50 <<'TEXT'
servo 99 returns No.50-53: temperature 70 deg C, voltage 7.38 V; \
    too hot, torque was cut, temperature alarm, the command could not be processed; sum 50 right
TEXT
check 'settings in their units, half of a value' \
    decodes FA AF 03 00 04 05 01 05 01 07 02 64 66 <<'TEXT'
write servo 3 (R_SHOULDER_P): id 5, reverse 1, baud 115200 bps, delay 200 us, \
    No.8 = 64 (half of cw_limit); sum 66 right; no reply
TEXT
check 'registers that do not exist' decodes FA AF 01 0F 8B F0 00 75 <<'TEXT'
read No.139-378 of servo 1 (CHEST_P); sum 75 right; asks for registers that do not exist
TEXT
check 'rubbish and what is cut off are shown, and what follows is found' \
    faulty 12 34 41 00 FD DF 01 00 24 01 01 24 FD DF 01 00 24 01 01 01 24 08 53 0C FA <<'TEXT'
rubbish: 12 34
check the board; reply: ACK
cut off: FD DF 01 00 24 01 01 24
servo 1 (CHEST_P) returns No.36: torque on; sum 24 right; nobody asked for it
NACK: refused
cut off: 53 0C FA
TEXT
check '--wiring: a board takes no bare packet' \
    decodes --wiring board FA AF 01 01 FF 00 00 FF <<'TEXT'
rubbish: FA AF 01 01 FF 00 00 FF
TEXT
check '-v shows the bytes' decodes -v 41 00 <<'TEXT'
check the board; reply: ACK
    41 00
TEXT

test_case 'text'

{
    printf '# a goal over two lines, and a check\n53 0C FA AF 03 00\n'
    printf '1E 04 01 84 03 0A 00 95 # end\n\n41:00\r\n'
} >"$work/lines"
check 'a file of lines' decodes "$work/lines" <<'TEXT'
relay 12: write servo 3 (R_SHOULDER_P): goal 90.0 deg, goal_time 100 ms; sum 95 right; no reply
check the board; reply: ACK
TEXT
check 'standard input' reads "$work/lines" <<'TEXT'
relay 12: write servo 3 (R_SHOULDER_P): goal 90.0 deg, goal_time 100 ms; sum 95 right; no reply
check the board; reply: ACK
TEXT
printf '0 41 00\n20 07\n40 54 09 FA AF 01 0F 2A 02 00 26 0A\n' >"$work/timed"
check 'lines with times' decodes "$work/timed" <<'TEXT'
     0.000  host     check the board; reply: ACK
    20.000  robot    ACK; 20.000 ms after its request
    40.000  host     relay 8, return 10: read No.42-43 of servo 1 (CHEST_P); sum 26 right; \
    reply: 10 bytes
TEXT
printf '20 41 00\n40.5 07\n' >"$work/cut-out"
check 'lines with times whose first could be a byte' decodes "$work/cut-out" <<'TEXT'
     0.000  host     check the board; reply: ACK
    20.500  robot    ACK; 20.500 ms after its request
TEXT
# Times are as exact as their text: whole milliseconds here, fractions in JSON.
check 'what play --dry-run prints' sh -c '
    "$GRCTL" play --dry-run motions/greet.pseq >"$1/dry" && "$GRCTL" decode "$1/dry" >"$1/got" &&
    [ "$(grep -c "write 20 servos: goal, goal_time; sum .. right" "$1/got")" -eq \
        "$(wc -l <"$1/dry")" ] && ! grep -Eq "rubbish|cut|wrong" "$1/got"' sh "$work"
check 'what play --dry-run --json prints is the same' sh -c '
    "$GRCTL" play --dry-run --json motions/greet.pseq | "$GRCTL" decode 2>/dev/null |
        sed "s/^ *[0-9.]*//" >"$1/other"
    [ -s "$1/got" ] && sed "s/^ *[0-9.]*//" "$1/got" | cmp - "$1/other"' sh "$work"
check 'a summary for people' sh -c '
    "$GRCTL" decode "$1/timed" 2>&1 >/dev/null |
        grep -q "^3 frames, 0 with a wrong sum, 0 cut off, 0 bytes of rubbish; of 2 requests 1"' \
    sh "$work"
check '-q says no summary' sh -c '[ -z "$("$GRCTL" decode -q "$1/timed" 2>&1 >/dev/null)" ]' \
    sh "$work"

test_case 'JSON'

check 'a frame as JSON' decodes --json 53 0C FA AF 03 00 1E 04 01 84 03 0A 00 95 <<'TEXT'
{"from":"host","kind":"relay","bytes":14,"hex":"53 0C FA AF 03 00 1E 04 01 84 03 0A 00 95",\
    "packet":{"kind":"short","action":"write","id":3,"flags":0,"address":30,"length":4,\
    "count":1,"sum":149,"sum_ok":true,"servos":[{"id":3,"name":"R_SHOULDER_P",\
    "registers":{"goal_deg":90.0,"goal_time_ms":100}}]},"reply":{"kind":"none","bytes":0}}
TEXT
check 'a wrong sum as JSON' faulty --json FA AF 03 00 24 01 01 01 27 <<'TEXT'
{"from":"host","kind":"packet","bytes":9,"hex":"FA AF 03 00 24 01 01 01 27",\
    "packet":{"kind":"short","action":"write","id":3,"flags":0,"address":36,"length":1,\
    "count":1,"sum":39,"sum_ok":false,"right_sum":38,"servos":[{"id":3,\
    "name":"R_SHOULDER_P","registers":{"torque":"on"}}]},"reply":{"error":"checksum"}}
TEXT
check 'a file as JSON ends in a summary' sh -c '
    "$GRCTL" decode --json "$1/timed" 2>/dev/null | tail -n 1 | grep -qxF "$2"' sh "$work" \
    '{"done":true,"frames":3,"bad_sums":0,"cut":0,"rubbish_bytes":0,"answered":1,'\
'"unanswered":1,"unasked":0}'
check 'JSON is read again' sh -c '
    "$GRCTL" decode --json "$1/timed" >"$1/json" && "$GRCTL" decode "$1/json" >"$1/got" 2>/dev/null
    "$GRCTL" decode "$1/timed" 2>/dev/null | diff - "$1/got"' sh "$work"

test_case 'what is wrong'

check 'no hex' refuses 2 "'G0' is neither a byte in hex nor a file" FA G0
check 'an odd number of digits' refuses 2 "'F' is neither a byte in hex nor a file" FA F
check 'no such file' refuses 3 './none: no such file$' ./none
check 'a folder' refuses 3 ': is a directory$' "$work"
printf 'FA AF\n03 0x1G\n' >"$work/bad"
check 'bad hex in a file, behind what is good' both exits 3 "$GRCTL" decode "$work/bad" --- \
    both complains "$work/bad:2:6: '1G' is not a byte in hex" --- says 'FA AF'
printf '\177ELF\1\2\3' >"$work/binary"
check 'a binary' refuses 3 "$work/binary:1:1: neither hex nor a pcapng trace" "$work/binary"
printf '{"hex": "41 0"}\n' >"$work/bad-json"
check 'bad hex in JSON' refuses 3 "$work/bad-json:1:1: '0' is not a byte in hex" "$work/bad-json"
printf '{"hex": \n' >"$work/worse-json"
check 'malformed JSON' refuses 3 'malformed JSON' "$work/worse-json"
check 'an error as JSON' sh -c '"$GRCTL" decode --json XY 2>/dev/null |
    grep -q "^{\"error\":{\"code\":\"syntax\""'
done_testing
