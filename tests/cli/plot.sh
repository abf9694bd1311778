#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl plot: pictures of motions.
. tests/support/cli.sh

data=${GROBO_SHARED:-../shared}/data
greet=motions/greet.pseq

# drawn FILE PATTERN...: FILE is well-formed XML that refers to nothing outside and has these texts.
drawn() {
    drawn_file=$1
    shift
    if have_json; then
        python3 -c '
import sys, xml.etree.ElementTree as tree
root = tree.parse(sys.argv[1]).getroot()
assert root.tag == "{http://www.w3.org/2000/svg}svg", root.tag
for element in root.iter():
    for name in element.attrib:
        assert not name.endswith("href") and name != "src", name
for number in [n for e in root.iter() for n in (e.get("points") or "").replace(",", " ").split()]:
    assert -1 < float(number) < 1e5, number
' "$drawn_file" || return 1
    fi
    for drawn_text in "$@"; do
        grep -q -e "$drawn_text" "$drawn_file" || {
            echo "no '$drawn_text' in $drawn_file"
            return 1
        }
    done
}

# plots FILE PATTERN...: a plot of it is well formed and has these texts.
plots() {
    plots_file=$1
    shift
    exits 0 "$GRCTL" plot -o "$work/plot.svg" "$plots_file" && drawn "$work/plot.svg" "$@"
}

# count PATTERN N: so many lines of the last plot are like that.
count() {
    count_got=$(grep -c -e "$1" "$work/plot.svg")
    [ "$count_got" -eq "$2" ] && return
    echo "$count_got lines like '$1', not $2"
    return 1
}

# The start of a .m line for a GR001 that stands: time and the twenty angles.
stands='0 0 200 0 -200 -200 0 200 0 200 0 -400 -200 0 0 -200 0 400 200 0'

test_case "every joint has its panel"
check "every joint has its panel" plots $greet '>greet<' 'R_SHOULDER_R  m4' 'L_ANKLE_R  m20' \
    'Head and trunk' 'Left leg' '10 key poses, 5.000 s'
check "twenty of them" count 'class="name"' 20
check "key poses are marked where they list the joint" count '<title>R_ELBOW_P ' 8
check "with angle and time" drawn "$work/plot.svg" '<title>R_SHOULDER_R −120° at 0.800 s</title>'
check "nothing is wrong with it" count 'class="warn"' 0

some_joints() {
    exits 0 "$GRCTL" plot -j right_arm,m2 -o "$work/plot.svg" $greet || return 1
    count 'class="name"' 4 && count 'Right leg' 0
}
check "--joints chooses" some_joints
check "--joints of no such name" fails 2 "no joint or group called 'tail'" \
    "$GRCTL" plot -j tail $greet
check "--rate beyond sense" fails 2 "'0' is not a number" "$GRCTL" plot --rate 0 $greet

test_case "what it says of a motion"

{
    echo "100 $stands"
    echo "300 $stands" | sed 's/ 200 0 -200/ 1700 0 -200/'
    echo "2000 $stands"
} >"$work/fast.m"
check "limits and speeds are marked" plots "$work/fast.m" '1 joint beyond its limits' \
    '1 joint faster than its servo' 'class="fast"' 'class="beyond"' '20 to 170°, 750°/s'
fast_json='lines[0]["joints"][14]["too_fast_ms"] == [[100, 300]] and
    lines[0]["joints"][14]["beyond_limits"] and
    not any(j["beyond_limits"] for j in lines[0]["joints"] if j["joint"] != 14) and
    lines[0]["joints"][14]["limits_deg"] == [-150, 150] and
    lines[0]["joints"][14]["peak_dps"] == 750'
check_json "and told as JSON" "$fast_json" "$GRCTL" plot --json -o "$work/fast.svg" "$work/fast.m"

slow_json='lines[0]["joints"][0]["peak_dps"] == 0 and lines[0]["length_ms"] == 5000 and
    lines[0]["postures"] == 10 and lines[0]["output"].endswith("x.svg") and
    lines[0]["joints"][15]["min_deg"] == -135 and lines[0]["joints"][15]["motor"] == 4'
check_json "a summary as JSON" "$slow_json" "$GRCTL" plot --json -o "$work/x.svg" $greet

cat >"$work/one.pseq" <<'PSEQ'
type: PoseSeq
name: "a<b>&\"\x01\u202e'"
refs:
  - time: 0
    refer: { type: Pose, name: "", joints: [ 0, 3 ], q: [ 0.1, -0.2 ] }
PSEQ
check "one pose, and a name that means mischief" plots "$work/one.pseq" \
    ">a&lt;b&gt;&amp;&quot;��'<" '1 key pose, 0.000 s' 'stays at 5.7°'
printf 'type: PoseSeq\nname: none\nrefs: []\n' >"$work/none.pseq"
check "no pose at all" plots "$work/none.pseq" 'No postures.'
printf 'type: PoseSeq\nname: none\nrefs:\n  - time: 0\n    refer: { type: Pose, name: "" }\n' \
    >"$work/unset.pseq"
check "no joint at all" plots "$work/unset.pseq" 'No posture sets a joint.'
cat >"$work/huge.pseq" <<'PSEQ'
type: PoseSeq
name: huge
refs:
  - time: 0
    refer: { type: Pose, name: "", joints: [ 0 ], q: [ -999999 ] }
  - time: 1e-7
    refer: { type: Pose, name: "", joints: [ 0 ], q: [ 999999 ] }
PSEQ
check "numbers beyond any robot" plots "$work/huge.pseq" 'R_HIP_Y'

# Many frames: as many points as the picture shows, not as the motion has.
{
    printf 'type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n    content: JointPosition\n'
    printf '    frameRate: 1000\n    numParts: 25\n    frames:\n'
    awk 'BEGIN { for (i = 0; i < 20000; i++) {
        printf "      - [ %.5f", sin(i / 3) / 3
        for (j = 1; j < 25; j++) printf ", %.4f", sin(i / 4000) * j / 40
        print " ]"
    } }'
} >"$work/many.yaml"
check "20000 frames of 25 joints" plots "$work/many.yaml" '>j24<' '20000 frames at 1000 Hz'
small() {
    [ "$(wc -c <"$work/plot.svg")" -lt 100000 ] || wc -c "$work/plot.svg"
}
check "in less than 100 kB" small
check "an extreme that lasts one frame is not lost" drawn "$work/plot.svg" '−19.1 to 19.1°'
check "joints of a body we do not know" both exits 0 "$GRCTL" plot -j j24 "$work/many.yaml" \
    --- says '>j24<'
check "have no other names" fails 2 'are j0 to j24' "$GRCTL" plot -j NECK_Y "$work/many.yaml"

for path in "$data"/choreonoid/*.pseq "$data"/choreonoid/*.yaml "$data"/choreonoid/*.seq; do
    if [ -f "$path" ]; then
        check "${path##*/}" plots "$path" "${path##*/}"
    else
        skip "motions of Choreonoid" "no reference material beside the checkout"
        break
    fi
done

test_case "the whole body"

walk_json='lines[0]["balance"]["stands_always"] and lines[0]["balance"]["problems"] == 0 and
    15 < lines[0]["balance"]["margin_mm"] < 39 and not lines[0]["balance"]["assumed"]'
check_json "--balance in numbers" "$walk_json" \
    "$GRCTL" plot --json --balance -o "$work/plot.svg" motions/step.pseq
check "and as a picture" drawn "$work/plot.svg" 'From above' 'class="sole right"' \
    'at least [0-9.]* mm inside' 'Right foot stands' 'legs by inverse kinematics'
check "the legs move" drawn "$work/plot.svg" '<title>R_KNEE_P .* at 1.700 s</title>'
still() {
    exits 0 "$GRCTL" plot --ik off -j R_HIP_Y,R_KNEE_P -o "$work/plot.svg" motions/step.pseq &&
        ! grep -q 'inverse kinematics' "$work/plot.svg"
}
check "--ik off draws their own angles" still
flat_json='lines[0]["balance"]["assumed"] and lines[0]["balance"]["margin_mm"] > 25 and
    lines[0]["balance"]["problems"] == 0'
check_json "a motion of angles stands on both feet" "$flat_json" \
    "$GRCTL" plot --json --balance -o "$work/plot.svg" motions/squat.pseq
check "which is said" drawn "$work/plot.svg" 'both feet are taken to stand'
long_json='lines[0]["length_ms"] > 5500 and lines[0]["balance"]["margin_mm"] > 15'
check_json "with the balancer it lasts a second longer" "$long_json" \
    "$GRCTL" plot --json --balance on -o "$work/plot.svg" motions/step.pseq
check "of another robot nothing is known" fails 3 'for a robot whose feet are not known' \
    "$GRCTL" plot --balance "$work/many.yaml"

test_case "our own"

check "motions/plots are what is drawn now" tools/plots.sh "$GRCTL" --check
shown() {
    for path in motions/*.pseq; do
        name=$(basename "$path" .pseq)
        grep -q "plots/$name.svg" motions/README.md && grep -q "^| \[$name\]" motions/README.md || {
            echo "$name is not in motions/README.md"
            return 1
        }
    done
}
check "motions/README.md shows each" shown

test_case "where it goes"

check "without -o to standard output" both exits 0 "$GRCTL" plot $greet --- says '^<svg '
check "-o - too" both exits 0 "$GRCTL" plot -o - $greet --- says '^<svg '
json_needs_it() {
    exits 2 "$GRCTL" plot --json -o - $greet && grep -q 'cannot both go' "$work/err"
}
from_stdin() {
    "$GRCTL" plot - <$greet >"$work/plot.svg" && drawn "$work/plot.svg" '>greet<'
}
check "from standard input" from_stdin
check "but not with --json" json_needs_it

# Without -o but with --json (or on a terminal) to a file of the motion's name, here.
here=$(pwd)
named() {
    mkdir "$work/named" && cd "$work/named" || return 1
    exits 0 "$GRCTL" plot --json "$here/$greet" || return 1
    drawn greet.svg '>greet<' && exits 0 "$GRCTL" plot --json "$here/$greet" || return 1
    echo mine >greet.svg
    exits 3 "$GRCTL" plot --json "$here/$greet" && grep -q 'no plot of ours' "$work/err" &&
        grep -q mine greet.svg
}
check "a name of its own, and nobody else's file is replaced" named
replaced() {
    echo mine >"$work/old.svg"
    exits 0 "$GRCTL" plot -q -o "$work/old.svg" $greet && [ ! -s "$work/err" ] &&
        drawn "$work/old.svg" '>greet<'
}
check "-o replaces" replaced

check "another extension" fails 2 'pictures are .svg or .png' "$GRCTL" plot -o x.jpg $greet
check "a directory that is not there" fails 3 'cannot write: no such folder' \
    "$GRCTL" plot -o "$work/no/x.svg" $greet
check "a file that is not there" fails 3 'no such file' "$GRCTL" plot "$work/no.pseq"
check "a file that is none" fails 3 '^grctl: README.md:[0-9]*:' "$GRCTL" plot README.md
check "no file" fails 2 'plot needs FILE' "$GRCTL" plot
full() {
    "$GRCTL" plot $greet 2>"$work/err" >/dev/full
    [ $? -eq 1 ] && [ "$(wc -l <"$work/err")" -eq 1 ]
}
if [ -e /dev/full ]; then
    check "a full disk is no success" full
else
    skip "a full disk is no success" "no /dev/full here"
fi

test_case "PNG: whatever draws it stands in PATH"

# tool NAME SCRIPT: $work/tools/NAME runs it; PATH has nothing else.
tool() {
    mkdir -p "$work/tools"
    printf '#!/bin/sh\n%s\n' "$2" >"$work/tools/$1"
    chmod +x "$work/tools/$1"
}
png() {
    saved=$PATH
    # shellcheck disable=SC2123 # it is the search path
    PATH=$work/tools
    exits "$@"
    png_status=$?
    PATH=$saved
    return $png_status
}
png_magic='printf "\211PNG\r\n\032\n"'
mkdir "$work/tools"
png_fails() {
    png "$1" "$GRCTL" plot -o "$work/out.png" $greet || return 1
    [ ! -e "$work/out.png" ] && complains "$2"
}
png_drawn() {
    png 0 "$GRCTL" plot -o "$work/out.png" $greet || return 1
    grep -a -q -e PNG "$work/out.png" && grep -a -q -e "$1" "$work/out.png" && rm "$work/out.png"
}
none='needs rsvg-convert, inkscape or ImageMagick; install one (Debian: librsvg2-bin)'
if [ -z "${EMULATOR:-}" ]; then
    check "without a rasteriser it says what to install" png_fails 3 "$none"
else
    skip "without a rasteriser" "qemu-user and wine do not tell that a program is missing"
fi
tool convert "while read -r line; do
    case \$line in *'>greet<'*) $png_magic; echo \"\$@\" ;; esac
done"
check "ImageMagick will do" png_drawn '^-density 192 svg:- png:-$'
tool inkscape 'exit 1'
check "one that fails is passed over" png_drawn '^-density'
tool rsvg-convert "$png_magic; echo \"\$@\""
check "librsvg comes first" png_drawn '^--format=png --zoom=2$'
rm "$work/tools/convert"
tool rsvg-convert 'echo no picture'
check "what is no PNG is not taken for one" png_fails 3 'could not draw it'
if command -v rsvg-convert >/dev/null 2>&1; then
    check "a real one" both exits 0 "$GRCTL" plot -o "$work/real.PNG" $greet \
        --- grep -q IHDR "$work/real.PNG"
else
    skip "a real PNG" "no rsvg-convert here"
fi
done_testing
