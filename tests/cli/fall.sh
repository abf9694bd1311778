#!/bin/sh
# SPDX-License-Identifier: MIT
# Torque off is a fall: servo off, teach and the exit policy `off` name the joints that drop.
. tests/support/cli.sh
. tests/support/registers.sh
. tests/support/terminal.sh

start_sim --robot so101 --physics on || { echo "Bail out! the simulator did not start"; exit 1; }

# Torque comes on wherever the arm is in its fall; the move is another program's, which would refuse
# an arm that swings yet.
raised() {
    exits 0 of so101 servo on && exits 0 of so101 move shoulder_lift 0 1500
}

# angle JOINT: where it was read.
angle() {
    exits 0 of so101 status && sed -n "s/^ *[0-9]*  $1  *\([-0-9.]*\) .*/\1/p" "$work/out"
}
# fallen JOINT DEG: its servo reads that it has left DEG, and that it turns no more.
fallen() {
    exits 0 of so101 status && awk -v joint="$1" -v from="$2" '
        $2 == joint { off = $3 > from ? $3 - from : from - $3; found = off > 5 && $6 == 0 }
        END { exit !found }' "$work/out"
}

# The judge is the simulator's own robot: it falls as far as was said, but for its backlash.
falls_as_said() {
    raised || return 1
    before=$(angle shoulder_lift)
    exits 0 of so101 servo off || return 1
    ! grep 'drop:.*shoulder_pan' "$work/err" || return 1 # weight does not turn it
    said_deg=$(sed -n 's/.*joints drop:.*shoulder_lift \([0-9]*\) deg.*/\1/p' "$work/err")
    wait_for fallen shoulder_lift "$before" || return 1
    now=$(angle shoulder_lift)
    echo "shoulder_lift from $before to $now deg, said: ${said_deg:-nothing}"
    awk -v a="$before" -v b="$now" -v s="${said_deg:--1}" \
        'BEGIN { d = a > b ? a - b : b - a; exit !(d > 30 && d - s < 6 && s - d < 6) }'
}
check "a joint drops as far as was said" falls_as_said

names_none() {
    exits 0 of so101 servo off && ! grep -q drop "$work/err"
}
check "a joint without torque is not named" names_none

leaves() {
    exits 0 of so101 --on-exit off move elbow_flex 5 300 &&
        grep -q 'these joints drop: .*shoulder_lift' "$work/err"
}
check "the arm is up again" raised
check "an exit without torque names them" leaves

stays_on() {
    raised || return 1
    type_line "$GRCTL --robot so101 -d $robot --timeout 500 servo off"
    until_screen 'Switch the torque off' && keys n Enter &&
        until_screen 'the torque stays on' &&
        exits 0 of so101 status && grep -q 'shoulder_lift .* on ' "$work/out"
}
goes_off() {
    type_line "$GRCTL --robot so101 -d $robot --timeout 500 servo off"
    until_screen 'Switch the torque off' && keys y Enter &&
        until_screen 'torque of 6 joints is off'
}
if have_terminal; then
    open_screen 120 24
    check "a terminal asks, and no is no" stays_on
    check "yes is yes" goes_off
else
    skip "a terminal asks, and no is no" 'no tmux'
    skip "yes is yes" 'no tmux'
fi

check "there is no rest posture to lower it to" fails 4 'has no rest posture' \
    of so101 servo off --lower
check "lowering goes with off" fails 2 'lower goes with off' of so101 servo on --lower
done_testing
