#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes the wheel of the Python package with the library inside, for Linux with glibc 2.17 and later
# (manylinux2014): `make wheel`.
#
# usage: tools/python/wheel.sh BUILD [x86_64 | aarch64]
#
# zig links for an old glibc whatever this machine has; libevent and libyaml are linked into the
# library, and only the names of its map are visible. The wheel is packed without pip: it holds
# Python files, the library and the metadata of pyproject.toml.
set -eu
cd "$(dirname "$0")/../.."

processor=${2:-x86_64}
top=$(pwd)
work=$top/build/cross/manylinux-$processor
mkdir -p "$1/wheel"
build=$(cd "$1" && pwd)

die() {
    echo "wheel: $1" >&2
    exit 1
}

case $processor in
x86_64 | aarch64) ;;
*) die "unknown processor '$processor': x86_64 or aarch64" ;;
esac
command -v cmake >/dev/null || die 'cmake is missing: tools/setup.sh --cross macos installs it'
. tools/cross/distribution.sh
. tools/cross/sources.sh
. tools/cross/zig.sh
zig_libraries "$processor-linux-gnu.2.17" Linux

unset MAKEFLAGS MAKELEVEL MFLAGS BUILD CC CFLAGS CPPFLAGS LDFLAGS
make --no-print-directory -j2 "$build/wheel/$processor/libgrobo.so.0" \
    BUILD="$build/wheel/$processor" CC="$work/bin/cc" AR="$work/bin/ar" WERROR= \
    CFLAGS="-O2 -ffile-prefix-map=$top=." LDFLAGS='-s -Wl,--exclude-libs,ALL' \
    PKG_CONFIG="PKG_CONFIG_LIBDIR=$work/root/lib/pkgconfig pkg-config"
make --no-print-directory python BUILD="$build"
python3 tools/python/pack.py "$build/python" "$build/wheel/$processor/libgrobo.so.0" \
    "manylinux2014_$processor" "$build/wheel"
