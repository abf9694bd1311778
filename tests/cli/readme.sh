#!/bin/sh
# SPDX-License-Identifier: MIT
# What README.md shows is true: its tour is run line by line, its program is built and run.
. tests/support/cli.sh

# block MARK: the lines of the fenced block that follows the line <!-- MARK -->.
block() {
    awk -v mark="<!-- $1 -->" '
        $0 == mark { wanted = 1; next }
        wanted && /^```/ { if (inside) exit; inside = 1; next }
        inside { print }' README.md
}

block tour >"$work/tour"
block example >"$work/example.c"
root=$PWD
build=$root/${BUILD:-build}

# ---- the program ----------------------------------------------------------------------------

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
    ${CC:-cc} -std=c11 -Wall -Wextra -Werror -o "$work/example" "$work/example.c" $(flags)
}
runs() {
    exits 0 timeout 30 "$work/example" && says '^moved: ' && [ ! -s "$work/err" ]
}
# On a robot behind a port it obeys the emergency stop of another program.
obeys() {
    sed -i "s|\.device = \"sim\"|.device = \"$robot\"|" "$work/example.c" && builds &&
        exits 0 "$GRCTL" -d "$robot" estop || return 1
    timeout 30 "$work/example" >"$work/out" 2>"$work/err"
    ! says '^moved: ' && complains '^move: stopped for safety until reset$' &&
        exits 0 "$GRCTL" -d "$robot" estop --reset && runs
}
check "the program is there" grep -q '^int main' "$work/example.c"
if [ -n "${CROSS:-}" ]; then
    skip "it builds and runs" "the libraries are of another machine"
elif command -v "${CC%% *}" >/dev/null 2>&1 || command -v cc >/dev/null 2>&1; then
    check "it builds" builds
    check "it moves the simulated robot" runs
    start_sim # out here, where its end is seen to
    check "it is refused after an emergency stop, until that is cleared" obeys
else
    skip "it builds and runs" "no C compiler"
fi

# ---- the tour -------------------------------------------------------------------------------

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
