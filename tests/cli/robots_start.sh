#!/bin/sh
# SPDX-License-Identifier: MIT
# Every robot that is built in, an own file of each kind of servo, wheels and robots of several
# lines, starts monitor, status,
# doctor, info, joints, plot, show, check, budget and serve, on a terminal and piped: the documented
# status, and no joint of another robot on the screen.
. tests/support/cli.sh

if ! have_json; then
    echo "1..0 # SKIP no python3 for a terminal"
    exit
fi
if [ -n "${NATIVE_GRCTL:-}" ]; then
    echo "1..0 # SKIP a pseudo-terminal is no console of Windows"
    exit
fi
if "$GRCTL" -d sim serve nowhere 2>&1 | grep -q 'without evhttp'; then
    echo "1..0 # SKIP this grctl has no evhttp"
    exit
fi

mkdir "$work/robots"
python3 tests/support/robots_start.py "$GRCTL" "$work/robots" >"$work/said" 2>"$work/why" ||
    cat "$work/why" >>"$work/said"
started() {
    grep -q -x -e "ok $1" "$work/said" || { cat "$work/said"; return 1; }
}
for name in $("$GRCTL" robot list | sed 's/ .*//') own-STS3215.yaml own-SM8512BL.yaml \
    own-HLS3930.yaml own-SCS0009.yaml own-XL430-W250.yaml own-XL-320.yaml \
    own-PH42-020-S300-R.yaml own-H54-200-S500-R.yaml own-AX-12A.yaml own-MX-28.yaml \
    own-LX-16A.yaml own-KRS-3301.yaml own-RS304MD.yaml one.yaml all64.yaml rover.yaml \
    two-arms.yaml ax-body-xl330-head.yaml; do
    test_that "$name starts every command" started "$name"
done
done_testing
