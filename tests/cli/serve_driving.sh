#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: who drives, what a stop does, what becomes of a page that is lost.
. tests/support/pages.sh

test_that "move, play, pause, seek, speed, queue, limp, capture" pages driving
test_that "a name is told as it was given, or cut at a character" pages names
test_that "what is based on an old state is refused" pages stale
test_that "a body that is not as it should be is refused, and names what is" pages fields
test_that "what was held up on its way acts on no newer situation" pages delayed
test_that "a stop beside a move, a reset or a resume stands, whichever comes first" pages order
test_that "a stop is carried out whatever its body is" pages unreadable
test_that "a stop is heard before there is a robot" pages first_of_all
test_that "a stop latches, is confirmed by each joint, is taken back" pages stopping
test_that "a stop for safety is confirmed by each joint" pages tripped
test_that "a stop on the way of a move, a jog, an approach" pages on_the_way
test_that "a stop beside streams that stand still" pages latency
test_that "jogging stops when the page is silent" pages lost_in_jog
test_that "a motion whose page is lost does what was declared" pages lost_in_motion
test_that "a lease given back while it moves is as good as lost" pages given_back
test_that "a page that is killed is lost" pages killed
test_that "the lease is asked for, refused, given, taken" pages takeover
test_that "a server that ends leaves the robot as the exit policy says" pages left

done_testing
