#!/bin/sh
# SPDX-License-Identifier: MIT
# The Python package, as make python makes it, against simulators: tests/package/python; and what
# its README and its guide show.
set -u

. tests/support/tap.sh
. tests/support/built.sh
build=${BUILD:-build}
python=${PYTHON:-python3}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

leave() {
    test_case 'Python'
    skip 'Python' "$1"
    done_testing
    exit 0
}
[ -z "${CROSS:-}${EMULATOR:-}" ] || leave 'only for this machine'
command -v "$python" >/dev/null || leave 'no python3'
"$python" -c 'import cffi, sys; sys.exit(sys.version_info < (3, 9))' 2>/dev/null ||
    leave 'no cffi for Python 3.9 or later (python3-cffi; tools/setup.sh --check installs it)'
nm "$build/libgrobo.so.1" 2>/dev/null | grep -q -e __asan_init -e __tsan_init &&
    leave 'the library is instrumented'

made() {
    copy_build "$build" "$work/built" && make_in_copy "$work/built" python PYTHON="$python"
}
PYTHONPATH=$work/built/python
CC=${CC:-cc}
export PYTHONPATH CC

# all NAME...: the classes of their tests wait more than they work, and run side by side. (Not by &,
# which has them ignore Ctrl-C.)
# shellcheck disable=SC2016
all() {
    for name; do
        awk -v name="$name" '/^class / { class = $2; sub(/[(:].*/, "", class); told = 0 }
            /^    (async )?def test_/ && !told++ { print name, class }' \
            "tests/package/python/$name.py"
    done | xargs -P 8 -L 1 sh -c '"$0" -X dev "tests/package/python/$2.py" "$3" -v \
        >"$1/$2.$3" 2>&1 </dev/null; echo $? >"$1/$2.$3.status"' "$python" "$work"
    for name; do
        cat "$work/$name".*.status | sort -rn | head -n 1 >"$work/$name.status"
        rm "$work/$name".*.status
        cat "$work/$name".* >"$work/$name"
    done
}
# Each test is a line of its own.
tell() {
    name=$1
    status=$(cat "$work/$name.status")
    awk -v name="$name" -v status=$status '
        /^test_.* \.\.\. / || /^test_[a-z_0-9]* \(/ { test = $1 }
        / \.\.\. (ok|FAIL|ERROR|skipped)/ || /^(ok|FAIL|ERROR|skipped .*)$/ {
            match($0, /(ok|FAIL|ERROR|skipped.*)$/)
            print substr($0, RSTART) "|" test
        }
        END { if (status != 0) print "FAIL|" name " ends well" }' "$work/$name" >"$work/results"
    while IFS='|' read -r verdict test; do
        case $verdict in
        ok) check "$name: $test" true ;;
        skipped*) skip "$name: $test" "${verdict#skipped }" ;;
        *) check "$name: $test" sh -c 'cat "$1"; exit 1' sh "$work/$name" ;;
        esac
    done <"$work/results"
}

# program FILE: what it prints is in $work/out. A machine that is away for 250 ms ends a motion, as
# it has to: then once more.
program() {
    "$python" "$1" >"$work/out" 2>"$work/err" && return
    grep -q 'Canceled: play' "$work/err" && "$python" "$1" >"$work/out" 2>"$work/err" && return
    cat "$work/err"
    return 1
}
# shown DOCUMENT TEXT: what its first block prints has the text.
shown() {
    awk '/^```python/ && !n { open = 1; n++; next } /^```/ { open = 0 } open' "$1" \
        >"$work/shown.py" && program "$work/shown.py" && grep -q -e "$2" "$work/out"
}

test_that 'the package is made' made
names=$(cd tests/package/python && find . -name 'test_*.py' | sed 's/^..//; s/\.py$//' | sort)
# shellcheck disable=SC2086 # a list of words
all $names
for name in $names; do
    tell "$name"
done
played() {
    awk '/^```python/ { open = 1; next } /^```/ { open = 0 } open' README.md >"$work/played.py" &&
        grep -q play "$work/played.py" && program "$work/played.py"
}
test_that 'what README.md shows' played
test_that 'what its README shows' shown tools/python/README.md '^-45\.8'
test_that 'what its guide shows' shown docs/guide/python.md '^R_ELBOW_P '
plugin() {
    awk '/^<!-- lerobot -->/ { there = 1 } there && /^```python/ { open = 1; next }
        /^```/ { open = 0 } open' docs/guide/lerobot.md >"$work/plugin.py" &&
        PYTHONPATH=$PYTHONPATH:tools/python/lerobot_robot_grobo:$stand_in \
            "$python" "$work/plugin.py" >"$work/out" && grep -q "'elbow_flex.pos': 2" "$work/out"
}
stand_in=tests/package/python/lerobot_stand_in
test_case 'what the guide for LeRobot shows'
if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))'; then
    check 'what the guide for LeRobot shows' plugin
else
    skip 'what the guide for LeRobot shows' 'LeRobot needs Python 3.12, its stand-in 3.10'
fi
if "$python" -c 'import lerobot.robots' 2>/dev/null; then
    GROBO_LEROBOT=real
    export GROBO_LEROBOT
    all test_lerobot
    tell test_lerobot
else
    test_case 'the plugin in LeRobot itself'
    skip 'the plugin in LeRobot itself' 'no lerobot'
fi
test_case 'its types'
if "$python" -m mypy --version >/dev/null 2>&1; then
    check 'its types' sh -c 'cd "$2" && "$1" -m mypy --strict -p grobo' sh "$python" \
        "$work/built/python"
else
    skip 'its types' 'no mypy'
fi
done_testing
