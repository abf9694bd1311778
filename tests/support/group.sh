# SPDX-License-Identifier: MIT
# For tests of groups of robots: three simulators, a, b and c, of the group stage.
# Sourced behind cli.sh.

mkdir -p "$work/config/grctl"
config=$work/config/grctl/config.yaml

# simulates NAME: a simulator behind $work/NAME; $pid is its process.
simulates() {
    "$GRCTL" sim --link "$work/$1" >"$work/$1.out" 2>"$work/$1.err" &
    pid=$!
    echo "$pid" >>"$work/pids"
    wait_for test -e "$work/$1"
}
if ! "$GRCTL" sim --help | grep -q -e --link; then
    echo "1..0 # SKIP the simulator has no pseudo-terminals here"
    exit 0
fi
simulates a && simulates b && simulates c || { echo "Bail out! no simulator"; exit 1; }
pid_c=$pid

cat >"$config" <<EOF2
groups: {stage: [a, b, c], pair: [a, b], ghosts: [a, nobody]}
robots:
  a: {device: $work/a}
  b: {device: $work/b}
  c: {device: $work/c}
EOF2

each_says() {
    grep -q "^a: .*$1" "$work/$2" && grep -q "^b: .*$1" "$work/$2" && grep -q "^c: .*$1" "$work/$2"
}
