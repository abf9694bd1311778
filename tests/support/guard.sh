# SPDX-License-Identifier: MIT
# For tests of the process beside grctl: a joint on its way, moved by a grctl that has a guard.
# Sourced behind cli.sh.

# Whatever fails, no process stays stopped.
mover=
end_mover() {
    [ -z "$mover" ] || kill -s KILL $mover 2>/dev/null
    end_cli_test
}
trap end_mover EXIT
start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }

# moves OPTIONS...: a joint goes on its way of 20 s; $mover is the process, $guard its guard.
moves() {
    exits 0 on_robot init --time 500 || return 1
    : >"$work/moving"
    "$GRCTL" -d "$robot" --timeout 500 -v "$@" move m5 -120 20000 >"$work/moved" 2>"$work/moving" &
    mover=$!
    is_on_its_way
}
is_on_its_way() {
    written "$work/moving" 'robot found' && wait_for sim_shows 5 ' -[2-9][0-9]\.[0-9] .*, moving'
    guard=$(sed -n 's/^guarded by process //p' "$work/moving")
}
stands() {
    wait_for sim_shows 5 "-[2-9][0-9]\.[0-9] deg .* torque on .* C\$" && ! sim_shows 5 moving
}
guard_is_gone() {
    case $(ps -o stat= -p "${guard:-1}") in
    '' | Z*) ;; # to be reaped by whoever inherited it
    *) return 1 ;;
    esac
}
# ends SIGNAL: the mover gets it; its status in $ended.
ends() {
    kill -s "$1" $mover
    wait $mover 2>/dev/null
    ended=$?
}

# ended_by SIGNAL: its status told that.
ended_by() {
    [ $ended -gt 128 ] && [ "$(kill -l $((ended - 128)))" = "$1" ] && return
    echo "status $ended"
    return 1
}

