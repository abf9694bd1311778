#!/bin/sh
# SPDX-License-Identifier: MIT
# Plays a motion on a simulated GR001 behind a pty: demo.sh GRCTL MOTION [OPTIONS OF play]
set -eu
grctl=$1
motion=$2
shift 2
dir=$(mktemp -d)
sim=
cleanup() {
    [ -z "$sim" ] || kill "$sim" 2>/dev/null || true
    rm -rf "$dir"
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

mkfifo "$dir/ready"
# In the background of a script it has no ears for Ctrl-C: the robot outlives who plays on it.
"$grctl" --quiet sim --link "$dir/gr001" >"$dir/ready" &
sim=$!
# The simulator prints its path when it can be opened; nothing comes if it could not start.
read -r path <"$dir/ready" || { echo "demo: the simulator did not start" >&2; exit 1; }

echo "A simulated GR001 stands behind $path, paced at 115200 bps."
echo "Playing $motion:"
"$grctl" --device "$dir/gr001" --on-exit off play --table "$@" "$motion"
