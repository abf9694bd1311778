#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl sim --state FILE: flash survives the simulator, whatever ends it, and whatever is in FILE.
. tests/support/cli.sh
own_sim
state=$work/flash

# shellcheck disable=SC2120 # options are for some calls
chain() {
    start_sim --servo 1=RS304MD,2=RS302CD --state "$state" "$@"
}
servo() {
    "$GRCTL" -q -d "$robot" --wiring bus --timeout 500 "$@"
}
delay_is() {
    servo servo-get "$1" delay >"$work/out" && says " $2 "
}

chain
test_case "registers are kept over power-off"
check "a file that is not there is made" [ "$(wc -l <"$state")" -eq 3 ]
check "set without flash" exits 0 servo servo-set 2 delay 5
stop_sim
chain
check "is forgotten" delay_is 2 0
# The robot's other servos are not there, and nobody waits for them.
nobody_else_is_asked() {
    "$GRCTL" decode "$work/asked" >"$work/out" && says 'host .*servo 2 ' &&
        ! grep 'host .*servo' "$work/out" | grep -v 'servo 2 '
}
check "no other servo is asked" both servo --trace "$work/asked" servo-get 2 delay --- \
    nobody_else_is_asked
check "set with flash" exits 0 servo servo-set 2 delay 7 --flash
check "and an id" exits 0 servo servo-set 1 id 9 --flash
stop_sim
cp "$state" "$work/good"
chain
check "is kept" delay_is 2 7
check "the id too" delay_is 9 0
stop_sim

# Killed: what the servos had written is there, and the lock of the dead one is not in the way.
chain
check "set once more" exits 0 servo servo-set 2 delay 11 --flash
changed() {
    ! cmp -s "$state" "$work/good"
}
check "the file is written while it runs" wait_for changed
kill -s KILL "$sim_pid"
wait "$sim_pid" 2>/dev/null
sim_pid=
chain
test_case "one file, one simulator, whole after SIGKILL"
check "after SIGKILL it is there too" delay_is 2 11
check "one file, one simulator" fails 3 'flash: another simulator has it' timeout 5 "$GRCTL" sim \
    --servo 1=RS304MD,2=RS302CD --state "$state"
ln -s flash "$work/other-name"
check "by another name too" fails 3 'another simulator has it' \
    timeout 5 "$GRCTL" sim --servo 1=RS304MD,2=RS302CD --state "$work/other-name"
check "the first one goes on" delay_is 2 11
stop_sim
check "no lock is left" [ ! -e "$state.lock" ]

# Hostile files: one line, status 3, and the file as it was.
refused() {
    cp "$work/bad" "$work/bad.before"
    fails 3 "^grctl: sim: --state: $work/bad: " timeout 5 "$GRCTL" sim \
        --servo 1=RS304MD,2=RS302CD --state "$work/bad" && cmp "$work/bad" "$work/bad.before"
}
: >"$work/bad"
test_case "files that are none are refused"
check "an empty file" refused
head -c 300 /dev/urandom >"$work/bad"
check "noise" refused
head -c 100 "$work/good" >"$work/bad"
check "a file cut off" refused
sed '3s/^3020/3040/' "$work/good" >"$work/bad"
check "another servo" refused
sed '2s/^3040 09/3040 00/' "$work/good" >"$work/bad"
check "an id that no servo can have" refused
check "which line" complains 'line 2: a register has a value'
sed '2s/^3040 09/3040 zz/' "$work/good" >"$work/bad"
check "no hexadecimal" refused
check "it is that which is wrong" complains 'line 2: no registers in hexadecimal'
sed '2s/ /\t/' "$work/good" >"$work/bad"
check "another space" refused
cat "$work/good" "$work/good" >"$work/bad"
check "too many lines" refused
sed '3d' "$work/good" >"$work/bad"
check "too few" refused
sed '2s/$/ 00/' "$work/good" >"$work/bad"
check "a line too long" refused
head -c 1000000 /dev/zero >"$work/bad"
check "a file too long" refused
sed '1s/1$/2/' "$work/good" >"$work/bad"
check "another version" refused
check "a folder" fails 3 'directory' timeout 5 "$GRCTL" sim --state "$work"
check "no such folder" fails 3 'no such' timeout 5 "$GRCTL" sim --state "$work/none/state"
mkfifo "$work/fifo"
check "a pipe" fails 3 'not a regular file' timeout 5 "$GRCTL" sim --state "$work/fifo"

start_sim --robots 2 --state "$work/many"
test_case "more robots, more files"
check "more robots, more files" both exits 0 test -s "$work/many" --- exits 0 test -s "$work/many2"
stop_sim
done_testing
