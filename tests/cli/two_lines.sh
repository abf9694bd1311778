#!/bin/sh
# SPDX-License-Identifier: MIT
# Two arms of two families on two ports (docs/examples/robots), from file to cockpit: in the
# simulator, and against two simulators of one arm each, which know nothing of the other.
. tests/support/cli.sh
unset GRCTL_ROBOT
arms=docs/examples/robots/two-arms.yaml
head=docs/examples/robots/ax-body-xl330-head.yaml

test_case "its file"
check "is right" ends_with 0 'two-arms: 8 joints, nothing wrong' "$GRCTL" robot check $arms
check "sixteen AX-12A and two XL330, too" ends_with 0 '18 joints, nothing wrong' \
    "$GRCTL" robot check $head
check "names its lines" ends_with 0 'right: 4 servos of family dynamixel2, 1000000 bps' \
    "$GRCTL" --robot $arms robot show
check_json "in JSON, too" \
    'lines[0]["lines"][1]["name"] == "right" and lines[0]["lines"][1]["joints"][0] == "R_pan"' \
    "$GRCTL" --robot $arms --json robot show
sed 's/line: right, id: 2/line: wrong, id: 2/' $arms >"$work/wrong.yaml"
check "a line that is not there" ends_with 3 "no line called 'wrong'" \
    "$GRCTL" robot check "$work/wrong.yaml"
sed 's/line: right, id: 2/line: right, id: 1/' $arms >"$work/wrong.yaml"
check "an id twice on a line" ends_with 3 'R_lift has the id of another joint' \
    "$GRCTL" robot check "$work/wrong.yaml"

test_case "in the simulator"
with_arms() {
    "$GRCTL" --robot $arms -d sim "$@"
}
check "it goes to its initial posture" exits 0 with_arms init
check "joints of both move" exits 0 with_arms pose L_pan=20 R_pan=-20
check "its state has all" ends_with 0 '1  R_pan' with_arms status
check "an emergency stop" exits 0 with_arms estop
check "the other robot, too" exits 0 "$GRCTL" --robot $head -d sim init
printf 'type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n    content: JointPosition\n' \
    >"$work/wave.yaml"
printf '    frameRate: 4\n    numFrames: 3\n    numParts: 8\n    frames:\n' >>"$work/wave.yaml"
for angle in 0 0.1 0; do
    echo "      - [$angle, 0, 0, 0, $angle, 0, 0, 0]" >>"$work/wave.yaml"
done
check "a motion" exits 0 with_arms play "$work/wave.yaml"
check "its frames are shown, each with its line" ends_with 0 '^[0-9]* right: ' \
    with_arms play --dry-run "$work/wave.yaml"
check "those of the left arm too" grep -q '^0 left: FF FF FE ' "$work/said"
check_json "in JSON, too" '{line["line"] for line in lines} == {"left", "right"}' \
    "$GRCTL" --robot $arms -d sim --json play --dry-run "$work/wave.yaml"
check "the ports of its file" ends_with 1 "^grctl: two-arms: no such file .*usb-left-arm" \
    "$GRCTL" --robot $arms status
check "a rate is of one line" ends_with 2 'are for one, as --line left names it' \
    with_arms -b 57600 status

# Line by line, and on each by ids: two ids that are the same hide no joint.
sed 's/name: L_pan, line: left, id: 1/name: L_pan, line: left, id: 6/' $arms >"$work/arms.yaml"
check_json "angles in motor order are those of both" \
    '[round(at["angle_deg"]) for at in lines[0]["joints"]][:3] == [40, 10, 20]
    and [round(at["angle_deg"]) for at in lines[0]["joints"]][4:7] == [50, 60, 70]' \
    "$GRCTL" --robot "$work/arms.yaml" -d sim --json pose 10 20 30 40 50 60 70 50
files_are_whole() {
    exits 0 "$GRCTL" --robot "$work/arms.yaml" convert "$work/wave.yaml" "$work/wave.m" &&
        grep -qx '250  0 0 0 57 57 0 0 0' "$work/wave.m"
}
check "a file in motor order has all joints" files_are_whole

test_case "line by line"
each_line() { # PATTERN PATTERN COMMAND...: what is told of the left arm, and of the right one
    left=$1 right=$2
    shift 2
    exits 0 with_arms "$@" || return 1
    sed -n '/^left: feetech, 1000000 bps, sim/,/^right: /p' "$work/out" | grep -q "$left" &&
        sed -n '/^right: dynamixel2, 1000000 bps, sim/,$p' "$work/out" | grep -q "$right" &&
        return
    cat "$work/out"
    return 1
}
check "scan" each_line '4  STS3215 .* L_gripper' '4  XL430-W250 .* R_gripper' scan --last 9
check "info" each_line '1  STS3215 .* L_pan' '1  XL430-W250 .* R_pan' info
check "doctor" each_line ' 7.40 V at the servos' ' 12.00 V at the servos' doctor
check "budget" each_line '^motion, 4 joints .* 40 B' '^motion, 4 joints .* B' budget
check_json "in JSON each has its line" 'lines[0]["line"] == "left" and len(lines[1]["servos"]) == 4
    and lines[1]["line"] == "right" and lines[1]["servos"][0]["name"] == "R_pan"' \
    "$GRCTL" --robot $arms -d sim --json info
check_json "and a joint" 'lines[0]["joints"][0]["line"] == "left"
    and lines[0]["joints"][7]["line"] == "right"' "$GRCTL" --robot $arms -d sim --json status
check_json "offline, too" 'lines[0]["joints"][7]["line"] == "right"' \
    "$GRCTL" --robot $arms --json joints
check "one line alone" ends_with 0 '4  R_gripper' with_arms --line right status
check "which has no other joint" fails 2 "no joint called 'L_pan'" \
    with_arms --line right move L_pan 3
check "a register by its joint" ends_with 0 'XL430-W250' with_arms servo-get R_pan model
check "by an id of its line" ends_with 0 'STS3215' with_arms --line left servo-get 1 model
check "an id of both" ends_with 2 'has 2 servos of id 1: name the joint, or the line: --line left' \
    with_arms servo-get 1
check "an id of none" ends_with 2 'has 0 joints of id 9; name the line' with_arms servo-get 9
check "nor a motor of both" ends_with 2 "'m1' is L_pan and R_pan, of two lines" with_arms move m1 3
check "a register is set" ends_with 0 'led' with_arms servo-set R_lift led 1
check "a line that is not there" ends_with 2 "has no line 'up'; it has left, right" \
    with_arms --line up status
check "a robot of one line" ends_with 2 '--line left: gr001 has one line' \
    "$GRCTL" -d sim --line left status
check "a line without a port" ends_with 2 'nothing says which port line r has: -d r=PORT' sh -c \
    'sed "s/, port: [^}]*//; s/: right/: r/" "$1" >"$2/r.yaml"
    exec "$0" --robot "$2/r.yaml" --line r info' "$GRCTL" $arms "$work"
for command in 'slot 1' 'scenario 1' first-contact; do
    # shellcheck disable=SC2086 # words
    check "$command is for one line" ends_with 2 'has 2 lines: choose one, as by --line left' \
        with_arms $command
done
check "a calibration is for each line" ends_with 2 "right: calibrate: the file of two-arms-right" \
    with_arms calibrate
check "a file of it for one" ends_with 2 'a file is of one line: choose it, as by --line left' \
    with_arms calibrate --from x
check "a shell has all" ends_with 2 "info: this shell has all lines of two-arms" \
    sh -c 'echo info | "$0" --robot "$1" -d sim shell' "$GRCTL" $arms
check "setup names the robot with all its ports" ends_with 0 'names it two-arms now' \
    env XDG_CONFIG_HOME="$work/config" "$GRCTL" --robot $arms -d sim -y setup
check "and it is that robot from then on" ends_with 0 '4  R_gripper' \
    env -u GRCTL_ROBOT XDG_CONFIG_HOME="$work/config" "$GRCTL" -d two-arms status

# one_arm NAME LETTER FAMILY SERVO: a simulator of one arm, as its own robot.
one_arm() {
    {
        printf 'name: %s\nfamily: %s\nline: {baud: 1000000}\njoints:\n' "$1" "$3"
        for joint in 1 2 3 4; do
            printf '  - {name: %s%d, id: %d, servo: %s, limits_deg: [-120, 120]}\n' "$2" $joint \
                $joint "$4"
        done
    } >"$work/$1.yaml"
    "$GRCTL" --robot "$work/$1.yaml" sim --link "$work/$1" >"$work/$1.out" 2>&1 &
    echo $! >>"$work/pids"
    echo $! >"$work/$1.pid"
    wait_for test -e "$work/$1"
}
ports="left=$work/left,right=$work/right"
on_ports() {
    "$GRCTL" --robot $arms -d "$ports" --timeout 500 "$@"
}
# stands ARM: as its own robot, by another program: nothing turns, and it is short of its goal.
stands() {
    "$GRCTL" --robot "$work/$1.yaml" -d "$work/$1" --json status >"$work/a" &&
        "$GRCTL" --robot "$work/$1.yaml" -d "$work/$1" --json status >"$work/b" &&
        python3 -c 'import json, sys
a, b = (json.load(open(f))["joints"] for f in sys.argv[1:3])
sys.exit(any(abs(x["angle_deg"] - y["angle_deg"]) > 0.3 for x, y in zip(a, b))
         or not 1 < abs(b[0]["angle_deg"]) < 55)' "$work/a" "$work/b"
}
moves() {
    "$GRCTL" --robot $arms -d "$ports" --timeout 500 pose --time 9000 L_pan=60 R_pan=60 \
        >"$work/moved" 2>&1 &
    mover=$!
    sleep 2
}

test_case "on two ports"
check "the left arm is there" one_arm left L feetech STS3215
check "and the right one" one_arm right R dynamixel2 XL430-W250
check "its state has both" ends_with 0 '4  R_gripper' on_ports status
check "both move" exits 0 on_ports pose L_pan=0 R_pan=0
check "a port is missing" ends_with 1 'right-arm' "$GRCTL" --robot $arms -d "left=$work/left" status
check "one port" ends_with 2 "-d left=PORT,right=PORT" "$GRCTL" --robot $arms -d "$work/left" status
check "each line is scanned at its port" ends_with 0 '4  XL430-W250 .* R_gripper' \
    on_ports scan --last 9
check "a register at its port" ends_with 0 'XL430-W250' on_ports servo-get R_pan model
check "one line, by its port alone" ends_with 0 '4  R_gripper' \
    "$GRCTL" --robot $arms -d "$work/right" --line right status
check "setup" ends_with 0 'names it two-arms now' env XDG_CONFIG_HOME="$work/named" "$GRCTL" \
    --robot $arms -d "$ports" -y setup
check "keeps both ports" ends_with 0 '4  R_gripper' env XDG_CONFIG_HOME="$work/named" "$GRCTL" \
    -d two-arms status
check "an emergency stop of a mistyped one" ends_with 2 "NOT stopped" \
    "$GRCTL" --robot $arms -d "lft=$work/left" estop
check "a line is mistyped" ends_with 2 "has no line 'lft'; it has left, right" \
    "$GRCTL" --robot $arms -d "lft=$work/left" status
if have_json; then
    estops() {
        moves
        exits 0 on_ports estop || return 1
        wait $mover && return 1
        stands left && stands right
    }
    check "an emergency stop of both" estops
    check "which latches" exits 4 on_ports pose L_pan=5
    check "and is released" exits 0 on_ports estop --reset
    check "they are back" exits 0 on_ports pose L_pan=0 R_pan=0
    killed() {
        moves
        kill -KILL $mover
        wait $mover
        wait_for stands left && wait_for stands right
    }
    check "a kill: the guard stops both" killed
    check "and they are back" exits 0 on_ports pose L_pan=0 R_pan=0
    # The mark of one device is enough for whoever has both.
    of_one() {
        moves
        "$GRCTL" --robot "$work/right.yaml" -d "$work/right" --timeout 300 estop >"$work/said" 2>&1
        wait $mover && return 1
        stands left && stands right
    }
    check "an emergency stop of one device stops both" of_one
    check "it is released" exits 0 "$GRCTL" -d "$work/right" estop --reset
    check "they are back again" exits 0 on_ports pose L_pan=0 R_pan=0
    lost() {
        moves
        kill "$(cat "$work/right.pid")"
        wait $mover && return 1
        grep -q 'lost replies (no answer in time) at motor 1 (R_pan)' "$work/moved" || {
            cat "$work/moved"
            return 1
        }
        stands left
    }
    check "a line that is lost stops the other" lost
    check "it is plugged in" one_arm right R dynamixel2 XL430-W250
    check "and moves after it was read" exits 0 on_ports pose L_pan=0 R_pan=0
else
    skip "stops on two ports" "no python3"
fi

test_case "one simulator of both"
"$GRCTL" --robot $arms sim --link "$work/both" >"$work/both.out" 2>&1 &
both_pid=$!
wait_for test -e "$work/both-right"
on_both() {
    "$GRCTL" --robot $arms -d "left=$work/both-left,right=$work/both-right" "$@"
}
check "both arms move" exits 0 on_both pose L_pan=12 R_pan=-12
check "the next program finds them" ends_with 0 '4  R_gripper' on_both status
check "where they are" grep -q 'R_pan  *-12.0 ' "$work/said"
check "it prints what -d takes" exits 0 \
    sh -c '"$0" --robot "$1" -d "$(head -n 1 "$2")" status' "$GRCTL" $arms "$work/both.out"
kill $both_pid
wait $both_pid 2>/dev/null

test_case "in the cockpit"
if have_json && ! "$GRCTL" -d sim serve nowhere 2>&1 | grep -q 'without evhttp'; then
    check "both arms move and stop" python3 tests/support/cockpit.py lines
else
    skip "both arms move and stop" "no python3, or no evhttp"
fi
done_testing
