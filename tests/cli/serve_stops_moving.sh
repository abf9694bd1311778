#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: a stop of what moves, beside readings and streams that take their time.
. tests/support/pages.sh

test_that "a stop on the way of a move, a jog, an approach" pages on_the_way
test_that "a stop beside streams that stand still" pages latency
done_testing
