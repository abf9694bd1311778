#!/bin/sh
# SPDX-License-Identifier: MIT
# A newcomer's machine: in a fresh root of each distribution the two commands of README.md, the
# packages and grctl, CMake's find_package() and Meson, and the wheel that plays a motion by five
# lines of Python. Takes long, root and a network: `make check-roots`.
# environment: BUILD; SUITES="trixie noble"; QUICK=yes leaves `make check` out
set -u

. tests/support/tap.sh
. tests/support/root.sh
needs_roots 'fresh roots' dh debootstrap unshare git
if [ "$(id -u)" -ne 0 ] || ! unshare -m true 2>/dev/null; then
    skip 'fresh roots' 'a fresh root with devices is made by root'
    done_testing
    exit 0
fi

made() {
    [ -n "$(find "$build/deb/$here" -name 'libgrobo-dev_*.deb' 2>/dev/null)" ] ||
        tools/package/deb.sh "$build" "$here"
}
wheel() {
    ls "$build"/wheel/grobo-*"$(uname -m)".whl 2>/dev/null | tail -n 1
}
wheel_made() {
    [ -n "$(wheel)" ] || env -u MAKEFLAGS -u MAKELEVEL tools/python/wheel.sh "$build" "$(uname -m)"
}

# quiet COMMAND...: what it said is shown where it fails.
quiet() {
    "$@" >"$work/said" 2>&1 || { tail -n 25 "$work/said"; return 1; }
}
apt() {
    quiet in_root apt-get -q -y -o APT::Sandbox::User=root --no-install-recommends install "$@"
}

# ---- the checkout --------------------------------------------------------------------------

# make is all that has to be there: a clone, as a user has it, with what is not committed yet.
fresh_root() {
    make_root "$1" make,ca-certificates && git clone -q . "$root/src" &&
        git ls-files -co --exclude-standard | tar -cf - -T - | tar -xf - -C "$root/src"
}
# A machine that is away for 250 ms ends a motion, as it has to: then once more.
demo() {
    plays_demo || { grep -q 'host stalled' "$work/said" && plays_demo; }
}
plays_demo() {
    quiet in_live_root make -C /src demo &&
        grep -q 'A simulated GR001 stands behind' "$work/said" &&
        grep -q 'largest error' "$work/said" || { tail -n 5 "$work/said"; return 1; }
}
# The whole of it is kept; what failed is shown.
whole_check() {
    in_live_root make -C /src --no-print-directory -j2 check >"$work/check-$suite" 2>&1 &&
        tail -n 1 "$work/check-$suite" | grep -q ' 0 failed' && return
    grep -e '^FAIL' -e '^  not ok' -A 5 "$work/check-$suite"
    tail -n 1 "$work/check-$suite"
    return 1
}

# ---- the packages --------------------------------------------------------------------------

packages() {
    # shellcheck disable=SC2046
    mkdir "$root/debs" && cp "$build/deb/$here"/*.deb "$root/debs" && rm -f "$root"/debs/*dbgsym* &&
        apt $(cd "$root" && find ./debs -name '*.deb' | sed 's/^\.//')
}
status() {
    in_root grctl -d sim status >"$work/status" 2>&1 && grep -q R_ELBOW_P "$work/status" ||
        { cat "$work/status"; return 1; }
}
consumer() {
    rm -rf "$root/consumer" && mkdir "$root/consumer" &&
        cp tests/export/consumer.c "$root/consumer/c.c" && cat >"$root/consumer/$1"
}
answers() {
    [ "$(in_root /consumer/build/c)" = 'no reply in time' ]
}
by_cmake() {
    consumer CMakeLists.txt <<'C' && quiet in_root cmake -S /consumer -B /consumer/build &&
cmake_minimum_required(VERSION 3.16)
project(c C)
find_package(grobo 0.1 REQUIRED)
add_executable(c c.c)
target_link_libraries(c PRIVATE grobo::grobo)
C
        quiet in_root cmake --build /consumer/build && answers
}
by_meson() {
    consumer meson.build <<'C' && quiet in_root meson setup /consumer/build /consumer &&
project('c', 'c')
executable('c', 'c.c', dependencies: dependency('grobo', version: '>= 0.1'))
C
        quiet in_root ninja -C /consumer/build && answers
}

# ---- Python --------------------------------------------------------------------------------

# cffi comes from where pip takes it on this machine, with its certificates.
pip_installs() {
    cp "$(wheel)" "$root/tmp" && cp /etc/ssl/certs/ca-certificates.crt "$root/tmp/certificates" &&
        quiet in_root python3 -m venv /venv &&
        quiet in_root env PIP_CERT=/tmp/certificates \
            PIP_INDEX_URL="${PIP_INDEX_URL:-https://pypi.org/simple}" \
            sh -c '/venv/bin/pip install /tmp/grobo-*.whl'
}
plays() {
    cat >"$root/tmp/five.py" <<'P'
import grobo
with grobo.connect("sim") as robot:
    robot.init()
    robot.play("/src/motions/greet.pseq", speed=2.0)
    print(len(robot.joints), robot.status().playing)
P
    [ "$(in_root /venv/bin/python /tmp/five.py)" = '20 False' ]
}

test_case 'packages are made'
check 'packages are there' made
check 'a wheel is there' wheel_made
# Debian stable, oldstable and testing, the last two long-term releases of Ubuntu.
for suite in ${SUITES:-trixie bookworm forky resolute noble}; do
    test_case "a fresh root of $suite"
    root=$work/root-$suite
    if ! fresh_root "$suite" >"$work/why" 2>&1; then
        skip "$suite" "no fresh root: $(tail -n 1 "$work/why")"
        rm -rf "$root"
        continue
    fi
    check "$suite: make demo" demo
    if [ -n "${QUICK:-}" ]; then
        skip "$suite: make check" 'left out by QUICK'
    else
        check "$suite: make check" whole_check
    fi
    check "$suite: apt installs the packages" packages
    check "$suite: grctl -d sim status" status
    check "$suite: CMake and Meson are installed" apt cmake meson pkg-config gcc libc6-dev
    check "$suite: find_package" by_cmake
    check "$suite: Meson" by_meson
    check "$suite: Python is installed" apt python3-venv
    check "$suite: pip installs the wheel" pip_installs
    check "$suite: five lines of Python play a motion" plays
    rm -rf "$root"
done
root=
done_testing
