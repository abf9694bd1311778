# SPDX-License-Identifier: MIT
# For shell tests: `. tests/support/tap.sh`, and at the end `done_testing`. Between them named
# tests, each with its steps:
#
#     test_case 'a motion plays to its end'
#     check 'it is sent' exits 0 "$GRCTL" play motions/greet.pseq
#     check 'and told' says '^played'
#
# A test whose step fails has failed, and later steps are tried all the same. One of which a step
# was left out is skipped. Steps before the first test_case are a test that is called after the
# file.

tap_count=0 # tests told
tap_case=${0##*/}
tap_case=${tap_case%.sh}
tap_begun= # by test_case
tap_steps=0
tap_bad=
tap_missing=
tap_failed=

# test_case NAME: begins a test; the one before has ended.
test_case() {
    tell_case
    tap_case=$1
    tap_begun=yes
    echo "# ---- $1"
}

# test_that NAME COMMAND...: a test of one step.
test_that() {
    test_case "$1"
    check "$@"
}

tell_case() {
    [ -n "$tap_begun" ] || [ $tap_steps -gt 0 ] || return 0
    tap_count=$((tap_count + 1))
    if [ $tap_steps -eq 0 ]; then
        echo '# FAILED: it has no step'
        tap_bad=yes
    fi
    if [ -n "$tap_bad" ]; then
        echo "not ok $tap_count - $tap_case"
        tap_failed=yes
    elif [ -n "$tap_missing" ]; then
        echo "ok $tap_count - $tap_case # SKIP $tap_case: $tap_missing"
    else
        echo "ok $tap_count - $tap_case"
    fi
    tap_steps=0
    tap_bad=
    tap_missing=
}

# Why a target leaves a step out: $LEFT_OUT is a file of lines SCRIPT|STEP|REASON.
left_out() {
    [ -n "${LEFT_OUT:-}" ] || return 0
    tap_script=${0##*/} tap_check=$1 awk -F '|' \
        '$1 == ENVIRON["tap_script"] && $2 == ENVIRON["tap_check"] { print $3 }' "$LEFT_OUT"
}

# check NAME COMMAND...: a step, which passes when the command succeeds; what it printed is shown
# when it fails.
check() {
    tap_name=$1
    shift
    tap_reason=$(left_out "$tap_name")
    if [ -n "$tap_reason" ]; then
        skip "$tap_name" "$tap_reason"
        return
    fi
    tap_steps=$((tap_steps + 1))
    if tap_output=$("$@" 2>&1); then
        echo "# well: $tap_name"
    else
        echo "# FAILED: $tap_name"
        printf '%s\n' "$tap_output" | sed 's/^/#   /'
        tap_bad=yes
    fi
}

# skip NAME REASON: a step that cannot be tried here.
skip() {
    tap_steps=$((tap_steps + 1))
    echo "# left out: $1: $2"
    case "; $tap_missing;" in
    *"; $2;"*) ;;
    *) tap_missing=${tap_missing:+$tap_missing; }$2 ;;
    esac
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

# As the script's last command it makes the script's exit status.
done_testing() {
    tell_case
    tap_begun=
    echo "1..$tap_count"
    [ -z "$tap_failed" ]
}
