#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: motions, poses, robots of other kinds.
. tests/support/pages.sh

test_that "motions are listed, previewed, edited to the bit" pages motions
test_that "key poses are mirrored, feet moved, motions saved elsewhere" pages making
test_that "a motion that would fall says when" pages falls
test_that "feet and waist are dragged" pages ik
test_that "a motion of another robot says so, and is not played" pages other_motion
test_that "a robot that is no humanoid" pages other_robot
test_that "a joint that is not set up says why" pages not_set_up
done_testing
