#!/bin/sh
# SPDX-License-Identifier: MIT
# scan and info of a GR001, who answers and who does not, by what they print.
. tests/support/cli.sh

# said PATTERN: on standard error.
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

test_case "scan, info"

# It waits for each that is silent: not as long as on_robot() would.
scan() {
    "$GRCTL" -d "$robot" --timeout 100 scan "$@"
}
finds() {
    [ "$(grep -c ' bps  ' "$work/out")" -eq "$1" ]
}
check "scan finds 20" both exits 0 scan --last 30 --- finds 20
check "a row of it" says '^ 12  RS301CR   firmware   1  115200 bps  R_KNEE_P$'
check "how long it took" said '^20 servos; 10 silent; [0-9]* ms, of which the wire took [0-9]*$'
check "all ids are asked without --last" both exits 0 "$GRCTL" -d sim scan --- said '; 107 silent; '
check "nobody there" exits 1 scan --first 21 --last 40
check_json "as JSON" '[s["id"] for s in lines[0]["servos"]] == [12, 13] and
    lines[0]["silent"] == 0 and lines[0]["wire_ms"] > 0' on_robot scan --json --first 12 --last 13
tell fault delay=1
check "who answers late is found" both exits 0 on_robot scan --first 10 --last 15 --- \
    says '^ 12 .*R_KNEE_P'
tell fault delay=0
check "a move as asked" exits 0 on_robot move m5 -40 1500
as_asked() {
    ! grep -q 'it took' "$work/err"
}
check "needs no word on its time" as_asked
check "status of another process knows the target" both exits 0 on_robot status m5 --- \
    says '^    5  R_ELBOW_P  *-40\.0  *-40\.0  on '
check "a joint without torque has none" both exits 0 on_robot status m4 --- \
    says '^    4  R_SHOULDER_R  *[-0-9.]*  *-  off '
check "a move that took longer" both exits 0 on_robot move m5 40 10 --- \
    said '^it took [0-9]* ms, not 10: no joint moves faster'
tell id 3 12
check "two servos with one id are named" both exits 1 on_robot scan --first 10 --last 13 --- \
    said '^id 12 answers, but: .* (two servos with one id?)$'
check "nobody else is" both finds 3 --- said '^not sure: '
if have_json; then
    twice_as_json() {
        exits 1 on_robot scan --json --first 10 --last 13 &&
            json '[(s["id"], s["name"]) for s in lines[0]["failed"]] == [(12, "R_KNEE_P")] and
                lines[0]["failed"][0]["status"] in ("checksum", "mismatch", "short")'
    }
    check "and in JSON, with the error" twice_as_json
else
    skip "and in JSON" "no python3"
fi
tell id 3 3
check "--first behind --last" fails 2 'first is behind' on_robot scan --first 5 --last 3
check "--all-baud through the board" fails 2 'needs --wiring bus' on_robot scan --all-baud
check "--all-baud without a line" fails 2 'needs a line' \
    "$GRCTL" -d sim --wiring bus scan --all-baud
check "info" both exits 0 on_robot info --- says '^ 20  RS301CR   firmware   1 .* L_ANKLE_R$'
check "how it is reached" says '^GR001 on .*, through its board, which answers$'
# One that is silent costs the whole time, at each try.
soon() {
    "$GRCTL" -d "$robot" --timeout 150 "$@"
}
tell silent 12 on
check "a silent servo is named" both exits 1 on_robot info --- \
    said '^motor 12 (R_KNEE_P): no reply in time$'
check "who does not answer: what, where, what to do" fails 1 \
    "no reply from motor 12 (R_KNEE_P) in [0-9.]* ms after 2 retries; is its cable in? see" \
    soon servo on m12
check "as often as asked" fails 1 'R_KNEE_P) in [0-9.]* ms after 1 retry;' \
    soon --retries 1 servo on m12
check "-v: the bytes too" both exits 1 soon -v servo on m12 --- \
    said '^sent 54 09 FA AF 0C 0F 1E 18 00 05 20; received nothing$'
tell silent 12 off
check "-vv: every byte" both exits 0 on_robot -vv status m12 --- \
    said '^ *[0-9.]*  >  54 09 FA AF 0C 0F 1E 18 00 05 20$'
check "and what came" said '^ *[0-9.]*  <  FD DF 0C 00 1E 18 01 '

stop_sim
done_testing
