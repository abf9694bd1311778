#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl first-contact while a servo restarts at another rate: ended there, and lost there.
. tests/support/cli.sh
. tests/support/first_contact.sh

describe rs30x RS302CD >"$work/arm.yaml"

# A flash write and a restart take 1.5 s each way: what comes when its trace begins comes between.
start_told_sim --robot "$work/arm.yaml"
restarting() {
    printf 'n\nn\ny\n' >"$work/answers"
    rm -f "$work/restart"[-.]*
    "$GRCTL" --robot "$work/arm.yaml" -d "$robot" --timeout 200 first-contact --yes \
        -o "$work/restart" <"$work/answers" >"$work/out" 2>"$work/err" &
    restart_pid=$!
    wait_for in_flash
}
in_flash() {
    "$GRCTL" --robot "$work/arm.yaml" decode "$work/restart-rate_restart.pcapng" 2>/dev/null |
        grep -q flash
}
ended_in_flash() {
    restarting
    kill -TERM $restart_pid
    wait $restart_pid
    status_was 143 first-contact
}
test_case "ended while the rate is another one"
check "ended while the rate is another one" ended_in_flash
check "it is back first" both grep -q 'rate_restart .* again at 115200$' "$work/restart.txt" --- \
    both exits 0 "$GRCTL" --robot "$work/arm.yaml" -d "$robot" --timeout 500 servo-get 2 baud --- \
    says ' 115200 bps$'
lost_in_flash() {
    restarting
    tell cable 2 out
    wait $restart_pid
    status_was 1 first-contact
}
test_case "a robot that is lost at another rate"
check "one that is lost meanwhile" lost_in_flash
check "is told" said '^NOT as assumed  *rate_restart .* not back at 115200 bps'
check "and how it is found again" \
    [ "$(grep -c '^if the servo is lost: .* --all-baud --first 2 --last 2' "$work/err")" -eq 3 ]
tell cable 2 in
check "there it is" both wait_for exits 0 "$GRCTL" --robot "$work/arm.yaml" -d "$robot" \
    scan --all-baud --first 2 --last 2 --- says '^ *2 '
stop_sim
done_testing
