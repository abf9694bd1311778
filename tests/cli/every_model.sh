#!/bin/sh
# SPDX-License-Identifier: MIT
# Every model of `grctl robot servos` as a robot of one joint, and each eighth as one of six: its
# file is checked, and it is scanned, read, examined, moved, played and stopped in one shell.
. tests/support/cli.sh
unset GRCTL_ROBOT

if [ -n "${NATIVE_GRCTL:-}${EMULATOR:-}" ]; then
    echo "1..0 # SKIP a hundred starts take too long where each is emulated"
    exit
fi
mkdir "$work/models"
"$GRCTL" robot servos >"$work/servos"

# robot_of FAMILY MODEL JOINTS: its file, and a motion for it.
robot_of() {
    printf 'name: r\nfamily: %s\njoints:\n' "$1" >"$work/models/$2-$3.yaml"
    angles=
    for id in $(seq "$3"); do
        printf '  - {name: p%s, id: %s, servo: %s, limits_deg: [-50, 50]}\n' "$id" "$id" "$2" \
            >>"$work/models/$2-$3.yaml"
        angles="$angles${angles:+, }0.02"
    done
    sed "s/ANGLES/$angles/; s/PARTS/$3/" >"$work/models/$2-$3.motion.yaml" <<'END'
type: BodyMotion
name: there
targetBody: r
components:
  - type: MultiValueSeq
    content: JointPosition
    purpose: JointPosition
    frameRate: 20
    numFrames: 2
    numParts: PARTS
    frames:
      - [ ANGLES ]
      - [ ANGLES ]
END
}

# Each ends with a file of its own: empty where it went well, else what was printed.
cat >"$work/one.sh" <<'END'
[ -n "${1:-}" ] || exit 0 # of an empty list
file=$1.yaml
printf '%s\n' 'scan --first 1 --last 7' status info doctor 'servo-get p1' 'move p1 2 20' \
    "play $1.motion.yaml" 'servo-get p1 temperature' stop 'servo off' >"$1.shell"
{
    "$GRCTL" robot check "$file" && "$GRCTL" --robot "$file" budget &&
        "$GRCTL" --robot "$file" -y --timeout 500 -d sim shell "$1.shell"
} >"$1.out" 2>&1 && grep -q 'torque of [0-9]* joints\{0,1\} is off' "$1.out" ||
    cp "$1.out" "$1.wrong"
END

count=0
while read -r family model rest; do
    case $rest in
    *'cannot be a joint'*) sizes= ;;
    *) sizes=$([ $((count % 8)) -eq 0 ] && echo '1 6' || echo 1) ;;
    esac
    for size in $sizes; do
        robot_of "$family" "$model" "$size"
        echo "$work/models/$model-$size"
    done
    count=$((count + 1))
done <"$work/servos" >"$work/robots"
GRCTL=$GRCTL xargs -P 16 -n 1 sh "$work/one.sh" <"$work/robots"

well() {
    for wrong in "$work"/models/*.wrong; do
        [ -e "$wrong" ] || return 0
        echo "${wrong##*/}"
        cat "$wrong"
    done
    return 1
}
test_that "every model that can be a joint is driven" well
test_that "these are more than 100" [ "$(wc -l <"$work/robots")" -gt 100 ]
refused() {
    while read -r family model rest; do
        case $rest in
        *'cannot be a joint'*) ;;
        *) continue ;;
        esac
        robot_of "$family" "$model" 1
        exits 3 "$GRCTL" robot check "$work/models/$model-1.yaml" &&
            [ "$(wc -l <"$work/out")" -eq 1 ] && says ':4:.*p1: .*\[servo\]$' || {
            echo "$model"
            cat "$work/out"
            return 1
        }
    done <"$work/servos"
}
test_that "of any other a file says why, in a line" refused
done_testing
