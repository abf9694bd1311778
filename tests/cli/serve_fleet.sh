#!/bin/sh
# SPDX-License-Identifier: MIT
# The view of a fleet, over a real broker with agents of simulated robots. Its clients are those of
# tests/support/fleet_view.py.
. tests/support/pages.sh

fleet() {
    PYTHONPATH=tests/support python3 -B tests/support/fleet_view.py "$1"
}

reason=$(PYTHONPATH=tests/support python3 -B -c \
    'import fleet_view; print(fleet_view.is_possible() or "")') || exit 1
if [ -n "$reason" ]; then
    echo "1..0 # SKIP $reason"
    exit
fi

test_that "robots are shown, who goes is seen to go" fleet shown
test_that "a stop of all stands, is told robot by robot, is released" fleet stopping
test_that "a stop is heard before there is a broker" fleet first_of_all
test_that "a stop while the broker is away goes out when it is back" fleet broker_away
test_that "hosts, origins and tokens are judged as elsewhere" fleet walls
test_that "what strangers say is bounded" fleet strangers
test_case "what is answered is what the OpenAPI file tells"
if python3 -c 'import jsonschema' 2>/dev/null; then
    check "what is answered is what the OpenAPI file tells" fleet schema
else
    skip "what is answered is what the OpenAPI file tells" "no python3-jsonschema"
fi

done_testing
