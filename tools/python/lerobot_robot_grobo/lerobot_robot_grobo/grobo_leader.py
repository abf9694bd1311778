# SPDX-License-Identifier: MIT
"""A robot of libgrobo that a hand moves, with the interface of LeRobot's teleoperators.

Its torque is off, and stays off: an arm falls, hold it. An action is what the thread of the library
read last, in the units of Grobo's actions.
"""

from functools import cached_property
from typing import Any

import grobo
from lerobot.teleoperators import Teleoperator
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

from lerobot_robot_grobo.config_grobo import GroboLeaderConfig
from lerobot_robot_grobo.scale import Scale


class GroboLeader(Teleoperator):
    config_class = GroboLeaderConfig
    name = "grobo_leader"

    def __init__(self, config: GroboLeaderConfig) -> None:
        self._robot: grobo.Robot | None = None  # before anything may fail: __del__ asks for it
        super().__init__(config)
        self.config = config
        self._description = grobo.Description(config.robot)
        calibration = getattr(self, "calibration", {})
        self._scale = Scale(self._description, config.percent, calibration)

    @cached_property
    def action_features(self) -> dict[str, type]:
        return {f"{joint}.pos": float for joint in self._description.joints}

    @property
    def feedback_features(self) -> dict[str, type]:
        return {}

    @property
    def is_connected(self) -> bool:
        return self._robot is not None

    def connect(self, calibrate: bool = True) -> None:
        """Opens the robot and switches its torque off: hold it."""
        if self._robot is not None:
            raise DeviceAlreadyConnectedError(f"{self} is already connected")
        self._robot = grobo.Robot(
            self.config.port,
            robot=self._description,
            exit=grobo.Exit.OFF,
            sense_interval=self.config.sense_s,
            reconnect=True,
        )
        try:
            self.configure()
        except BaseException:
            self.disconnect()
            raise

    @property
    def is_calibrated(self) -> bool:
        """Whether each joint was read, and its servo is set up and calibrated as it needs it."""
        return self._robot is not None and all(
            joint.ready for joint in self._robot.status().joints.values()
        )

    def calibrate(self) -> None:
        """Nothing: `grctl calibrate` keeps the calibration in the servos."""

    def configure(self) -> None:
        robot = self._connected()
        robot.torque(False)
        robot.angles()

    def get_action(self) -> dict[str, Any]:
        action = {}
        for name, joint in self._connected().status().joints.items():
            if joint.angle is None or joint.age is None or joint.age > self.config.stale_s:
                raise TimeoutError(f"{self}: {name} was not read for {self.config.stale_s:g} s")
            action[f"{name}.pos"] = self._scale.shown(joint, joint.angle)
        return action

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        if feedback:
            raise NotImplementedError(f"{self} has no feedback")

    def disconnect(self) -> None:
        robot, self._robot = self._robot, None
        if robot is not None:
            robot.close()

    def _connected(self) -> grobo.Robot:
        if self._robot is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        return self._robot
