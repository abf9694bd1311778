#!/bin/sh
# SPDX-License-Identifier: MIT
# What brings and measures other machines does not take nothing, or a half, for the whole.
. tests/support/tap.sh

here=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

ports_knows_its_names() {
    BUILD=$work/build tools/ports.sh size no-such-machine >"$work/out" 2>&1
    [ $? -eq 2 ] && grep -q 'no machine is called no-such-machine' "$work/out"
}

size_measures_something() {
    mkdir -p "$work/bare/cortex-m0/src"
    PREFIX=no-such- tools/baremetal/size.sh "$work/bare" cortex-m0 >"$work/out" 2>&1
    [ $? -eq 1 ] && grep -q 'nothing could be measured on cortex-m0' "$work/out"
}

# stub NAME: a program that says nothing and does what standard input says.
stub() {
    { echo '#!/bin/sh'; cat; } >"$work/stubs/$1"
    chmod +x "$work/stubs/$1"
}

# As on a full disk, the files of pkg-config cannot be written; there is room again afterwards.
libs_are_whole_or_none() {
    mkdir -p "$work/stubs" "$work/tools"
    cp -R "$here/tools/cross" "$work/tools"
    for name in wine wineserver tar; do
        stub $name </dev/null
    done
    echo 'case "$*" in *indextargets*) echo http://nowhere/debian ;; esac' | stub apt-get
    echo 'case "$*" in *--install*) rm -rf build/cross/win64/root/lib ;; esac' | stub cmake
    stub ../tools/setup.sh </dev/null
    for _ in 1 2; do
        PATH=$work/stubs:$PATH "$work/tools/cross/libs.sh" win64 >"$work/out" 2>&1 && return 1
        [ ! -s "$work/build/cross/win64/made-of" ] || return 1
    done
    grep -q 'libevent_core.pc' "$work/out"
}

test_that 'ports: a name that is none is no row that was skipped' ports_knows_its_names
test_that 'size: no tools, no objects: no success' size_measures_something
test_case 'libraries that could not be written are not taken for made'
if [ -r /usr/share/keyrings/debian-archive-keyring.gpg ]; then
    check 'libraries that could not be written are not taken for made' libs_are_whole_or_none
else
    skip 'libraries that could not be written are not taken for made' 'only on Debian'
fi
done_testing
