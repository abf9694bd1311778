#!/bin/sh
# SPDX-License-Identifier: MIT
# A cockpit that nobody looks at costs next to nothing, and is fresh again for who asks.
. tests/support/pages.sh

# What a process slept for and woke up from, so far: of Linux.
wakeups() {
    awk '/^voluntary_ctxt_switches/ { print $2 }' "/proc/$serve_pid/status"
}
# 30 a second is the tick of one that is looked at, and each reading wakes it more than once.
rests() {
    before=$(wakeups)
    sleep 1
    [ $(($(wakeups) - before)) -lt 20 ]
}
begin() {
    "$GRCTL" -d sim --physics on serve --port 0 motions >"$work/link" 2>"$work/said" &
    serve_pid=$!
    echo $serve_pid >>"$work/pids"
    written "$work/link" '#token=' && page=$(sed 's/#.*//' "$work/link")
}
end() {
    kill $serve_pid
    wait $serve_pid
}
# The oldest reading of the state that is answered now, in milliseconds, and its sequence.
asked() {
    python3 - "$page" <<'PY'
import json, sys, urllib.request
state = json.load(urllib.request.urlopen(sys.argv[1] + "api/state"))
print(max(state["age_ms"]), state["sequence"])
PY
}
is_fresh() {
    # shellcheck disable=SC2046 # two numbers
    set -- $(asked)
    [ "$1" -lt 1500 ]
}
comes_to_rest() {
    begin || return 1
    wait_for rests || { echo "$(wakeups) wakeups"; return 1; }
    # A state that is asked for is one that a request may be based on: it was told at once.
    # shellcheck disable=SC2046 # two numbers
    set -- $(asked) && first=$2 && set -- $(asked) && [ "$2" -ge "$first" ] &&
        wait_for is_fresh && wait_for rests
    rested=$?
    end
    return $rested
}
name="it comes to rest, is fresh for who asks, and comes to rest again"
if [ -r /proc/self/status ] && [ -z "${EMULATOR:-}${NATIVE_GRCTL:-}" ]; then
    test_that "$name" comes_to_rest
else
    test_case "$name"
    skip "$name" "not Linux"
fi
done_testing
