#!/bin/sh
# SPDX-License-Identifier: MIT
# The runner must not call anything passed that did not pass.
set -u

. tests/support/tap.sh
top=$(pwd)
runner=$top/tests/run.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

# program NAME: an executable whose text comes from standard input.
program() {
    { echo '#!/bin/sh' && cat; } >"$1"
    chmod +x "$1"
}

limit_s=60
only=
# ends STATUS LAST_LINE TEXT PROGRAM...: what the runner does with the programs.
ends() {
    status=$1
    last=$2
    text=$3
    shift 3
    said=$(TEST_LOGS= TEST_WRAPPER= TEST_ONLY=$only TEST_TIMEOUT_S=$limit_s sh "$runner" "$@")
    got=$?
    printf '%s\n' "$said"
    [ "$got" = "$status" ] && [ "$(printf '%s\n' "$said" | tail -n 1)" = "$last" ] &&
        case $said in *"$text"*) true ;; *) false ;; esac
}

program good <<'S'
printf '1..2\nok 1 - a\nok 2 - b\n'
S
program bad <<'S'
printf '1..2\nok 1 - a\nsaid before\nnot ok 2 - b\n# 1 != 2\n'
exit 1
S
program skips <<'S'
printf '1..2\nok 1 - a\nno robot here\nnot ok 2 # SKIP with_a_robot\n'
S
program skips_all <<'S'
echo '1..0 # SKIP no tool'
S
program wants_material <<'S'
printf '1..2\nx.json is missing: reference material beside the checkout\nnot ok 1 # SKIP one\n'
printf 'y.json is missing: reference material beside the checkout\nnot ok 2 # SKIP other\n'
S
program empty <<'S'
S
program empty_group <<'S'
echo 1..0
S
program crash <<'S'
printf '1..2\nok 1 - a\n'
kill -SEGV $$
S
program hang <<'S'
printf '1..1\n'
exec sleep 30
S
program short <<'S'
printf '1..3\nok 1 - a\nok 2 - b\n'
S
program status <<'S'
printf '1..1\nok 1 - a\n'
exit 3
S
program half_line <<'S'
printf '1..1\nok 1 - a\n# no newline at the end'
S
program two_groups <<'S'
printf '1..1\nok 1 - a\n1..2\nok 1 - a\nok 2 - b\n'
S
program leaves <<'S'
sleep 60 &
echo $! >left.pid
printf '1..1\nok 1 - a\n'
S
program lingers <<'S'
sleep 0.5 &
printf '1..1\nok 1 - a\n'
S
# It ends when three of it run at once.
mkdir cli here
for number in 1 2 3; do
    program cli/$number <<'S'
touch "here/${0##*/}"
until [ -e here/1 ] && [ -e here/2 ] && [ -e here/3 ]; do sleep 0.03; done
printf '1..1\nok 1 - a\n'
S
done
program files <<'S'
echo "1..$#"
for f in "$@"; do echo "ok 1 - $f"; done
S
mkdir corpus && touch corpus/a 'corpus/b c'
printf 'echo 1..1\necho ok 1 - from a script\n' >script.sh
program no_plan <<'S'
printf 'ok 1 - a\n'
S
# steps NAME: a script of the project's own, of which standard input has the tests.
steps() {
    { echo ". $top/tests/support/tap.sh" && cat && echo done_testing; } >"$1.sh"
}
steps named <<'S'
test_case 'what stands'
check 'one' true
check 'two' true
test_case 'what sits'
check 'three' true
test_that 'what lies' true
S
steps broken <<'S'
test_case 'what stands'
check 'one' true
check 'two' sh -c 'echo because; false'
check 'three' true
test_case 'what sits'
check 'four' true
S
steps partly <<'S'
test_case 'what stands'
check 'one' true
skip 'two' 'no robot here'
skip 'three' 'no robot here'
test_case 'what sits'
check 'four' true
S
steps idle <<'S'
test_case 'what stands'
test_case 'what sits'
check 'one' true
S
steps unnamed <<'S'
check 'one' true
check 'two' true
S
program several <<'S'
[ "${1:-}" != --list ] || { printf 'a_robot_stands\na_robot_sits\n'; exit; }
printf '1..1\nok 1 - a_robot_%s\n' "${1:-and_all_others}"
S
steps gone <<'S'
test_case 'what stands'
check 'one' true
exit
S

test_that 'all pass' ends 0 '5 passed, 0 failed, 0 skipped' 'pass' ./good ./two_groups
test_that 'a failure shows what was printed' \
    ends 1 '3 passed, 1 failed, 0 skipped' '# 1 != 2' ./bad ./good
test_that 'a process left behind is a failure' \
    ends 1 '1 passed, 1 failed, 0 skipped' 'sleep 60' ./leaves
nobody_left() {
    ! kill -0 "$(cat left.pid)" 2>/dev/null
}
check 'and it is ended' wait_for nobody_left
test_that 'one that ends by itself is none' ends 0 '1 passed, 0 failed, 0 skipped' pass ./lingers
test_that 'the slowest are told' \
    ends 0 '3 passed, 0 failed, 0 skipped' 'slow  ./lingers: ' ./lingers ./good
test_that 'what waits does so beside the others' \
    ends 0 '9 passed, 0 failed, 0 skipped' pass ./cli/1 ./cli/2 ./cli/3 ./good ./good ./good
test_that 'a skip is told with its reason' \
    ends 0 '1 passed, 0 failed, 1 skipped' 'with_a_robot: no robot here' ./skips
test_that 'a program may skip whole' ends 0 '0 passed, 0 failed, 1 skipped' 'no tool' ./skips_all
test_that 'what needs reference material is one skip, and each is told' \
    ends 0 '0 passed, 0 failed, 2 skipped' 'wants_material: other: y.json' \
    ./wants_material ./skips_all
test_that 'no output is a failure' ends 1 '0 passed, 1 failed, 0 skipped' 'holds no test' ./empty
test_that 'no test is a failure' \
    ends 1 '0 passed, 1 failed, 0 skipped' 'holds no test' ./empty_group
test_that 'a crash is a failure' \
    ends 1 '1 passed, 1 failed, 0 skipped' 'killed by signal 11' ./crash
limit_s=1
test_that 'no end is a failure' ends 1 '0 passed, 1 failed, 0 skipped' 'no end within 1 s' ./hang
limit_s=60
test_that 'fewer tests than planned is a failure' \
    ends 1 '2 passed, 1 failed, 0 skipped' '2 results for 3 planned' ./short
test_that 'an exit status is a failure' \
    ends 1 '1 passed, 1 failed, 0 skipped' 'exit status 3' ./status
test_that 'a last line without newline' ends 0 '1 passed, 0 failed, 0 skipped' pass ./half_line
test_that 'a missing program is a failure' ends 1 '0 passed, 1 failed, 0 skipped' status ./nothing
test_that 'a corpus goes to the program' ends 0 '2 passed, 0 failed, 0 skipped' pass ./files@corpus
test_that 'an empty corpus is a failure' \
    ends 1 '0 passed, 1 failed, 0 skipped' 'holds no' ./files@no
test_that 'a shell script' ends 0 '1 passed, 0 failed, 0 skipped' pass script.sh
test_that 'a program that ends in the middle' \
    ends 1 '1 passed, 1 failed, 0 skipped' 'without saying how many' ./no_plan
test_that 'tests of a script are counted, not their steps' \
    ends 0 '3 passed, 0 failed, 0 skipped' 'named.sh (3)' named.sh
test_that 'a step that fails fails its test' \
    ends 1 '1 passed, 1 failed, 0 skipped' 'not ok 1 - what stands' broken.sh
check 'and is told with what was said' \
    ends 1 '1 passed, 1 failed, 0 skipped' "# FAILED: two
  #   because" broken.sh
test_that 'a test of which a step is left out is skipped, its reason told once' \
    ends 0 '1 passed, 0 failed, 1 skipped' 'partly.sh: what stands: no robot here
' partly.sh
test_that 'a test without a step is a failure' \
    ends 1 '1 passed, 1 failed, 0 skipped' 'it has no step' idle.sh
test_that 'steps before the first test are one' \
    ends 0 '1 passed, 0 failed, 0 skipped' 'unnamed.sh (1)' unnamed.sh
test_that 'a script that ends in the middle of a test' \
    ends 1 '0 passed, 1 failed, 0 skipped' 'holds no test' gone.sh
only=sits
test_that 'a word chooses tests of programs and scripts by name' \
    ends 0 '4 passed, 0 failed, 0 skipped' 'named.sh (3)
pass  ./several (1)' good named.sh ./several script.sh files@corpus
only='several'
test_that 'and whole programs by theirs' \
    ends 0 '1 passed, 0 failed, 0 skipped' 'several (1)' ./several ./good
only='robot sits'
test_that 'a blank is an underscore' \
    ends 0 '1 passed, 0 failed, 0 skipped' 'several (1)' ./several ./good
only=lies_down
test_that 'a word that no test has is a failure' \
    ends 1 '0 passed, 0 failed, 0 skipped' "no test is called 'lies_down'" ./several ./good
only=
test_that 'nothing to run is a failure' ends 1 '0 passed, 0 failed, 0 skipped' 'nothing to run'
done_testing
