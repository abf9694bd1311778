#!/bin/sh
# SPDX-License-Identifier: MIT
# How legs are solved: the options that play, show, convert, plot and check share.
. tests/support/cli.sh

data=${GROBO_SHARED:-../shared}/data
step=motions/step.pseq
bare=$work/bare.pseq # without desired ZMP
sed '/[zZ]mp/d' "$step" >"$bare"

# seen_by COMMAND OPTION...: what a command makes of $bare with these options, on standard output.
seen_by() {
    seen_command=$1
    shift
    case $seen_command in
    show) "$GRCTL" show --rate 20 "$@" "$bare" ;;
    convert) "$GRCTL" convert --rate 20 --to yaml "$@" "$bare" - ;;
    play) "$GRCTL" play --dry-run --rate 20 "$@" "$bare" ;;
    plot) "$GRCTL" plot -o - "$@" --balance "$bare" ;; # its word is the one before
    esac
}
# same COMMAND OPTIONS OPTIONS: both sets of options do the same.
same() {
    seen_by "$1" $2 >"$work/first" && seen_by "$1" $3 >"$work/second" || return 1
    [ -s "$work/first" ] && cmp "$work/first" "$work/second"
}
differ() {
    if same "$@" >"$work/out" 2>&1; then
        echo "'$2' and '$3' do the same"
        return 1
    fi
    [ -s "$work/first" ] && [ -s "$work/second" ]
}

long_choreonoid='--ik numeric --step stealthy --zmp auto --balance off'
long_11='--ik numeric --step none --zmp auto --balance compat11'
long_robot='--ik numeric --step none --zmp auto --balance on'
test_case "presets mean the same to show, convert, play, plot"
for command in show convert play plot; do
    for balance in on compat11; do
        check "$command: --balance $balance implies automatic ZMP" \
            same $command "--balance $balance" "--balance $balance --zmp auto"
        check "$command: --balance $balance does something" \
            differ $command "--balance $balance" '--balance off'
    done
    check "$command: --like choreonoid" same $command '--like choreonoid' "$long_choreonoid"
    check "$command: --like choreonoid-1.1" same $command '--like choreonoid-1.1' "$long_11"
    check "$command: --like robot" same $command '--like robot' "$long_robot"
    check "$command: the other options change a preset" \
        same $command '--balance off --step stealthy --like choreonoid-1.1' '--like choreonoid'
    check "$command: a balancer that has no leg to move" fails 2 \
        '--ik off and a balancer cannot be used together; add --balance off' \
        seen_by $command --like robot --ik off
    check "$command: no balancer, no legs" exits 0 \
        seen_by $command --like robot --ik off --balance off
done
# Nothing is added to a motion whose ZMP shall be that of the file.
test_case "presets of check"
check "--zmp file is kept" differ show '--balance on --zmp file' '--balance on'
check "check takes presets" exits 0 "$GRCTL" check --balance --like robot "$step"
check "and keeps the preset's balancer at --balance without a word" fails 2 'cannot be used' \
    "$GRCTL" check --like robot --ik off "$step" --balance
check "a preset that is none" fails 2 "invalid value 'me' (choreonoid|choreonoid-1.1|robot)" \
    "$GRCTL" show --like me "$step"
idle() {
    exits 0 "$GRCTL" convert --balance on motions/greet.pseq "$work/greet.yaml" &&
        grep -q 'greet.pseq: no legs by ikLinks: the balancer has nothing to move$' "$work/err"
}
check "legs that are no targets" idle

test_case "a robot's file with feet"

# alike OPTION...: a robot of a file has the legs of the one that comes with grctl.
alike() {
    "$GRCTL" show --rate 50 "$@" "$step" >"$work/first" &&
        "$GRCTL" --robot ./src/robots/gr001.yaml show --rate 50 "$@" "$step" >"$work/second" &&
        grep -q 'legs by inverse kinematics' "$work/first" && cmp "$work/first" "$work/second"
}
check "exact" alike
check "numeric" alike --ik numeric
check "with a balancer" alike --like robot
sed '/^feet:/,$d; s/^name: gr001/name: footless/' src/robots/gr001.yaml >"$work/footless.yaml"
check "without feet they are not solved, which is said" both exits 0 \
    "$GRCTL" --robot "$work/footless.yaml" show "$step" --- \
    says 'poses give legs by ikLinks: the feet of its robot are not known$'
check "nor converted" fails 3 'have ikLinks, and the feet of their robot are not known; --ik off' \
    "$GRCTL" --robot "$work/footless.yaml" convert "$step" "$work/footless.m"
sed 's/link: R_ANKLE_R, sole/link: R_ANKEL_R, sole/' src/robots/gr001.yaml >"$work/wrong.yaml"
check "a foot that is no link" both exits 3 "$GRCTL" robot check "$work/wrong.yaml" --- \
    says "no link called 'R_ANKEL_R'.*R_ANKLE_R"
sed '/link: L_ANKLE_R, sole/d' src/robots/gr001.yaml >"$work/wrong.yaml"
check "one foot" both exits 3 "$GRCTL" robot check "$work/wrong.yaml" --- \
    says 'one foot only, R_ANKLE_R: two are wanted'

test_case "reference material"

# golden MODE PRESET: every frame that Choreonoid's own code computes, within 1e-7 rad.
golden() {
    "$GRCTL" convert --to yaml --rate 30 --like "$2" \
        "$data/choreonoid/GR001-SampleMotion1.pseq" - |
        sed -n 's/^ *- \[\(.*\)\]$/\1/p' >"$work/got"
    paste -d, "$work/got" "$data/golden/SampleMotion1.r30.$1.csv" | awk -F, '
        NF != 40 { print "not as many frames or joints: line " NR; exit 1 }
        { for (j = 1; j <= 20; j++) { d = ($j - $(j + 20)) ^ 2; if (d > most) most = d } }
        END { if (NR < 250 || most > 1e-14) { print NR " frames, off by " sqrt(most); exit 1 } }'
}
if [ -d "$data/golden" ]; then
    check "--like choreonoid is what its window shows" golden default choreonoid
    check "--like choreonoid-1.1 is what it made for the robot" golden compat11 choreonoid-1.1
    check "Choreonoid's own body is imported" exits 0 "$GRCTL" robot import \
        "$data/choreonoid/GR001.body" --family rs30x --servo RS301CR -o "$work/imported.yaml"
    GRCTL_ROBOT=$work/imported.yaml
    export GRCTL_ROBOT
    check "its legs are those of its window" golden default choreonoid
    check "and of 1.1" golden compat11 choreonoid-1.1
    unset GRCTL_ROBOT
else
    skip "presets against Choreonoid's frames" "no reference material beside the checkout"
fi
done_testing
