#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl sim: a robot for other programs, where they find it.
. tests/support/cli.sh
own_sim

test_case "where it is"

start_sim
check "the path is a terminal's" [ -c "$sim_pty" ]
check "two programs, one after the other" both exits 0 on_robot move m2 20 200 --- \
    exits 0 on_robot status m2
check "the robot stays as it was left" says 'NECK_Y  *20\.0  *20\.0  *on '
ignores_int() {
    kill -s INT "$sim_pid"
    exits 0 on_robot status m2
}
check "SIGINT, ignored when it began as a shell does for &: it stays" ignores_int
ends() {
    kill -s "$1" "$sim_pid"
    wait "$sim_pid"
    ends_got=$?
    sim_pid=
    [ $ends_got -eq "$2" ] && [ ! -e "$robot" ] && [ ! -L "$robot" ] && return
    echo "status $ends_got, not $2; $(ls -l "$robot" 2>&1)"
    return 1
}
end_sim() {
    ends TERM 143 >"$work/ends" && ends_result=0 || ends_result=1
}
by_tcp || end_sim
check "SIGTERM: 143, and the link is gone" [ "${ends_result:-}" = 0 ]
stop_sim
check "SIGINT: 130" exits 130 timeout --preserve-status -s INT 1 "$GRCTL" sim

: >"$work/mine"
check "a file in the link's place is not replaced" fails 1 "$work/mine" timeout 5 "$GRCTL" sim \
    --link "$work/mine"
check "it is still there" [ -f "$work/mine" ]
check "its help has every fault" both exits 0 "$GRCTL" help sim --- says 'brownout, or all'
ln -s mine "$work/to-mine"
check "nor is a link to one" fails 1 'exists already: no link to a pseudo-terminal' \
    timeout 5 "$GRCTL" sim --link "$work/to-mine"
check "it leads there still" [ "$(readlink "$work/to-mine")" = mine ]
check "no such folder" fails 1 "$work/none/robot" timeout 5 "$GRCTL" sim --link "$work/none/robot"
ln -s /dev/pts/none "$work/robot"
start_sim
check "a dangling link of an earlier one is replaced" exits 0 on_robot status m1
stop_sim

if by_tcp; then
    start_sim
    tcp=$robot
else
    start_sim --tcp 0
    written "$work/sim.log" '^also at '
    tcp=$(sed -n 's/^also at //p' "$work/sim.log")
fi
check "another one there" fails 1 "^grctl: sim: $tcp: in use by another program" \
    "$GRCTL" sim --tcp "${tcp##*:}"
check "behind the last port" fails 2 '65535 is the last' "$GRCTL" sim --tcp 65535 --robots 2
check "by TCP too" both exits 0 "$GRCTL" -d "$tcp" --timeout 500 status m12 --- \
    says 'R_KNEE_P  *-40\.0'
check "one robot, whichever way" both exits 0 "$GRCTL" -d "$tcp" --timeout 500 servo on m12 --- \
    exits 0 on_robot status m12
check "its torque is on" says ' on '
stop_sim

many() {
    mkfifo "$work/many"
    set --
    by_tcp || set -- --link "$work/many-"
    "$GRCTL" --json sim --robots 3 "$@" >"$work/many" 2>/dev/null &
    sim_pid=$!
    read -r many_line <"$work/many"
    echo "$many_line" >"$work/out"
}
many_devices() {
    if by_tcp; then
        grep -o 'tcp:[0-9.:]*' "$work/out"
    else
        printf '%s\n' "$work/many-" "$work/many-2" "$work/many-3"
    fi
}
many
if have_json; then
    check "three robots, in JSON" json \
        'lines[0]["simulated"] is True and len({r["device"] for r in lines[0]["robots"]}) == 3'
else
    skip "three robots, in JSON" "no python3 to parse JSON with"
fi
number=0
for device in $(many_devices); do
    number=$((number + 1))
    check "number $number answers" exits 0 "$GRCTL" -d "$device" --timeout 500 status m1
done
check "all three" [ $number -eq 3 ]
stop_sim
done_testing
