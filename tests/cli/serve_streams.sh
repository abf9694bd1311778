#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: streams, and a stop that comes through whatever else is connected.
. tests/support/pages.sh

test_that "states come 30 times a second, events are kept" pages stream
test_that "a stream that sends something is dropped" pages greedy
test_that "a stream that does not read is dropped, the others miss nothing" pages slow
test_that "a stop comes through where all places are taken" pages crowd
test_that "a stop comes through where connections stay half open" pages half_open
test_that "a stop comes through where another page holds all places" pages foreign
done_testing
