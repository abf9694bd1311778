# SPDX-License-Identifier: MIT
"""A robot of libgrobo with the interface of LeRobot's robots.

Observations and actions are degrees by "JOINT.pos", of a gripper 0..100 over its range. The thread of the library reads the joints;
get_observation() takes what was read last and never waits for the line. An action is clipped here:
near where each joint was read (max_relative_target), so that a policy that jumps does not throw the
arm, and to the limits. The library checks and times it as any target; what is returned is what was
sent. Between two actions nothing moves on: each ends at its own target.
"""

import math
from functools import cached_property
from typing import Any

import grobo
from lerobot.cameras import make_cameras_from_configs
from lerobot.robots import Robot
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

from lerobot_robot_grobo.config_grobo import GroboConfig
from lerobot_robot_grobo.scale import Scale


def most_relative(option: Any, joints: list[str]) -> dict[str, float]:
    """max_relative_target for each joint, in radians; inf: as far as its limits."""
    if option is None:
        return dict.fromkeys(joints, math.inf)
    each = option if isinstance(option, dict) else dict.fromkeys(joints, option)
    if set(each) != set(joints):
        odd = sorted(set(each) ^ set(joints))
        raise ValueError(f"max_relative_target has each joint or is one number: see {odd[0]!r}")
    for joint, degrees in each.items():
        number = isinstance(degrees, (int, float)) and not isinstance(degrees, bool)
        if not number or not 0 < degrees < math.inf:
            raise ValueError(
                f"max_relative_target of {joint} is {degrees!r}: degrees above 0, or None for all"
            )
    return {joint: math.radians(degrees) for joint, degrees in each.items()}


class Grobo(Robot):
    config_class = GroboConfig
    name = "grobo"

    def __init__(self, config: GroboConfig) -> None:
        self._robot: grobo.Robot | None = None  # before anything may fail: __del__ asks for it
        self.cameras: dict[str, Any] = {}
        super().__init__(config)
        self.config = config
        self._description = grobo.Description(config.robot)
        if config.on_exit.upper() not in grobo.Exit.__members__:
            raise ValueError(f"on_exit {config.on_exit!r}: default, hold, sit or off")
        self._exit = grobo.Exit[config.on_exit.upper()]
        self._most = most_relative(config.max_relative_target, self._description.joints)
        calibration = getattr(self, "calibration", {})
        self._scale = Scale(self._description, config.percent, calibration)
        self.cameras = make_cameras_from_configs(config.cameras) if config.cameras else {}

    # ---- what it has; also before it is connected --------------------------------------------

    @cached_property
    def action_features(self) -> dict[str, type]:
        return {f"{joint}.pos": float for joint in self._description.joints}

    @cached_property
    def observation_features(self) -> dict[str, Any]:
        features: dict[str, Any] = dict(self.action_features)
        for name, camera in self.cameras.items():
            if getattr(camera, "use_rgb", True):
                features[name] = (camera.height, camera.width, 3)
            if getattr(camera, "use_depth", False):
                features[f"{name}_depth"] = (camera.height, camera.width, 1)
        return features

    # ---- connecting --------------------------------------------------------------------------

    @property
    def is_connected(self) -> bool:
        return self._robot is not None and all(c.is_connected for c in self.cameras.values())

    def connect(self, calibrate: bool = True) -> None:
        """Opens the robot and switches torque on where it stands; nothing moves."""
        if self._robot is not None:
            raise DeviceAlreadyConnectedError(f"{self} is already connected")
        self._robot = grobo.Robot(
            self.config.port,
            robot=self._description,
            exit=self._exit,
            sense_interval=self.config.sense_s,
            reconnect=True,
        )
        try:
            for camera in self.cameras.values():
                camera.connect()
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
        """Nothing: `grctl calibrate` keeps the calibration in the servos, and reads LeRobot's
        files."""

    def configure(self) -> None:
        """Torque comes on with each goal at the present angle."""
        robot = self._connected()
        robot.torque(True)
        robot.angles()

    def disconnect(self) -> None:
        """Carries out the exit policy and closes."""
        robot, self._robot = self._robot, None
        try:
            if robot is not None:
                robot.close()
        finally:
            for camera in self.cameras.values():
                if camera.is_connected:
                    camera.disconnect()

    # ---- each period -------------------------------------------------------------------------

    def get_observation(self) -> dict[str, Any]:
        seen: dict[str, Any] = {}
        for name, joint in self._connected().status().joints.items():
            seen[f"{name}.pos"] = self._scale.shown(joint, self._present(joint))
        for name, camera in self.cameras.items():
            if getattr(camera, "use_rgb", True):
                seen[name] = camera.read_latest()
            if getattr(camera, "use_depth", False):
                seen[f"{name}_depth"] = camera.read_latest_depth()
        return seen

    def send_action(self, action: dict[str, Any]) -> dict[str, Any]:
        robot = self._connected()
        limits = self._description.limits
        read = robot.status().joints
        target = {}
        for key, shown in action.items():
            joint = key.removesuffix(".pos")
            if joint == key or joint not in limits:
                raise KeyError(f"{self} has no {key!r}")
            if not math.isfinite(float(shown)):
                raise ValueError(f"{self}: {key} is {shown}")
            angle = self._scale.angle(read[joint], float(shown))
            most = self._most[joint]
            if most < math.inf:
                present = self._present(read[joint])
                angle = min(max(angle, present - most), present + most)
            low, high = limits[joint]
            ends = read[joint].range or (low, high)
            low, high = max(low, ends[0]), min(high, ends[1])
            target[joint] = min(max(angle, low), high)
        robot.send(target, time=self.config.action_s)
        return {
            f"{joint}.pos": self._scale.shown(read[joint], angle) for joint, angle in target.items()
        }

    def _present(self, joint: grobo.JointStatus) -> float:
        """Where a joint was read, in radians."""
        if joint.angle is None or joint.age is None or joint.age > self.config.stale_s:
            raise TimeoutError(f"{self}: {joint.name} was not read for {self.config.stale_s:g} s")
        return joint.angle

    def _connected(self) -> grobo.Robot:
        if self._robot is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        return self._robot
