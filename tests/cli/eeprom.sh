#!/bin/sh
# SPDX-License-Identifier: MIT
# What servos keep over power-off: saved to a file before it is changed, and put back from it.
. tests/support/cli.sh
unset GRCTL_ROBOT

saved=$XDG_STATE_HOME/grctl/eeprom
of() {
    one=$1
    shift
    "$GRCTL" --robot "$one" -d "$robot" --timeout 1000 "$@"
}
last_saved() {
    find "$saved" -name '*.json' | sort | tail -n 1
}

# saves_and_restores ROBOT ID REGISTER VALUE: another value of it, over what it holds.
saves_and_restores() {
    before=$(of "$1" servo-get "$2" "$3" | awk '{ print $3 }')
    rm -rf "$saved"
    of "$1" servo-set "$2" "$3" "$4" --flash >"$work/set" 2>&1 || { cat "$work/set"; return 1; }
    [ "$(find "$saved" -name '*.json' | wc -l)" -eq 1 ] || return 1
    file=$(last_saved)
    grep -q "what it keeps is saved: $file" "$work/set" &&
        grep -q "\"$3\": $before[,}]*\$" "$file" &&
        [ "$(of "$1" servo-get "$2" "$3" | awk '{ print $3 }')" = "$4" ] &&
        of "$1" servo-set "$2" --restore "$file" >"$work/out" 2>&1 &&
        says 'registers written: 1$' &&
        [ "$(of "$1" servo-get "$2" "$3" | awk '{ print $3 }')" = "$before" ] &&
        of "$1" servo-set "$2" --restore "$file" >"$work/out" 2>&1 && says 'registers written: 0$'
}

test_case "what a servo keeps is saved, and put back"
start_sim --robot koch
check "DYNAMIXEL X" saves_and_restores koch 3 return_delay 10
check "whose current limit is its own" saves_and_restores koch 6 current_limit 900
kept=$(last_saved)
check "a file of another model is refused" \
    fails 4 'it is of a XL330-M288; the servo is a XL430-W250' of koch servo-set 1 --restore "$kept"
sed 's/"current_limit": [0-9]*/"current_limit": 99999/' "$kept" >"$work/bad.json"
check "a value that it does not take" fails 3 'current_limit: its servo does not take that value' \
    of koch servo-set 6 --restore "$work/bad.json"
sed 's/"current_limit"/"voltage"/' "$kept" >"$work/bad.json"
check "a register that it does not keep" fails 3 'voltage: its servo keeps no such register' \
    of koch servo-set 6 --restore "$work/bad.json"
check "no file" fails 3 'nothing.json: ' of koch servo-set 6 --restore "$work/nothing.json"
check "without a register" fails 2 'takes ID KEY VALUE, or ID --restore FILE' of koch servo-set 6
of koch servo on m6 >/dev/null 2>&1
sed 's/"min_position": [0-9]*/"min_position": 1000/' "$kept" >"$work/jump.json"
check "not to one that holds" fails 4 'servo 6 holds, and would jump' \
    of koch servo-set 6 --restore "$work/jump.json"
of koch servo off m6 >/dev/null 2>&1
# A folder that nobody can write to: nothing is written to the servo.
rm -rf "$saved"
: >"$saved"
unsaved() {
    of koch servo-set 3 return_delay 20 --flash >"$work/out" 2>&1
    [ $? -eq 3 ] && says 'cannot be saved: .*; nothing was written$'
}
check "without a file nothing is written" unsaved
check "nothing was" [ "$(of koch servo-get 3 return_delay | awk '{ print $3 }')" = 250 ]
rm -f "$saved"
stop_sim
for one in so101:4:return_delay:5 pan-tilt:1:temperature_limit:60 gr001:2:delay:3; do
    start_sim --robot "${one%%:*}"
    # shellcheck disable=SC2046 # words
    check "of ${one%%:*}" saves_and_restores $(echo "$one" | tr : ' ')
    stop_sim
done

# Families whose values are parts of frames, one that only its EEPROM as a whole can be read of, and
# those where the change leaves a setup that the joint cannot be moved with.
another_than() {
    [ "$(awk '{ print $3 }' "$work/out")" != "$1" ]
}
two_lines() {
    [ "$(wc -l <"$work/out")" -eq 2 ]
}
whole() {
    kept=$(last_saved) &&
        [ "$(grep -c '^    "[a-z_0-9]*": -\{0,1\}[0-9]*,\{0,1\}$' "$kept")" -ge "$1" ]
}
two_of() {
    cat <<END
name: two
family: $1
joints:
  - {name: a, id: 1, servo: $2, limits_deg: [-90, 90]}
  - {name: b, id: 2, servo: $2, limits_deg: [-90, 90]}
END
}
while read -r family servo register value; do
    two_of "$family" "$servo" >"$work/two.yaml"
    start_sim --robot "$work/two.yaml"
    check "of $servo" saves_and_restores "$work/two.yaml" 1 "$register" "$value"
    check "all that a $servo keeps is in the file" whole 9
    check "its other servo is another" \
        both exits 0 of "$work/two.yaml" servo-get 2 "$register" --- another_than "$value"
    check "two registers of a $servo at once" \
        both exits 0 of "$work/two.yaml" servo-get 1 "$register" id --- \
        two_lines
    stop_sim
done <<'END'
lx16a LX-16A temperature_limit 60
lx16a LX-16A max_position 900
ics KRS-3301 temperature_limit 60
ics KRS-3301 punch 5
dynamixel1 MX-28 return_delay 10
feetech SCS0009 return_delay 10
feetech HLS3930 secondary_id 9
feetech SM40BL max_position 2100
rs30x RS405CB delay 3
dynamixel1 AX-12A max_position 600
dynamixel2 XL-320 max_position 600
dynamixel2 PH54-200-S500-R drive_mode 5
dynamixel2 H54-200-S500-R max_position 1000
dynamixel2 H54-200-S500-RA max_position 1000
END

test_case "several registers are read in one frame"
start_sim --robot koch
several() {
    of koch --trace "$work/several.pcapng" servo-get 3 >"$work/all" &&
        exits 0 "$GRCTL" --robot koch decode "$work/several.pcapng" &&
        [ "$(grep -c 'host .*read .* of servo 3 ' "$work/out")" -eq 1 ] &&
        [ "$(wc -l <"$work/all")" -gt 50 ]
}
check "all of a DYNAMIXEL X" several
check "those that are named" both exits 0 of koch servo-get 3 id temperature_limit voltage --- \
    says '^ 31  temperature_limit '
check "and no others" [ "$(wc -l <"$work/out")" -eq 3 ]
check "one that it has not" fails 2 "no register 'volts'" of koch servo-get 3 id volts
stop_sim
done_testing
