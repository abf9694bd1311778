#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl convert: motions from one format to another.
. tests/support/cli.sh

data=${GROBO_SHARED:-../shared}/data
greet=motions/greet.pseq

# convert ARGUMENT...: succeeds.
convert() {
    exits 0 "$GRCTL" convert "$@"
}

# played FILE: every joint ten times a second, as it is played, without the line about the file.
played() {
    "$GRCTL" show --rate 10 "$1" | sed 1d
}
# postures FILE: every posture without the line about the file.
postures() {
    "$GRCTL" show "$1" | sed 1d
}
# alike VIEW FILE FILE: the same in that view.
alike() {
    $1 "$2" >"$work/first" && $1 "$3" >"$work/second" || return 1
    [ -s "$work/first" ] && diff "$work/first" "$work/second"
}

test_case "greet, our own, in all four"

remade() {
    convert $2 $greet "$work/greet.$1" || return 1
    alike postures motions/greet."$1" "$work/greet.$1"
}
check "greet.m is what convert makes" remade m
check "greet.mseq too" remade mseq
check "greet.yaml too" remade yaml '--rate 50'
check "frames play as the key poses do" alike played $greet motions/greet.yaml

# there_and_back FORMAT: to another format and back to key poses gives the same postures.
there_and_back() {
    convert --exact motions/squat.pseq "$work/there.$1" &&
        convert "$work/there.$1" "$work/back.m" &&
        convert motions/squat.pseq "$work/straight.m" &&
        alike postures "$work/straight.m" "$work/back.m"
}
for format in pseq mseq yaml m; do
    check "squat to $format and on to m" there_and_back $format
done
check "key poses stay key poses" both convert motions/sit.pseq "$work/sit.pseq" \
    --- cmp motions/sit.pseq "$work/sit.pseq"

test_case "names, formats, streams"

streams() {
    "$GRCTL" convert --from pseq --to m - - <$greet >"$work/streamed.m" || return 1
    convert $greet "$work/direct.m" && cmp "$work/streamed.m" "$work/direct.m"
}
check "- is standard input and output" streams
check "--to says it when the name does not" both convert --to m $greet "$work/greet.txt" \
    --- cmp "$work/greet.txt" "$work/direct.m"
check "nobody says it" fails 2 'unknown file type; use --to m|pseq|mseq|yaml' \
    "$GRCTL" convert $greet "$work/greet.txt"
check "content tells when the name does not" both convert "$work/greet.txt" "$work/again.m" \
    --- alike postures "$work/greet.txt" "$work/again.m"
check "a file that is not there" fails 3 'nowhere.m: no such file' \
    "$GRCTL" convert nowhere.m "$work/x.m"
check "a directory that is not there" fails 3 'cannot write: no such folder' \
    "$GRCTL" convert $greet "$work/no/x.m"
json_told='lines[0]["file"].endswith("told.m") and lines[0]["postures"] == 10'
check_json "as JSON" "$json_told" "$GRCTL" convert --json $greet "$work/told.m"

kept() {
    echo precious >"$work/old.m"
    echo 'type: PoseSeq' >"$work/bad.pseq"
    echo 'refs: [ 1' >>"$work/bad.pseq"
    exits 3 "$GRCTL" convert "$work/bad.pseq" "$work/old.m" && grep -q precious "$work/old.m"
}
check "a bad file leaves the old one alone" kept
nothing_beside() {
    left=$(ls -A "$work" | grep -v -e '^[a-z]*\.[a-z]*$' -e '^[a-z]*$')
    [ -z "$left" ] || { echo "left behind: $left"; return 1; }
}
check "nothing is left beside" nothing_beside

test_case "what is lost, what is solved"

check "what .m cannot hold is said" both convert --ik off motions/step.pseq "$work/step.m" \
    --- grep -q '^motions/step.pseq:[0-9]*: note: ikLinks are dropped' "$work/err"
skipped() {
    zmp='{ type: Vector3Seq, content: ZMP, frameRate: 50, frames: [ [ 0, 0, 0 ] ] }'
    { cat motions/greet.yaml && echo "  - $zmp"; } >"$work/zmp.yaml"
    convert "$work/zmp.yaml" "$work/nozmp.yaml" &&
        grep -q 'zmp.yaml:[0-9]*:5: note: a Vector3Seq (ZMP) is skipped$' "$work/err"
}
check "so is what reading skips" skipped
solved() {
    convert --rate 20 motions/step.pseq "$work/step.yaml" || return 1
    "$GRCTL" show --rate 20 --ik exact -j legs motions/step.pseq | sed 1,2d >"$work/first"
    "$GRCTL" show -j legs "$work/step.yaml" | sed 1d >"$work/second"
    diff "$work/first" "$work/second" && grep -q 'name: "step"' "$work/step.yaml"
}
check "legs given by ikLinks become angles" solved
lost_beside_legs() {
    sed 's/^refs:/author: me\n&/; s/type: Pose$/&\n      mine: 1/' motions/step.pseq \
        >"$work/mine.pseq"
    convert "$work/mine.pseq" "$work/mine.yaml" && grep -q '^author: me$' "$work/mine.yaml" &&
        grep -q 'mine.pseq:[0-9]*: note: zmp is dropped' "$work/err" &&
        grep -q 'note: keys of no known meaning are dropped' "$work/err" &&
        ! grep -q 'ikLinks are dropped' "$work/err"
}
check "what angles have no place for is said there too" lost_beside_legs
unsolved() {
    convert --ik off --rate 20 motions/step.pseq "$work/off.yaml" || return 1
    ! cmp -s "$work/step.yaml" "$work/off.yaml"
}
check "--ik off leaves them as they are listed" unsolved
links_kept() {
    convert motions/step.pseq "$work/step.pseq" && cmp motions/step.pseq "$work/step.pseq"
}
check "key poses keep their links" links_kept

if [ -e /dev/full ]; then
    on_full() {
        "$GRCTL" convert --to m motions/greet.pseq - >/dev/full 2>"$work/err"
        [ $? -eq 1 ] || return 1
        complains 'no room left on the disk'
    }
    check "a full disk" fails 3 '/dev/full: cannot write: no room left on the disk' \
        "$GRCTL" convert --to m motions/greet.pseq /dev/full
    check "a full disk behind standard output" on_full
else
    skip "a full disk" "no /dev/full here"
fi

test_case "what an old file holds"

cp $greet "$work/old.pseq"
check "an old file of another format stays" fails 3 \
    'old.pseq: holds something other than a .m motion' \
    "$GRCTL" convert --to m $greet "$work/old.pseq"
check "as it was" cmp $greet "$work/old.pseq"
printf 'function y = f(x)\n' >"$work/matlab.m"
check "a .m file that holds no motion" fails 3 'matlab.m: holds something other' \
    "$GRCTL" convert $greet "$work/matlab.m"
check "--replace writes over it" both convert --replace $greet "$work/matlab.m" \
    --- cmp motions/greet.m "$work/matlab.m"
check "a motion of the same format is replaced" both convert motions/step.pseq "$work/old.pseq" \
    --- convert $greet "$work/old.pseq"
: >"$work/empty"
check "an empty file is filled" convert --to yaml $greet "$work/empty"

test_case "what cannot be written without loss"

# pseq FILE REF...: a file of key poses.
pseq() {
    file=$1
    shift
    { printf 'type: PoseSeq\nname: t\nrefs:\n' && printf -- '- %s\n' "$@"; } >"$file"
}
pseq "$work/jump.pseq" '{ time: 0.5, refer: { type: Pose, joints: [ 3 ], q: [ -0.5 ] } }' \
    '{ time: 0.5, refer: { type: Pose, joints: [ 3 ], q: [ -0.6 ] } }'
check "a jump cannot be in .m" fails 3 \
    'jump.pseq:5: the posture at 500 ms is reached at 750 ms in the copy; --lossy writes' \
    "$GRCTL" convert "$work/jump.pseq" "$work/jump.m"
check "nothing is written then" test ! -e "$work/jump.m"
check "--lossy writes it" both convert --lossy "$work/jump.pseq" "$work/jump.m" \
    --- test -s "$work/jump.m"
link='translation: [ 0, 0, 0 ], rotation: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]'
pseq "$work/other.pseq" "{ time: 1, refer: { type: Pose, ikLinks: [ { name: X, $link } ] } }"
sed 's/^name: t/&\ntargetBody: Other/' "$work/other.pseq" >"$work/foreign.pseq"
check "legs that nothing solves" fails 3 'foreign.pseq: 1 of 1 poses have ikLinks' \
    "$GRCTL" convert "$work/foreign.pseq" "$work/foreign.yaml"
check "key poses keep them" convert "$work/foreign.pseq" "$work/kept.pseq"

# Only two joints, none of them the last: every format plays the same, for any body of this robot's.
few() {
    knees='refer: { type: Pose, joints: [ 3, 9 ]'
    pseq "$work/few.pseq" "{ time: 0.5, $knees, q: [ -0.5, 0.5 ] } }" \
        "{ time: 1, $knees, q: [ -0.7, 0.7 ] } }"
    [ -z "$1" ] || sed -i "s/^name: t/&\\ntargetBody: $1/" "$work/few.pseq"
    "$GRCTL" show --rate 2 -j 3,9 "$work/few.pseq" | sed 1d >"$work/first"
    for format in m mseq yaml; do
        convert "$work/few.pseq" "$work/few.$format" || return 1
        "$GRCTL" show --rate 2 -j 3,9 "$work/few.$format" | sed 1d >"$work/second"
        diff "$work/first" "$work/second" || return 1
    done
}
for body in '' GR001 SerialRobot; do
    check "a few joints, body '$body'" few "$body"
done
whole() {
    ! grep '\.' "$1"
}
check "whole numbers, which the original reads" whole "$work/few.m"
check "--exact keeps what they lose" both convert --exact "$work/few.pseq" "$work/exact.m" \
    --- grep -q '\.' "$work/exact.m"
check "frames at a rate, which every Choreonoid reads" both grep -q '^type: BodyMotion' \
    "$work/few.yaml" --- grep -q 'frameRate: 50$' "$work/few.yaml"
check "--exact keeps the times" both convert --exact "$work/few.pseq" "$work/exact.yaml" \
    --- grep -q 'has_frame_time: true' "$work/exact.yaml"
check "and says who reads them" grep -q 'by Choreonoid from 2.1 on' "$work/err"
check "a frame each ten seconds" exits 0 "$GRCTL" convert --rate 0.1 $greet "$work/slow.yaml"
check "and none more seldom" fails 2 "'0.09' is not a number from 0.1 to 1000" \
    "$GRCTL" convert --rate 0.09 $greet "$work/slow.yaml"
check "--exact and --integers" fails 2 'cannot be used together' \
    "$GRCTL" convert --exact --integers $greet "$work/x.m"

# Two keys 9000 s apart, of which every thousandth of a second is a frame: some gigabytes.
too_long() {
    joints=$(seq -s ', ' 0 19)
    printf 'type: PoseSeq\nname: long\ntargetBody: GR001\nrefs:\n' >"$work/long.pseq"
    for at in 0 9000; do
        printf -- '- { time: %s, refer: { type: Pose, joints: [ %s ], q: [ %s ] } }\n' \
            "$at" "$joints" "$(seq -s ', ' -f "0.%03.0f1234$at" 20)" >>"$work/long.pseq"
    done
    fails 3 'frames would be about [0-9.]* GB, more than the 1.1 GB' \
        "$GRCTL" convert --rate 1000 "$work/long.pseq" "$work/long.yaml" &&
        [ ! -e "$work/long.yaml" ]
}
test_case "a text that nobody could read"
check "it is refused before it is made" too_long

test_case "reference material"

# Every file to each format; key poses and frames back to what they were.
every_way() {
    name=$(basename "$1")
    for format in m pseq mseq yaml; do
        convert --ik off "$1" "$work/$name.$format" || return 1
        exits 0 "$GRCTL" show "$work/$name.$format" || return 1
    done
    same=${name##*.}
    [ "$same" = seq ] && same=yaml
    "$GRCTL" convert "$work/$name.$same" "$work/twice.$same" 2>/dev/null &&
        cmp "$work/$name.$same" "$work/twice.$same" && alike postures "$1" "$work/twice.$same"
}
if [ -d "$data/choreonoid" ]; then
    for path in "$data"/choreonoid/*.pseq "$data"/choreonoid/*.yaml "$data"/choreonoid/*.seq; do
        check "$(basename "$path") every way" every_way "$path"
    done
else
    skip "motions of Choreonoid" "no reference material beside the checkout"
fi
done_testing
