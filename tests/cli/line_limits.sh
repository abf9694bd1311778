#!/bin/sh
# SPDX-License-Identifier: MIT
# Robots of many servos on slow lines: what a line cannot do is refused in one line that says what
# helps, 'robot check' knows it, and a dry run of every robot ends.
. tests/support/cli.sh

# robot_of NAME FAMILY SERVO JOINTS FIRST_ID BAUD: writes $work/NAME.yaml.
robot_of() {
    awk -v name="$1" -v family="$2" -v servo="$3" -v n="$4" -v first="$5" -v baud="$6" 'BEGIN {
        printf "name: %s\nfamily: %s\nline: {baud: %d}\njoints:\n", name, family, baud
        for (i = 0; i < n; i++)
            printf "  - {name: part%dx, id: %d, servo: %s, limits_deg: [-100, 100]}\n",
                i, first + i, servo
    }' >"$work/$1.yaml"
}

# motion_of JOINTS: $work/motion-JOINTS.yaml, two seconds from 0 degrees and back.
motion_of() {
    awk -v n="$1" 'BEGIN {
        print "type: BodyMotion\ncomponents:\n  -\n    type: MultiValueSeq"
        print "    content: JointPosition\n    purpose: JointPosition"
        printf "    frameRate: 25\n    numFrames: 51\n    numParts: %d\n    frames:\n", n
        for (i = 0; i < 51; i++) {
            printf "      - [ "
            for (j = 0; j < n; j++)
                printf "%s%.4f", j ? ", " : "", -0.1 * (1 - cos(i / 25 * 3.14159265))
            print " ]"
        }
    }' >"$work/motion-$1.yaml"
}

# ends ROBOT JOINTS: a dry run prints frames to the motion's end, and of one time the last.
ends() {
    motion_of "$2"
    exits 0 "$GRCTL" --robot "$1" -d sim play --dry-run --clamp --force "$work/motion-$2.yaml" &&
        [ "$(tail -n 1 "$work/out" | cut -d ' ' -f 1)" -ge 1900 ]
}

test_case "a dry run of every robot ends"
"$GRCTL" robot list >"$work/robots"
while read -r name _ n _; do
    check "$name" ends "$name" "$n"
done <"$work/robots"
while read -r name family servo n baud; do
    robot_of "$name" "$family" "$servo" "$n" 1 "$baud"
    check "$n $servo at $baud bps" ends "$work/$name.yaml" "$n"
done <<'END'
xl20 dynamixel2 XL430-W250 20 57600
xl64 dynamixel2 XL430-W250 64 1000000
ax29 dynamixel1 AX-12A 29 1000000
sts40 feetech STS3215 40 1000000
scs22 feetech SCS0009 22 1000000
krs31 ics KRS-3301 31 115200
lx40 lx16a LX-16A 40 115200
rs64 rs30x RS303MR 64 115200
END
imported() {
    awk 'BEGIN {
        print "format: ChoreonoidBody\nformatVersion: 1.0\nangleUnit: degree\nname: SR1"
        print "rootLink: WAIST\nlinks:\n  -\n    name: WAIST\n    jointType: free"
        for (i = 0; i < 29; i++) {
            printf "  -\n    name: PART_%d\n    parent: %s\n", i, i ? "PART_" i - 1 : "WAIST"
            printf "    translation: [ 0, 0, 0.05 ]\n    jointId: %d\n", i
            printf "    jointType: revolute\n    jointAxis: %s\n", substr("XYZ", i % 3 + 1, 1)
            print "    jointRange: [ -90, 90 ]"
        }
    }' >"$work/sr1.body"
    for family in feetech dynamixel2 dynamixel1 rs30x lx16a ics; do
        rm -f "$work/sr1.yaml"
        exits 0 "$GRCTL" --yes robot import "$work/sr1.body" --family $family --ids 1-29 \
            -o "$work/sr1.yaml" && ends "$work/sr1.yaml" 29 || { echo "$family"; return 1; }
    done
}
check "a body that was imported, of each family" imported

test_case "a line that is too slow is named, with what helps"
robot_of slow dynamixel2 XL430-W250 64 1 57600
raise='57600 bps are too slow to move and read 64 joints in time; raise the baud rate: '
raise=$raise'grctl servo-set ID baud [0-9]* --flash$'
checked() {
    exits 0 "$GRCTL" robot check "$work/$1.yaml" && complains "^$1: $2"
}
motion_of 64
check "robot check warns" checked slow "$raise"
check "init is refused" fails 4 "$raise" "$GRCTL" --robot "$work/slow.yaml" -d sim init
check "play is refused" fails 4 "$raise" \
    "$GRCTL" --robot "$work/slow.yaml" -d sim play --force "$work/motion-64.yaml"
check "a dry run is refused" fails 4 "$raise" \
    "$GRCTL" --robot "$work/slow.yaml" -d sim play --dry-run --force "$work/motion-64.yaml"
check_json "and in JSON" 'lines[0]["ok"] and "115200" in lines[0]["slow_line"]' \
    "$GRCTL" --json robot check "$work/slow.yaml"
check_json "budget has it, too" 'lines[0]["pace_us"] == 0' \
    "$GRCTL" --json --robot "$work/slow.yaml" budget
budgets() {
    exits 0 "$GRCTL" --robot "$work/slow.yaml" budget && says "^$raise" &&
        exits 0 "$GRCTL" --robot so101 budget &&
            says '^trajectories in segments *renewed every 100 ms$'
}
check "and in words" budgets
robot_of fast dynamixel2 XL430-W250 64 1 1000000
check "a fast one is not" checked fast '64 joints, nothing wrong$'
robot_of only lx16a LX-16A 64 1 115200
check "where no rate is faster" checked only \
    '115200 bps are too slow .* no faster rate; move fewer joints at a time$'
robot_of ids ics KRS-3301 33 0 115200
check "more servos than a line has ids" fails 3 "an id from 0 to 31 is wanted$" \
    "$GRCTL" --robot "$work/ids.yaml" -d sim init
done_testing
