# SPDX-License-Identifier: MIT
# For tests of `grctl estop`: the robot is braked, a joint is under way. Sourced behind cli.sh.

braked() {
    exits 0 on_robot status && says '^ *12  R_KNEE_P .* brake '
}

# under_way [guarded]: a slow move, as seen from the joint; its process in $mover. A guard would
# stop the joint of one that is stopped, and release the port.
under_way() {
    [ "${1:-}" = guarded ] || export GRCTL_GUARD=''
    rm -f "$work/moving"
    exits 0 on_robot servo on && exits 0 on_robot move m5 0 500 || return 1
    "$GRCTL" -d "$robot" --timeout 500 -v move m5 -120 20000 >"$work/moving" 2>&1 </dev/null &
    mover=$!
    written "$work/moving" 'robot found' && wait_for sim_shows 5 ' -[1-9][0-9]\.[0-9] deg'
}
# read_angle: what the simulator says of the joint's angle, in $angle.
read_angle() {
    tell look 5 && angle=$(tail -n +"$((tell_lines + 1))" "$work/sim.log" |
        sed -n 's/.* \(-*[0-9]*\)\.[0-9] deg.*/\1/p')
}
seconds() {
    date +%s
}
