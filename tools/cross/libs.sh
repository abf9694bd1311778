#!/bin/sh
# SPDX-License-Identifier: MIT
# Brings what a build for another machine needs: compilers and emulators (tools/setup.sh), and the
# libraries, below build/cross/TARGET. Silent and quick where nothing is missing.
#
# usage: tools/cross/libs.sh TARGET
#   TARGET is one of tools/cross/*.mk.
# What fails ends it: what is half made, on a full disk, must not pass for whole the next time.
set -eu
cd "$(dirname "$0")/../.." || exit 1

usage() {
    echo 'usage: tools/cross/libs.sh TARGET' >&2
    exit 2
}

die() {
    echo "cross: $1" >&2
    exit 1
}

[ $# -eq 1 ] || usage
target=$1
top=$(pwd)
work=$top/build/cross/$target

. tools/cross/distribution.sh
. tools/cross/sources.sh
. tools/cross/musl.sh
. tools/cross/windows.sh
. tools/cross/zig.sh

tools/setup.sh --cross "$target" || exit 1
case $target in
arm64 | armhf | s390x) sysroot "$target" "$codename" ;;
win64) windows_libraries x86_64-w64-mingw32 ;;
riscv64) sysroot riscv64 trixie ;; # Debian has had it since 13
musl) musl_libraries amd64 gcc ;;
musl-arm64) musl_libraries arm64 aarch64-linux-gnu-gcc ;;
macos) zig_libraries aarch64-macos Darwin ;;
freebsd) zig_libraries x86_64-freebsd FreeBSD ;;
openbsd) zig_libraries x86_64-openbsd OpenBSD ;;
*) usage ;;
esac
