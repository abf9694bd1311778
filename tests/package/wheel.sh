#!/bin/sh
# SPDX-License-Identifier: MIT
# The wheels: made for manylinux2014, the same twice, installed in an environment of their own, and
# a motion is played, by the package and by the grctl inside; those of macOS and Windows are looked
# into. Takes minutes and a network: `make check-wheel`.
# environment: BUILD; PROCESSORS="x86_64 aarch64 macos win64", of which this machine's is run
set -u

. tests/support/tap.sh
build=${BUILD:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

for command in cmake python3 apt-get; do
    command -v $command >/dev/null || {
        skip 'wheels' "no $command"
        done_testing
        exit 0
    }
done

made() {
    env -u MAKEFLAGS -u MAKELEVEL tools/python/wheel.sh "$build" "$1" >"$work/name-$1" &&
        [ -s "$(tail -n 1 "$work/name-$1")" ]
}

same_again() {
    wheel=$(tail -n 1 "$work/name-$1")
    before=$(sha256sum <"$wheel")
    rm -rf "$build/wheel/$1" "$wheel"
    made "$1" && [ "$(sha256sum <"$wheel")" = "$before" ]
}

# Another libevent in the same process must not be mixed up with ours.
hides_the_rest() {
    nm -D --defined-only "$build/wheel/$1/libgrobo.so.1" | grep -v -e ' grobo_' -e ' A GROBO_1$'
    [ $? -eq 1 ]
}

machine() {
    readelf -h "$build/wheel/$1/libgrobo.so.1" | grep -i -e "Machine:.*$2"
}

installs() {
    python3 -m venv "$work/venv" && "$work/venv/bin/pip" install -q \
        --disable-pip-version-check "$(tail -n 1 "$work/name-$1")"
}

plays() {
    cat >"$work/five.py" <<'P'
import grobo
with grobo.connect("sim") as robot:
    robot.init()
    robot.play("motions/greet.pseq", speed=2.0)
    print(grobo.version(), len(robot.joints), robot.status().playing)
P
    [ "$(env -u PYTHONPATH "$work/venv/bin/python" "$work/five.py")" = "$version 20 False" ]
}

# It opens a serial line and sets its rate: nobody answers there.
opens() {
    cat >"$work/opens.py" <<'P'
import os
import grobo
own, other = os.openpty()
try:
    grobo.connect(os.ttyname(other), robot="pan-tilt", guard=False)
except grobo.errors.Error as refused:
    print("no reply in time" in str(refused) or refused)
P
    [ "$(env -u PYTHONPATH "$work/venv/bin/python" "$work/opens.py")" = True ]
}

# The command, and as what the library starts for a guard.
commands() {
    [ "$("$work/venv/bin/grctl" version)" = "grctl $version" ] &&
        [ "$("$work/venv/bin/python" -m grobo version)" = "grctl $version" ] &&
        "$work/venv/bin/grctl" -d sim play motions/greet.m &&
        echo 'import grobo, os; print(os.environ["GRCTL_GUARD"])' >"$work/guard.py" &&
        [ "$(env -u PYTHONPATH -u GRCTL_GUARD "$work/venv/bin/python" "$work/guard.py")" = \
            "$(echo "$work"/venv/lib/python3*/site-packages/grobo/grctl)" ]
}

# of_system PROCESSOR LIBRARY COMMAND: what the wheel holds is of that system.
of_system() {
    rm -rf "$work/open"
    python3 -m zipfile -e "$(tail -n 1 "$work/name-$1")" "$work/open" &&
        file "$work/open/grobo/$2" "$work/open/grobo/$3" >"$work/kind" || return 1
    cat "$work/kind"
    case $1 in
    macos) [ "$(grep -c 'Mach-O 64-bit arm64' "$work/kind")" -eq 2 ] ;;
    win64) [ "$(grep -c 'PE32+ .*x86-64' "$work/kind")" -eq 2 ] ;;
    esac
}

# LeRobot finds it by the name of its distribution, and imports that.
plugin() {
    cp -R tools/python/lerobot_robot_grobo "$work/plugin" &&
        "$work/venv/bin/pip" install -q --disable-pip-version-check --no-deps \
            --ignore-requires-python "$work/plugin" || return 1
    cat >"$work/found.py" <<'P'
import importlib, importlib.metadata
for found in importlib.metadata.distributions():
    if found.metadata["Name"].startswith("lerobot_robot_"):
        print(importlib.import_module(found.metadata["Name"]).Grobo.name)
P
    [ "$(env PYTHONPATH=tests/package/python/lerobot_stand_in "$work/venv/bin/python" \
        "$work/found.py")" = grobo ]
}

version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
for processor in ${PROCESSORS:-x86_64 aarch64 macos win64}; do
    test_case "a wheel for $processor"
    check "$processor: made" made "$processor"
    case $processor in
    macos)
        check "$processor: of that system" of_system macos libgrobo.1.dylib grctl
        continue
        ;;
    win64)
        check "$processor: of that system" of_system win64 grobo.dll grctl.exe
        continue
        ;;
    esac
    check "$processor: shows the names of the map alone" hides_the_rest "$processor"
    if [ "$processor" = "$(uname -m)" ]; then
        check "$processor: the same again" same_again "$processor"
        check "$processor: installed" installs "$processor"
        check "$processor: plays a motion" plays
        check "$processor: opens a serial line" opens
        check "$processor: its grctl" commands
        check "$processor: the plugin for LeRobot is found" plugin
    else
        check "$processor: of that machine" machine "$processor" \
            "$(echo "$processor" | sed 's/_/-/')"
    fi
done
done_testing
