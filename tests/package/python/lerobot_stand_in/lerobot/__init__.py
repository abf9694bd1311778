# SPDX-License-Identifier: MIT
"""Stands for LeRobot 0.6 in the tests: what its documentation asks of a plugin (Bring Your Own
Hardware), without its dependencies. test_lerobot.py takes the real one where GROBO_LEROBOT=real."""
