#!/bin/sh
# SPDX-License-Identifier: MIT
# A program in C and the same in C++ find the library by pkg-config and CMake: an installed tree,
# moved, and its source taken along (add_subdirectory). fetch_content.sh and meson.sh do the rest.
set -u
. tests/support/consumers.sh

# ---- pkg-config ----------------------------------------------------------------------------

by_pkg_config() {
    cat >"$work/core.c" <<'C'
#include <grobo/core/rs30x.h>
#include <grobo/core/static.h>
int main(void)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    return grobo_rs30x_driver_init(&driver, grobo_gr001_model(), grobo_rs30x_protocol()) < 0;
}
C
    # shellcheck disable=SC2046
    ${CC:-gcc} -o "$work/core" "$work/core.c" $(pkg-config --cflags --libs grobo-core) &&
        "$work/core" && readelf -d "$work/core" >"$work/needed" && ! grep -q -e grobo -e event \
        "$work/needed"
}

# ---- CMake ---------------------------------------------------------------------------------

cmake_installed() {
    cmake_project found 'find_package(grobo 0.1 REQUIRED)' "$link_c" "$link_cxx" &&
        cmake_builds found -DCMAKE_PREFIX_PATH="$work/moved" &&
        readelf -d "$work/found/b/cxx" | grep -q 'NEEDED.*libgrobo\.so\.1'
}

cmake_static() {
    cmake_project static 'find_package(grobo REQUIRED COMPONENTS static core)' \
        'target_link_libraries(c PRIVATE grobo::static)' \
        'target_link_libraries(cxx PRIVATE grobo::static)' "add_executable(core $work/core.c)" \
        'target_link_libraries(core PRIVATE grobo::core)' &&
        cmake_builds static -DCMAKE_PREFIX_PATH="$work/moved" && "$work/static/b/core" &&
        readelf -d "$work/static/b/c" >"$work/needed" && ! grep -q grobo "$work/needed"
}

# A version that does not fit, and a component that is not there, are refused.
cmake_refuses() {
    for asked in '0.2' '1.0' '0.1.99' 'COMPONENTS nothing'; do
        cmake_project refused "find_package(grobo $asked REQUIRED)"
        ! cmake -S "$work/refused" -B "$work/refused/b" -DCMAKE_PREFIX_PATH="$work/moved" \
            >"$work/out" 2>&1 && grep -qi grobo "$work/out" || { echo "took $asked"; return 1; }
    done
}

cmake_source() {
    cmake_project source "add_subdirectory($here/tools/package grobo)" "$link_c" "$link_cxx" &&
        cmake_builds source
}

test_that 'an installed tree, moved' installs
test_that 'pkg-config: grobo-core needs nothing else' by_pkg_config
if command -v cmake >/dev/null; then
    test_that 'CMake: find_package' cmake_installed
    test_that 'CMake: the static libraries' cmake_static
    test_that 'CMake: find_package refuses what does not fit' cmake_refuses
    test_that 'CMake: add_subdirectory' cmake_source
else
    test_case 'CMake'
    skip 'CMake' 'no cmake (tools/setup.sh --check installs it)'
fi
done_testing
