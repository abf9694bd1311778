#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes the wheel of the Python package with the library inside, for Linux with glibc 2.17 and later
# (manylinux2014): `make wheel`.
#
# usage: tools/python/wheel.sh BUILD [x86_64 | aarch64]
#
# zig links for an old glibc whatever this machine has; libevent and libyaml are linked into the
# library, and only the names of its map are visible. auditwheel confirms what it says of itself.
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
make --no-print-directory -j2 "$build/wheel/$processor/libgrobo.so.1" \
    BUILD="$build/wheel/$processor" CC="$work/bin/cc" AR="$work/bin/ar" WERROR= \
    CFLAGS="-O2 -ffile-prefix-map=$top=." LDFLAGS=-s SYMBOLIC=-Wl,-Bsymbolic \
    PKG_CONFIG="PKG_CONFIG_LIBDIR=$work/root/lib/pkgconfig pkg-config"
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
cp "$build/wheel/$processor/libgrobo.so.1" "$package/grobo"
find "$package" -name __pycache__ -exec rm -rf {} +
GROBO_PLATFORM=manylinux2014_$processor
SOURCE_DATE_EPOCH=$(stat -c %Y CHANGELOG.md)
[ ! -e .git ] || SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export GROBO_PLATFORM SOURCE_DATE_EPOCH
(cd "$package" && "$tools/bin/python" setup.py -q bdist_wheel --dist-dir "$build/wheel") \
    >"$build/wheel/log" 2>&1 || { tail -n 20 "$build/wheel/log" >&2; die 'bdist_wheel failed'; }
for wheel in "$build/wheel"/grobo-*-py3-none-manylinux2014_"$processor".whl; do
    "$tools/bin/auditwheel" show "$wheel" >"$build/wheel/audit-$processor"
    grep -q "manylinux_2_17_$processor" "$build/wheel/audit-$processor" || {
        cat "$build/wheel/audit-$processor" >&2
        die 'it needs a younger system than manylinux2014'
    }
    echo "$wheel"
done
