# SPDX-License-Identifier: MIT
# For shell tests: `. tests/support/tap.sh`, `check NAME COMMAND...`, and at the end `done_testing`.

tap_count=0

# Why a target leaves a check out: $LEFT_OUT is a file of lines SCRIPT|CHECK|REASON.
left_out() {
    [ -n "${LEFT_OUT:-}" ] || return 0
    tap_script=${0##*/} tap_check=$1 awk -F '|' \
        '$1 == ENVIRON["tap_script"] && $2 == ENVIRON["tap_check"] { print $3 }' "$LEFT_OUT"
}

# Passes when the command succeeds; what it printed is shown when it fails.
check() {
    tap_name=$1
    shift
    tap_reason=$(left_out "$tap_name")
    if [ -n "$tap_reason" ]; then
        skip "$tap_name" "$tap_name: $tap_reason"
        return
    fi
    tap_count=$((tap_count + 1))
    if tap_output=$("$@" 2>&1); then
        echo "ok $tap_count - $tap_name"
    else
        echo "not ok $tap_count - $tap_name"
        printf '%s\n' "$tap_output" | sed 's/^/# /'
    fi
}

skip() {
    tap_count=$((tap_count + 1))
    echo "ok $tap_count - $1 # SKIP $2"
}

# wait_for COMMAND...: until it succeeds; half a minute at least, longer where each try takes long.
# The pause is for what is waited for: it may need the processor. One wait_for may stand in another.
wait_for() (
    left=1000
    until "$@" >/dev/null 2>&1; do
        left=$((left - 1))
        [ $left -gt 0 ] || return 1
        sleep 0.03
    done
)

done_testing() {
    echo "1..$tap_count"
}
