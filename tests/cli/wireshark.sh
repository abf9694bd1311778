#!/bin/sh
# SPDX-License-Identifier: MIT
# tools/wireshark/grobo.lua in tshark sees in a trace what grctl decode sees.
. tests/support/cli.sh
. tests/support/traces.sh
dissector=tools/wireshark/grobo.lua

# The dissector's own table of registers is that of the library; rows of models differ in defaults.
registers_in_header() {
    awk -F ', *' '/^ *ROW\("/ { gsub(/"| *ROW\(/, "")
        print $1, $2, $3, $4, "<" $7 ">" }' src/servo/rs30x/registers.c | uniq
}
registers_in_dissector() {
    sed -n '/^local registers/,/^}/p' $dissector |
        awk -F ', *' '/^ *\{"/ { gsub(/[" {}]/, "", $1); gsub(/[}"]/, "", $5)
            print $1, $2, $3, $4, "<" $5 ">" }'
}
same_registers() {
    registers_in_header >"$work/header" && registers_in_dissector >"$work/lua" &&
        [ "$(wc -l <"$work/header")" -gt 20 ] && diff "$work/header" "$work/lua"
}
test_that 'the registers are those of the library' same_registers

if ! command -v tshark >/dev/null 2>&1; then
    test_case 'frames as grctl decode has them'
    skip 'frames as grctl decode has them' 'no tshark here (tools/setup.sh --check installs it)'
    done_testing
    exit 0
fi

# Wireshark 4.2 and later run no Lua for root.
as_user=
if [ "$(id -u)" -eq 0 ] && command -v setpriv >/dev/null 2>&1; then
    as_user='setpriv --reuid=65534 --regid=65534 --clear-groups'
    chmod 755 "$work"
fi
# shark FILE OPTIONS...: what tshark says; its complaints fail the test.
shark() {
    install -m 644 "$1" "$work/shark.pcapng" &&
        install -m 644 $dissector "$work/shark.lua" || return
    shift
    # $as_user is a list of words.
    # shellcheck disable=SC2086
    $as_user tshark -X "lua_script:$work/shark.lua" -r "$work/shark.pcapng" "$@" \
        2>"$work/shark.err"
    shark_status=$?
    # What it says to root, and of the folders of a home that is none, is not about us.
    grep -v 'Running as user\|^$' "$work/shark.err" >&2
    return $shark_status
}

# Fields of every frame, one a line, of one side (host or robot).
fields_by_shark() {
    shark "$1" -Y "grobo.from == $2" -T fields -e grobo.kind -E occurrence=a | tr , '\n' |
        sed '/^$/d'
}
fields_by_grctl() {
    "$GRCTL" -q decode --json "$1" | sed -n 's/^{.*"from":"'"$2"'","kind":"\([a-z_]*\)".*/\1/p'
}

# agree NAME FILE: frames of either side are the same in the same order.
agree() {
    for side in host robot; do
        fields_by_shark "$1" $side >"$work/by-shark" || return 1
        fields_by_grctl "$1" $side >"$work/by-grctl" || return 1
        [ -s "$work/by-shark" ] && diff "$work/by-shark" "$work/by-grctl" || return 1
    done
}

"$GRCTL" -q -d sim --trace "$work/status" status >/dev/null
"$GRCTL" -q -d sim --trace "$work/move" init --time 100 >/dev/null
"$GRCTL" -q -d sim --wiring bus --trace "$work/bus" init --time 100 >/dev/null
"$GRCTL" -q -d sim --wiring bus --echo --trace "$work/echo" init --time 100 >/dev/null
test_that 'status: the same frames' agree "$work/status"
test_that 'init: the same frames' agree "$work/move"
test_that 'on a bus: the same frames' agree "$work/bus"
test_that 'of one wire: the same frames' agree "$work/echo"

make_trace >"$work/made" <<'LINES'
out 1000 41
out 1500 00 53 0C FA AF
in 1700 07
out 2000 03 00 1E 04 01 84 03 0A 00 95
in 3000 FD DF 01
out 900000 41 00 53 40 FA AF 53 09 FA AF 03 00 24 01 01 02 25
in 901000 12 34 FD DF 01 00 24 01 01 24 FD DF 01 00 24 01 01 01 24 07
in 902000 FD DF 63 A2 32 04 01 46 00 E2 02 51 08
out 903000 53 09 FA AF 03 00 24 01 01 02 26 50 4D 07 50 53 03 99 99
out 904000 54 09 FA AF 03 0F 1E 02 00 10 0A
out 2000000 41 00
in 2001000 07
LINES
test_that 'rubbish, frames cut off, wrong sums, split frames: the same' agree "$work/made"

# A robot of which every byte in a hundred is hit: whatever came, both see the same in it.
faults() {
    start_sim --seed 7 --fault flip=0.01,drop=0.01,rubbish=0.1,duplicate=0.05 || return 1
    "$GRCTL" -q -d "$robot" --trace "$work/faults" status >/dev/null 2>&1
    stop_sim
    # What stands at the end unfinished is for decode cut off, for tshark not there yet.
    for side in host robot; do
        fields_by_shark "$work/faults" $side >"$work/by-shark" || return 1
        fields_by_grctl "$work/faults" $side | head -n "$(wc -l <"$work/by-shark")" |
            diff "$work/by-shark" - || return 1
    done
    [ "$(grep -c . "$work/by-shark")" -gt 5 ]
}
test_that 'a line full of faults: the same frames' faults

# Ids, joints, values, sums of all frames, as numbers in their order.
values() {
    shark "$work/move" -Y 'grobo.kind == relay' -T fields -e grobo.id -e grobo.joint \
        -e grobo.reg.goal -e grobo.reg.goal_time -e grobo.sum_ok -E separator='|' >"$work/out"
    goals='0,0,20,0,-20,-20,0,20,0,20,0,-40,-20,0,0,-20,0,40,20,0'
    ids='0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20'
    says "^$ids|CHEST_P,NECK_Y,.*,L_ANKLE_R|$goals|10,10,.*|[1T]" || return 1
    shark "$work/move" -Y 'grobo.kind == return && grobo.id == 12 && grobo.reg.voltage' \
        -T fields -e grobo.joint -e grobo.reg.position -e grobo.reg.voltage \
        -e grobo.reg.temperature -e grobo.reg.torque -E separator='|' >"$work/out"
    says '^R_KNEE_P|-40|7.3[0-9]*|25|'
}
test_that 'values in their units' values

joints_as_grctl() {
    shark "$work/status" -Y 'grobo.kind == return' -T fields -e grobo.id -e grobo.joint \
        -E separator='|' | sort -n >"$work/by-shark"
    "$GRCTL" -q decode --json "$work/status" | sed -n '/"kind":"return","action"/{
        s/.*"servos":\[{"id":\([0-9]*\),"name":"\([A-Z_]*\)".*/\1|\2/
        p
    }' | sort -n | diff "$work/by-shark" -
}
test_that 'names of joints' joints_as_grctl

in_words() {
    shark "$work/made" >"$work/out" || return 1
    says 'host .* robot .*relay: write servo 3 (R_SHOULDER_P): goal 90 deg, goal_time 100 ms' &&
        says 'robot .* host .*ack' && says '\[wrong sum\]' && says 'play slot 7; .*play scenario 3'
}
test_that 'a line for people' in_words

expert() {
    shark "$work/made" -q -z expert >"$work/out" || return 1
    says 'Wrong sum' && says 'No frame' && says 'Nobody asked for it' && says 'Refused'
}
test_that 'what is wrong is told as expert information' expert

replies() {
    shark "$work/status" -2 -Y grobo.request_in -T fields -e grobo.request_in \
        -e grobo.reply_time_ms -E separator='|' >"$work/out" || return 1
    [ "$(wc -l <"$work/out")" -ge 21 ] && says '^3|[0-9]*\.[0-9]*$' || return 1
    shark "$work/made" -2 -T fields -e frame.number -e grobo.continued_in \
        -E separator='|' >"$work/out" && says '^1|2$' && says '^2|4$'
}
test_that 'replies know their requests, split frames their ends' replies

# What an adapter of one wire returns is no request: a reply answers what the host sent, its time
# counts from there, and a repeated request is the one that counts.
make_trace >"$work/one-wire" <<'LINES'
out 1000 FA AF 01 0F 2A 02 00 26
in 2000 FA AF 01 0F 2A 02 00 26
in 3500 FD DF 01 00 2A 02 01 00 00 28
out 10000 FA AF 02 0F 2A 02 00 25
in 11000 FA AF 02 0F 2A 02 00 25
out 40000 FA AF 02 0F 2A 02 00 25
in 41000 FA AF 02 0F 2A 02 00 25 FD DF 02 00 2A 02 01 00 00 2B
out 50000 FA AF 03 01 24 01 01 01 27
in 51000 FA AF 03 01 24 01 01 01 27 07
LINES
echoes() {
    shark "$work/one-wire" -2 -T fields -e frame.number -e grobo.request_in \
        -e grobo.reply_time_ms -e grobo.reply_in -E separator='|' >"$work/out" || return 1
    printf '%s\n' '1|||3' '2|||' '3|1|2.5|' '4|||' '5|||' '6|||7' '7|6|1|' '8|||9' '9|8|1|' |
        diff - "$work/out" || return 1
    # In a trace of the simulator each reply answers a packet of the host too.
    shark "$work/echo" -2 -Y 'grobo.from == host' -T fields -e frame.number >"$work/host" &&
        shark "$work/echo" -2 -Y grobo.request_in -T fields -e grobo.request_in |
        tr , '\n' >"$work/requests" || return 1
    [ "$(wc -l <"$work/requests")" -ge 20 ] && ! grep -v -x -F -f "$work/host" "$work/requests"
}
test_that 'on an echoing line replies answer what the host sent' echoes

# As the guide says: in the folder of a person's plugins.
# shellcheck disable=SC2086
as_plugin() {
    folder=$(env HOME="$work/home" $as_user tshark -G folders 2>/dev/null |
        sed -n 's/^Personal Lua Plugins:[[:space:]]*//p')
    case $folder in
    "$work/home/"*) ;;
    *) echo "not in the home: $folder"; return 1 ;;
    esac
    mkdir -p "$folder" && install -m 644 "$dissector" "$folder" && chmod 644 "$work/move" ||
        return 1
    env HOME="$work/home" $as_user tshark -r "$work/move" -Y 'grobo.kind == check' \
        2>/dev/null >"$work/out" &&
        says 'check'
}
test_that 'as a plugin' as_plugin
done_testing
