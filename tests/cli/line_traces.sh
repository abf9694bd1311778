#!/bin/sh
# SPDX-License-Identifier: MIT
# Traces of a robot of several lines: an interface a line, read by others, decoded and run again.
. tests/support/cli.sh
unset GRCTL_ROBOT
arms=docs/examples/robots/two-arms.yaml

# What the file says by the format's text, not by our reader: names, descriptions, speeds, and the
# bytes of each interface, whose heads (FF FF ID; FF FF FD 00) tell whose they are.
cat >"$work/pcapng.py" <<'END'
import struct, sys
data, at, faces, sent, came, last = open(sys.argv[1], "rb").read(), 0, [], {}, {}, 0
while at < len(data):
    kind, size = struct.unpack_from("<II", data, at)
    assert size % 4 == 0 and struct.unpack_from("<I", data, at + size - 4)[0] == size
    body = data[at + 8:at + size - 4]
    at += size
    if kind == 1:
        options, link, told = body[8:], struct.unpack_from("<H", body)[0], {}
        while options:
            code, length = struct.unpack_from("<HH", options)
            if code == 0:
                break
            told[code] = options[4:4 + length]
            options = options[4 + (length + 3) // 4 * 4:]
        faces.append((told[2].decode(), told[3].decode(), struct.unpack("<Q", told[8])[0], link))
    elif kind == 6:
        face, high, low, n, whole = struct.unpack_from("<IIIII", body)
        assert face < len(faces) and n == whole and high << 32 | low >= last
        last = high << 32 | low
        flags = body[20 + (n + 3) // 4 * 4:]
        way = sent if struct.unpack_from("<HHI", flags)[2] & 3 == 2 else came
        way[face] = way.get(face, b"") + body[20:20 + n]
device = sys.argv[2] if len(sys.argv) > 2 else "sim,sim"
left, right = device.split(",")
assert faces == [("left", "feetech, " + left, 1000000, 147),
                 ("right", "dynamixel2, " + right, 1000000, 147)], faces
assert set(sent) == {0, 1}
assert sent[0][:2] == b"\xff\xff" and b"\xff\xff\xfd\x00" not in sent[0] + came.get(0, b"")
assert sent[1].count(b"\xff\xff\xfd\x00") > 3 and sent[1][:4] == b"\xff\xff\xfd\x00"
END

test_case "the trace of two arms"
check "a move is traced" exits 0 "$GRCTL" --robot $arms -d sim --timeout 5000 \
    --trace "$work/both" pose --time 300 L_pan=10 R_pan=-10
if have_json; then
    check "an interface a line, its packets with it" python3 "$work/pcapng.py" "$work/both"
else
    skip "an interface a line" "no python3"
fi
if command -v tshark >/dev/null 2>&1; then
    by_tshark() {
        tshark -r "$work/both" -T fields -e frame.interface_name -e frame.interface_description \
            2>/dev/null | sort -u >"$work/names"
        cat "$work/names"
        printf 'left\tfeetech, sim\nright\tdynamixel2, sim\n' | diff - "$work/names"
    }
    check "tshark has the same lines" by_tshark
else
    skip "tshark has the same lines" "no tshark"
fi
check "decode names line and joint" ends_with 0 \
    '^ *[0-9.]*  right: robot .*servo 1 (R_pan) returns .* ms after its request' \
    "$GRCTL" --robot $arms decode "$work/both"
of_each() {
    grep -q '^ *[0-9.]*  left: host .*servo 1 (L_pan)' "$work/said" &&
        grep -q ' left, feetech, sim, 1000000 bps, begun 2' "$work/said" &&
        grep -q ' right, dynamixel2, sim, 1000000 bps, begun 2' "$work/said" &&
        grep -q ' of \([0-9]*\) requests \1 were answered; 0 replies nobody asked for' \
            "$work/said" && ! grep -q 'rubbish  \|cut off  \|nobody asked for it' "$work/said"
}
check "of each line: all are answered" of_each
in_turn() {
    turns=$(sed -n 's/^ *[0-9.]*  \([a-z]*\): .*/\1/p' "$work/said" | uniq | wc -l)
    [ "$turns" -gt 10 ] || { echo "$turns turns"; return 1; }
}
check "in their turn" in_turn
check "without the robot's file: the same frames" ends_with 0 \
    'right: robot .*servo 1 returns model XL430-W250' \
    "$GRCTL" decode "$work/both"
check_json "in JSON each has its line" \
    'lines[0]["line"] == "left" and lines[0]["trace"]["line"] == "feetech"
    and lines[0]["trace"]["device"] == "sim" and lines[1]["line"] == "right"
    and lines[1]["trace"]["baud_bps"] == 1000000 and lines[-1]["bad_sums"] == 0
    and lines[-1]["frames"] == len(lines) - 3 and lines[-1]["unanswered"] == 0
    and {(f["line"], f["packet"]["servos"][0].get("name", "")[:1]) for f in lines[2:-1]
         if f["kind"] == "return"} == {("left", "L"), ("right", "R")}' \
    "$GRCTL" --robot $arms --json decode "$work/both"
check "a family that is told holds for all" ends_with 0 'left: host  *rubbish: FF FF 01' \
    "$GRCTL" decode --family dynamixel2 "$work/both"
check "of one line it is as it was" exits 0 "$GRCTL" --robot $arms -d sim --line right \
    --trace "$work/right" status
check "with no line before its frames" ends_with 0 '^ *[0-9.]*  host  .*(R_pan)' \
    "$GRCTL" --robot $arms --line right decode "$work/right"

test_case "run again"
printf 'type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n    content: JointPosition\n' \
    >"$work/wave.yaml"
printf '    frameRate: 4\n    numFrames: 3\n    numParts: 8\n    frames:\n' >>"$work/wave.yaml"
for angle in 0 0.1 0; do
    echo "      - [$angle, 0, 0, 0, $angle, 0, 0, 0]" >>"$work/wave.yaml"
done
# kind FAMILY SERVO BAUD: the right arm of another family, in virtual time. A rehearsal ends when
# the last frame has left: one reply may not have come.
kind() {
    sed "s/right, family: dynamixel2, baud: 1000000/right, family: $1, baud: $3/
        s/XL430-W250/$2/" $arms >"$work/$1.yaml"
    "$GRCTL" --robot "$work/$1.yaml" play --dry-run --trace "$work/$1" "$work/wave.yaml" \
        >"$work/said" 2>&1 || { cat "$work/said"; return 1; }
    "$GRCTL" --robot "$work/$1.yaml" replay "$work/$1" >"$work/said" 2>&1
    cat "$work/said"
    equal='call for a reply: [1-9][0-9]* equal, 0 differ, 0 missing, [01] extra, 0 silent'
    [ "$(grep -c "^[0-9]* frames sent, [1-9][0-9]* $equal" "$work/said")" -eq 2 ] || return 1
    "$GRCTL" --robot "$work/$1.yaml" decode "$work/$1" >"$work/said" 2>&1 || return 1
    grep -q 'right: host .*(R_pan)' "$work/said" && grep -q "right, $1, sim, $3 bps" "$work/said"
}
check "with DYNAMIXEL 1.0" kind dynamixel1 AX-12A 1000000
check "with Hiwonder" kind lx16a LX-16A 115200
check "with Kondo" kind ics KRS-3301 115200
check "with Futaba" kind rs30x RS303MR 460800
check "with Feetech SCS" kind feetech SCS0009 1000000
check "one of them alone" exits 0 "$GRCTL" --robot "$work/rs30x.yaml" --line right \
    replay "$work/rs30x"
check_json "in JSON each line has its name" '[line["line"] for line in lines] == ["left", "right"]
    and lines[1]["ok"] and lines[1]["requests"] == lines[1]["equal"] > 4' \
    sh -c '"$0" --robot "$1.yaml" --json replay "$1" | grep \"done\"' "$GRCTL" "$work/rs30x"
# A DYNAMIXEL X tells the time since its start.
check "a reply that differs" ends_with 1 'right: \|returns model XL430-W250, .*tick' \
    "$GRCTL" --robot $arms replay "$work/both"
check "the lines of another robot" ends_with 3 'nothing went over line body' \
    "$GRCTL" --robot docs/examples/robots/ax-body-xl330-head.yaml replay "$work/both"
check "a robot of one line" ends_with 2 'a trace of 2 lines, and GR001 has one: name the robot' \
    "$GRCTL" replay "$work/both"
check "a trace of one line" ends_with 2 'a trace of one line: choose it, as by --line left' \
    "$GRCTL" --robot $arms replay "$work/right"
check "not to a robot" ends_with 2 'a trace of several lines goes to a simulator' \
    "$GRCTL" --robot $arms -d left=/dev/null,right=/dev/null replay "$work/both"

test_case "for one line"
for command in scan info doctor calibrate sim; do
    check "$command" ends_with 2 "$command: --trace is for one line, as --line left names it" \
        "$GRCTL" --robot $arms -d sim --trace "$work/none" $command
done
check "and nothing is written" test ! -e "$work/none"
done_testing
