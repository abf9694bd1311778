#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands of the guides on robots and servos of one's own do what these say.
. tests/support/guide.sh

guides_work "the commands of the guides on own robots and servos" docs/guide/own-robot.md \
    docs/guide/own-servo.md
done_testing
