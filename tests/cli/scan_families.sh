#!/bin/sh
# SPDX-License-Identifier: MIT
# scan where nobody knows which servos are on the line: of one family, and of all.
. tests/support/cli.sh
. tests/support/registers.sh

test_case "whoever is there"

for one in 3=LX-16A:lx16a 4=KRS-3301:ics; do
    start_sim --servo "${one%:*}"
    check "scan finds ${one%:*}" both exits 0 "$GRCTL" -d "$robot" --timeout 100 scan \
        --family "${one#*:}" --last 5 --- says "^  ${one%%=*} .* ${one#*:}\$"
    stop_sim
done
start_sim --servo 1=XL330-M288,2=STS3215,3=AX-12A,5=SCS0009 -b 1000000
on_line() {
    "$GRCTL" -d "$robot" --timeout 100 scan "$@"
}
check "every family is found" exits 0 on_line --family all --last 6
check "DYNAMIXEL 2.0" says '^  1  XL330-M288  firmware  52  1000000 bps  dynamixel2$'
check "Feetech STS" says '^  2  STS3215   firmware   3  1000000 bps  feetech$'
check "DYNAMIXEL 1.0" says '^  3  AX-12A    firmware  24  1000000 bps  dynamixel1$'
check "Feetech SCS" says '^  5  SCS0009   firmware   3  1000000 bps  feetech$'
check "and nobody twice" [ "$(grep -c ' bps  ' "$work/out")" -eq 4 ]
check "one family" both exits 0 on_line --family dynamixel2 -b 1000000 --last 3 --- \
    said '^1 servo; 3 silent; '
check "nobody there" exits 1 on_line --family rs30x --last 3
check_json "in JSON" '[(s["id"], s["family"], s["joint"]) for s in lines[0]["servos"]] ==
    [(1, "dynamixel2", None)]' on_line --timeout 500 --json --family dynamixel2 -b 1000000 --last 2
check "without a line" fails 2 '--family needs a line' \
    "$GRCTL" -d sim scan --family dynamixel2 --last 2
stop_sim
done_testing
