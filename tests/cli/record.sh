#!/bin/sh
# SPDX-License-Identifier: MIT
# `grctl record` while a hand turns the simulated robot's joints.
. tests/support/cli.sh

# start_record OPTIONS...: it hears the keys written to descriptor 6; ready when this returns.
start_record() {
    rm -f "$work/keys" "$work/err"
    mkfifo "$work/keys"
    (cd "$work" && exec "$GRCTL" -d "$robot" --timeout 500 record "$@" <keys >out 2>err) &
    record_pid=$!
    exec 6>"$work/keys"
    written "$work/err" '^\(space\|Ctrl-C\)'
}

key() {
    printf '%s' "$1" >&6
}

# What the record that ran ended with is in $ended then: checks run in a shell of their own.
finish() {
    wait $record_pid
    ended=$?
    exec 6>&-
}

# In a second, and the joint rests there.
turn_elbow() {
    tell turn 5 "$1" 1000
    wait_for sim_shows 5 " $1\.0 deg"
}

# counts N FILE: so many postures.
counts() {
    exits 0 "$GRCTL" --json show "$2" || return 1
    [ "$(grep -o '"time_ms"' "$work/out" | wc -l)" -eq "$1" ] && return
    cat "$work/out"
    return 1
}

fails_to_find() {
    ! grep -e "$1" "$2"
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

exits 0 on_robot servo on
start_record --key -o wave.pseq
test_case "postures are recorded by key"
check "what holds is held in the hands" grep -q 'joints follow your hands' "$work/err"
key ' '
turn_elbow -90
key '  d'
key s
finish
check "by key: s saves" [ $ended -eq 0 ]
check "it says where" says '^wave.pseq$'
check "two are left of three" counts 2 "$work/wave.pseq"
check "torque holds afterwards" both exits 0 on_robot status m5 --- says ' on '

start_record --key --json
key 'd '
exec 6>&-
finish
test_case "the end of the keys is the end, in JSON"
check "the end of the keys is the end" [ $ended -eq 0 ]
if have_json; then
    check "its name is the first free one" json \
        'lines[0]["file"] == "Motion1.m" and lines[0]["postures"] == 1'
else
    skip "its name is the first free one" "no python3 to parse JSON with"
fi
check "it is there" [ -s "$work/Motion1.m" ]

# The elbow alone is read a hundred times a second: a hand that turns it is seen all the way. With
# all joints it would be seen 13 times.
exits 0 on_robot move m5 -20 500
start_record --rate 50 --moved 1 -o all.m m5
tell load 5 200
wait_for sim_shows 5 'torque brake'
tell turn 5 -80 2000
wait_for sim_shows 5 ' -80\.0 deg'
tell load 5 0
kill -INT $record_pid
finish
test_case "a whole motion is recorded at a rate"
check "Ctrl-C is told by the status" [ $ended -eq 130 ]
check "no rate is called too high" fails_to_find 'sees nothing more' "$work/err"
check "what was recorded is kept" counts "$(wc -l <"$work/all.m")" "$work/all.m"
check "it has more than a reading of all joints would see" [ "$(wc -l <"$work/all.m")" -gt 20 ]
check "it is a motion" exits 0 "$GRCTL" show "$work/all.m"

start_record --rate 50 -o lost.m arms
test_case "a lost line: what was recorded is kept"
check "a rate that the line does not allow is told" \
    grep -q 'each joint 20.8 times a second: a higher --rate sees nothing more' "$work/err"
tell plug out
finish
check "a lost line is a failure" [ $ended -eq 1 ]
check "what was recorded is kept then too" [ -s "$work/lost.m" ]
tell plug in

# killed: nobody could save anything.
killed() {
    kill -KILL $record_pid
    wait $record_pid 2>/dev/null
    exec 6>&-
    # Its guard gives the line back.
    wait_for exits 0 on_robot status m5
}
start_record --key -o power.pseq
turn_elbow -40
key ' '
written "$work/err" '^1 kept'
turn_elbow -60
key ' '
written "$work/err" '^2 kept'
key 'd '
said_again() {
    [ "$(grep -c '^2 kept' "$work/err")" -eq 2 ]
}
wait_for said_again
test_case "what was recorded before the power went is there"
killed
check "nothing has the name of the recording" test ! -e "$work/power.pseq"
check "both postures can be read" counts 2 "$work/power.pseq.part.m"
check "as they were" grep -q ' -400 ' "$work/power.pseq.part.m"
cp "$work/power.pseq.part.m" "$work/left"
start_record --key -o power.pseq
check "the next recording says so" \
    grep -q '^power.pseq.part.m has what a recording kept' "$work/err"
key ' q'
finish
check "and leaves it" cmp "$work/left" "$work/power.pseq.part.m"
check "its own is gone when it is saved" test ! -e "$work/power.pseq.part2.m"
check "it is saved" counts 1 "$work/power.pseq"

# A disk that is full while it is recorded; more is there at the end.
small_record() {
    rm -f "$work/keys" "$work/err"
    mkfifo "$work/keys"
    mkdir "$work/disk"
    (cd "$work" && exec unshare -Urm sh -c 'mount -t tmpfs -o size=4k none disk && exec "$@"' sh \
        "$GRCTL" -d "$robot" --timeout 500 record --key -o disk/full.m <keys >out 2>err) &
    record_pid=$!
    exec 6>"$work/keys"
    written "$work/err" '^\(space\|Ctrl-C\)'
}
test_case "a full disk ends no recording"
if unshare -Urm true 2>/dev/null; then
    small_record
    i=0
    while [ $i -lt 80 ]; do # of more than 80 bytes each
        i=$((i + 1))
        key ' '
        written "$work/err" "^$i kept"
    done
    check "it says so" grep -q 'full.m.part.m: cannot write: .*memory alone' "$work/err"
    check "once" test "$(grep -c 'memory alone' "$work/err")" -eq 1
    check "and goes on" grep -q '^80 kept' "$work/err"
    key q
    finish
    check "the file that cannot be written is an error" test $ended -eq 3
    check "it says what is there" grep -q 'full.m.part.m has [1-7][0-9] postures of it' "$work/err"
else
    skip "a disk of 4 KiB" "a user namespace of its own is needed"
fi

start_record --key
key q
finish
test_case "who cannot be recorded says why"
check "nothing is left" test ! -e "$work/Motion.part.m"
check "nothing was shown" grep -q 'nothing was recorded' "$work/err"
check "a name without a format" fails 2 'unknown file type' \
    on_robot record -o wave
check "a joint that is none" fails 2 'no joint or group' on_robot record tail
cp motions/greet.pseq "$work/greet.m"
check "a file of another format, before a joint is let go" \
    fails 3 'greet.m: holds something other' \
    "$GRCTL" -d sim record -o "$work/greet.m"
check "it is as it was" cmp motions/greet.pseq "$work/greet.m"
check "a folder that is none, before a joint is let go" fails 3 'nowhere/wave.m: cannot write' \
    on_robot record --key -o nowhere/wave.m
stop_sim
done_testing
