#!/bin/sh
# SPDX-License-Identifier: MIT
# Named robots, their trims, and grctl calibrate.
. tests/support/cli.sh

mkdir -p "$work/config/grctl"
config=$work/config/grctl/config.yaml

written() {
    cat >"$config"
}
start_sim || { echo "Bail out! the simulator did not start"; exit 1; }

written <<EOF
# the robots of this house
default: kitchen
robots:
  kitchen:   # the first one
    device: $robot
    wiring: board
    baud: 115200
    on_exit: hold
  cellar: {device: $work/none, wiring: bus, trim: {m5: 1}}
EOF
test_case "robots are found by name"
check "the default robot" both exits 0 "$GRCTL" -v status m3 --- says R_SHOULDER_P
if [ -z "${NATIVE_GRCTL:-}" ]; then
    check "the port used last is remembered" grep -qx -e "$robot" "$work/state/grctl/last-port"
fi
check "a named one" both exits 0 "$GRCTL" -d kitchen status m3 --- says R_SHOULDER_P
in_environment() {
    exits 0 env GRCTL_DEVICE=kitchen "$GRCTL" status m3 && says R_SHOULDER_P
}
check "in the environment" in_environment
check "another one" fails 1 'none: no such file' "$GRCTL" -d cellar status
check "what is no name is a device" fails 1 'attic: no such file' "$GRCTL" -d attic status
check "a name nearly right" fails 1 "kitchne: no such file or device (did you mean 'kitchen'?)" \
    "$GRCTL" -d kitchne status
check "so for an emergency stop" fails 1 "(did you mean 'kitchen'?); NOT stopped" \
    "$GRCTL" -d kitchne estop

test_case "trims"

check "calibrate sets a trim" both exits 0 "$GRCTL" -d kitchen calibrate R_ELBOW_P 2.5 --- \
    says 'R_ELBOW_P  *0\.0 ->  *2\.5'
kept() {
    grep -q '^# the robots of this house' "$config" && grep -q '# the first one' "$config" &&
        grep -q 'trim: {R_ELBOW_P: 2\.5}' "$config" && grep -q 'cellar' "$config"
}
check "and keeps the rest of the file" kept
exits 0 "$GRCTL" -d kitchen move m5 -60 300
check "a trimmed joint is where it was sent" both exits 0 "$GRCTL" -d kitchen status m5 --- \
    says 'R_ELBOW_P  *-60\.0'
check "and 2.5 deg beside it for the servo" both exits 0 on_robot status m5 --- \
    says 'R_ELBOW_P  *-57\.5'
check "limits hold behind the trim" exits 4 "$GRCTL" -d kitchen move m5 49
check "and before it" exits 4 "$GRCTL" -d kitchen move m5 51
check "up to it" exits 0 "$GRCTL" -d kitchen move m5 47.5 500
check "where the servo is at its limit" both exits 0 on_robot status m5 --- \
    says 'R_ELBOW_P  *50\.0'
check "another trim beside it" exits 0 "$GRCTL" calibrate m12 -1
check "both are there" grep -q 'trim: {R_KNEE_P: -1, R_ELBOW_P: 2\.5}' "$config"
check "the table of joints has no trims" both exits 0 "$GRCTL" joints m5 --- \
    says '^R_ELBOW_P .* -130  *50  *-20  '
check "a robot in braces" both exits 0 "$GRCTL" -d cellar calibrate m5 3 --- \
    grep -q 'trim: {R_ELBOW_P: 3}}$' "$config"
check "not more than a tooth" fails 4 'does its horn sit right' "$GRCTL" calibrate m5 30
dry() {
    cp "$config" "$work/before"
    exits 0 "$GRCTL" calibrate m5 7 --dry-run && cmp "$config" "$work/before"
}
check "--dry-run writes nothing" dry
# The second one finds the file as the first one, and a person, have left it.
one_by_one() {
    {
        echo 'calibrate m5 1.5'
        until grep -q '1\.5' "$config"; do sleep 0.05; done
        sed 's/^default:/# a line more\n&/' "$config" >"$work/more" && cp "$work/more" "$config"
        echo 'calibrate m12 -3'
    } | "$GRCTL" -d kitchen --yes shell >"$work/out" 2>"$work/err" || { cat "$work/err"; return 1; }
    diff "$config" - <<EOF
$(sed 's/^default:/# a line more\n&/; s/trim: {R_KNEE.*}/trim: {R_KNEE_P: -3, R_ELBOW_P: 1.5}/' \
    "$work/before")
EOF
}
check "one after the other in a shell" one_by_one
cp "$work/before" "$config"

# By measuring: the robot stands in its initial posture but for one joint.
exits 0 on_robot init --time 500
exits 0 on_robot move R_KNEE_P -37 500
check_json "calibrate measures" \
    '[j["trim_deg"] for j in lines[0]["joints"] if j["trim_deg"]] == [3] and lines[0]["written"]' \
    "$GRCTL" calibrate --json --timeout 500
check_json "then the posture is the initial one" \
    'lines[0]["joints"][0]["angle_deg"] == -40' "$GRCTL" status R_KNEE_P --json
check "calibrate without a robot" fails 2 'keep no calibration, and -d names no robot of' \
    on_robot calibrate
check "a joint without degrees" fails 2 'needs JOINT DEG' "$GRCTL" calibrate m5

offset() {
    sed "s/baud: .*/offset: {m12: 2}/" "$config" >"$work/new" && cp "$work/new" "$config"
    exits 0 "$GRCTL" status R_KNEE_P && says 'R_KNEE_P  *-38\.0'
}
check "an offset is added to what is read" offset

# trims_read LINE: of a file on standard input; what calibrate has written is read, and has it.
trims_read() {
    sed "s|PORT|$robot|" | written
    exits 0 "$GRCTL" -d kitchen calibrate m12 1.5 && exits 0 "$GRCTL" -d kitchen status m12 &&
        grep -qxF -e "$1" "$config" && return
    cat "$config" "$work/err"
    return 1
}
cp "$config" "$work/mine"
check "a trim stands behind the robot that it is of" trims_read '    trim: {R_KNEE_P: 1.5}' <<'EOF'
robots:
  kitchen:
    device: PORT
    robot: gr001   # or another
    wiring: board
EOF
line="  kitchen: {device: \"$robot\", robot: \"gr001\", trim: {R_KNEE_P: 1.5}}"
check "in braces too, as setup writes it" trims_read "$line" <<'EOF'
robots:
  kitchen: {device: "PORT", robot: "gr001"}
EOF
line="  kitchen: {device: \"$robot\", trim: {R_KNEE_P: 1.5, R_ELBOW_P: 0.125}}"
check "what a person wrote finer stays so" trims_read "$line" <<'EOF'
robots:
  kitchen: {device: "PORT", trim: {R_ELBOW_P: 0.125}}
EOF
utf16() {
    printf 'robots:\n  kitchen:\n    device: sim\n' | iconv -f UTF-8 -t UTF-16 >"$config" &&
        cp "$config" "$work/before" && exits 0 "$GRCTL" -d kitchen joints &&
        exits 3 "$GRCTL" -d kitchen calibrate m12 1.5 &&
        complains 'would not be read as it is meant; change it by hand$' &&
        cmp "$config" "$work/before"
}
if command -v iconv >/dev/null; then
    check "a file in UTF-16 is read, and left alone" utf16
else
    skip "a file in UTF-16 is read, and left alone" "no iconv"
fi
cp "$work/mine" "$config"

test_case "the shell"

in_shell() {
    printf 'connect kitchen\nstatus m12\n' | "$GRCTL" -d sim shell >"$work/out" 2>"$work/err" ||
        { cat "$work/err"; return 1; }
    says 'R_KNEE_P  *-38\.0'
}
check "connect knows names" in_shell

# The knee bends to -120 at rest; a trim leaves it -110, which the offset makes -108 when read.
sits() {
    exits 0 "$GRCTL" calibrate m12 -20 && exits 0 "$GRCTL" --on-exit sit init --time 1500 &&
        exits 0 "$GRCTL" status legs && says 'R_KNEE_P  *-108\.0.* off'
}
check "a trim leaves room for the resting posture" sits

test_case "mistakes"

# bad PLACE-AND-MESSAGE: the file on standard input is refused there.
bad() {
    written
    fails 3 "config\.yaml:$1" "$GRCTL" -d kitchen status
}
check "no YAML" bad '[0-9]*:[0-9]*: ' <<'EOF'
robots: [
EOF
check "an unknown key" bad "1:1: no key 'robot'" <<'EOF'
robot: {}
EOF
check "an unknown key of a robot" bad "3:5: no key 'colour'" <<'EOF'
robots:
  kitchen:
    colour: red
EOF
check "an unknown joint" bad "4:12: no joint called 'TAIL'" <<'EOF'
robots:
  kitchen:
    device: x
    trim: {TAIL: 3}
EOF
check "a trim that is none" bad '2:46: degrees' <<'EOF'
robots:
  kitchen: {device: /dev/x, trim: {R_KNEE_P: far}}
EOF
check "a wiring that is none" bad "2:37: .*(board|bus)" <<'EOF'
robots:
  kitchen: {device: /dev/x, wiring: string}
EOF
check "an echo that is none" bad "2:50: true or false" <<'EOF'
robots:
  kitchen: {device: /dev/x, wiring: bus,   echo: 1}
EOF
check "a baud rate that is none" bad "2:35: .*'9' is not" <<'EOF'
robots:
  kitchen: {device: /dev/x, baud: 9}
EOF
check "no device" bad '2:3: robot kitchen has no device' <<'EOF'
robots:
  kitchen: {wiring: bus}
EOF
check "an alias" bad '3:12: aliases' <<'EOF'
robots:
  kitchen: &a {device: /dev/x}
  cellar:  *a
EOF
check "a robot twice" bad '3:3: kitchen is there twice' <<'EOF'
robots:
  kitchen: {device: /dev/x, trim: {m5: 1}}
  kitchen: {device: /dev/x, trim: {m5: 2}}
EOF
check "a key twice" bad '2:44: trim is there twice' <<'EOF'
robots:
  kitchen: {device: /dev/x, trim: {m5: 1}, trim: {m6: 2}}
EOF
check "a joint twice, by its motor and by its name" bad '2:43: R_ELBOW_P is there twice' <<'EOF'
robots:
  kitchen: {device: /dev/x, trim: {m5: 1, R_ELBOW_P: 2}}
EOF
check "it does not keep others from working" exits 0 "$GRCTL" check motions/greet.pseq
if [ -z "${NATIVE_GRCTL:-}" ]; then
    ln -sf config.yaml "$config"
    check "a link to itself is not taken for no file" \
        fails 3 'config.yaml: ' "$GRCTL" -d kitchen status
    rm "$config"
fi
written <<'EOF'
default: attic
EOF
check "a default that is none" fails 3 "config/grctl/config.yaml: default 'attic' is not a robot" \
    "$GRCTL" status
written <<'EOF'
# nothing yet
EOF
check "an empty file" fails 1 'attic: no such file' "$GRCTL" -d attic status
done_testing
