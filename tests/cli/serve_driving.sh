#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: moves and motions of the page that drives, and what is refused.
. tests/support/pages.sh

test_that "move, play, pause, seek, speed, queue, limp, capture" pages driving
test_that "a name is told as it was given, or cut at a character" pages names
test_that "what is based on an old state is refused" pages stale
test_that "a body that is not as it should be is refused, and names what is" pages fields
test_that "what was held up on its way acts on no newer situation" pages delayed
done_testing
