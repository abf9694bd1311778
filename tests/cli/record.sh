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
    until grep -qs '^\(space\|Ctrl-C\)' "$work/err"; do kill -0 $record_pid || return 1; done
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

# The elbow is turned until it stands elsewhere; free mode grips again and again on the way.
turn_elbow() {
    turned_tries=0
    turned_from=$(where)
    until [ "$(where)" != "$turned_from" ]; do
        tell turn 5 "$1" 1000
        turned_tries=$((turned_tries + 1))
        [ $turned_tries -lt 200 ] || return 1
    done
}

where() {
    tell look 5
    tail -n 1 "$work/sim.log" | sed 's/ deg .*//'
}

# counts N FILE: so many postures.
counts() {
    exits 0 "$GRCTL" --json show "$2" || return 1
    [ "$(grep -o '"time_ms"' "$work/out" | wc -l)" -eq "$1" ] && return
    cat "$work/out"
    return 1
}

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

start_record --key -o wave.pseq
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
check "the end of the keys is the end" [ $ended -eq 0 ]
if have_json; then
    check "its name is the first free one" json \
        'lines[0]["file"] == "Motion1.m" and lines[0]["postures"] == 1'
else
    skip "its name is the first free one" "no python3 to parse JSON with"
fi
check "it is there" [ -s "$work/Motion1.m" ]

start_record --rate 20 --moved 0 -o all.m right_arm
until [ "$(wc -l <"$work/sim.log")" -gt 400 ]; do tell look 5; done
kill -INT $record_pid
finish
check "Ctrl-C is told by the status" [ $ended -eq 130 ]
check "what was recorded is kept" counts "$(wc -l <"$work/all.m")" "$work/all.m"
check "it is a motion" exits 0 "$GRCTL" show "$work/all.m"

start_record -o lost.m
tell plug out
finish
check "a lost line is a failure" [ $ended -eq 1 ]
check "what was recorded is kept then too" [ -s "$work/lost.m" ]
tell plug in

start_record --key
key q
finish
check "nothing was shown" grep -q 'nothing was recorded' "$work/err"
check "a name without a format" fails 2 'its name tells no format' \
    on_robot record -o wave
check "a joint that is none" fails 2 'no joint or group' on_robot record tail
check "a folder that is none, before a joint is let go" fails 3 'nowhere/wave.m: cannot write' \
    on_robot record --key -o nowhere/wave.m
stop_sim
done_testing
