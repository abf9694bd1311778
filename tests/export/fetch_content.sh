#!/bin/sh
# SPDX-License-Identifier: MIT
# A program in C and the same in C++ take the library along by CMake's FetchContent, shared.
set -u
. tests/support/consumers.sh

cmake_fetched() {
    cmake_project fetched 'include(FetchContent)' \
        "FetchContent_Declare(grobo URL $tarball SOURCE_SUBDIR tools/package)" \
        'set(BUILD_SHARED_LIBS ON)' 'FetchContent_MakeAvailable(grobo)' "$link_c" "$link_cxx" &&
        cmake_builds fetched &&
        readelf -d "$work/fetched/b/c" | grep -q 'NEEDED.*libgrobo\.so\.1' &&
        nm -D --defined-only "$(find "$work/fetched/b" -name 'libgrobo.so.1')" |
        sed -n 's/.* [TDBR] //p' | cut -d @ -f 1 | sort -u >"$work/exported" &&
        sed -n 's/^ *\(grobo_.*\);/\1/p' src/libgrobo.map | sort >"$work/listed" &&
        diff "$work/listed" "$work/exported"
}

pack
if command -v cmake >/dev/null; then
    test_that 'CMake: FetchContent, shared, exports what the map lists' cmake_fetched
else
    test_case 'CMake: FetchContent'
    skip 'CMake: FetchContent' 'no cmake (tools/setup.sh --check installs it)'
fi
done_testing
