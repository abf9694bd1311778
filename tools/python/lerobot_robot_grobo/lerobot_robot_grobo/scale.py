# SPDX-License-Identifier: MIT
"""Angles as LeRobot has them: degrees, mm of linear joints, and 0..100 over its range where a joint
is a gripper."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import grobo
from grobo._lib import lib

TICKS = 4096  # of a turn, of the servos of LeRobot's arms; their middle is 2048


class Scale:
    """For each joint degrees, or the ends of its range in radians: those of LeRobot's calibration;
    else those that its servo keeps; else the limits of the robot's file."""

    def __init__(
        self, robot: grobo.Description, percent: Iterable[str], calibration: Mapping[str, Any]
    ) -> None:
        # What a robot's file gives a unit keeps that; percent of a file is percent here.
        self._number = {
            name: j for j, name in enumerate(robot.joints) if robot.units[name] != "deg"
        }
        self._model = robot.model
        self._percent = (set(percent) & set(robot.joints)) - set(self._number)
        self._limits = robot.limits
        mounted = dict(zip(robot.joints, grobo.description.joints_of(robot.model)))
        self._of_file = {
            name: (self._of_ticks(one.range_min), self._of_ticks(one.range_max))
            for name, one in calibration.items()
            if name in self._percent
            and one.range_min < one.range_max
            and self._is_plain(mounted[name])
        }

    @staticmethod
    def _is_plain(joint: Any) -> bool:
        """Whether the angle of the joint is that of its servo."""
        return joint.sign in (0, 1) and joint.gear in (0, 1) and joint.zero_rad == 0

    @staticmethod
    def _of_ticks(ticks: int) -> float:
        return (ticks - TICKS // 2) * 2 * math.pi / TICKS

    def ends(self, joint: grobo.JointStatus) -> tuple[float, float]:
        low, high = self._limits[joint.name]
        if joint.name in self._of_file:
            return self._of_file[joint.name]
        if joint.range is not None and joint.range[0] < high and joint.range[1] > low:
            return max(low, joint.range[0]), min(high, joint.range[1])
        return low, high

    def shown(self, joint: grobo.JointStatus, angle: float) -> float:
        if joint.name in self._number:
            number = self._number[joint.name]
            return float(lib.grobo_model_value(self._model, number, angle))
        if joint.name not in self._percent:
            return math.degrees(angle)
        low, high = self.ends(joint)
        return min(max((angle - low) / (high - low), 0.0), 1.0) * 100

    def angle(self, joint: grobo.JointStatus, shown: float) -> float:
        if joint.name in self._number:
            return float(lib.grobo_model_angle(self._model, self._number[joint.name], shown))
        if joint.name not in self._percent:
            return math.radians(shown)
        low, high = self.ends(joint)
        return low + min(max(shown / 100, 0.0), 1.0) * (high - low)
