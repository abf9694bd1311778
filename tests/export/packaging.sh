#!/bin/sh
# SPDX-License-Identifier: MIT
# What a packager does: a tarball, the libraries alone, folders with blanks in their names, an
# installation that compiles nothing again, and a tree that is moved after it.
set -u

. tests/support/tap.sh
here=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"
    find build -maxdepth 1 -name ".link-*" -lname "$work*" -delete 2>/dev/null' EXIT
built=${BUILD:-build}
unset BUILD

# make in a folder, without what the make above has set.
make_in() {
    (
        unset MAKEFLAGS MAKELEVEL MFLAGS
        cd "$1" && shift && make --no-print-directory "$@"
    )
}

# Only the development files of libevent and libyaml are on this machine.
cat >"$work/pkg-config" <<'S'
#!/bin/sh
case "$*" in *jansson* | *cmocka* | *libedit* | *ncurses* | *expat*) exit 1 ;; esac
exec pkg-config "$@"
S
chmod +x "$work/pkg-config"

# prints TEXT COMMAND...: and its exit status is 0.
prints() {
    text=$1
    shift
    "$@" >"$work/out" 2>&1 && grep -Fq -- "$text" "$work/out" || { cat "$work/out"; return 1; }
}

# Without git a checkout is taken for what it was made of.
has_git() {
    [ -e .git ] && git rev-parse -q --verify HEAD >/dev/null 2>&1
}

tarball() {
    if has_git; then
        make_in "$here" dist BUILD="$work/dist" && tar -xzf "$work"/dist/*.tar.gz -C "$work"
    else
        mkdir "$work/libgrobo-0" &&
            tar -cf - --exclude=./build* --exclude=./.git . | tar -xf - -C "$work/libgrobo-0"
    fi
    source=$(echo "$work"/libgrobo-*)
    [ -e "$source/Makefile" ]
}

same_tarball() {
    first=$(cat "$work"/dist/*.tar.gz | sha256sum)
    umask 077 && make_in "$here" dist BUILD="$work/dist" &&
        [ "$(cat "$work"/dist/*.tar.gz | sha256sum)" = "$first" ] &&
        grep -q "^source_hash = ${first%% *}" "$work/dist/subprojects/grobo.wrap"
}

dist_needs_git() {
    make_in "$source" dist BUILD="$work/again" >"$work/out" 2>&1 && return 1
    cat "$work/out"
    [ "$(grep -c '^dist: not a git checkout' "$work/out")" -eq 1 ] &&
        [ -z "$(find "$work/again" -name '*.tar*' 2>/dev/null)" ]
}

# A user's compiler may be younger than this tree: it warns of what was right when that was written.
no_warning_ends_a_build() {
    for tree in "$here" "$source"; do
        # shellcheck disable=SC2086
        for target in all lib install "demo MOTION=none" "test RING=unit"; do
            (unset WERROR; make_in "$tree" -n $target BUILD="$work/n") >"$work/out" 2>&1
            grep -q -e '-Wall' "$work/out" || { echo "$tree, $target: compiles nothing"; return 1; }
            ! grep -m 2 -e -Werror "$work/out" || { echo "$tree: make $target"; return 1; }
        done
    done
}

# What .ci/run runs, with a make that only tells: each stage is given it.
ci_is_strict() {
    mkdir -p "$work/ci/.ci" "$work/ci/tools" "$work/ci/bin" && cp .ci/run "$work/ci/.ci" || return 1
    printf '%s\n' '#!/bin/sh' 'exit 0' >"$work/ci/tools/setup.sh"
    # shellcheck disable=SC2016
    printf '%s\n' '#!/bin/sh' 'echo "stage ${WERROR:-lax} $*" >&3' >"$work/ci/bin/make"
    chmod +x "$work/ci/tools/setup.sh" "$work/ci/bin/make"
    (unset WERROR; PATH=$work/ci/bin:$PATH "$work/ci/.ci/run" 3>"$work/out" >/dev/null 2>&1)
    cat "$work/out"
    [ "$(wc -l <"$work/out")" -ge 5 ] && ! grep -v '^stage -Werror ' "$work/out"
}
# Each build of such a stage takes it along, below other makes too.
strict_is_strict() {
    for target in all check-san check-tsan check-memcheck "fuzz FUZZ_CC=gcc"; do
        # shellcheck disable=SC2086
        (export WERROR=-Werror; make_in "$here" -n $target RING=unit BUILD="$work/n") \
            >"$work/out" 2>&1
        grep -e '-Wall' "$work/out" >"$work/calls" ||
            { echo "$target: compiles nothing"; return 1; }
        ! grep -m 2 -v -e -Werror "$work/calls" || { echo "make $target"; return 1; }
    done
}

# What pkg-config is asked when each recipe is expanded; libyaml is needed.
needs_no_more() {
    make_in "$source" -n lib PKG_CONFIG="$work/pkg-config" BUILD="$work/n" >"$work/out" 2>&1 ||
        { cat "$work/out"; return 1; }
    ! make_in "$source" -n lib PKG_CONFIG=false BUILD="$work/n" >"$work/out" 2>&1
}

# The objects of this build in another folder, as if they had been built there with other flags.
as_built_with() {
    mkdir "$work/plain" && cp -R "$built/src" "$built/ports" "$work/plain" &&
        make_in "$here" "$work/plain/.flags" BUILD="$work/plain" CC="${CC:-gcc}" CFLAGS="$1" &&
        find "$work/plain" -name '*.o' -exec touch {} + &&
        touch -d 2001-01-01 "$work/plain/.flags" && mv "$work/plain" "$work/b u"
}

# The guard's program is below PREFIX: that file alone is compiled for it, with the same flags.
installs_what_was_built() {
    as_built_with "-O0 -DREMEMBERED='\"a b\"'" || return 1
    make_in "$here" install-lib V=1 BUILD="$work/b u" DESTDIR="$work/d e" PREFIX=/opt/grobo \
        >"$work/out" 2>&1 || { cat "$work/out"; return 1; }
    grep -o -e '-DREMEMBERED.* -c -o .*' "$work/out" | head -n 3
    [ "$(grep -c -e "-DREMEMBERED='\"a b\"'.* -c -o .*guard\.o" "$work/out")" -eq 1 ] &&
        [ "$(grep -c -e ' -c -o ' "$work/out")" -eq 1 ] || return 1
    ls "$work/b u/libgrobo.a" "$work/d e/opt/grobo/lib/libgrobo.so.1" \
        "$work/d e/opt/grobo/include/grobo/grobo.h"
}

# What the file needs itself is beside what is asked for.
takes_cppflags() {
    make_in "$here" -n "$work/n/ports/posix/guard.o" BUILD="$work/n" CPPFLAGS=-DMINE V=1 |
        grep -q -e '-DMINE.*-DGROBO_GUARD_PROGRAM'
}

compiles_again_for_other_flags() {
    make_in "$here" -n install-lib BUILD="$work/b u" CFLAGS=-O1 PREFIX=/opt/grobo |
        grep -q -e ' -O1 .*error\.c'
}

moved() {
    mkdir "$work/moved" && mv "$work/d e/opt/grobo" "$work/moved/tree" || return 1
    PKG_CONFIG_PATH=$work/moved/tree/lib/pkgconfig
    export PKG_CONFIG_PATH
    case $(pkg-config --cflags --libs grobo) in
    *"$work"*"$work"*) ;;
    *) return 1 ;;
    esac
    # shellcheck disable=SC2046
    ${CC:-gcc} -o "$work/program" tests/export/consumer.c $(pkg-config --cflags --libs grobo) &&
        LD_LIBRARY_PATH=$work/moved/tree/lib "$work/program"
}

uninstalls() {
    for target in install-lib uninstall; do
        make_in "$here" $target BUILD="$work/b u" DESTDIR="$work/d e" PREFIX=/opt/grobo || return 1
    done
    left=$(find "$work/d e" -type f -o -type l)
    [ -z "$left" ] || { echo "$left"; return 1; }
}

if [ -n "${CROSS:-}${EMULATOR:-}" ]; then
    test_case 'packaging'
    skip 'packaging' 'only for this machine'
    done_testing
    exit 0
fi
test_that 'a tarball, unpacked' tarball
source=$(echo "$work"/libgrobo-*)
if has_git; then
    test_that 'the same commit, the same tarball' same_tarball
else
    test_case 'the same commit, the same tarball'
    skip 'the same commit, the same tarball' 'no git, or not a checkout'
fi
test_that 'a tarball of a tarball: one line, and no file' dist_needs_git
test_that 'no command of a user makes a warning an error' no_warning_ends_a_build
if [ -e .ci/run ]; then
    test_that '.ci/run gives -Werror to each stage' ci_is_strict
    test_that 'and each build of them takes it along' strict_is_strict
fi
test_that 'the libraries alone need libevent and libyaml' needs_no_more
test_that 'blanks in BUILD and DESTDIR; nothing is compiled again' installs_what_was_built
test_that 'grobo.pc: the tree may be moved' moved
test_that 'uninstalled there, no file is left' uninstalls
test_that 'CPPFLAGS of the command line reach the files that add some' takes_cppflags
test_that 'other flags, when they are given, are used' compiles_again_for_other_flags
done_testing
