#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl check: what is wrong with motion files.
. tests/support/cli.sh

data=${GROBO_SHARED:-../shared}/data

calls_itself() {
    cp motions/README.md "$work/readme.pseq"
    exits 3 "$GRCTL" check motions/* "$work/readme.pseq"
}
test_case "our own motions are right"
check "our own motions are right" fails 0 '^11 files, nothing wrong$' "$GRCTL" check motions/*
check "what is no motion is passed by" both exits 0 "$GRCTL" check -v motions/* \
    --- says '^motions/README.md: note: .*skipped'
check "but not alone" exits 3 "$GRCTL" check motions/README.md
check "nor when it is called a motion" calls_itself
for path in motions/*.*seq motions/*.m motions/greet.yaml; do
    check "${path##*/} does not fall" fails 0 'nothing wrong' "$GRCTL" check --balance "$path"
done

# found STATUS PATTERN FILE [OPTIONS]: check exits so and prints exactly one line, like that.
found() {
    found_status=$1
    found_pattern=$2
    shift 2
    exits "$found_status" "$GRCTL" check "$@" || return 1
    [ "$(wc -l <"$work/out")" -eq 1 ] && grep -q -e "$found_pattern" "$work/out" && return
    echo "not one line like '$found_pattern' but:"
    cat "$work/out"
    return 1
}

# pose TIME JOINTS Q: a key pose.
pose() {
    printf '  - time: %s\n    refer:\n      type: Pose\n      name: ""\n' "$1"
    printf '      joints: [ %s ]\n      q: [ %s ]\n' "$2" "$3"
}
# motion NAME: standard input as the poses of $work/NAME.pseq.
motion() {
    printf 'type: PoseSeq\nname: %s\ntargetBody: GR001\nrefs:\n' "$1"
    cat
}

streamed() {
    pose 0 '13' 1 | motion streamed | "$GRCTL" check - >"$work/out"
    grep '^(standard input):10:12: NECK_Y: 57.3 ' "$work/out"
}
test_case "standard input and odd names"
check "- is standard input" streamed
named_oddly() {
    odd=$(printf 'odd\n\033[31m.pseq')
    : | motion odd >"$work/$odd"
    found 0 'odd??\[31m.pseq: warning: no postures' "$work/$odd"
}
check "an odd name stays one line without its escape codes" named_oddly

{ pose 0 '13' 0 && pose 1 '13, 3' '0.9, -0.5'; } | motion outside >"$work/outside.pseq"
test_case "what is wrong in a file is found, to the column"
check "an angle outside its limits, to the column" \
    found 3 "outside.pseq:16:12: NECK_Y: 51.6 degrees, outside -50..50 \[limit\]" \
    "$work/outside.pseq"
{ pose 0 '12, 3' '0.0035, 0' && pose 1 '12, 3' '0.0105, 0.0174'; } |
    motion near >"$work/near.pseq"
check "within a degree of limits: one warning" found 0 \
    'near.pseq:5: warning: 3 angles up to 1.0 degrees outside their limits (R_KNEE_P): clamped' \
    "$work/near.pseq"
{ pose 0 '12' 0 && pose 1 '12' 0.0192; } | motion beyond >"$work/beyond.pseq"
check "beyond it an error" found 3 'beyond.pseq:16:12: CHEST_P: 1.1 degrees, outside' \
    "$work/beyond.pseq"
{ pose 0 '13' 0 && pose 0.1 '13' 0.8; } | motion fast >"$work/fast.pseq"
check "a move too fast, with the time it needs" \
    found 3 "fast.pseq:16:12: NECK_Y: 45.8 degrees in 100 ms, the servo needs 123 ms \[too-fast\]" \
    "$work/fast.pseq"
{ pose 1 '13' 0 && pose 0.5 '13' 0.1; } | motion back >"$work/back.pseq"
check "times that go back: a warning" found 0 "back.pseq:11.*warning.*\[time-back\]" \
    "$work/back.pseq"
pose 0 '13, 25' '0, 0' | motion joint >"$work/joint.pseq"
check "a joint that GR001 does not have" found 0 "joint.pseq:10:.*warning: joint 25.*GR001" \
    "$work/joint.pseq"
: | motion empty >"$work/empty.pseq"
check "no postures" found 0 'empty.pseq: warning: no postures' "$work/empty.pseq"
printf '%s\n' '0 0' '100 0 x' '200 y' >"$work/bad.m"
every_error() {
    exits 3 "$GRCTL" check "$work/bad.m" && says 'bad.m:2:' && says 'bad.m:3:' &&
        grep -q '^2 errors, 1 warning$' "$work/err"
}
check "every error of a file in one run" every_error
test_case "how it is told"
check "a file that is not there" found 3 'nowhere.m: no such file \[open\]$' "$work/nowhere.m"
check "quiet" both exits 0 "$GRCTL" -q check motions/greet.m --- [ ! -s "$work/err" ]
json_list='not lines[0]["ok"] and [(d["file"][-12:], d["line"], d["column"], d["severity"],
    d["code"]) for d in lines[0]["diagnostics"]] == [("outside.pseq", 16, 12, "error", "limit")]'
as_json() {
    exits 3 "$GRCTL" check --json "$work/outside.pseq" && json "$json_list"
}
check_json "nothing as JSON" 'lines == [{"ok": True, "diagnostics": []}]' \
    "$GRCTL" check --json motions/greet.pseq
if have_json; then
    check "a diagnostic as JSON" as_json
else
    skip "a diagnostic as JSON" "no python3 to parse JSON with"
fi

test_case "the whole body"

# Bends so far forward that it falls; without balance nothing is wrong with it.
stand='0, 0, 0.35, -0.7, -0.35, 0, 0, 0, -0.35, 0.7, 0.35, 0, 0, 0, 0.35, 0, -0.35, -0.35, 0, 0.35'
all='0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19'
{
    pose 0 "$all" "$stand"
    pose 2 '2, 4, 8, 10, 12' '0.35, -1.2, -0.35, 1.2, -1.5'
} | motion falls >"$work/falls.pseq"
check "what falls is right as far as joints go" exits 0 "$GRCTL" check "$work/falls.pseq"
falls() {
    exits 3 "$GRCTL" check --balance "$work/falls.pseq" &&
        says 'falls.pseq:[0-9]*: the ZMP is [0-9.]* mm outside the soles, at .*\[zmp-margin\]'
}
check "with --balance it is not" falls
warned='falls.pseq:[0-9]*: warning: the robot would fall: the ZMP is [0-9.]* mm outside'
check "it warns of the fall without" found 0 "$warned.*\[fall\]$" "$work/falls.pseq"
check "--force silences it" fails 0 'nothing wrong' "$GRCTL" check --force "$work/falls.pseq"
mkdir -p "$XDG_CONFIG_HOME/grctl"
printf '%s\n' 'warn_fall: false' 'robots: {a: {device: sim}}' >"$XDG_CONFIG_HOME/grctl/config.yaml"
check "the configuration too" fails 0 'nothing wrong' "$GRCTL" check "$work/falls.pseq"
check "but not what is asked for" falls
printf '%s\n' 'warn_fall: maybe' >"$XDG_CONFIG_HOME/grctl/config.yaml"
check "a configuration that cannot be read says nothing" \
    found 0 'the robot would fall' "$work/falls.pseq"
rm "$XDG_CONFIG_HOME/grctl/config.yaml"
# One knee bends by angles alone: both feet are said to stand, and one leg is shorter.
tips() {
    {
        pose 0 "$all" "$stand"
        pose 0.6 "2, 3, 4" "$1"
        pose 2.5 "2, 3, 4" "$1"
    } | motion tips >"$work/tips.pseq"
}
tips_over() {
    tips '0.95, -1.9, -0.95' && exits 3 "$GRCTL" check --balance "$work/tips.pseq" &&
        says 'tips.pseq:[0-9]*: the robot falls to its right, at [0-9.]* s .*\[fall\]'
}
check "a leg that is shorter" tips_over
leans_a_little() {
    tips '0.5, -1, -0.5' && exits 0 "$GRCTL" check --balance "$work/tips.pseq" &&
        ! says '\[fall\]'
}
check "a leg that is a little shorter" leans_a_little
doubtful() {
    { pose 0 "$all" "$stand" && pose 1 '4, 10' '-0.09, 0.09' && pose 3 '4, 10' '-0.09, 0.09'; } |
        motion leans >"$work/leans.pseq"
    exits 0 "$GRCTL" check --balance "$work/leans.pseq" && says \
        'warning: the robot falls on its back on a floor that slopes by 1.5 degrees, .*\[fall\]'
}
check "a fall that a slope decides" doubtful
# With the chest where its file has it, 0.9 degrees beyond, the ZMP is where it is at its limit.
margin() {
    "$GRCTL" check --balance "$1" | sed -n 's/.*the ZMP is \([0-9.]*\) mm.*/\1/p'
}
slack_judged() {
    for chest in 0 0.0157 0.05; do
        pose 0 '4, 10, 12' "-0.5, 0.5, $chest" |
            motion bent >"$work/bent$chest.pseq"
    done
    [ -n "$(margin "$work/bent0.pseq")" ] &&
        [ "$(margin "$work/bent0.pseq")" = "$(margin "$work/bent0.0157.pseq")" ] &&
        [ "$(margin "$work/bent0.pseq")" != "$(margin "$work/bent0.05.pseq")" ]
}
check "balance is judged at the limit that is played" slack_judged
slips() {
    { pose 0 "$all" "$stand" && pose 2 '6' '0.5'; } | motion slips >"$work/slips.pseq"
    exits 0 "$GRCTL" check --balance "$work/slips.pseq" &&
        says 'warning: L_ANKLE_R: the standing foot slips [0-9.]* mm, at .*\[foot-slip\]'
}
check "a foot that turns on the ground" slips
# Legs by targets: the step of ours with one foot put too far away.
reaches() {
    sed 's/translation: \[ 0.0252, -0.0196, 0.02115 \]/translation: [ 0.2252, -0.0196, 0.02115 ]/' \
        motions/step.pseq >"$work/far.pseq"
    exits 3 "$GRCTL" check "$work/far.pseq" || return 1
    says 'far.pseq:[0-9]*: R_ANKLE_R: the leg does not reach its target, at .*\[unreachable\]' ||
        return 1
    exits 0 "$GRCTL" check --ik off "$work/far.pseq"
}
check "a target out of reach" reaches
: | motion nothing >"$work/nothing.pseq"
check "nothing to balance" both exits 0 "$GRCTL" check --balance "$work/nothing.pseq" \
    --- says 'balance-unknown'
check "a balancer that is none is a file" found 3 '^sideways: no such file' --balance sideways
check "unless it is told apart" fails 2 "invalid value 'sideways' (off|on|compat11)" \
    "$GRCTL" check --balance=sideways motions/step.pseq
check "with the balancer" fails 0 'nothing wrong' "$GRCTL" check --balance on motions/step.pseq

test_case "reference material"

# edge NAME VERDICT: as expected.tsv says of reading it.
edge() {
    edge_path=$data/edge/$1
    case $2 in
    refuse*)
        exits 3 "$GRCTL" check "$edge_path" && says "$1:[0-9]*:[0-9]*: " &&
            exits 3 "$GRCTL" show "$edge_path"
        ;;
    *)
        exits 0 "$GRCTL" show "$edge_path" || return 1
        "$GRCTL" check "$edge_path" >"$work/out" 2>"$work/err"
        case $2 in *warn*) says "$1:.*warning: " ;; esac
        ;;
    esac
}
if [ -f "$data/edge/expected.tsv" ]; then
    tab=$(printf '\t')
    grep -v '^#' "$data/edge/expected.tsv" >"$work/expected"
    while IFS=$tab read -r name choreonoid verdict; do
        check "$name: $verdict (Choreonoid: $choreonoid)" edge "$name" "$verdict"
    done <"$work/expected"
    check "SampleMotion1 stands" exits 0 \
        "$GRCTL" check --balance "$data/choreonoid/GR001-SampleMotion1.pseq"
    check "its legs are given by links" says 'legs by ikLinks'
else
    skip "files at the edge" "no reference material beside the checkout"
fi
done_testing
