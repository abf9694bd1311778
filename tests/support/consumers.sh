# SPDX-License-Identifier: MIT
# For tests of build systems: an installed tree that was moved, the tree as a release packs it, and
# a project with the same program in C and C++.
. tests/support/tap.sh
. tests/support/built.sh
here=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
built=${BUILD:-build}
unset BUILD MAKEFLAGS MAKELEVEL MFLAGS
CFLAGS=-O0
CXXFLAGS=-O0
export CFLAGS CXXFLAGS

if [ -n "${CROSS:-}${EMULATOR:-}" ]; then
    skip 'build systems' 'only for this machine'
    done_testing
    exit 0
fi

quiet() {
    "$@" >"$work/out" 2>&1 || { tail -n 40 "$work/out"; return 1; }
}

# says PROGRAM...: each says what it was made to say.
says() {
    for program in "$@"; do
        [ "$("$program")" = 'no reply in time' ] || { echo "$program"; return 1; }
    done
}

installs() {
    copy_build "$built" "$work/built" &&
        make_in_copy "$work/built" install-lib DESTDIR="$work/stage" PREFIX=/opt/grobo &&
        mv "$work/stage/opt/grobo" "$work/moved"
}

# project FOLDER: an empty one with both programs.
project() {
    mkdir -p "$work/$1" && cp "$here/tests/export/consumer.c" "$work/$1/c.c" &&
        cp "$here/tests/export/consumer.c" "$work/$1/cxx.cpp"
}

export PKG_CONFIG_PATH="$work/moved/lib/pkgconfig"

# The tree as it stands, as a release is packed.
pack() {
    version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
    tarball=$work/libgrobo-$version.tar.gz
    tar -czf "$tarball" --exclude=./build* --exclude=./.git \
        --transform "s,^\.,libgrobo-$version," ./include ./src ./ports ./tools ./Makefile
}

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
