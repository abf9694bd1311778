#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands of the guides on arms and on LeRobot do what these say, with an SO-101.
. tests/support/guide.sh

GRCTL_ROBOT=so101
export GRCTL_ROBOT
guides_work "the commands of the guides on arms" docs/guide/arm.md docs/guide/lerobot.md
done_testing
