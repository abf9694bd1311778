#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl robot export: links and joints for programs that simulate bodies.
. tests/support/cli.sh
unset GRCTL_ROBOT

to() {
    "$GRCTL" robot export "$@"
}
# counts N WORD FILE
counts() {
    [ "$(grep -c -e "$2" "$3")" -eq "$1" ]
}

test_case "MJCF"
check "of a robot with feet" exits 0 to gr001 --mjcf -o "$work/gr001.xml"
check "has a hinge for each joint" counts 20 '^<joint name=' "$work/gr001.xml"
check "a free base" counts 1 '<freejoint name="base"/>' "$work/gr001.xml"
check "two soles on a floor" both counts 2 'class="sole" pos' "$work/gr001.xml" --- \
    counts 1 'type="plane"' "$work/gr001.xml"
check "what nobody knows stands in it" both grep -q 'Friction of the soles: 0.8' "$work/gr001.xml" \
    --- grep -q 'RS301CR: not identified: .*friction and inertia are chosen' "$work/gr001.xml"
fixed() {
    exits 0 to so101 --mjcf && counts 0 freejoint "$work/out"
}
check "an arm's base is fixed" fixed
check "or free, if wanted" both exits 0 to so101 --mjcf --free --- says '^<freejoint'
check "a motor that was identified is named" both exits 0 to so101 --mjcf --- \
    says ' STS3215: identified: .*2410.08650'

test_case "URDF"
again() {
    exits 0 to so101 --urdf -o "$work/arm.urdf" &&
        exits 0 "$GRCTL" robot import "$work/arm.urdf" --family feetech --servo STS3215 \
            -o "$work/again.yaml" && exits 0 "$GRCTL" --robot so101 joints &&
        sed 1d "$work/out" >"$work/first" &&
        exits 0 "$GRCTL" --robot "$work/again.yaml" joints && sed 1d "$work/out" >"$work/second" &&
        awk '{ print $1, $2, $3, $4, $5 }' "$work/first" >"$work/a" &&
        awk '{ print $1, $2, $3, $4, $5 }' "$work/second" >"$work/b" && cmp "$work/a" "$work/b"
}
check "imported again it is the same robot" again
mass() {
    "$GRCTL" --json robot show "$1" | sed 's/.*"mass_kg":\([0-9.]*\).*/\1/'
}
same_mass() {
    [ "$(mass so101)" = "$(mass "$work/again.yaml")" ]
}
check "of the same mass" same_mass
check "in JSON" both exits 0 to so101 --urdf --json --- says '"format":"urdf"'

test_case "what cannot be"
check "neither" fails 2 'one of --mjcf and --urdf is wanted' to so101
check "both" fails 2 'one of --mjcf and --urdf is wanted' to so101 --mjcf --urdf
check "a URDF with a free base" fails 2 'does not say whether' to so101 --urdf --free
check "a robot without links" fails 3 'pan-tilt: its file has no links' to pan-tilt --mjcf
check "no robot" fails 3 "no robot called 'so10'" to so10 --mjcf
check "a file is not replaced" fails 2 'gr001.xml is there already; --yes replaces it' \
    to gr001 --mjcf -o "$work/gr001.xml"
done_testing
