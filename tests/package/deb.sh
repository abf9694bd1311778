#!/bin/sh
# SPDX-License-Identifier: MIT
# The Debian packages: lintian finds nothing, and in a fresh root of each distribution they are
# installed, tried, and purged without a trace. Takes minutes, root and a network: `make check-deb`.
# environment: BUILD; SUITES="bookworm noble"; ARCHS="amd64 arm64", of which this machine's is run
set -u

. tests/support/tap.sh
. tests/support/root.sh
needs_roots 'Debian packages' dh lintian debootstrap

debs() {
    find "$build/deb/$1" -name '*.deb' ! -name '*dbgsym*'
}

clean() {
    lintian --allow-root --fail-on error,warning "$build/deb/$1"/*.changes >"$work/lintian" 2>&1 &&
        [ ! -s "$work/lintian" ] || { cat "$work/lintian"; return 1; }
}

# complete ARCH: each package is there, and binaries are that machine's.
complete() {
    for package in $packages; do
        debs "$1" | grep -q -e "/${package}_.*_\($1\|all\)\.deb$" ||
            { echo "no $package"; return 1; }
    done
    case $1 in amd64) machine=X86-64 ;; *) machine=AArch64 ;; esac
    dpkg-deb --fsys-tarfile "$(debs "$1" | grep /grctl_)" | tar -xOf - ./usr/bin/grctl \
        >"$work/grctl" && readelf -h "$work/grctl" | grep -q "Machine: .*$machine"
}

same_needs() {
    for package in grctl libgrobo1; do
        for arch in "$here" "$1"; do
            dpkg-deb -f "$(debs "$arch" | grep "/${package}_")" Depends >"$work/needs-$arch"
        done
        diff "$work/needs-$here" "$work/needs-$1" || return 1
    done
}

# ---- a fresh root --------------------------------------------------------------------------

# What a program is compiled with, and what Python itself leaves behind, is there before.
fresh_root() {
    make_root "$1" gcc,libc6-dev,pkg-config,python3-cffi-backend || return 1
    # shellcheck disable=SC2046
    mkdir "$root/debs" && cp $(debs "$here") "$root/debs"
}

# Names only; what apt keeps for itself is not ours.
list_files() {
    (cd "$root" && find . \( -path ./proc -o -path ./sys -o -path ./dev -o -path ./debs -o \
        -path ./var/cache -o -path ./var/log -o -path ./var/lib/apt -o -path ./tmp \) -prune -o \
        ! -name '*-old' -print | sort)
}

installs() {
    list_files >"$work/before"
    in_root sh -c 'apt-get -q -y -o APT::Sandbox::User=root --no-install-recommends install \
        /debs/*.deb' >"$work/apt" 2>&1 || { tail -n 20 "$work/apt"; return 1; }
}

runs() {
    in_root grctl -d sim status >"$work/status" 2>&1 && grep -q R_ELBOW_P "$work/status" ||
        { cat "$work/status"; return 1; }
}

compiles() {
    cat >"$root/consumer.c" <tests/export/consumer.c
    in_root sh -c 'cc -o /consumer /consumer.c $(pkg-config --cflags --libs grobo)' &&
        [ "$(in_root /consumer)" = 'no reply in time' ]
}

python_runs() {
    in_root python3 -c 'import grobo
with grobo.connect("sim") as robot:
    robot.init()
    print(len(robot.joints), grobo.__version__)' >"$work/python" 2>&1 &&
        grep -q "^20 [0-9]" "$work/python" || { cat "$work/python"; return 1; }
}

owns() {
    for file in /usr/bin/grctl /usr/share/man/man1/grctl.1.gz /usr/share/man/man5/grctl-json.5.gz \
        /usr/lib/udev/rules.d/60-grobo.rules /usr/share/bash-completion/completions/grctl \
        /usr/share/zsh/site-functions/_grctl /usr/share/fish/vendor_completions.d/grctl.fish; do
        in_root dpkg -L grctl | grep -q -Fx "$file" || { echo "no $file"; return 1; }
    done
}

purges() {
    rm -f "$root/consumer" "$root/consumer.c"
    # shellcheck disable=SC2086
    in_root apt-get -q -y purge --autoremove $packages >"$work/apt" 2>&1 ||
        { tail -n 20 "$work/apt"; return 1; }
    list_files >"$work/after"
    diff "$work/before" "$work/after"
}

# What `make deb-source` makes: the same twice, and nothing of it to complain of.
source_same() {
    tools/package/deb_source.sh "$build" >"$work/source" || return 1
    rm -rf "$work/first" && cp -R "$build/deb/source" "$work/first" &&
        tools/package/deb_source.sh "$build" >"$work/source" &&
        diff -r "$work/first" "$build/deb/source" &&
        lintian --allow-root --fail-on error,warning "$build"/deb/source/*.dsc
}

# Twice in folders of its own, without a network, and the packages are equal byte by byte.
source_builds() {
    for n in 1 2; do
        rm -rf "$work/built-$n" && mkdir "$work/built-$n" &&
            dpkg-source -x "$build"/deb/source/*.dsc "$work/built-$n/tree" >"$work/source" &&
            (cd "$work/built-$n/tree" && env -u MAKEFLAGS -u MAKELEVEL \
                DEB_BUILD_OPTIONS='nocheck parallel=2' unshare -n dpkg-buildpackage -b -us -uc) \
                >"$work/source" 2>&1 || { tail -n 20 "$work/source"; return 1; }
        (cd "$work/built-$n" && sha256sum ./*.deb) >"$work/sums-$n"
    done
    diff "$work/sums-1" "$work/sums-2"
}

packages=$(sed -n 's/^Package: //p' tools/package/debian/control)
test_case 'the source package'
if git rev-parse -q --verify HEAD >/dev/null 2>&1; then
    check 'the same twice, and lintian finds nothing' source_same
    if unshare -n true 2>/dev/null; then
        check 'builds the same twice, without a network' source_builds
    else
        skip 'builds without a network' 'no namespaces of a network'
    fi
else
    skip 'the source package' 'no git checkout'
fi
for arch in ${ARCHS:-amd64 arm64}; do
    test_case "a package for $arch"
    check "$arch: built" tools/package/deb.sh "$build" "$arch"
    check "$arch: complete" complete "$arch"
    check "$arch: lintian finds nothing" clean "$arch"
    [ "$arch" = "$here" ] || check "$arch: needs the same packages" same_needs "$arch"
done
for suite in ${SUITES:-bookworm noble}; do
    test_case "the package in $suite"
    root=$work/root-$suite
    if [ "$(id -u)" -ne 0 ]; then
        skip "$suite" 'a fresh root is made by root'
        continue
    fi
    if ! fresh_root "$suite" >"$work/why" 2>&1; then
        skip "$suite" "no fresh root: $(tail -n 1 "$work/why")"
        rm -rf "$root"
        continue
    fi
    check "$suite: installed" installs
    check "$suite: grctl -d sim status" runs
    check "$suite: a program is compiled" compiles
    check "$suite: Python moves a robot" python_runs
    check "$suite: man pages, completion, udev rule" owns
    check "$suite: purged without a trace" purges
    rm -rf "$root"
done
root=
done_testing
