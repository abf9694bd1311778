#!/bin/sh
# SPDX-License-Identifier: MIT
# What servos of every model keep over power-off is saved to a file before it is changed, and put
# back from it: all registers that may be written, but those by which a servo is reached.
. tests/support/cli.sh
unset GRCTL_ROBOT

if ! have_json || [ -n "${NATIVE_GRCTL:-}${EMULATOR:-}" ]; then
    echo "1..0 # SKIP no python3, or three hundred starts that are emulated"
    exit
fi
mkdir "$work/models"
python3 tests/support/eeprom_models.py "$GRCTL" "$work/models" >"$work/told" 2>"$work/why" ||
    cat "$work/why" >>"$work/told"
put_back() {
    grep -q -x -e "ok $1" "$work/told" || { cat "$work/told"; return 1; }
}
for family in $("$GRCTL" robot servos | awk '!seen[$1]++ { print $1 }'); do
    test_that "$family" put_back "$family"
done
all_of_them() {
    cat "$work/told"
    awk '/ models, / { exit !($1 >= 110 && $3 > 1500) }' "$work/told"
}
test_that "these are more than a hundred models" all_of_them

# The others are written while the servo answers writes: it does not wait for each of them.
test_case "the reply level is put back last, or first where it says less"
printf '%s\n' 'name: one' 'family: feetech' 'joints:' \
    '  - {name: a, id: 1, servo: STS3215, limits_deg: [-90, 90]}' >"$work/one.yaml"
cat >"$work/less.json" <<END
{"id": 1, "model": "STS3215",
 "registers": {"id": 1, "reply_level": 0, "return_delay": 5, "temperature_limit": 60}}
END
sed 's/_level": 0/_level": 1/; s/: 5,/: 6,/' "$work/less.json" >"$work/more.json"
order() {
    printf '%s\n' "servo-set 1 --restore $work/$1.json" "servo-set 1 --restore $work/$2.json" \
        >"$work/script"
    "$GRCTL" --robot "$work/one.yaml" -y -d sim --trace "$work/trace" shell "$work/script" &&
        "$GRCTL" --robot "$work/one.yaml" decode "$work/trace" |
        grep 'host.* write' | grep -o 'return_delay\|temperature_limit\|reply_level' \
            >"$work/written"
}
in_order() {
    order less more >"$work/said" 2>&1 &&
        [ "$(uniq "$work/written" | tr '\n' ' ')" = \
            "return_delay temperature_limit reply_level return_delay " ] ||
        { cat "$work/said" "$work/written"; return 1; }
}
check "by the trace" in_order
done_testing
