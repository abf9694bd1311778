#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs into a tree of its own and builds a stranger's program against it: C and C++, shared and
# static, by each compiler that is here, with the flags that pkg-config tells and nothing else.
set -u

. tests/support/tap.sh
. tests/support/built.sh
here=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
tree=$work/tree
library=$tree/opt/grobo/lib
emulator=${EMULATOR:-} # for another machine: a command with its options
c11="-std=c11 -Wall -Wextra -Wpedantic ${WERROR:-} -x c"
cxx11="-std=c++11 -Wall -Wextra -Wpedantic ${WERROR:-} -x c++"
PKG_CONFIG_SYSROOT_DIR=$tree
PKG_CONFIG_PATH=$library/pkgconfig
export PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH
mkdir "$tree"
if [ -n "${SYSROOT:-}" ]; then
    # What another machine has installed stands in the same tree.
    ln -s "$SYSROOT/usr" "$tree/usr"
    PKG_CONFIG_LIBDIR=$(find "$tree/usr/" -type d -name pkgconfig | paste -sd :)
    export PKG_CONFIG_LIBDIR
fi

make_target() {
    [ -e "$work/built" ] || copy_build "${BUILD:-build}" "$work/built" tools || return 1
    env -u MAKEFLAGS -u MAKELEVEL -u PKG_CONFIG_SYSROOT_DIR -u PKG_CONFIG_PATH \
        -u PKG_CONFIG_LIBDIR make --no-print-directory -C "$here" "$1" BUILD="$work/built" \
        PREFIX=/opt/grobo DESTDIR="$tree" CROSS="${CROSS:-}"
}

# builds COMPILER SOURCE PKG_CONFIG_OPTION...; flags are lists of words.
# shellcheck disable=SC2046
builds() {
    compiler=$1
    source=$2
    shift 2
    rm -f "$work/program"
    $compiler "$source" -x none -o "$work/program" $(pkg-config --cflags --libs "$@" grobo)
}

runs() {
    [ "$(LD_LIBRARY_PATH=$library $emulator "$work/program")" = 'no reply in time' ]
}

# A program of the classic shelf, which needs both libraries; with --static neither.
# shellcheck disable=SC2046
classic() {
    printf '%s\n' '#include <grobo/classic/classic.h>' 'int main(void)' '{' \
        '    GR001 *robot = GR001_new("/nowhere");' \
        '    int size = RobotMotion_getSize(robot->motion);' \
        '    GR001_delete(robot);' '    return size;' '}' >"$work/classic.c"
    rm -f "$work/classic"
    $1 "$work/classic.c" -x none -o "$work/classic" \
        $(pkg-config --cflags --libs ${2:-} grobo-classic) &&
        LD_LIBRARY_PATH=$library $emulator "$work/classic"
}

needs() {
    readelf -d "$work/program" | grep NEEDED | grep -q "libgrobo\.so\.1"
}

# Of the program and of the classic one, whatever of them was built last.
needs_none() {
    builds "${command}" tests/export/consumer.c --static && classic "$command" --static || return 1
    for program in "$work/program" "$work/classic"; do
        readelf -d "$program" | grep NEEDED | grep grobo && return 1
    done
    return 0
}

# Every program of docs/examples, by the line that README.md gives.
examples() {
    for source in docs/examples/*.c docs/examples/classic/*.c; do
        case $source in
        */classic/*) module=grobo-classic ;;
        */own_loop.c) module='grobo libevent_core' ;; # it calls libevent itself
        *) module=grobo ;;
        esac
        # shellcheck disable=SC2046,SC2086
        ${CC:-gcc} $source ${WERROR:-} -o "$work/program" \
            $(pkg-config --cflags --libs "$@" $module) || return 1
    done
}

same_version() {
    told=$(pkg-config --modversion grobo)
    echo "pkg-config: $told"
    grep -Fq "GROBO_VERSION_STRING \"$told\"" include/grobo/version.h
}

# quietly COMMAND...: it succeeds, and has nothing to say.
quietly() {
    "$@" >"$work/said" 2>&1 && [ ! -s "$work/said" ] || { head -n 20 "$work/said"; return 1; }
}

# All functions of all installed headers, in one program of their addresses.
every_function() {
    (cd "$tree/opt/grobo" && sh "$here/tools/lint/symbols.sh" --declared) >"$work/functions"
    {
        (cd "$tree/opt/grobo/include" && find grobo -name '*.h' ! -path '*/classic/*' |
            sed 's/.*/#include <&>/')
        echo '#include <stdio.h>'
        echo 'typedef void (*function)(void);'
        echo 'static const volatile function all[] = {'
        sed 's/.*/    (function)&,/' "$work/functions"
        echo '};'
        cat <<'C'
int main(void)
{
    unsigned n = 0;
    for (unsigned i = 0; i < sizeof all / sizeof *all; i++) {
        n += all[i] != NULL;
    }
    return printf("%u\n", n) < 0;
}
C
    } >"$work/all.c"
    [ "$(grep -c . "$work/functions")" -gt 400 ] && quietly builds "$@" &&
        LD_LIBRARY_PATH=$library $emulator "$work/program" |
        grep -qx "$(grep -c . "$work/functions")"
}

# The shortest program of README.md, which is C and C++; tests/cli/readme.sh plays it.
readme_program() {
    awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' README.md >"$work/readme.c"
    grep -q 'int main' "$work/readme.c" && quietly builds "$@"
}

every_header() {
    (cd "$tree/opt/grobo/include" && find grobo -name '*.h') |
        sed 's/.*/#include <&>/' >"$work/all.c"
    echo 'int main(void) { return 0; }' >>"$work/all.c"
    [ "$(grep -c include "$work/all.c")" -ge "$(find include -name '*.h' | wc -l)" ] &&
        builds "$1" "$work/all.c"
}

# Each compiler, on a line: its name, and the command with the language.
compilers() {
    cc=${CC:-gcc}
    cxx=${CXX:-g++}
    echo "C, ${cc%% *}: $cc $c11"
    echo "C++, ${cxx%% *}: $cxx $cxx11"
    for year in 17 20; do
        echo "C++$year, ${cxx%% *}: $cxx -std=c++$year ${cxx11#* }"
    done
    # clang belongs to what continuous integration installs.
    [ -n "$emulator" ] || [ "${cc%% *}" = clang ] || ! command -v clang++ >/dev/null ||
        printf '%s\n' \
        "C, clang: clang $c11" "C++, clang: clang++ $cxx11"
}

# A program for another number of joints finds nothing to make a posture with.
other_cap() {
    cat >"$work/posture.c" <<'C'
#include <grobo/posture.h>
int main(void)
{
    grobo_posture posture;
    return grobo_posture_init(&posture, 3);
}
C
    builds "${CC:-gcc} $c11" "$work/posture.c" "$@" &&
        ! builds "${CC:-gcc} $c11 -DGROBO_JOINTS_MAX=20" "$work/posture.c" "$@" 2>"$work/said" &&
        grep -q 'grobo_[a-z_]*_20' "$work/said"
}

# Of what a build for plain drivers leaves out, a driver must need nothing.
plain_drivers() {
    cat >"$work/plain.c" <<'C'
#include <string.h>
#include <grobo/core/driver.h>
static grobo_driver driver;
static int is_refused(void)
{
    int result = grobo_driver_check(&driver);
    driver = *grobo_gr001_driver(GROBO_WIRING_BUS);
    return result == GROBO_ERR_UNSUPPORTED;
}
#define REFUSED(with) (driver.with, is_refused())
#define HAVING(function) \
    (memcpy(&driver.function, &driver.sense, sizeof driver.sense), is_refused())
int main(void)
{
    return is_refused() || grobo_driver_check(&driver) < 0 ||
        !(REFUSED(accel_rad_s2 = 1) && REFUSED(goal_energises = true) &&
        REFUSED(tells_no_speed = true) &&
        REFUSED(keeps_setup = true) && HAVING(sense_many) && HAVING(sense_fast) &&
        HAVING(sense_more) && HAVING(watchdog) && HAVING(torque_limit));
}
C
    # shellcheck disable=SC2086
    ${CC:-gcc} $c11 -DGROBO_DRIVERS_PLAIN=1 -I include -I . "$work/plain.c" src/servo/driver.c \
        -x none -o "$work/plain" "${BUILD:-build}/libgrobo-core.a" -lm && $emulator "$work/plain"
}

# Takes the last two fields of each structure with a size out of the installed headers.
yesterdays_headers() {
    mkdir -p "$work/yesterday/grobo/core"
    for header in $(cd "$tree/opt/grobo/include/grobo" && ls -- *.h core/*.h); do
        awk '
        /size_t size; .*_(CONFIG|OPTIONS)_INIT/ { print; n = 0; inside = 1; next }
        inside && /^}/ {
            for (i = 1; i <= n - 2; i++) {
                print field[i]
            }
            inside = 0
        }
        inside { # a field begins behind the end of the one before, with the comment above it
            text = text == "" ? $0 : text "\n" $0
            if (text ~ /;/ && $0 ~ /(;|\*\/)$/) {
                field[++n] = text
                text = ""
            }
            next
        }
        { print }' "$tree/opt/grobo/include/grobo/$header" >"$work/yesterday/grobo/$header"
    done
    ! cmp -s "$work/yesterday/grobo/session.h" "$tree/opt/grobo/include/grobo/session.h"
}

# A program of yesterday, whose structures are shorter, does what it did with the library of today.
yesterdays_program() {
    for headers in "$work/yesterday" "$tree/opt/grobo/include"; do
        builds "${CC:-gcc} $c11 -Wno-missing-field-initializers -I $headers" \
            tests/export/yesterday.c &&
            LD_LIBRARY_PATH=$library $emulator "$work/program" >"$work/sizes" || return 1
        tr ' ' '\n' <"$work/sizes" >"$work/sizes.${headers##*/}"
    done
    paste "$work/sizes.yesterday" "$work/sizes.include"
    paste "$work/sizes.yesterday" "$work/sizes.include" |
        awk '$1 >= $2 { bad = 1 } END { exit bad }'
}

# by_each OPTION...: by each compiler a program, with these options for pkg-config. What a header is
# in another year of C++ does not depend on the kind of library.
by_each() {
    mode=${1:-shared}
    while read -r line; do
        name="${line%%: *}, ${mode#--}"
        command=${line#*: }
        case $mode$name in
        --static'C++'[12]*) continue ;;
        esac
        if ! command -v "${command%% *}" >/dev/null; then
            skip "$name" "no ${command%% *} here"
            continue
        fi
        check "$name: builds" builds "$command" tests/export/consumer.c "$@"
        check "$name: runs" runs
        check "$name: the classic shelf" classic "$command" "${1:-}"
        check "$name: the program of README.md" readme_program "$command" "$work/readme.c" "$@"
        check "$name: every function links" every_function "$command" "$work/all.c" "$@"
        if [ $# -gt 0 ]; then
            check "$name: links libgrobo.a, with libgrobo.so beside it" needs_none
            continue
        fi
        check "$name: asks for libgrobo.so.1" needs
        check "$name: every installed header together" every_header "$command"
    done <"$work/compilers"
}

test_case "a tree is installed"
check 'install' make_target install
share=$tree/opt/grobo/share
check 'the man page is there' grep -q '^\.Dt GRCTL 1' "$share/man/man1/grctl.1"
check 'and in Japanese' grep -q '^\.Nd シリアルサーボ' "$share/man/ja/man1/grctl.1"
check 'that of what --json prints too' grep -q '^\.Dt GRCTL-JSON 5' "$share/man/man5/grctl-json.5"
check 'its schema' grep -q '"title": "What grctl --json prints' "$share/grobo/grctl.schema.json"
check 'the dissector for Wireshark' grep -q '^local grobo = Proto(' \
    "$share/grobo/wireshark/grobo.lua"
# What help names, and what the documents show: a play of each motion, an example that builds.
motions_are_there() {
    for motion in $("$tree/opt/grobo/bin/grctl" help play | grep -o 'motions/[a-z0-9_-]*\.[a-z]*') \
        motions/greet.m motions/so101-wave.yaml; do
        [ -s "$share/grobo/$motion" ] || { echo "no $motion"; return 1; }
    done
    for motion in "$share"/grobo/motions/*.*; do
        "$tree/opt/grobo/bin/grctl" show "$motion" >"$work/shown" || { echo "$motion"; return 1; }
    done
}
documents_are_there() {
    docs=$share/doc/grobo/docs
    cmp docs/guide/safety.md "$docs/guide/safety.md" && [ -s "$docs/design.md" ] &&
        [ -s "$docs/examples/classic/nod.c" ] && [ -s "$docs/examples/robots/hexapod.yaml" ]
}
check 'guides and examples' documents_are_there
if [ -z "${CROSS:-}${EMULATOR:-}" ]; then
    check 'the motions that help names' motions_are_there
fi
# By what is installed beside it alone.
fleet_is_beside() {
    ! "$tree/opt/grobo/bin/grctl" fleet list --broker mqtt://127.0.0.1:1 >"$work/said" 2>&1 &&
        grep -q 'fleet: 127.0.0.1: ' "$work/said"
}
[ -n "${CROSS:-}${EMULATOR:-}" ] || check 'grctl fleet is beside it' fleet_is_beside
check 'completion for bash' grep -q '^complete ' "$share/bash-completion/completions/grctl"
check 'completion for zsh' grep -q '^#compdef' "$share/zsh/site-functions/_grctl"
check 'completion for fish' grep -q '^complete ' "$share/fish/vendor_completions.d/grctl.fish"
check 'pkg-config tells the version of the headers' same_version
compilers >"$work/compilers"
by_each
check 'every example of docs/examples builds' examples
test_case "a program that does not fit fails to link"
check 'another GROBO_JOINTS_MAX fails to link' other_cap
check 'a build for plain drivers refuses others' plain_drivers
check 'headers with shorter structures' yesterdays_headers
test_case "a program of yesterday runs with the library of today"
check 'a program of yesterday runs with the library of today' yesterdays_program
by_each --static
check 'every example of docs/examples builds statically' examples --static
rm -f "$library"/libgrobo*.so*
check 'another GROBO_JOINTS_MAX fails to link statically' other_cap --static
test_case "it is uninstalled"
check 'uninstall' make_target uninstall
# Where a motion of the documents is not, the message names the one that is installed.
says_where() {
    env -u MAKEFLAGS -u MAKELEVEL -u PKG_CONFIG_SYSROOT_DIR -u PKG_CONFIG_PATH \
        -u PKG_CONFIG_LIBDIR make --no-print-directory -C "$here" install BUILD="$work/built" \
        PREFIX="$work/prefix" >"$work/installed" 2>&1 || { cat "$work/installed"; return 1; }
    (cd / && "$work/prefix/bin/grctl" show motions/greet.pseq) >"$work/said" 2>&1
    [ $? -eq 3 ] && grep -q -F "motions/greet.pseq: no such file; see $work/prefix/share" \
        "$work/said"
}
check 'uninstall leaves no file' test -z "$(find "$tree" -type f -o -type l ! -path "$tree/usr")"
[ -n "${CROSS:-}${EMULATOR:-}" ] || check 'a motion that is only installed is named' says_where
done_testing
