#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl show: motions as tables.
. tests/support/cli.sh

data=${GROBO_SHARED:-../shared}/data
greet=motions/greet.pseq

test_case "what a motion is"
check "what it is" both exits 0 "$GRCTL" show $greet --- \
    says '^motions/greet.pseq: pseq "greet" for GR001, 10 key poses, 5.000 s, angles in degrees$'
# Where there is no terminal a posture is a line, and its fields are where the names say.
as_lines() {
    [ "$(wc -l <"$work/out")" -eq 12 ] && awk '
        FNR == 2 { for (i = 1; i <= NF; i++) at[$i] = i; fields = NF }
        FNR > 2 && NF != fields { exit bad = 1 }
        FNR > 2 && $1 == 800 && ($at["R_SHOULDER_R"] != "-120.0" || $at["R_HIP_Y"] != ".") {
            exit bad = 1
        }
        END { exit bad || fields != 21 }' "$work/out"
}
check "a line a posture, 21 fields" as_lines
chosen() {
    exits 0 "$GRCTL" show -j NECK_Y,right_arm,j3 $greet &&
        says '^ *time_ms  R_KNEE_P  NECK_Y  R_SHOULDER_P  R_SHOULDER_R  R_ELBOW_P$'
}
check "--joints chooses" chosen
check "no such joint" fails 2 "no joint or group called 'tail'" "$GRCTL" show -j tail $greet
check "frames have a rate" both exits 0 "$GRCTL" show motions/greet.yaml \
    --- says ' 251 frames at 50 Hz, 5.000 s'
check "increments are told as such" both exits 0 "$GRCTL" show motions/greet.mseq \
    --- says ' 10 increments, '
check "poses that give legs by links are counted" both exits 0 "$GRCTL" show motions/step.pseq \
    --- says '^9 of 9 poses give legs by ikLinks: --ik exact'
anothers() {
    sed 's/^targetBody: .*/targetBody: "KNIGHT"/' motions/step.pseq >"$work/knight.pseq"
    exits 0 "$GRCTL" show "$work/knight.pseq" &&
        says '^9 of 9 poses give legs by ikLinks: the feet of its robot are not known'
}
check "another robot's are not promised" anothers

test_case "as it is played"

between() {
    exits 0 "$GRCTL" show --rate 20 -j R_SHOULDER_P $greet || return 1
    says '101 rows, 5.000 s' && says '^ *400  *10.0$'
}
check "--rate interpolates" between
added_up() {
    exits 0 "$GRCTL" show --rate 20 -j R_SHOULDER_R motions/greet.mseq || return 1
    says '^ *800  *-120.0$'
}
check "and adds increments up" added_up
solved() {
    sed '/^      joints/,/^      ikLinks/{/ikLinks/!d;}' motions/step.pseq >"$work/links.pseq"
    exits 0 "$GRCTL" show -j R_KNEE_P motions/step.pseq || return 1
    grep '^ *[0-9.]*  *[-0-9.]*$' "$work/out" >"$work/listed"
    exits 0 "$GRCTL" show --ik exact -j R_KNEE_P "$work/links.pseq" || return 1
    says '^legs by inverse kinematics$' && [ -s "$work/listed" ] &&
        grep '^ *[0-9.]*  *[-0-9.]*$' "$work/out" | diff "$work/listed" -
}
# A step without a time takes the default time: the length above is the time of the last row below.
one_length() {
    for times in '0 0 500' '500 500 1000 200' '0 10000 10500' '250 500'; do
        for t in $times; do echo "$t 0 0"; done >"$work/times.m"
        exits 0 "$GRCTL" show "$work/times.m" || return 1
        awk -v times="$times" 'NR == 1 { sub(/.*postures, /, ""); length_ms = $1 * 1000 }
            NR > 2 { last = $1 } END { if (length_ms != last) {
                print times ": " length_ms " above, " last " below"; exit 1 } }' \
            "$work/out" || return 1
    done
    exits 0 "$GRCTL" show --json "$work/times.m" && says '"length_ms":500.0.*"time_ms":500.0'
}
check "the length is the time of the last row" one_length
check "--ik exact gives the angles that our own poses carry" solved
aeon_pose='refer: { type: Pose, name: "", joints: [ 0 ], q: [ 0 ] }'
printf 'type: PoseSeq\nname: aeon\nrefs:\n  - time: 0\n    %s\n  - time: 1e6\n    %s\n' \
    "$aeon_pose" "$aeon_pose" >"$work/aeon.pseq"
check "more rows than sense" fails 3 'more than 10000000 rows' \
    "$GRCTL" show --rate 1000 "$work/aeon.pseq"

test_case "JSON"

greet_json='lines[0]["format"] == "pseq" and lines[0]["name"] == "greet" and
    lines[0]["length_ms"] == 5000 and len(lines[0]["joints"]) == 20 and
    len(lines[0]["keys"]) == 10 and lines[0]["keys"][1]["time_ms"] == 800 and
    lines[0]["keys"][1]["angle_deg"][15] == -120 and lines[0]["keys"][1]["angle_deg"][0] is None'
check_json "as JSON" "$greet_json" "$GRCTL" show --json $greet
rate_json='[k["angle_deg"] for k in lines[0]["keys"][:2]] == [[0], [-120]]'
check_json "played, as JSON" "$rate_json" \
    "$GRCTL" show --json --rate 1.25 -j R_SHOULDER_R motions/greet.pseq

test_case "files that mean mischief"

printf 'type: PoseSeq\nname: "\\e[31mred\\x9b"\ntargetBody: "\\a"\nrefs: []\n' >"$work/evil.pseq"
safe() {
    exits 0 "$GRCTL" show "$work/evil.pseq" || return 1
    ! LC_ALL=C grep -q '[[:cntrl:]]' "$work/out" && says 'pseq "?\[31mred?*" for ?, 0 key poses'
}
check "no control character reaches the terminal" safe
cat >"$work/wide.pseq" <<'PSEQ'
type: PoseSeq
name: wide
refs:
  - time: 123456789.5
    refer: { type: Pose, name: "", joints: [ 0, 1 ], q: [ -999999, -0.0001 ] }
PSEQ
wide() {
    exits 0 "$GRCTL" show "$work/wide.pseq" &&
        says '^ *123456789500  *-57295722.2  *0.0$'
}
check "numbers do not run together, nor is there a -0.0" wide

test_case "on a terminal"

# on_terminal COLUMNS COMMAND...: its output on a terminal so wide is in $work/out.
on_terminal() {
    python3 - "$@" >"$work/out" <<'PYTHON'
import fcntl, os, pty, struct, sys, termios
pid, fd = pty.fork()
if pid == 0:
    fcntl.ioctl(1, termios.TIOCSWINSZ, struct.pack("HHHH", 24, int(sys.argv[1]), 0, 0))
    os.execvp(sys.argv[2], sys.argv[2:])
text = b""
try:
    while chunk := os.read(fd, 65536):
        text += chunk
except OSError:
    pass
sys.stdout.write(text.decode().replace("\r\n", "\n"))
sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
PYTHON
}
eighty() {
    on_terminal 80 "$GRCTL" --color never show motions/greet.yaml || return 1
    awk 'FNR > 1 && length($0) > 80 { print "too wide: " $0; exit bad = 1 }
        /time_ms/ { heads++ }
        END { exit bad || heads != 21 }' "$work/out"
}
red() {
    printf 'type: PoseSeq\nname: red\nrefs:\n  - time: 0\n    %s\n' "${aeon_pose%\[*}[ 2 ] }" \
        >"$work/red.pseq"
    on_terminal 80 "$GRCTL" --color always show "$work/red.pseq" &&
        says "$(printf '\033')\[31m *114.6"
}
if have_json; then
    check "on a terminal it keeps to 80 columns, limb by limb, 40 rows at a time" eighty
    check "what is outside limits is red" red
else
    skip "on a terminal it keeps to 80 columns" "no python3 to make a terminal with"
fi

test_case "reference material"

shows() {
    exits 0 "$GRCTL" show "$1" && says "$2"
}
if [ -d "$data/choreonoid" ]; then
    check "SR1's joints have numbers" shows "$data/choreonoid/SR1WalkPattern3.yaml" ' j28$'
    check "SampleMotion1" shows "$data/choreonoid/GR001-SampleMotion1.pseq" '16 key poses'
else
    skip "motions of Choreonoid" "no reference material beside the checkout"
fi
done_testing
