#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds the Debian packages of this tree, in BUILD/deb/ARCHITECTURE: `make deb`.
#
# usage: tools/package/deb.sh BUILD [ARCHITECTURE]     (of dpkg; without one: this machine's)
# environment: DEBFULLNAME, DEBEMAIL: who maintains these packages. The address in debian/control
#   is of a domain that nobody has (RFC 2606).
#
# The tree is copied, debian/ is laid into the copy, and its changelog is made: the version is the
# headers', the time is that of the last commit, so that the same commit gives the same packages.
set -eu
cd "$(dirname "$0")/../.."

here=$(dpkg --print-architecture)
arch=${2:-$here}
mkdir -p "$1/deb/$arch"
out=$(cd "$1/deb/$arch" && pwd)
version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
tree=$out/libgrobo-$version
command -v dh >/dev/null || {
    echo 'deb: debhelper is missing; tools/setup.sh --packages installs it' >&2
    exit 1
}

rm -rf "${out:?}"/*
mkdir "$tree"
if [ -e .git ]; then
    git ls-files -co --exclude-standard >"$out/files"
    SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
else
    find . -type f ! -path './build*' >"$out/files"
    SOURCE_DATE_EPOCH=$(stat -c %Y CHANGELOG.md)
fi
export SOURCE_DATE_EPOCH
tar -cf - -T "$out/files" | tar -xf - -C "$tree"
tools/package/debianize.sh "$tree" "$version"

# dpkg-shlibdeps knows the packages of this machine only: the others have the same names.
if [ "$arch" != "$here" ]; then
    tools/cross/libs.sh "$arch"
    [ -x "$1/deb/$here/grctl" ] || "$0" "$1" "$here"
    cp "$1/deb/$here/shlibs" "$tree/debian/shlibs.cross"
    GRCTL_HERE=$(cd "$1/deb/$here" && pwd)/grctl
    CROSS_DIR=$(pwd)/build/cross/$arch
    export GRCTL_HERE CROSS_DIR
fi

(
    unset MAKEFLAGS MAKELEVEL MFLAGS BUILD CC CFLAGS CPPFLAGS LDFLAGS
    cd "$tree"
    # shellcheck disable=SC2046 # an option, or nothing
    DEB_BUILD_OPTIONS="nocheck parallel=2" dpkg-buildpackage -b -us -uc -a"$arch" \
        $([ "$arch" = "$here" ] || echo -d)
) >"$out/log" 2>&1 || {
    tail -n 30 "$out/log" >&2
    echo "deb: failed; $out/log has the whole" >&2
    exit 1
}

if [ "$arch" = "$here" ]; then
    cp "$tree/build/grctl" "$out/grctl"
    # libNAME SOVERSION PACKAGE (>= VERSION), of what these packages need.
    sed -n 's/^shlibs:Depends=//p' "$tree"/debian/*.substvars | tr ',' '\n' | sed 's/^ *//' |
        sort -u >"$out/needs"
    for binary in "$tree"/build/grctl "$tree"/build/grctl-[sf]* "$tree"/build/libgrobo.so.[0-9]; do
        objdump -p "$binary" | sed -n 's/^ *NEEDED *//p'
    done | sort -u | while read -r file; do
        path=$(ldconfig -p | sed -n "s|^\t$file (.* => ||p" | head -n 1)
        package=$(dpkg -S "$(readlink -f "$path")" "$path" 2>/dev/null | head -n 1 | cut -d : -f 1)
        need=$(grep -e "^$package\( \|\$\)" "$out/needs" | tail -n 1)
        case $file in
        *.so.*) echo "${file%%.so.*} ${file##*.so.} $need" ;;
        esac
    done >"$out/shlibs"
fi
rm -rf "$tree" "$out/files"
ls "$out"/*.deb
