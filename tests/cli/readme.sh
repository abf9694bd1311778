#!/bin/sh
# SPDX-License-Identifier: MIT
# What README.md shows is true: its program is built and run; and the tour of docs/guide/tour.md,
# line by line. tests/cli/demo.sh runs its first command, tests/export/python.sh its Python.
. tests/support/cli.sh
. tests/support/guide_blocks.sh

block docs/guide/tour.md tour >"$work/tour"
block README.md example >"$work/example.c"
root=$PWD
build=$root/${BUILD:-build}

test_case "the program"

# Against the build tree, with the flags that pkg-config tells of it; instrumented code needs the
# flags it was made with.
flags() {
    nm "$build/libgrobo.a" 2>/dev/null >"$work/symbols"
    grep -q __asan_init "$work/symbols" && printf '%s ' -fsanitize=address,undefined
    grep -q __gcov_ "$work/symbols" && printf '%s ' --coverage
    ls -d "$root"/ports/*/include | sed 's/^/-I/'
    printf '%s ' "-I$root/include" "-L$build"
    PKG_CONFIG_PATH=$build pkg-config --cflags --libs --static grobo libevent_core |
        sed 's/-lgrobo/-l:libgrobo.a/'
}
builds() {
    # Flags and compiler are lists of words.
    # shellcheck disable=SC2046
    ${CC:-cc} -std=c11 -Wall -Wextra ${WERROR:-} -o "$work/${1:-example}" "$work/${1:-example}.c" \
        $(flags)
}
plays() {
    exits 0 timeout 30 "$work/example" && [ ! -s "$work/err" ]
}
# A machine that is away for 250 ms ends a motion, as it has to: then once more.
runs() {
    plays || plays
}
# On a robot behind a port it obeys the emergency stop of another program.
obeys() {
    sed -i "s|\.device = \"sim\"|.device = \"$robot\"|" "$work/example.c" && builds &&
        exits 0 on_robot estop || return 1
    exits 1 timeout 30 "$work/example" && exits 0 on_robot estop --reset && runs
}
check "the program is there" grep -q '^int main' "$work/example.c"
few_lines() {
    [ "$(wc -l <"$work/example.c")" -le 12 ] && ! grep -n '.\{101\}' "$work/example.c"
}
check "it has at most twelve lines" few_lines
# A motion that is not there, and it fails: it looks at what it is told.
fails_without() {
    sed 's/greet/none/' "$work/example.c" >"$work/none.c" &&
        builds none && exits 1 timeout 30 "$work/none"
}
status() {
    sed -n 3p README.md | grep -q '^\*\*Status: .*no real robot has been driven yet\.\*\*$'
}
check "line 3 says the status" status
screen() {
    [ "$(wc -l <README.md)" -le 90 ]
}
check "it is short" screen
links() {
    grep -o '](\([^)#:]*\)[)#]' README.md | sed 's/](\(.*\)[)#]/\1/' | while read -r file; do
        [ -e "$file" ] || { echo "no $file"; exit 1; }
    done
}
check "what it links to is there" links
if [ -n "${CROSS:-}" ]; then
    skip "it builds and runs" "the libraries are of another machine"
elif command -v "${CC%% *}" >/dev/null 2>&1 || command -v cc >/dev/null 2>&1; then
    check "it builds" builds
    check "it plays on the simulated robot" runs
    check "it fails without its motion" fails_without
    start_sim # out here, where its end is seen to
    check "it is refused after an emergency stop, until that is cleared" obeys
else
    skip "it builds and runs" "no C compiler"
fi

test_case "the tour"

# A checkout as after make, where the tour may write.
mkdir -p "$work/checkout/build"
ln -s "$root/motions" "$work/checkout/motions"
ln -s "$GRCTL" "$work/checkout/build/grctl"
cd "$work/checkout" || exit 1

step() {
    exits 0 timeout 30 sh -c "$1" || return 1
    ! grep -q '^grctl:' "$work/err" || { cat "$work/err"; return 1; }
}
steps=0
while read -r line; do
    case $line in
    '') ;;
    'export '*) eval "$line" ;;
    *)
        steps=$((steps + 1))
        check "tour: $line" step "$line"
        ;;
    esac
done <"$work/tour"
check "the tour has steps" [ $steps -ge 5 ]
check "what it converts is there" [ -s build/greet.yaml ]
check "it uses the command under test" [ "$(command -v grctl)" = "$work/checkout/build/grctl" ]
done_testing
