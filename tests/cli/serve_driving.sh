#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: who drives, what a stop does, what becomes of a page that is lost.
. tests/support/pages.sh

check "move, play, pause, seek, speed, queue, limp, capture" pages driving
check "a name is told as it was given, or cut at a character" pages names
check "what is based on an old state is refused" pages stale
check "a body that is not as it should be is refused, and names what is" pages fields
check "what was held up on its way acts on no newer situation" pages delayed
check "a stop beside a move, a reset or a resume stands, whichever comes first" pages order
check "a stop is carried out whatever its body is" pages unreadable
check "a stop is heard before there is a robot" pages first_of_all
check "a stop latches, is confirmed by each joint, is taken back" pages stopping
check "a stop for safety is confirmed by each joint" pages tripped
check "a stop on the way of a move, a jog, an approach" pages on_the_way
check "a stop beside streams that stand still" pages latency
check "jogging stops when the page is silent" pages lost_in_jog
check "a motion whose page is lost does what was declared" pages lost_in_motion
check "a lease given back while it moves is as good as lost" pages given_back
check "a page that is killed is lost" pages killed
check "the lease is asked for, refused, given, taken" pages takeover
check "a server that ends leaves the robot as the exit policy says" pages left

done_testing
