#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes the wheel of the Python package with the library and grctl inside: `make wheel`.
#
# usage: tools/python/wheel.sh BUILD [x86_64 | aarch64 | macos | win64]
#
# x86_64, aarch64: Linux with glibc 2.17 and later (manylinux2014). zig links for an old glibc
# whatever this machine has; libevent, libyaml and jansson are linked in, and of the library only
# the names of its map are visible. auditwheel confirms what the wheel says of itself. macos is that
# of arm64, by zig too, win64 by mingw-w64: both are linked here and were never tried there.
set -eu
cd "$(dirname "$0")/../.."

processor=${2:-x86_64}
top=$(pwd)
work=$top/build/cross/manylinux-$processor
mkdir -p "$1/wheel"
build=$(cd "$1" && pwd)
made=$build/wheel/$processor

die() {
    echo "wheel: $1" >&2
    exit 1
}
# makes WORDS...: the library and the command, by make with these.
makes() {
    make --no-print-directory -j2 "$made/$library" "$made/$command" BUILD="$made" WERROR= \
        CFLAGS="-O2 -ffile-prefix-map=$top=." LDFLAGS="$link" "$@"
}

library=libgrobo.so.1
command=grctl
link=-s
GROBO_PLATFORM=manylinux2014_$processor
command -v cmake >/dev/null || die 'cmake is missing: tools/setup.sh --cross macos installs it'
unset MAKEFLAGS MAKELEVEL MFLAGS BUILD CC CFLAGS CPPFLAGS LDFLAGS
case $processor in
x86_64 | aarch64)
    . tools/cross/distribution.sh
    . tools/cross/sources.sh
    . tools/cross/zig.sh
    zig_libraries "$processor-linux-gnu.2.17" Linux
    makes CC="$work/bin/cc" AR="$work/bin/ar" SYMBOLIC=-Wl,-Bsymbolic WHOLE_GRCTL=yes \
        PKG_CONFIG="PKG_CONFIG_LIBDIR=$work/root/lib/pkgconfig pkg-config"
    ;;
macos)
    library=libgrobo.1.dylib
    GROBO_PLATFORM=macosx_11_0_arm64
    tools/cross/libs.sh macos
    makes CROSS=macos
    ;;
win64)
    library=grobo.dll
    command=grctl.exe
    link='-static -s'
    GROBO_PLATFORM=win_amd64
    tools/cross/libs.sh win64
    makes CROSS=win64
    ;;
*) die "unknown system '$processor': x86_64, aarch64, macos or win64" ;;
esac
make --no-print-directory python BUILD="$build"

# A copy of the package with that library, packed by the tools of PyPI.
tools=$build/wheel/tools
[ -x "$tools/bin/auditwheel" ] || {
    python3 -m venv "$tools" &&
        "$tools/bin/pip" install -q --disable-pip-version-check \
            'setuptools<81' wheel cffi 'auditwheel>=6' >&2
}
package=$build/wheel/package-$processor
rm -rf "$package"
mkdir "$package"
cp -R "$build/python/." "$package"
rm -f "$package/grobo/libgrobo.so.1" # of this machine
cp "$made/$library" "$made/$command" "$package/grobo"
find "$package" -name __pycache__ -exec rm -rf {} +
SOURCE_DATE_EPOCH=$(stat -c %Y CHANGELOG.md)
[ ! -e .git ] || SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export GROBO_PLATFORM SOURCE_DATE_EPOCH
(cd "$package" && "$tools/bin/python" setup.py -q bdist_wheel --dist-dir "$build/wheel") \
    >"$build/wheel/log" 2>&1 || { tail -n 20 "$build/wheel/log" >&2; die 'bdist_wheel failed'; }
for wheel in "$build/wheel"/grobo-*-py3-none-"$GROBO_PLATFORM".whl; do
    case $GROBO_PLATFORM in
    manylinux*)
        "$tools/bin/auditwheel" show "$wheel" >"$build/wheel/audit-$processor"
        grep -q "manylinux_2_17_$processor" "$build/wheel/audit-$processor" || {
            cat "$build/wheel/audit-$processor" >&2
            die 'it needs a younger system than manylinux2014'
        }
        ;;
    esac
    echo "$wheel"
done
