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

# ---- greet, our own, in all four ------------------------------------------------------------

remade() {
    convert $2 $greet "$work/greet.$1" || return 1
    alike postures motions/greet."$1" "$work/greet.$1"
}
check "greet.m is what convert makes" remade m --integers
check "greet.mseq too" remade mseq
check "greet.yaml too" remade yaml '--rate 50'
check "frames play as the key poses do" alike played $greet motions/greet.yaml

# there_and_back FORMAT: to another format and back to key poses gives the same postures.
there_and_back() {
    convert motions/squat.pseq "$work/there.$1" && convert "$work/there.$1" "$work/back.m" &&
        convert motions/squat.pseq "$work/straight.m" &&
        alike postures "$work/straight.m" "$work/back.m"
}
for format in pseq mseq yaml m; do
    check "squat to $format and on to m" there_and_back $format
done
check "key poses stay key poses" both convert motions/sit.pseq "$work/sit.pseq" \
    --- cmp motions/sit.pseq "$work/sit.pseq"

# ---- names, formats, streams ----------------------------------------------------------------

streams() {
    "$GRCTL" convert --from pseq --to m - - <$greet >"$work/streamed.m" || return 1
    convert $greet "$work/direct.m" && cmp "$work/streamed.m" "$work/direct.m"
}
check "- is standard input and output" streams
check "--to says it when the name does not" both convert --to m $greet "$work/greet.txt" \
    --- cmp "$work/greet.txt" "$work/direct.m"
check "nobody says it" fails 2 'its name tells no format; give --to m|pseq|mseq|yaml' \
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

# ---- what is lost, what is solved -----------------------------------------------------------

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
        ! "$GRCTL" convert --to m motions/greet.pseq - >/dev/full 2>"$work/err" || return 1
        complains 'no room left on the disk'
    }
    check "a full disk" fails 3 '/dev/full: cannot write: no room left on the disk' \
        "$GRCTL" convert --to m motions/greet.pseq /dev/full
    check "a full disk behind standard output" on_full
else
    skip "a full disk" "no /dev/full here"
fi

# ---- reference material ---------------------------------------------------------------------

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
