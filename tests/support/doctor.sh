# SPDX-License-Identifier: MIT
# For tests of `grctl doctor`: what it finds. Sourced behind cli.sh.

doctor() {
    # On a busy machine the simulator answers late.
    "$GRCTL" -d "$robot" --timeout 100 doctor "$@"
}

# finds PATTERN FIX [OPTIONS]: exit status 1, a check that failed like that, and the line under it.
finds() {
    finds_message=$1
    finds_fix=$2
    shift 2
    exits 1 doctor "$@" || return 1
    grep -A 1 "^BAD .*$finds_message" "$work/out" | grep -q -e "-> .*$finds_fix" && return
    cat "$work/out"
    return 1
}
