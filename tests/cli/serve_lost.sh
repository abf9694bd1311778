#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: what moves where its page is lost.
. tests/support/pages.sh

test_that "jogging stops when the page is silent" pages lost_in_jog
test_that "a motion whose page is lost does what was declared" pages lost_in_motion
done_testing
