#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: a lease that is given back while the robot moves.
. tests/support/pages.sh

test_that "a lease given back while it moves is as good as lost" pages given_back
done_testing
