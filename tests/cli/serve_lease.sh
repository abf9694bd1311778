#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: who drives, a page or a server that ends.
. tests/support/pages.sh

test_that "a page that is killed is lost" pages killed
test_that "the lease is asked for, refused, given, taken" pages takeover
test_that "a server that ends leaves the robot as the exit policy says" pages left
done_testing
