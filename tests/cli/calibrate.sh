#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl calibrate: a simulated SO-101 is calibrated by hand, by a file, and as it was again.
. tests/support/cli.sh
own_sim
by_tcp && { echo "1..0 # SKIP needs a hand at the simulator beside the command"; exit; }
GRCTL=$(cd "$(dirname "$GRCTL")" && pwd)/${GRCTL##*/}
simulator=$GRCTL
GRCTL_ROBOT=so101
export GRCTL_ROBOT

start_told_sim || { echo "Bail out! the simulator did not start"; exit 1; }
mkfifo "$work/keys"
calibrate_pid=
end_calibrate_test() {
    kill ${calibrate_pid:+"$calibrate_pid"} 2>/dev/null
    end_cli_test
}
trap end_calibrate_test EXIT

# in_folder COMMAND...: where files are written.
in_folder() (
    cd "$work" && "$@"
)
# turned JOINT DEG: its shaft, by hand.
turned() {
    tell turn "$1" "$2" && sim_shows "$1" " $2\.0 deg"
}
# by_hand TORQUE: begins it, and lets the torque go that there is; enter is a line to descriptor 7.
by_hand() {
    : >"$work/said"
    : >"$work/told"
    (cd "$work" && exec "$GRCTL" -v -d "$robot" --timeout 500 calibrate -o so101.json) \
        <"$work/keys" >"$work/told" 2>"$work/said" &
    calibrate_pid=$!
    exec 7>"$work/keys"
    held=no
    written "$work/said" 'torque goes off when you press enter' >&2 &&
        sim_shows shoulder_pan "torque $1" >&2 && held=yes
    echo >&7
}
# ended: waits for its end.
ended() {
    wait "$calibrate_pid"
    calibrate_got=$?
    calibrate_pid=
    exec 7>&-
}
with_status() {
    [ "$calibrate_got" -eq "$1" ] && return
    echo "status $calibrate_got, not $1"
    cat "$work/told" "$work/said"
    return 1
}
# register ID NAME VALUE: the servo holds that.
register() {
    exits 0 on_robot servo-get "$1" "$2" && grep -q " $2  *$3 " "$work/out" && return
    cat "$work/out"
    return 1
}

# The arm is put together 20 degrees off in the shoulder: 228 counts.
test_case "an arm is calibrated by hand"
check "as it came" register 1 offset 0
check "it had torque" exits 0 on_robot servo on
by_hand on
check "nothing falls before enter" [ $held = yes ]
check "it asks for the middle" written "$work/said" 'the middle of its range, then press enter'
check "the arm is limp" sim_shows shoulder_pan 'torque off'
check "the shoulder is off" turned shoulder_pan 20
echo >&7
check "then for the ends" written "$work/said" 'both of its ends'
# A joint goes so far, and the command has seen it.
goes() {
    turned "$1" "$2" && written "$work/said" "$1: $3"
}
check "the shoulder goes to one end" goes shoulder_pan 90 '20[0-9]* to 284[34]'
check "and to the other" goes shoulder_pan -60 '113[67] to 284[34]'
rest() {
    for joint in shoulder_lift elbow_flex wrist_flex wrist_roll; do
        goes $joint 95 '20[0-9]* to 31[23][0-9]' && goes $joint -85 '108[01] to 31' &&
            turned $joint 0 || return 1
    done
    turned shoulder_pan 20
}
test_case "a joint that was not moved ends it"
check "so do others" rest
check "the gripper by less than 10 degrees" turned gripper 4
echo >&7
ended
check "but the gripper was not moved" with_status 2
check "that is said" grep -q 'gripper was not moved' "$work/said"

by_hand off
test_case "what was found is kept, and joints obey it"
check "once more" written "$work/said" 'the middle of its range, then press enter'
check "the shoulder is off again" turned shoulder_pan 20
echo >&7
check "it asks for the ends" written "$work/said" 'both of its ends'
all() {
    for joint in shoulder_pan shoulder_lift elbow_flex wrist_flex wrist_roll gripper; do
        goes $joint 95 '[0-9]* to [23][0-9]*' && goes $joint -5 '[12][0-9]* to [23]' || return 1
    done
    turned shoulder_pan 20
}
check "all joints go" all
echo >&7
ended
check "it is calibrated" with_status 0
check "the servo keeps the offset" register 1 offset 22[78]
check "its limits are where the hand was" register 1 min_position '17[67][0-9]'
check "what it was is kept" grep -q '"homing_offset": 0' "$work/so101-before.json"
check "what it is, too" grep -q '"homing_offset": 22[78]' "$work/so101.json"
check_json "the joint reads 0 there" 'abs(lines[0]["joints"][0]["angle_deg"]) < 0.2' \
    on_robot --json status shoulder_pan
check "it moves" exits 0 on_robot move shoulder_pan 5 500
check "no further than the hand" fails 4 'shoulder_pan.*go from -25 to 75 deg' \
    on_robot move shoulder_pan -60 500
check "it is let go" exits 0 on_robot servo off

# Whose servos are set up otherwise than its file says.
test_case "a servo that is set up otherwise is not moved"
check "another mode" exits 0 on_robot --yes servo-set 3 mode 3 --flash
check "it is not moved, and the fix is named" fails 1 \
    "elbow_flex.*mode is 3, 0 is wanted; 'grctl servo-set 3 mode 0 --flash'" \
    on_robot move elbow_flex 5
check "its resolution, too" exits 0 on_robot --yes servo-set 3 angular_resolution 2 --flash
check "that more is wrong is said" fails 1 \
    "elbow_flex.*mode is 3, 0 is wanted, and 1 more register is wrong; 'grctl servo-set 3 mode 0" \
    on_robot move elbow_flex 5
one_setup() {
    exits 1 on_robot --json status && [ "$(grep -o '"setup":{[^}]*}' "$work/out")" = \
        "\"setup\":{\"message\":\"mode is 3, 0 is wanted, and 1 more register is wrong\",\
\"fix\":\"'grctl servo-set 3 mode 0 --flash' sets it\"}" ]
}
check "so JSON says, of that joint alone" one_setup
check "put right" exits 0 on_robot --yes servo-set 3 angular_resolution 1 --flash
check "nor anything with it" fails 1 'elbow_flex' on_robot init
check "it is read" exits 1 on_robot status
check "its registers, too" exits 0 on_robot servo-get 3 mode
check "as they are" grep -q ' mode  *3$' "$work/out"
check "it is made limp" both exits 0 on_robot servo off --- true
check "it is put right as was said" exits 0 on_robot --yes servo-set 3 mode 0 --flash
check "it moves again" exits 0 on_robot move elbow_flex 5 500
# as_new: the calibration of servos as they left the factory.
as_new() {
    sed 's/_offset": [-0-9]*/_offset": 0/;s/_min": [0-9]*/_min": 0/;s/_max": [0-9]*/_max": 4095/' \
        "$work/so101.json" >"$work/new.json"
    exits 0 on_robot calibrate --restore "$work/new.json"
}
test_case "an arm that was never calibrated is not moved, and says so"
check "as it came from its factory" in_folder as_new
check "its offset is none" register 1 offset 0
check "its limits, too" register 1 max_position 4095
check "it was never calibrated" fails 1 "never calibrated, offset is 0.*'grctl calibrate'" \
    on_robot move shoulder_pan 5
check "it is not switched on" fails 1 "never calibrated" on_robot servo on
check "it is made limp" exits 0 on_robot servo off
# Its ids are right: nothing else is said of them.
new_arm() {
    exits 1 on_robot doctor && ! grep 'two servos\|NEW --flash' "$work/out" || return 1
    [ "$(grep -c '^BAD .*: its servo was never calibrated, offset is 0 as from the factory$' \
        "$work/out")" -eq 6 ] || return 1
    [ "$(grep -c -e "-> 'grctl calibrate' does it$" "$work/out")" -eq 6 ]
}
check "doctor says what a new arm needs" new_arm
status_says_why() {
    exits 1 on_robot status && [ "$(grep -c "^motor [1-6] ([a-z_]*): its servo was never \
calibrated, offset is 0 as from the factory; 'grctl calibrate' does it$" "$work/err")" -eq 6 ]
}
check "so does status" status_says_why
setup_says_why() {
    XDG_CONFIG_HOME="$work/new-home" \
        exits 0 "$GRCTL" -d "$robot" --robot so101 --timeout 100 --yes setup &&
        grep -q "^  shoulder_pan .*its servo was never calibrated" "$work/err" &&
        grep -q 'has its name, but 6 of its 6 joints cannot move yet' "$work/err" &&
        ! grep '^done' "$work/err"
}
check "and setup, which is not done" setup_says_why
check "it is shown" exits 1 on_robot --json status
check "with its heat, without an angle" \
    grep -q '"angle_deg":null.*"torque":"off".*"temperature_c":[23]' "$work/out"
json_says_why() {
    why='its servo was never calibrated, offset is 0 as from the factory'
    [ "$(grep -o "\"setup\":{\"message\":\"$why\",\"fix\":\"'grctl calibrate' does it\"}" \
        "$work/out" | wc -l)" -eq 6 ]
}
check "and with the reason of each joint" json_says_why
check_json "a calibration is shown" \
    'lines[0]["written"] is False and lines[0]["joints"][2]["before_range"][1] == 4095' \
    on_robot --json calibrate --from "$work/so101.json" --dry-run
check "nothing was written" register 3 max_position 4095
# A disk that takes nothing: what the servos hold could not be put back.
full() (
    cd "$work" && ls >"$work/listed" || return 1
    { (no_counters && ulimit -f 0 && on_robot calibrate --from so101.json); echo $? >&9; } \
        9>"$work/status" 2>&1 >/dev/null | cat >"$work/err"
    [ "$(cat "$work/status")" -eq 3 ] && grep -q "so101-before[0-9]*\.json: " "$work/err" &&
        rm "$work/status" && ls | diff "$work/listed" -
)
test_case "a full disk leaves no half file"
check "nor where a disk is full, and no half file is left" \
    both full --- register 3 max_position 4095
test_case "a calibration is taken from a file, and taken back"
check "a calibration is taken" in_folder exits 0 on_robot calibrate --from so101.json
check "it moves again" exits 0 on_robot move elbow_flex 5 500
check "all is as it came" in_folder exits 0 on_robot calibrate --restore so101-before.json
check "its offset" register 1 offset 0
check "its limits" register 1 max_position 3300

# Files that do not fit.
spoiled() {
    spoiled_want=$1
    shift
    sed "$@" "$work/so101.json" >"$work/bad.json"
    fails 3 "bad.json:.*$spoiled_want" on_robot calibrate --from "$work/bad.json"
}
test_case "files that do not fit are refused"
check "another name" spoiled 'elbow: so101 has no such joint' 's/elbow_flex/elbow/'
check "another id" spoiled 'wrist_flex: id is 9; it is 4 in so101' 's/"id": 4/"id": 9/'
check "a range without the middle" spoiled 'shoulder_pan: range 2100 to' \
    '0,/"range_min": [0-9]*/s//"range_min": 2100/'
check "an offset too large" spoiled 'shoulder_pan: homing_offset' \
    '0,/"homing_offset": [0-9]*/s//"homing_offset": 2048/'
check "a word for a number" spoiled 'gripper: needs whole numbers' 's/"id": 6/"id": "6"/'
check "a mirrored joint" spoiled 'gripper: drive_mode' \
    '/"gripper"/,$s/"drive_mode": 0/"drive_mode": 1/'
check "no JSON" spoiled '[0-9]*:[0-9]*: ' 's/{/[/'
check "a joint is missing" spoiled 'gripper: needs' '/"gripper"/,$d;/"wrist_roll"/,$s/},$/}}/'
check "no file" fails 3 'none.json' on_robot calibrate --from "$work/none.json"
test_case "who cannot be calibrated says why"
check "nobody presses enter" in_folder exits 2 on_robot calibrate
check "that is said" grep -q 'needs a person to press enter' "$work/err"
check "the file must say so" fails 2 "calibrated: true" "$GRCTL" --robot pan-tilt -d sim calibrate
check "another robot has trims" fails 2 'keep no calibration' \
    "$GRCTL" --robot gr001 -d sim calibrate --from "$work/so101.json"

printf 'name: lx\nfamily: lx16a\njoints:\n%s\n' \
    '  - {name: a, id: 1, servo: LX-16A, limits_deg: [-90, 90]}' >"$work/lx.yaml"
check "so has one of Hiwonder, and it is said where" fails 2 'keep no calibration.*trims' \
    "$GRCTL" --robot "$work/lx.yaml" -d sim calibrate

# A DYNAMIXEL adds its offset.
start_dxl() {
    stop_sim
    exec 5>&- 6<&-
    GRCTL_ROBOT=koch
    start_told_sim
}
dxl_calibrated() {
    : >"$work/said"
    (cd "$work" && "$GRCTL" -d "$robot" --timeout 500 calibrate) <"$work/keys" >"$work/told" \
        2>"$work/said" &
    calibrate_pid=$!
    exec 7>"$work/keys"
    echo >&7
    tell turn shoulder_pan 20
    written "$work/said" 'then press enter' || return 1
    echo >&7
    written "$work/said" 'both of its ends' || { cat "$work/said"; return 1; }
    exec 7>&-
    wait $calibrate_pid
    register 1 homing_offset -22[78]
}
start_dxl
test_case "a Koch arm takes a calibration"
check "a Koch arm takes a calibration" dxl_calibrated
stop_sim
done_testing
