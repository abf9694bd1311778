#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl sim --strict: what a client does against the protocol, one line each, and the exit status.
. tests/support/cli.sh
own_sim

# Opens the simulator as any program does, and writes bytes: "FA AF 01"; "wait 30" pauses for 30 ms,
# "reply 8" reads a reply of 8 bytes.
cat >"$work/client.py" <<'PY'
import os, select, sys, time, tty
fd = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(fd)
for what in sys.argv[2:]:
    if what.startswith("wait "):
        time.sleep(float(what[5:]) / 1e3)
    elif what.startswith("reply "):
        wanted = int(what[6:])
        while wanted > 0 and select.select([fd], [], [], 30)[0]:
            wanted -= len(os.read(fd, wanted))
    else:
        os.write(fd, bytes.fromhex(what))
PY

# offended: the simulator has printed an offence.
offended() {
    grep -q '^grctl: sim: robot ' "$work/sim.log"
}

# strict OPTIONS --- BYTES...: the status when it is ended, the lines of offences. Where $awaits is
# set, such a line is waited for.
awaits=
strict() {
    strict_options=
    while [ "$1" != --- ]; do
        strict_options="$strict_options $1"
        shift
    done
    shift
    # shellcheck disable=SC2086 # options are words
    start_sim --strict $strict_options
    python3 "$work/client.py" "$robot" "$@" "wait 60"
    [ -z "$awaits" ] || wait_for offended
    kill -s TERM "$sim_pid"
    wait "$sim_pid"
    strict_status=$?
    sim_pid=
    grep '^grctl: sim: robot ' "$work/sim.log" >"$work/out"
}

# offends CODE BYTES [COUNT]: the last strict ended with 3, and this is what was printed.
offends() {
    [ $strict_status -eq 3 ] && says "^grctl: sim: robot 1: [0-9.]* ms: $1: .*: $2" &&
        [ "$(wc -l <"$work/out")" -eq "${3:-1}" ] && return
    echo "status $strict_status"
    cat "$work/out"
    return 1
}

if by_tcp || ! command -v python3 >/dev/null 2>&1; then
    test_case 'offences against the protocol'
    skip 'offences against the protocol' 'needs a pty and python3'
    done_testing
    exit 0
fi

chain='--servo 1=RS301CR,2=RS304MD'
# t NAME CODE BYTES-PRINTED BYTES...
t() {
    name=$1
    code=$2
    bytes=$3
    shift 3
    case $code in
    rubbish | cut) awaits= ;; # told when the simulator ends
    *) awaits=yes ;;
    esac
    # shellcheck disable=SC2086 # options are words
    strict $chain --- "$@"
    awaits=
    test_that "$name" offends "$code" "$bytes"
}

# shellcheck disable=SC2086 # options are words
strict $chain --- 'FA AF 01 0F 2A 02 00 26' 'reply 10' 'FA AF 01 00 1E 04 01 84 03 0A 00 97' \
    'wait 30' 'FA AF 01 40 FF 00 00 BE' 'wait 30' 'FA AF 01 0F 2A 02 00 26'
faultless() {
    cat "$work/out"
    [ "$strict_status" -eq 0 ] && [ ! -s "$work/out" ]
}
test_that 'a client that keeps to the protocol: 0, and nothing is printed' faultless
t 'a wrong sum' sum 'FA AF 01 00 24 01 01 01 25' 'FA AF 01 00 24 01 01 01 25'
t 'a value out of range' range 'FA AF 01 00 1E 02 01 D0 07 CB' 'FA AF 01 00 1E 02 01 D0 07 CB'
test_that 'which' says 'goal 2000 is outside -1500..1500'
t 'a register that is read-only' range 'FA AF 01 00 2A' 'FA AF 01 00 2A 02 01 00 00 28'
t 'behind the last register' request 'FA AF 01 0F 8B' 'FA AF 01 0F 8B 05 00 80'
t 'an id in a long packet' range 'FA AF 00 00 24' 'FA AF 00 00 24 02 01 80 01 A6'
t 'what an RS301CR does not have' refused 'FA AF 01 0D' 'FA AF 01 0D 00 00 01 0D'
t 'bytes that are no frame' rubbish '41 00 12' '41 00 12'
t 'a frame cut off' cut 'FA AF 01 0F' 'FA AF 01 0F'
t 'talking over a reply' talk 'FA AF 01 0F 00 1E 00 10 FA AF 02' \
    'FA AF 01 0F 00 1E 00 10 FA AF 02 00 24 01 01 01 27'
t 'writing during a flash write' busy 'FA AF 01 00 24 01 01 01 24' 'FA AF 01 40 FF 00 00 BE' \
    'wait 50' 'FA AF 01 00 24 01 01 01 24'
check 'why' says 'the servo writes its flash'
t 'writing during a restart' busy 'FA AF 01 00 24 01 01 01 24' 'FA AF 01 20 FF 00 00 DE' \
    'wait 50' 'FA AF 01 00 24 01 01 01 24'
# A machine that holds the client up makes its pause too long: what was begun never ends then.
for _ in 1 2 3 4 5; do
    # shellcheck disable=SC2086 # options are words
    strict $chain --- 'FA AF 01' 'wait 30' '00 24 01 01 01 24'
    grep -q ' cut: ' "$work/out" || break
done
test_that 'a pause inside a packet' offends stall 'FA AF 01'

strict --- '54 09 FA AF 01 0F 24 12 00 38 1A'
test_that 'through the board: nothing' [ "$strict_status" = 0 ]
strict --- '54 09 FA AF 01 0F 24 12 00 38 0A'
test_that 'too few bytes asked of the board' offends relay '54 09 FA'
strict --- '53 09 FA AF 01 00 24 01 01 01 25' 'wait 20' '41 00'
test_that 'a wrong sum behind the board' offends sum '53 09 FA AF 01'
strict --robots 2 --- '41 00'
test_that 'two robots' [ "$strict_status" = 0 ]
# A simulator that the machine holds up answers late, when grctl asks again: that alone is repeated.
ours() {
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        start_sim --strict --wiring "$1"
        "$GRCTL" -q -d "$robot" --timeout 5000 --wiring "$1" init --time 100
        kill -s TERM "$sim_pid"
        wait "$sim_pid"
        strict_status=$?
        sim_pid=
        [ $strict_status -eq 0 ] && return
        grep '^grctl: sim: robot ' "$work/sim.log"
        grep '^grctl: sim: robot ' "$work/sim.log" | grep -qv ' talk: ' && break
    done
    return 1
}
test_that 'grctl keeps to the protocol' ours board
check 'on a bus too' ours bus
start_sim --json --strict --wiring bus
python3 "$work/client.py" "$robot" 'FA AF 01 00 24 01 01 01 25' 'wait 30'
read -r line <&6
printf '%s\n' "$line" >"$work/out"
check 'as JSON' says '^{"offence":"sum","robot":1,"time_ms":[0-9.]*,"bytes":"FA AF 01 [^"]*25",'
stop_sim
# ---- other families

chain='--robot so101'
# shellcheck disable=SC2086 # options are words
strict $chain --- 'FF FF 01 04 02 38 02 BE' 'reply 8' 'FF FF 01 05 03 2A 00 08 C4' 'reply 6'
test_that "Feetech: a read and a goal" faultless
t 'Feetech: a wrong sum' sum 'FF FF 01 04 02 38 02 BF$' 'FF FF 01 04 02 38 02 BF'
t 'Feetech: a read-only register' range 'FF FF 01 05 03 38 00 08 B6$' 'FF FF 01 05 03 38 00 08 B6'
t 'Feetech: an unknown instruction' request 'FF FF 01 02 77 85$' 'FF FF 01 02 77 85'
t 'Feetech: no frame' rubbish 'FF FF 01 01 00$' 'FF FF 01 01 00'
chain='--robot koch'
t 'DYNAMIXEL: a value out of range' range 'FF FF FD 00 01 06 00 03 40 00 09 .*$' \
    'FF FF FD 00 01 06 00 03 40 00 09 E8 E6'
t "DYNAMIXEL: an instruction of Feetech's" request 'FF FF FD 00 01 03 00 0B 25 4E$' \
    'FF FF FD 00 01 03 00 0B 25 4E'
chain='--servo 1=MX-28,2=AX-12A'
# shellcheck disable=SC2086 # options are words
strict $chain --- 'FF FF 01 05 03 1E C4 09 0B'
test_that "each servo by its own model: a goal of MX-28 that AX-12A has not" faultless
t 'the same to the AX-12A' range 'FF FF 02 05 03 1E C4 09 0A$' 'FF FF 02 05 03 1E C4 09 0A'
test_that 'and its range' says '2500 .*outside 0\.\.1023'
t 'what no MX-28 has' range 'FF FF 01 05 03 1E 30 75 33$' 'FF FF 01 05 03 1E 30 75 33'
test_that 'and its own range' says '30000 .*outside -28672\.\.28672'
# An id that was given while it ran goes with the model.
# shellcheck disable=SC2086
strict $chain --- 'FF FF 01 04 03 03 07 ED' 'reply 6' 'FF FF 07 05 03 1E C4 09 05' 'reply 6'
test_that "by the id that it was given" faultless
test_that "two families on a line" fails 2 'knows one family on a line' \
    "$GRCTL" sim --strict --servo 1=XL330-M288,2=STS3215
done_testing
