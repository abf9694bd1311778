#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs into a tree of its own and builds a stranger's program against it: C and C++, shared and
# static, with the flags that pkg-config tells and nothing else.
set -u

. tests/support/tap.sh
here=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
tree=$work/tree
library=$tree/opt/grobo/lib
PKG_CONFIG_SYSROOT_DIR=$tree
PKG_CONFIG_PATH=$library/pkgconfig
export PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH
cc="${CC:-gcc} -std=c11 -Wall -Wextra -Wpedantic -Werror -x c"
cxx="${CXX:-g++} -std=c++11 -Wall -Wextra -Wpedantic -Werror -x c++"

make_target() {
    env -u MAKEFLAGS -u MAKELEVEL -u PKG_CONFIG_SYSROOT_DIR -u PKG_CONFIG_PATH \
        make --no-print-directory -C "$here" "$1" BUILD="${BUILD:-build}" PREFIX=/opt/grobo \
        DESTDIR="$tree"
}

# builds COMPILER SOURCE PKG_CONFIG_OPTION...; flags are lists of words.
# shellcheck disable=SC2046
builds() {
    compiler=$1
    source=$2
    shift 2
    $compiler "$source" -x none -o "$work/program" $(pkg-config --cflags --libs "$@" grobo)
}

runs() {
    [ "$(LD_LIBRARY_PATH=$library "$work/program")" = 'no reply in time' ]
}

needs() {
    readelf -d "$work/program" | grep NEEDED | grep -q "libgrobo\.so\.0"
}

same_version() {
    told=$(pkg-config --modversion grobo)
    echo "pkg-config: $told"
    grep -Fq "GROBO_VERSION_STRING \"$told\"" include/grobo/version.h
}

every_header() {
    for header in "$tree"/opt/grobo/include/grobo/*.h; do
        echo "#include <grobo/${header##*/}>"
    done >"$work/all.c"
    echo 'int main(void) { return 0; }' >>"$work/all.c"
    [ "$(grep -c include "$work/all.c")" -ge "$(ls include/grobo/*.h | wc -l)" ] &&
        builds "$1" "$work/all.c"
}

check 'install' make_target install
share=$tree/opt/grobo/share
check 'the man page is there' grep -q '^\.Dt GRCTL 1' "$share/man/man1/grctl.1"
check 'that of what --json prints too' grep -q '^\.Dt GRCTL-JSON 5' "$share/man/man5/grctl-json.5"
check 'its schema' grep -q '"title": "What grctl --json prints' "$share/grobo/grctl.schema.json"
check 'completion for bash' grep -q '^complete ' "$share/bash-completion/completions/grctl"
check 'completion for zsh' grep -q '^#compdef' "$share/zsh/site-functions/_grctl"
check 'completion for fish' grep -q '^complete ' "$share/fish/vendor_completions.d/grctl.fish"
check 'pkg-config tells the version of the headers' same_version
check 'C, shared: builds' builds "$cc" tests/export/consumer.c
check 'C, shared: runs' runs
check 'C, shared: asks for libgrobo.so.0' needs
check 'C: every installed header together' every_header "$cc"
if command -v "${CXX:-g++}" >/dev/null; then
    check 'C++, shared: builds' builds "$cxx" tests/export/consumer.c
    check 'C++, shared: runs' runs
    check 'C++: every installed header together' every_header "$cxx"
else
    skip 'C++' 'no C++ compiler'
fi
rm -f "$library"/libgrobo.so*
check 'C, static: builds' builds "$cc" tests/export/consumer.c --static
check 'C, static: runs' runs
if command -v "${CXX:-g++}" >/dev/null; then
    check 'C++, static: builds' builds "$cxx" tests/export/consumer.c --static
    check 'C++, static: runs' runs
fi
check 'uninstall' make_target uninstall
check 'uninstall leaves no file' test -z "$(find "$tree" -type f -o -type l)"
done_testing
