#!/bin/sh
# SPDX-License-Identifier: MIT
# Arms of two families that are unplugged while they play, and plugged in again.
. tests/support/cli.sh
own_sim

arm() {
    on_robot --robot "$family_robot" "$@"
}
plays() {
    arm play --repeat 5 "$work/$family_robot-wave.yaml" >"$work/out" 2>"$work/said" </dev/null &
    player=$!
    wait_for sim_moves_or_play_ended && kill -0 "$player" 2>/dev/null && return
    wait "$player"
    return 1
}
sim_moves_or_play_ended() {
    sim_shows 3 ', moving' || ! kill -0 "$player" 2>/dev/null
}
# Unplugged while it moves. Where the machine held the player up, as it says, it is begun again.
unplugged() {
    for _ in 1 2 3; do
        if plays; then
            tell plug out
            ended_with 1 "$player"
            return
        fi
        grep -q 'host stalled' "$work/said" || break
    done
    cat "$work/said"
    return 1
}
says_so() {
    grep -q 'is gone while busy with play$' "$work/said" || { cat "$work/said"; return 1; }
}
# Each joint has an angle, and torque.
all_are_there() {
    exits 0 arm status || return 1
    [ "$(grep -c '^ *[1-6]  [a-z_]* *-*[0-9.]* .* on ' "$work/out")" -eq 6 ] && return
    cat "$work/out"
    return 1
}
all_stand() {
    for motor in 1 2 3 4 5 6; do
        sim_shows "$motor" 'torque on.* C$' || return 1
    done
}

for family_robot in so101 koch; do
    start_told_sim --robot "$family_robot" || { echo "Bail out! no simulator"; exit 1; }
    sed "s/^targetBody:.*/targetBody: $family_robot/" motions/so101-wave.yaml \
        >"$work/$family_robot-wave.yaml"
    test_case "$family_robot is unplugged in a motion and comes back"
    check "$family_robot stands ready" exits 0 arm init
    check "is unplugged in motion" unplugged
    check "which is said" says_so
    check "its servos stop by themselves" wait_for all_stand
    check "there is no port" fails 1 'no such file or device\|refused' arm status
    check "it is plugged in" tell plug in
    check "and all joints answer" all_are_there
    check "it moves" both exits 0 arm init --- written "$work/err" 'done; largest error 0\.[0-9]'
    check "and plays to the end" both exits 0 arm play --speed 200 \
        "$work/$family_robot-wave.yaml" --- says '^largest error at the end'
    stop_sim
done
done_testing
