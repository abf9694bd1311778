#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: a stop, whatever comes beside it, and until it is taken back.
. tests/support/pages.sh

test_that "a stop beside a move, a reset or a resume stands, whichever comes first" pages order
test_that "a stop is heard before there is a robot" pages first_of_all
test_that "a stop latches, is confirmed by each joint, is taken back" pages stopping
test_that "a stop for safety is confirmed by each joint" pages tripped
done_testing
