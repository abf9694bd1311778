#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the libraries that `make bench` measures ours beside, below a folder: nothing of them
# reaches the system.
#
# usage: tests/bench/peers.sh FOLDER
set -u

mkdir -p "$1"
cd "$1" || exit 1

# Those of a distribution, unpacked where no package manager knows of them.
for name in libmodbus5 libyaml-cpp0.7 libyaml-cpp-dev; do
    if [ -e "$name.there" ]; then
        continue
    fi
    if ! command -v apt-get >/dev/null || ! apt-get -q download "$name" >/dev/null 2>&1; then
        echo "bench-peers: $name: no such package here; its cells will be empty" >&2
        continue
    fi
    dpkg -x "$name"_*.deb . && rm "$name"_*.deb && touch "$name.there"
done

# Those of PyPI.
python3 -m venv python || exit 1
for name in pyserial==3.5 dynamixel-sdk==4.1.0 rustypot==1.13.1; do
    python/bin/pip install -q --disable-pip-version-check "$name" ||
        echo "bench-peers: $name: cannot be installed; its cells will be empty" >&2
done
