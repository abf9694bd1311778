#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl replay: traces run again on a robot.
. tests/support/cli.sh
. tests/support/traces.sh

READ1='54 09 FA AF 01 0F 2A 02 00 26 0A' # position of servo 1, which is 0.0 deg
test_case 'to a robot'

# An adapter hands over a reply in one piece: on a busy machine it could stand still in its middle
# for so long that it is cut there.
start_told_sim --latency 16 || { echo "Bail out! the simulator did not start"; exit 1; }

is_untouched() {
    on_robot --trace "$work/after" status >"$work/out" || return 1
    ! says ' on ' >/dev/null && says ' off '
}

# What comes late is asked again: that is another request when the trace is replayed.
patient() {
    "$GRCTL" -d "$robot" --timeout 5000 "$@"
}
exits 0 patient --trace "$work/reads" status
check 'reads go to a robot without a question' both exits 0 patient replay "$work/reads" --- \
    says ' equal, 0 differ, 0 missing, 0 extra'
check 'the replay of a replay' both exits 0 patient --trace "$work/again" replay "$work/reads" \
    --- both exits 0 "$GRCTL" replay "$work/again" --- says ' equal, 0 differ, 0 missing, 0 extra'
"$GRCTL" -d sim --timeout 500 -q --trace "$work/moves" move R_KNEE_P -45 500
check 'moves are not sent unasked' fails 4 'frames move joints of a real robot; say --yes' \
    on_robot replay "$work/moves"
check 'and nothing moved' is_untouched
# Torque was switched on safely before, which two readings show, and those while it moves too.
check 'moves are sent with --yes' both exits 1 on_robot replay --yes "$work/moves" --- \
    both says ' [1-9][0-9]* differ, 0 missing, 0 extra' --- says 'recorded .* torque off,'
check 'and the joint has moved' both exits 0 on_robot status R_KNEE_P --- says '-45.0 .* on '

stopped() {
    exits 0 on_robot estop || return 1
    fails 4 "stopped by 'grctl estop'" on_robot --yes replay "$work/moves" || return 1
    exits 0 on_robot estop --reset
}
check 'an emergency stop holds for a replay' stopped

# is_refused PATTERN HEX...: even with --yes, before anything is sent.
is_refused() {
    pattern=$1
    shift
    printf 'out 0 %s\nout 1000 %s\n' "$READ1" "$*" | make_trace >"$work/refused"
    fails 4 "at 1.000 ms: not to a real robot: .*$pattern" on_robot --yes \
        --trace "$work/sent" replay "$work/refused" && [ ! -e "$work/sent" ]
}
check 'settings are refused' is_refused 'write servo 3 .*: id 5' \
    53 09 FA AF 03 00 04 01 01 05 02
check 'flash is refused' is_refused 'flash servo 5' 53 08 FA AF 05 40 FF 00 00 BA
check 'stored motions are refused' is_refused 'play motion slot 7' 50 4D 07
check 'a wrong sum is refused' is_refused 'sum 27 wrong' 53 09 FA AF 03 00 24 01 01 01 27
out_of_limits() {
    printf 'out 0 53 0C FA AF 0C 00 1E 04 01 64 00 F4 01 86\n' | make_trace >"$work/far"
    fails 4 'outside a joint.s limits' on_robot --yes replay "$work/far" &&
        exits 0 on_robot status R_KNEE_P && says '-45.0'
}
check 'a goal outside limits is refused by the engine' out_of_limits
too_fast() {
    printf 'out 0 53 0C FA AF 0C 00 1E 04 01 00 00 01 00 16\n' | make_trace >"$work/fast"
    fails 4 'faster than the servo can move' on_robot --yes replay "$work/fast" &&
        exits 0 on_robot status R_KNEE_P && says '-45.0'
}
check 'a goal too fast for the joint is refused by the engine' too_fast
"$GRCTL" -d sim --timeout 500 -q --trace "$work/looks" status m3 >"$work/out"
behind_refused() {
    printf 'replay %s\nreplay %s\n' "$work/refused" "$work/looks" |
        on_robot --yes shell --keep-going >"$work/out" 2>"$work/err"
    says '^[1-9][0-9]* frames sent' || { cat "$work/err"; return 1; }
}
check 'in a shell the next one is another one' behind_refused
done_testing
