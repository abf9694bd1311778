#!/bin/sh
# SPDX-License-Identifier: MIT
# A program in C and the same in C++ find the library by pkg-config and CMake: an installed tree,
# moved, and its source taken along (add_subdirectory, FetchContent). Meson has meson.sh.
set -u
. tests/support/consumers.sh

# ---- pkg-config ----------------------------------------------------------------------------

by_pkg_config() {
    cat >"$work/core.c" <<'C'
#include <grobo/rs30x.h>
#include <grobo/static.h>
int main(void)
{
    grobo_driver driver;
    return grobo_rs30x_driver_init(&driver, &grobo_gr001_model, &grobo_rs30x_protocol) < 0;
}
C
    # shellcheck disable=SC2046
    ${CC:-gcc} -o "$work/core" "$work/core.c" $(pkg-config --cflags --libs grobo-core) &&
        "$work/core" && readelf -d "$work/core" >"$work/needed" && ! grep -q -e grobo -e event \
        "$work/needed"
}

# ---- CMake ---------------------------------------------------------------------------------

# cmake_project FOLDER LINES...: how the library is found, on lines of its own.
cmake_project() {
    folder=$1
    shift
    project "$folder" || return 1
    {
        printf '%s\n' 'cmake_minimum_required(VERSION 3.16)' 'project(consumer C CXX)' \
            'set(CMAKE_C_STANDARD 11)' 'set(CMAKE_CXX_STANDARD 11)' \
            'add_executable(c c.c)' 'add_executable(cxx cxx.cpp)' "$@"
    } >"$work/$folder/CMakeLists.txt"
}

# cmake_builds FOLDER OPTION...
cmake_builds() {
    folder=$1
    shift
    quiet cmake -S "$work/$folder" -B "$work/$folder/b" "$@" &&
        quiet cmake --build "$work/$folder/b" -j 2 && says "$work/$folder/b/c" "$work/$folder/b/cxx"
}

link_c='target_link_libraries(c PRIVATE grobo::grobo)'
link_cxx='target_link_libraries(cxx PRIVATE grobo::grobo)'

cmake_installed() {
    cmake_project found 'find_package(grobo 0.1 REQUIRED)' "$link_c" "$link_cxx" &&
        cmake_builds found -DCMAKE_PREFIX_PATH="$work/moved" &&
        readelf -d "$work/found/b/cxx" | grep -q 'NEEDED.*libgrobo\.so\.0'
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

cmake_fetched() {
    cmake_project fetched 'include(FetchContent)' \
        "FetchContent_Declare(grobo URL $tarball SOURCE_SUBDIR tools/package)" \
        'set(BUILD_SHARED_LIBS ON)' 'FetchContent_MakeAvailable(grobo)' "$link_c" "$link_cxx" &&
        cmake_builds fetched &&
        readelf -d "$work/fetched/b/c" | grep -q 'NEEDED.*libgrobo\.so\.0' &&
        nm -D --defined-only "$(find "$work/fetched/b" -name 'libgrobo.so.0')" |
        sed -n 's/.* [TDBR] //p' | cut -d @ -f 1 | sort -u >"$work/exported" &&
        sed -n 's/^ *\(grobo_.*\);/\1/p' src/libgrobo.map | sort >"$work/listed" &&
        diff "$work/listed" "$work/exported"
}

check 'an installed tree, moved' installs
check 'pkg-config: grobo-core needs nothing else' by_pkg_config
pack
if command -v cmake >/dev/null; then
    check 'CMake: find_package' cmake_installed
    check 'CMake: the static libraries' cmake_static
    check 'CMake: find_package refuses what does not fit' cmake_refuses
    check 'CMake: add_subdirectory' cmake_source
    check 'CMake: FetchContent, shared, exports what the map lists' cmake_fetched
else
    skip 'CMake' 'no cmake (tools/setup.sh --ci installs it)'
fi
done_testing
