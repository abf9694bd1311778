#!/bin/sh
# SPDX-License-Identifier: MIT
# Robots as people build them, from file to cockpit: a hexapod of 18 AX-12A (docs/examples/robots),
# and a humanoid of 22 KRS servos, as large as the KHR-3, imported from a body with legs.
. tests/support/cli.sh
unset GRCTL_ROBOT

# sways FILE N: a motion of a second in which N joints go to 3 degrees and back.
sways() {
    {
        printf 'type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n'
        printf '    content: JointPosition\n'
        printf '    frameRate: 10\n    numFrames: 11\n    numParts: %d\n    frames:\n' "$2"
        awk -v n="$2" 'BEGIN {
            for (f = 0; f <= 10; f++) {
                line = "      - [ "
                for (j = 0; j < n; j++) {
                    line = line (j ? ", " : "") 0.0524 * (1 - cos(f * 0.6283185)) / 2
                }
                print line " ]"
            }
        }'
    } >"$1"
}

# in_cockpit FILE N MODEL: grctl serve tells of the robot with N joints.
in_cockpit() {
    rm -f "$work/link" # of the one before
    "$GRCTL" --robot "$1" -d sim serve --port 0 "$work" >"$work/link" 2>"$work/err" &
    cockpit=$!
    wait_for grep -q '^http://' "$work/link"
    python3 - "$(head -1 "$work/link")" "$2" "$3" <<'END'
import json, sys, urllib.request
page, token = sys.argv[1].split("/#token=")
request = urllib.request.Request(page + "/api/robot", headers={"X-Grobo-Token": token})
robot = json.load(urllib.request.urlopen(request, timeout=30))
sys.exit(0 if len(robot["joints"]) == int(sys.argv[2]) and robot["model"] == sys.argv[3] else 1)
END
    status=$?
    kill $cockpit
    wait $cockpit 2>/dev/null
    return $status
}

test_case "a hexapod"
hexapod=docs/examples/robots/hexapod.yaml
sways "$work/hexapod-sway.yaml" 18
check "its file is right" fails 0 'hexapod: 18 joints, nothing wrong' \
    "$GRCTL" robot check $hexapod
check "it goes to its initial posture" exits 0 "$GRCTL" --robot $hexapod -d sim init
check "a leg moves" exits 0 "$GRCTL" --robot $hexapod -d sim pose RM_coxa=20 RM_femur=30
check "it is read" exits 0 "$GRCTL" --robot $hexapod -d sim status tripod_a
check "a motion of its own is planned" exits 0 \
    "$GRCTL" --robot $hexapod -d sim play --dry-run "$work/hexapod-sway.yaml"
check "and played" exits 0 "$GRCTL" --robot $hexapod -d sim play "$work/hexapod-sway.yaml"
if have_json; then
    check "in the cockpit" in_cockpit $hexapod 18 hexapod
else
    skip "in the cockpit" "no python3"
fi

# A body of 22 joints: legs of six, arms of four, head and waist; proportions of our own.
test_case "a humanoid of 22 KRS"
awk 'BEGIN {
    print "format: ChoreonoidBody\nname: KRS22\nlinks:"
    print "  - {name: WAIST, mass: 0.4}"
    joint("HEAD", "WAIST", "Z", 90, "[0, 0, 0.12]", 0.1)
    joint("CHEST", "WAIST", "Z", 60, "[0, 0, 0.05]", 0.3)
    side("R", -1)
    side("L", 1)
    print "footLinks:"
    print "  - {link: R_ANKLE_R, soleCenter: [0, 0, -0.02]}"
    print "  - {link: L_ANKLE_R, soleCenter: [0, 0, -0.02]}"
}
function joint(name, parent, axis, most, at, mass) {
    printf "  - {name: %s, parent: %s, jointType: revolute, jointId: %d, jointAxis: %s,\n", name,
        parent, id++, axis
    printf "     jointRange: [%d, %d], translation: %s, mass: %g,\n", -most, most, at, mass
    print "     centerOfMass: [0, 0, 0], inertia: [1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4]}"
}
function side(s, y) {
    joint(s "_HIP_Y", "WAIST", "Z", 60, "[0, " 0.04 * y ", -0.03]", 0.05)
    joint(s "_HIP_R", s "_HIP_Y", "X", 60, "[0, 0, 0]", 0.05)
    joint(s "_HIP_P", s "_HIP_R", "Y", 100, "[0, 0, 0]", 0.1)
    joint(s "_KNEE_P", s "_HIP_P", "Y", 130, "[0, 0, -0.08]", 0.1)
    joint(s "_ANKLE_P", s "_KNEE_P", "Y", 80, "[0, 0, -0.08]", 0.05)
    joint(s "_ANKLE_R", s "_ANKLE_P", "X", 60, "[0, 0, 0]", 0.05)
    joint(s "_SHOULDER_P", "CHEST", "Y", 130, "[0, " 0.08 * y ", 0.06]", 0.05)
    joint(s "_SHOULDER_R", s "_SHOULDER_P", "X", 130, "[0, 0, 0]", 0.05)
    joint(s "_ELBOW_Y", s "_SHOULDER_R", "Z", 130, "[0, 0, -0.04]", 0.05)
    joint(s "_ELBOW_P", s "_ELBOW_Y", "Y", 100, "[0, 0, -0.03]", 0.05)
}' >"$work/krs22.body"
sways "$work/krs22-sway.yaml" 22
check "is imported" exits 0 "$GRCTL" robot import "$work/krs22.body" -o "$work/krs22.yaml" \
    --family ics --servo KRS-3301 --ids 0-21 --yes
check "with its feet" grep -q '^  - {link: L_ANKLE_R, sole_m: ' "$work/krs22.yaml"
check "its file is right" fails 0 'KRS22: 22 joints, nothing wrong' \
    "$GRCTL" robot check "$work/krs22.yaml"
check "it goes to its initial posture" exits 0 "$GRCTL" --robot "$work/krs22.yaml" -d sim init
check "a motion of its own is planned" exits 0 \
    "$GRCTL" --robot "$work/krs22.yaml" -d sim play --dry-run "$work/krs22-sway.yaml"
check "and played" exits 0 \
    "$GRCTL" --robot "$work/krs22.yaml" -d sim play "$work/krs22-sway.yaml"
check "its balance is judged" exits 0 \
    "$GRCTL" --robot "$work/krs22.yaml" check "$work/krs22-sway.yaml"
if have_json; then
    check "in the cockpit" in_cockpit "$work/krs22.yaml" 22 KRS22
else
    skip "in the cockpit" "no python3"
fi

done_testing
