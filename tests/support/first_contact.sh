# SPDX-License-Identifier: MIT
# For tests of `grctl first-contact`: answers to its questions, and what it reported. Sourced behind
# cli.sh.

unset GRCTL_ROBOT
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}
# contact STATUS ANSWERS PREFIX ARGUMENTS...: lines of standard input, \n between them.
contact() {
    contact_want=$1
    printf '%b' "$2" >"$work/answers"
    contact_out=$work/$3
    shift 3
    "$GRCTL" "$@" first-contact --yes -o "$contact_out" \
        <"$work/answers" >"$work/out" 2>"$work/err"
    status_was "$contact_want" "$@"
}
# calmly ANSWERS PREFIX ...: nothing is otherwise than assumed. On a machine that is busy half of
# the replies may be late, or the command itself: once more then.
calmly() {
    for _ in 1 2 3 4 5 6; do
        contact 0 "$@" >"$work/why" && return
        grep -q -e '^NOT as assumed  *\(latency\|line\) ' \
            -e 'stopped for safety: host stalled' "$work/err" || break
        rm -f "$work/$2"[-.]*
    done
    cat "$work/why" "$work/err"
    return 1
}
# Where each family is assumed to answer: at once at the new rate, RS30x when they restart.
rates_of() {
    there='set to \([0-9]*\) bps, answers at \1, and again at'
    here='set to [0-9]* bps, answers at 115200, and again at 115200$'
    case $1 in
    rs30x)
        grep -q "^as assumed  *rate  .*$here" "$2" &&
            grep -q "^as assumed  *rate_restart  .*$there 115200$" "$2"
        ;;
    lx16a) grep -q '^not done  *rate  .*one rate$' "$2" ;;
    dynamixel2) grep -q "^as assumed  *rate  .*$there 57600$" "$2" ;;
    ics) grep -q "^as assumed  *rate  .*$there 115200$" "$2" ;;
    *) grep -q "^as assumed  *rate  .*$there 1000000$" "$2" ;;
    esac || { cat "$2"; return 1; }
}
describe() {
    printf 'name: t\nfamily: %s\njoints:\n' "$1"
    printf '  - {name: turn, id: 1, servo: %s, limits_deg: [-90, 90]}\n' "$2"
    printf '  - {name: lift, id: 2, servo: %s, limits_deg: [-20, 60], init_deg: 59}\n' "$2"
}

