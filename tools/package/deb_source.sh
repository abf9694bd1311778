#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes the Debian source package of the last commit, in BUILD/deb/source: `make deb-source`.
#
# usage: tools/package/deb_source.sh BUILD
# environment: as tools/package/deb.sh
#
# What was released is the .orig.tar.gz (`make dist`); debian/ is tools/package/debian and a
# changelog. Times are the commit's, so the same commit gives the same files. It is built by
# `dpkg-source -x *.dsc`, then `dpkg-buildpackage` in the folder: no network and no git are needed.
set -eu
cd "$(dirname "$0")/../.."

git rev-parse -q --verify HEAD >/dev/null 2>&1 || {
    echo 'deb-source: not a git checkout: a source package is made of a commit' >&2
    exit 1
}
command -v dpkg-source >/dev/null || {
    echo 'deb-source: dpkg-source is missing; tools/setup.sh --packages installs it' >&2
    exit 1
}
rm -rf "$1/deb/source"
mkdir -p "$1/deb/source"
out=$(cd "$1/deb/source" && pwd)
version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
tree=$out/libgrobo-$version
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
git -c tar.umask=0022 archive --prefix="libgrobo-$version/" HEAD |
    gzip -n >"$out/libgrobo_$version.orig.tar.gz"
tar -xzf "$out/libgrobo_$version.orig.tar.gz" -C "$out"
tools/package/debianize.sh "$tree" "$version"
(cd "$out" && dpkg-source -b "$tree" >log)
rm -rf "$tree"
ls "$out"/*.dsc
