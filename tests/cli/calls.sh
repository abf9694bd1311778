#!/bin/sh
# SPDX-License-Identifier: MIT
# Whichever one call to the system goes wrong, in a command or in what it starts: an error, an
# interruption, one byte of many, an end; or one allocation, its libraries' too. The command ends in
# time, by itself; it says why where it has not done what it was told; what it wrote is whole or not
# there; nothing of it stays behind; and the robot stands a moment later, and obeys.
#
# Environment: CALLS=all has 40 calls of each kind go wrong, one after the other (make nightly);
# without it one, of a sixth of what can go wrong, another sixth for each command. CALLS_OF="play
# estop" chooses commands.
. tests/support/cli.sh
. tests/support/fleet.sh

all_skipped() {
    echo "1..0 # SKIP $1"
    exit
}
[ -z "${EMULATOR:-}" ] || all_skipped "the command is of another machine"
grep -q __asan_init "$GRCTL" && all_skipped "built with a sanitizer"
[ "$(uname -sm)" = 'Linux x86_64' ] || all_skipped "calls are spoiled on Linux of x86-64 alone"
nth=$work/nth
${CC:-cc} -o "$nth" tests/cli/nth_call.c 2>"$work/said" || all_skipped "no C compiler"
${CC:-cc} -shared -fPIC -o "$nth.so" tests/cli/nth_allocation.c 2>"$work/said" ||
    all_skipped "no library to load first can be built"
"$nth" "$work/count" open EIO 0 /bin/true || all_skipped "no process can be traced"
GRCTL=$(cd "$(dirname "$GRCTL")" && pwd)/${GRCTL##*/}
simulator=$GRCTL

# What goes wrong: the kind, and how (tests/cli/nth_call.c).
wrongs='open:EMFILE open:EACCES open:EIO read:EIO read:EINTR read:short read:end write:EIO
write:EINTR write:ENOSPC write:short sync:EIO name:EACCES name:EIO wait:EINTR ioctl:EIO
ioctl:EINTR control:EIO handle:EMFILE socket:EACCES start:EAGAIN memory:ENOMEM look:EIO
allocation:NULL'

# ---- commands ------------------------------------------------------------------------------------

# Each runs grctl in $work/in by $spoil, a list of words; and says whether what it left is right,
# given its exit status.
mkdir "$work/in" "$work/motions" "$work/config/grctl" 2>/dev/null || mkdir -p "$work/in" \
    "$work/motions" "$work/config/grctl"
cat >"$work/motions/two.pseq" <<'PSEQ'
type: PoseSeq
name: "two"
refs:
  - time: 0
    refer: { type: Pose, name: "", joints: [ 2, 3 ], q: [ 0, 0 ] }
  - time: 0.2
    refer: { type: Pose, name: "", joints: [ 2, 3 ], q: [ 0.1, -0.1 ] }
PSEQ
grctl() {
    # shellcheck disable=SC2086
    (cd "$work/in" && exec timeout -s KILL 40 $spoil "$GRCTL" "$@")
}
on_it() {
    grctl --robot so101 -d "$robot" --timeout 1000 "$@"
}
# nothing_but NAME...: in the folder where it ran.
nothing_but() {
    for nothing_path in "$work/in"/* "$work/in"/.[!.]*; do
        nothing_name=${nothing_path##*/}
        [ -e "$nothing_path" ] || continue
        case " $* " in *" $nothing_name "*) continue ;; esac
        echo "$nothing_name was left"
        return 1
    done
}
is_motion() {
    "$GRCTL" --robot so101 check "$1" >"$work/checked" 2>&1 || { cat "$work/checked"; return 1; }
}

run_open() {
    on_it status
}
left_open() {
    nothing_but
}
run_play() {
    on_it play "$work/motions/two.pseq"
}
left_play() {
    nothing_but
}
run_record() {
    printf ' q' | on_it record -o kept.yaml -k
}
# What was written as it came stays where the file was not; where it could not be removed, too.
left_record() {
    nothing_but kept.yaml kept.yaml.part.m || return 1
    [ "$1" -ne 0 ] || [ -s "$work/in/kept.yaml" ] || { echo "nothing was kept"; return 1; }
    for record_file in "$work/in"/*; do
        [ ! -s "$record_file" ] || is_motion "$record_file" || return 1
    done
}
run_convert() {
    grctl --robot so101 convert "$work/motions/two.pseq" made.yaml
}
left_convert() {
    nothing_but made.yaml || return 1
    if [ -e "$work/in/made.yaml" ]; then
        is_motion "$work/in/made.yaml"
    elif [ "$1" -eq 0 ]; then
        echo "nothing was made"
        return 1
    fi
}
homing_of() {
    printf '"%s": {"id": %d, "drive_mode": 0, "homing_offset": 0, ' "$1" "$2"
    printf '"range_min": 800, "range_max": 3300}'
}
{
    n=0
    for joint in shoulder_pan shoulder_lift elbow_flex wrist_flex wrist_roll gripper; do
        [ $n -eq 0 ] && echo '{' || echo ','
        n=$((n + 1))
        homing_of $joint $n
    done
    echo '}'
} >"$work/homing.json"
run_calibrate() {
    on_it --yes calibrate --from "$work/homing.json" -o done.json
}
left_calibrate() {
    nothing_but done.json so101-before.json || return 1
    for calibrate_file in "$work/in"/*.json; do
        [ ! -e "$calibrate_file" ] || python3 -m json.tool "$calibrate_file" >/dev/null || return 1
    done
}
run_setup() {
    rm -f "$work/config/grctl/"*
    grctl --robot so101 -d "$robot" setup --yes # a longer time to answer makes its scan minutes
}
# The configuration is there and can be read, or it is not there.
left_setup() {
    nothing_but || return 1
    [ ! -e "$work/config/grctl/config.yaml" ] ||
        "$GRCTL" -d so101 --timeout 1000 status >"$work/checked" 2>&1 || {
        cat "$work/checked" "$work/config/grctl/config.yaml"
        return 1
    }
}
# end_spoiled PID SIGNAL: the command below timeout, and nth_call, if it is still there.
end_spoiled() {
    end_command=$(pgrep -P "$1" | head -n 1)
    case $spoil in
    "$nth"*) [ -z "$end_command" ] || end_command=$(pgrep -o -P "$end_command" | head -n 1) ;;
    esac
    [ -z "$end_command" ] || kill -s "$2" "$end_command" 2>/dev/null
}
# A page that is asked for once; a stop; and SIGTERM. Where it could not start it has ended.
run_serve() {
    rm -f "$work/link"
    (cd "$work/in" && GRCTL_TOKEN=0123456789abcdef0123456789abcdef exec timeout -k 1 40 $spoil \
        "$GRCTL" --robot so101 -d "$robot" --timeout 1000 serve --port 0 --operator \
        "$work/motions" >"$work/link") &
    serve_pid=$!
    wait_for serve_is_there_or_ended
    serve_at=$(sed -n 's|^\(http://[^/]*\)/.*|\1|p' "$work/link")
    if [ -n "$serve_at" ]; then
        curl -s -m 5 "$serve_at/api/state" >/dev/null 2>&1
        curl -s -m 5 -X POST "$serve_at/api/stop" >/dev/null 2>&1
    fi
    end_spoiled $serve_pid TERM
    wait $serve_pid
}
serve_is_there_or_ended() {
    grep -q '^http' "$work/link" || ! kill -0 $serve_pid 2>/dev/null
}
left_serve() {
    nothing_but
}
# At a broker, until it has said hello.
run_agent() {
    mkdir -p "$work/agents/grctl"
    echo "robots: {arm: {device: $robot, robot: so101}}" >"$work/agents/grctl/config.yaml"
    (cd "$work/in" && XDG_CONFIG_HOME=$work/agents exec timeout -k 1 40 $spoil "$GRCTL" -d arm \
        --timeout 1000 agent --broker "$broker" --host one --motions "$work/motions") &
    agent_pid=$!
    wait_for agent_is_there_or_ended
    end_spoiled $agent_pid TERM
    wait $agent_pid
}
agent_is_there_or_ended() {
    grep -q '^connected' "$work/err" || ! kill -0 $agent_pid 2>/dev/null
}
left_agent() {
    nothing_but
}
run_estop() {
    on_it estop
}
# 0 promises that no joint has torque that turns it; whatever it was, it can be taken back.
left_estop() {
    "$GRCTL" --robot so101 -d "$robot" --timeout 1000 estop --reset >"$work/checked" 2>&1 ||
        { cat "$work/checked"; return 1; }
    nothing_but
}
# The motion's program is killed while it plays: its guard is whose call goes wrong.
run_guard() {
    : >"$work/plays"
    (cd "$work/in" && exec timeout -s KILL 40 $spoil "$GRCTL" --robot so101 -d "$robot" \
        --timeout 1000 --json move elbow_flex 60 20000 >"$work/plays") &
    guard_pid=$!
    wait_for guard_moves_or_ended
    end_spoiled $guard_pid KILL
    wait $guard_pid
}
guard_moves_or_ended() {
    ! kill -0 $guard_pid 2>/dev/null || sim_shows 3 ' [1-9][0-9]*\.[0-9] deg.*, moving'
}
left_guard() {
    nothing_but
}

# ---- what is asked of all of them ----------------------------------------------------------------

# stands: none of its joints turns, and they answer to a healthy command.
stands() {
    "$GRCTL" --robot so101 -d "$robot" --timeout 2000 status >"$work/status" 2>&1 &&
        awk '$1 ~ /^[0-9]+$/ { joints++; turning += $6 != 0 } END { exit joints != 6 || turning }' \
            "$work/status"
}
# Its exit status where nothing goes wrong; who is killed has that of nth_call.
usual_status() {
    case $1 in
    guard) echo 137 ;;
    serve | agent) echo 143 ;;
    *) echo 0 ;;
    esac
}
# spoiled COMMAND KIND FATE N: that call of it goes wrong.
spoiled() {
    find "$work/in" -mindepth 1 -delete
    spoil="$nth $work/count $2 $3 $4"
    [ "$2" != allocation ] ||
        spoil="env LD_PRELOAD=$nth.so FAIL_AT=$4 COUNT_TO=$work/count"
    for _ in 1 2 3; do # a machine that held it up had it stopped for safety
        "run_$1" >"$work/out" 2>"$work/err" </dev/null
        spoiled_status=$?
        grep -q -e 'host stalled' -e 'lost replies (1 in a row)' "$work/err" || break
    done
    spoiled_why=
    if [ "$4" -eq 0 ] && [ $spoiled_status -ne "$(usual_status "$1")" ]; then
        spoiled_why="that is not as ever"
    elif [ $spoiled_status -gt 127 ] && [ $spoiled_status -ne "$(usual_status "$1")" ]; then
        spoiled_why="it was ended"
    elif [ $spoiled_status -ne 0 ] && [ $spoiled_status -ne "$(usual_status "$1")" ] &&
        [ "$2" != write ] &&
        ! cat "$work/err" "$work/out" | grep -q .; then
        spoiled_why="it does not say why"
    elif ! "left_$1" $spoiled_status >"$work/left"; then
        case $2:$(cat "$work/left") in
        name:*' was left') ;; # it could not be removed
        *) spoiled_why=$(cat "$work/left") ;;
        esac
    fi
    if [ -z "$spoiled_why" ] && [ "$1" != convert ] && ! wait_for stands; then
        spoiled_why="the robot does not stand: $(cat "$work/status")"
    fi
    [ -z "$spoiled_why" ] && return
    echo "$1, $2 number $4 is $3: status $spoiled_status, $spoiled_why"
    sed -n '1,5p' "$work/err"
    return 1
}
# points: which of its $total calls.
points() {
    if [ "${CALLS:-}" = all ]; then
        seq 1 $((1 + total / 40)) "$total"
    elif [ "$total" -gt 0 ]; then
        echo $((1 + salt * 7 % total))
    fi
}
all_spoiled() {
    all_failed=0
    all_ran=0
    all_counted=
    for wrong in $wrongs; do
        salt=$((salt + 1))
        [ "${CALLS:-}" = all ] || [ $((salt % 6)) -eq 0 ] || continue
        [ "$all_counted" = "${wrong%:*}" ] || spoiled "$1" "${wrong%:*}" "${wrong#*:}" 0 || return 1
        [ "$all_counted" = "${wrong%:*}" ] || total=$(cat "$work/count")
        all_counted=${wrong%:*}
        for point in $(points); do
            all_ran=$((all_ran + 1))
            spoiled "$1" "${wrong%:*}" "${wrong#*:}" "$point" || all_failed=$((all_failed + 1))
        done
    done
    echo "$all_ran calls spoiled, $all_failed wrongly borne"
    [ $all_failed -eq 0 ]
}

salt=0
start_told_sim --robot so101 || { echo "Bail out! the simulator did not start"; exit 1; }
"$GRCTL" --robot so101 -d "$robot" --timeout 2000 servo on >"$work/said" 2>&1
for command in ${CALLS_OF:-open play record convert calibrate setup serve estop guard agent}; do
    test_case "$command: a call to the system goes wrong"
    if [ "$command" = agent ]; then
        if ! command -v mosquitto_pub >/dev/null || has_no_mqtt; then
            skip agent "no broker, or no MQTT in this grctl"
            continue
        fi
        find_port
        broker=mqtt://127.0.0.1:$port
        begin_open_broker
    fi
    check "$command" all_spoiled "$command"
    salt=$((salt + 1))
done
done_testing
