#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: a stop is carried out whatever its body is.
. tests/support/pages.sh

test_that "a stop is carried out whatever its body is" pages unreadable
done_testing
