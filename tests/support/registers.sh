# SPDX-License-Identifier: MIT
# For tests of the registers of servos: the last command said a line, a robot of some family, a
# servo whose power goes and comes. Sourced behind cli.sh.

said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}
# of ROBOT COMMAND...
of() {
    of_robot=$1
    shift
    "$GRCTL" --robot "$of_robot" -d "$robot" --timeout 200 "$@"
}
# restarted ID: its power goes and comes.
restarted() {
    tell cable "$1" out
    tell cable "$1" in
}

