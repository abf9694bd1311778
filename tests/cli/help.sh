#!/bin/sh
# SPDX-License-Identifier: MIT
# The command line itself: help, versions, mistakes.
. tests/support/cli.sh

test_case "help and version"
check "help lists commands" both exits 0 "$GRCTL" help --- says '^  play  '
check "--help does too" both exits 0 "$GRCTL" --help --- says '^  play  '
check "--version" both exits 0 "$GRCTL" --version --- says '^grctl [0-9]*\.[0-9]*\.[0-9]*$'
check "version" both exits 0 "$GRCTL" version --- says '^grctl [0-9]*\.[0-9]*\.[0-9]*$'
check_json "version as JSON" 'lines[0]["name"] == "grctl"' "$GRCTL" version --json
check_json "help as JSON" 'any(c["name"] == "play" for c in lines[0]["commands"])' \
    "$GRCTL" --json help

# Every command of the overview has a help page that names it.
"$GRCTL" help | sed -n '/^Global options/q;s/^  \([a-z-]*\) .*/\1/p' >"$work/commands"
test_case "every command has a page that fits"
check "there are commands" [ -s "$work/commands" ]
while read -r command; do
    check "help $command" both exits 0 "$GRCTL" help "$command" --- says "usage: grctl $command"
    check "its lines fit into 80 columns" [ "$(grep -c '.\{81\}' "$work/out")" -eq 0 ]
    check "$command --help" both exits 0 "$GRCTL" "$command" --help --- says "usage: grctl $command"
done <"$work/commands"

no_command() {
    exits 2 "$GRCTL" || return 1
    grep -q '^usage: grctl' "$work/err" && [ ! -s "$work/out" ]
}
test_case "mistakes in words get a near guess"
check "no command at all: the overview, on standard error" no_command
check "a command that is none" fails 2 "no command 'nonsense'" "$GRCTL" nonsense
check "no guess where little is alike" fails 2 "no command 'nope'; see 'grctl help'$" "$GRCTL" nope
check "a near miss" fails 2 "did you mean 'status'" "$GRCTL" stauts
check "help on a near miss" fails 2 "did you mean 'play'" "$GRCTL" help plya
check "an option that is none" fails 2 'unknown option --nonsense' "$GRCTL" status --nonsense
check "a near miss of one" fails 2 'unknown option --sped; did you mean --speed?$' \
    "$GRCTL" play --sped 3 x
check "of a global one" fails 2 'unknown option --jsn; did you mean --json?$' "$GRCTL" status --jsn
check "the beginning of one" both exits 0 "$GRCTL" -d sim status --js m2 --- says '^{"robot":'
check "before its value" both exits 0 "$GRCTL" --dev=sim status m2 --- says NECK_Y
check "the beginning of two" fails 2 '^grctl: --re may be --repeat or --reverse; see' \
    "$GRCTL" play --re x
check "its whole name, which begins another" exits 0 "$GRCTL" -d sim init --time 300
check "the name of another command's is no beginning" fails 2 \
    'unknown option --time; see' "$GRCTL" -d sim move m2 10 --time 8000
check "the beginning of none" fails 2 'unknown option --jx' "$GRCTL" status --jx
check "of a joint" fails 2 "no joint called 'r_kne_p'; did you mean R_KNEE_P?$" \
    "$GRCTL" move r_kne_p 3
check "a group where one joint is wanted" fails 2 "^grctl: 'legs' is a group; one joint is wanted" \
    "$GRCTL" move legs 3
check "of a group" fails 2 'did you mean right_arm?$' "$GRCTL" status rightarm
check "a group is no guess for one joint" fails 2 "joint called 'right_arn'; joints are named" \
    "$GRCTL" move right_arn 3
test_case "joints are listed"
check "the joints" both exits 0 "$GRCTL" joints --- \
    says '^R_KNEE_P  *j3  *m12  *12  *-130  *0  *-40  right_leg legs$'
check "all of them" [ "$(wc -l <"$work/out")" -eq 21 ]
only_body() {
    exits 0 "$GRCTL" joints body && [ "$(grep -c '  body$' "$work/out")" -eq 2 ] &&
        [ "$(wc -l <"$work/out")" -eq 3 ]
}
check "those named" only_body
check_json "joints as JSON" \
    'lines[0]["joints"][0] == {"joint": 12, "motor": 1, "id": 1, "name": "CHEST_P",
        "limits_deg": [-95, 0], "init_deg": 0, "groups": ["all", "body"]}' \
    "$GRCTL" joints m1 --json
test_case "mistakes in values are told in one line"
check "a joint that is none, in joints" fails 2 'did you mean R_KNEE_P?$' "$GRCTL" joints R_KNE_P
check "a word for a device, misspelled" fails 1 "^grctl: sin: .*(did you mean 'sim'?)$" \
    "$GRCTL" -d sin status
check "a file without a name" fails 2 'the file name is empty' "$GRCTL" play ''
check "an option without a value" fails 2 'output needs a value: OUT' "$GRCTL" plot -o '' x
check "a posture of no file" fails 2 "'@:2' is not @FILE or @FILE:N" "$GRCTL" pose @:2
check "a device without a name" fails 2 'device needs a value: DEV' "$GRCTL" -d '' status
check "an address that is none" fails 2 'tcp:x: not of the form' "$GRCTL" -d tcp:x status
check "a letter that is none" fails 2 'unknown option -Z' "$GRCTL" -Z status
check "a value missing" fails 2 'device needs a value' "$GRCTL" status --device
check "a value too many" fails 2 'json takes no value' "$GRCTL" status --json=yes
check "a number that is none" fails 2 "'fast' is not a whole number" "$GRCTL" -b fast status
check "a number too large" fails 2 "'99999999' is not" "$GRCTL" -b 99999999 status
check "a choice that is none" fails 2 "invalid value 'string' (board|bus)" \
    "$GRCTL" --wiring string status
check "an argument missing" fails 2 'move needs JOINT DEG' "$GRCTL" move R_KNEE_P
check "an argument too many" fails 2 "'x' is one argument too many" "$GRCTL" version x
check "a joint that is none" fails 2 "no joint called 'R_TAIL'" "$GRCTL" move R_TAIL 3
check "an angle that is none" fails 2 "'up' is not an angle" "$GRCTL" move m3 up
check "not a number as an angle" fails 2 "'nan' is not an angle" "$GRCTL" move m3 nan
json_mistake() {
    exits 2 "$GRCTL" status --nonsense --json || return 1
    json 'lines[0]["error"]["code"] == "arg"'
}
test_case "with --json a mistake is JSON too"
if have_json; then
    check "with --json a mistake is JSON too" json_mistake
else
    skip "with --json a mistake is JSON too" "no python3 to parse JSON with"
fi
done_testing
