#!/bin/sh
# SPDX-License-Identifier: MIT
# A stranger's program for Windows, C and C++, against the installed headers: with grobo.dll through
# its import library, and with the static library.
set -u

. tests/support/tap.sh
here=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
place=$work/opt/grobo
# What the library itself is built on stands in the same tree.
mkdir -p "$work/$(dirname "$GROBO_WINE")"
ln -s "$GROBO_WINE" "$work/$GROBO_WINE"
warnings="-Wall -Wextra -Wpedantic ${WERROR:-}"

make_target() {
    env -u MAKEFLAGS -u MAKELEVEL make --no-print-directory -C "$here" "$1" \
        BUILD="$BUILD" PREFIX=/opt/grobo DESTDIR="$work" CROSS="$CROSS"
}

# builds COMPILER SOURCE PKG_CONFIG_OPTION...: flags are lists of words. Windows looks for a DLL
# where the program is.
# shellcheck disable=SC2086
builds() {
    compiler=$1
    source=$2
    shift 2
    rm -f "$place/bin/program.exe"
    flags=$(PKG_CONFIG_LIBDIR=$place/lib/pkgconfig:$GROBO_WINE/root/lib/pkgconfig \
        PKG_CONFIG_SYSROOT_DIR=$work pkg-config --cflags --libs "$@" grobo)
    $compiler $warnings "$source" -x none ${1:+-static} -o "$place/bin/program.exe" $flags
}

runs() {
    [ "$($EMULATOR "$place/bin/program.exe" | tr -d '\r')" = 'no reply in time' ]
}

imports() {
    "${CC%gcc}objdump" -p "$place/bin/program.exe" | grep 'DLL Name' >"$work/names"
    cat "$work/names"
    [ "$(grep -c grobo.dll "$work/names")" = "$1" ]
}

every_header() {
    (cd "$place/include" && find grobo -name '*.h') | sed 's/.*/#include <&>/' >"$work/all.c"
    echo 'int main(void) { return grobo_gr001_model()->n_joints == 20 ? 0 : 1; }' >>"$work/all.c"
    builds "$1" "$work/all.c" && $EMULATOR "$place/bin/program.exe"
}

test_case "it is installed"
check 'install' make_target install
for compiler in "$CC -std=c11 -x c" "$CXX -std=c++11 -x c++"; do
    name=${compiler%% *}
    test_case "$name"
    check "$name, grobo.dll: builds" builds "$compiler" tests/export/consumer.c
    check "$name, grobo.dll: runs" runs
    check "$name: imports grobo.dll" imports 1
    check "$name: every header together, and data of the DLL" every_header "$compiler"
    check "$name, static: builds" builds "$compiler" tests/export/consumer.c --static
    check "$name, static: runs" runs
    check "$name, static: imports no grobo.dll" imports 0
done
test_case "it is uninstalled"
check 'uninstall' make_target uninstall
check 'uninstall leaves no file' test -z "$(find "$place" -type f ! -name program.exe)"
done_testing
