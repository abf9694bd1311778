# SPDX-License-Identifier: MIT
# For tests of the rate of servos: two on a bus, as all but the one that changes its rate are silent
# then, each for the whole time. Sourced behind cli.sh.

# said PATTERN: on standard error.
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}

cat >"$work/two.yaml" <<EOF2
name: two
family: rs30x
joints:
  - {name: turn, id: 2, servo: RS302CD, limits_deg: [-90, 90]}
  - {name: lift, id: 12, servo: RS302CD, limits_deg: [-90, 90]}
EOF2
on_bus() {
    "$GRCTL" -d "$robot" --robot "$work/two.yaml" --timeout 300 "$@"
}
# follows NAME: with --flash to the new rate, and back.
follows() {
    check "$1: with --flash the servo is followed" both \
        exits 0 on_bus servo-set 2 baud 460800 --flash --- \
        said '^servo 2: baud [57] (.*) -> 10 (460800 bps), kept in flash; it answers at 460800 bps$'
    check "$1: it is not at the old rate" fails 1 'no reply from servo 2' \
        on_bus servo-get 2 baud
    check "$1: it is where the command says" both exits 0 on_bus -b 460800 servo-get 2 baud --- \
        says '^  6  baud  *10  *460800 bps$'
    check_json "$1: and back" 'lines[0]["flash"] and lines[0]["baud_bps"] == 115200' \
        on_bus -b 460800 --json servo-set 2 baud 7 --flash
}

