#!/bin/sh
# SPDX-License-Identifier: MIT
# scan, info, servo-get, servo-set and doctor with servos of Hiwonder and Kondo, whose values are
# read and written in pieces.
. tests/support/cli.sh
. tests/support/registers.sh

test_case "Hiwonder LX"

describe() {
    printf 'name: t\nfamily: %s\njoints:\n' "$1"
    printf '  - {name: turn, id: 1, servo: %s, limits_deg: [-90, 90]}\n' "$2"
    printf '  - {name: lift, id: 2, servo: %s, limits_deg: [-20, 60]}\n' "$2"
}
describe lx16a LX-16A >"$work/lx.yaml"
describe ics KRS-3301 >"$work/krs.yaml"
describe ics KRS-2552RHV >"$work/krs35.yaml"
printf '%s\n' 'name: t' 'family: ics' 'joints:' \
    '  - {name: other, id: 9, servo: KRS-3301, limits_deg: [-90, 90]}' >"$work/beside.yaml"

start_told_sim --robot "$work/lx.yaml"
check "LX: scan" both exits 0 of "$work/lx.yaml" scan --last 4 --- says '^  1  Hiwonder LX .* turn$'
check "info" both exits 0 of "$work/lx.yaml" info --- says '^  2  Hiwonder LX .* lift$'
check "all of its values" both exits 0 of "$work/lx.yaml" servo-get lift --- \
    says '^ 30  voltage  *7[0-9]*  *7\.[0-9]* V$'
check "one of two that go together" both exits 0 of "$work/lx.yaml" \
    servo-set 1 max_position 900 --- \
    said '^servo 1: max_position 1000 (120.0 deg) -> 900 (96.0 deg), kept$'
check "the other stays" both exits 0 of "$work/lx.yaml" servo-get 1 min_position --- \
    says '^  2  min_position  *0  *-120.0 deg$'
check "an id" both exits 0 of "$work/lx.yaml" servo-set 2 id 9 --- said '^servo 9: id 2 -> 9, kept$'
check "found again" both exits 0 of "$work/lx.yaml" scan --first 9 --last 9 --- \
    says '^  9  Hiwonder LX'
check "and back" exits 0 of "$work/lx.yaml" servo-set 9 id 2
check "doctor" both exits 0 of "$work/lx.yaml" doctor --- says 'all 2 answer'
check "no brake" fails 4 'the servos of t have no brake' of "$work/lx.yaml" servo brake
stop_sim

start_told_sim --robot "$work/krs.yaml"
test_case "Kondo KRS"
check "KRS: scan" both exits 0 of "$work/krs.yaml" scan --- says '^  1  Kondo KRS .* turn$'
check "its EEPROM" both exits 0 of "$work/krs.yaml" servo-get 1 max_position --- \
    says '^  8  max_position  *11500  *135.0 deg$'
exits 0 of "$work/krs.yaml" move turn 30
check "halves of a position are put together" both exits 0 of "$work/krs.yaml" servo-get 1 --- \
    says '^ 50  present_position  *8[0-9]*  *30.0 deg$'
check "a setting of one that holds" fails 4 'servo 1 holds' \
    of "$work/krs.yaml" servo-set 1 stretch 80
exits 0 of "$work/krs.yaml" servo off
check "of one that does not" both exits 0 of "$work/krs.yaml" servo-set 1 stretch 80 --- \
    said '^servo 1: stretch 60 -> 80, kept$'
check "the rest of the EEPROM stays" both exits 0 of "$work/krs.yaml" servo-get 1 punch --- \
    says '^  3  punch  *1$'
check "the rate" both exits 0 of "$work/krs.yaml" servo-set 2 baud 625000 --- \
    said 'baud 10 (115200 bps) -> 1 (625000 bps), kept; it answers at 625000 bps$'
check "where it is found" both exits 0 of "$work/krs.yaml" scan --all-baud --last 2 --- \
    says '^  2  Kondo KRS .* 625000 bps'
check "and back" exits 0 of "$work/krs.yaml" -b 625000 servo-set 2 baud 115200
check "doctor tells no voltage" both exits 0 of "$work/krs.yaml" doctor -v --- \
    says 'do not report their voltage'
stop_sim

# The servos do not tell which they are: one that no file names is asked for what all of them tell.
test_case "Kondo KRS that no file names"
start_told_sim --robot "$work/beside.yaml" --servo 9=KRS-3301,1=KRS-2552RHV,2=KRS-3301
all_but_the_position() {
    of "$work/beside.yaml" servo-get "$1" >"$work/told" &&
        grep -q '^ 49  temperature ' "$work/told" && ! grep present_position "$work/told"
}
check "all registers of one with ICS 3.5" all_but_the_position 1
check "of one with ICS 3.6" all_but_the_position 2
check "a setting" both exits 0 of "$work/beside.yaml" servo-set 1 stretch 80 --- \
    said '^servo 1: stretch 60 -> 80, kept$'
stop_sim
sed 's/id: 1/id: 2/; /lift/d' "$work/krs.yaml" >"$work/alone.yaml"
start_told_sim --robot "$work/alone.yaml"
exits 0 of "$work/alone.yaml" move turn 30 --on-exit hold
check "of one that holds" fails 4 'servo 2 holds.*no joint of this robot' \
    of "$work/beside.yaml" servo-set 2 stretch 80
gives_no_id() {
    echo "$work/beside.yaml" | "$GRCTL" -d "$robot" --yes setup >"$work/told" 2>&1
    [ $? -eq 4 ] && grep -q 'setup: servo 2 holds; switch its power off' "$work/told"
}
check "which setup gives no id either" gives_no_id
stop_sim
check "ICS 3.5 does not tell where it stands" both \
    exits 3 "$GRCTL" robot check "$work/krs35.yaml" --- \
    says '4:.*turn: a KRS-2552RHV does not tell where it stands'
done_testing
