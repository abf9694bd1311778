#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl doctor: a supply that servos are not made for.
. tests/support/cli.sh
. tests/support/doctor.sh

# supply_of ROBOT VOLTS MOST_V: what it comes with is right, and so many volts are too much.
supply_of() {
    test_case "$1"
    start_told_sim --robot "$1" || { echo "Bail out! the simulator did not start"; exit 1; }
    check "its own supply is right" wait_for exits 0 doctor --robot "$1"
    tell voltage "$2"
    check "more than it is made for is found" \
        finds "V at the servos: servo [0-9]* is made for $3 V at most" 'switch it off' --robot "$1"
    stop_sim
    exec 5>&-
}
supply_of so101 12 8.0
supply_of koch 20 14.0
supply_of openmanipulator-x 19 16.0
done_testing
