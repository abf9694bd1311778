#!/bin/sh
# SPDX-License-Identifier: MIT
# A program in C and the same in C++ find the library by Meson: installed and moved, and by a wrap.
set -u
. tests/support/consumers.sh

meson_project() {
    project "$1" && cat >"$work/$1/meson.build" <<'M'
project('consumer', 'c', 'cpp', default_options: ['c_std=c11', 'cpp_std=c++11'])
grobo = dependency('grobo', version: '>= 0.1')
executable('c', 'c.c', dependencies: grobo)
executable('cxx', 'cxx.cpp', dependencies: grobo)
M
}

meson_builds() {
    folder=$1
    shift
    quiet meson setup "$work/$folder/b" "$work/$folder" "$@" &&
        quiet meson compile -C "$work/$folder/b" -j 2
}

meson_installed() {
    meson_project meson && meson_builds meson && LD_LIBRARY_PATH=$work/moved/lib says \
        "$work/meson/b/c" "$work/meson/b/cxx"
}

meson_wrapped() {
    meson_project wrapped && make --no-print-directory wrap BUILD="$work/wrap" TARBALL="$tarball" &&
        mv "$work/wrap/subprojects" "$work/wrapped" &&
        PKG_CONFIG_PATH='' meson_builds wrapped --force-fallback-for=grobo &&
        says "$work/wrapped/b/c" "$work/wrapped/b/cxx"
}

test_that 'an installed tree, moved' installs
pack
if command -v meson >/dev/null && command -v ninja >/dev/null; then
    test_that 'Meson: dependency' meson_installed
    test_that 'Meson: wrap' meson_wrapped
else
    test_case 'Meson'
    skip 'Meson' 'no meson (tools/setup.sh --check installs it)'
fi
done_testing
