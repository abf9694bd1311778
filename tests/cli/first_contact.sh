#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl first-contact: what is assumed of a robot, tested on simulated ones of every family.
. tests/support/cli.sh
. tests/support/first_contact.sh

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
    # On a machine that is busy half of the replies may be late, and no more is otherwise.
    told() {
        on_robot --json first-contact --yes -o "$work/told" >"$work/out" 2>"$work/err"
        [ $? -le 1 ] && json 'lines[0]["robot"] == "gr001" and len(lines[0]["servos"]) == 20 and
            lines[0]["servos"][3]["registers"]["id"] == 12 and
            lines[0]["not_as_assumed"] == sum(s["verdict"] == "not_as_assumed"
                for s in lines[0]["steps"] if s["name"] in ("latency", "line")) and
            {s["name"] for s in lines[0]["steps"]} > {"ping", "models", "latency", "board", "echo"}'
    }
    check "the report as JSON" told
    # As a real robot's, of which some is otherwise than that of the simulator.
    test_case "what differs from another report is said"
    otherwise() {
        python3 - "$1" "$2" <<'EOF'
import json, sys
report = json.load(open(sys.argv[1]))
servo = report["servos"][3]
servo["firmware"] += 1
servo["registers"]["cw_limit"] = servo["registers"].get("cw_limit", 0) - 5
servo["registers"]["present_position"] = 777
json.dump(report, open(sys.argv[2], "w"))
EOF
    }
    check "a report that is another" otherwise "$work/told.json" "$work/real.json"
    compared() {
        on_robot first-contact --yes -o "$work/compared" --compare "$work/real.json" >"$work/out" \
            2>"$work/err"
        [ $? -le 1 ] && grep '^differs' "$work/compared.txt" | grep -v ' verdict: ' >"$work/differs"
    }
    check "it is compared" compared
    check "a firmware" grep -q '^differs  *R_KNEE_P firmware: ' "$work/differs"
    check "a register that is kept" grep -q '^differs  *R_KNEE_P cw_limit: ' "$work/differs"
    check "and nothing that is measured" [ "$(wc -l <"$work/differs")" -eq 2 ]
    check "another robot's" fails 2 'real.json: is of gr001; choose that robot' "$GRCTL" -d sim \
        --robot so101 first-contact --yes -o "$work/no" --compare "$work/real.json"
    check "none at all" fails 3 'shy.txt: is no report' on_robot first-contact --yes \
        -o "$work/no" --compare "$work/shy.txt"
fi
stop_sim
done_testing
