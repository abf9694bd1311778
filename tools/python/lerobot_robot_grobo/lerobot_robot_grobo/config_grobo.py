# SPDX-License-Identifier: MIT
"""The options of --robot.type=grobo."""

from dataclasses import dataclass, field

from lerobot.cameras import CameraConfig
from lerobot.robots import RobotConfig
from lerobot.teleoperators import TeleoperatorConfig


@RobotConfig.register_subclass("grobo")
@dataclass(kw_only=True)
class GroboConfig(RobotConfig):
    # A serial port, "tcp:HOST:PORT", "sim", or "auto".
    port: str = "auto"
    # A robot of the library ("so101"), or a robot file where it has a slash or a dot.
    robot: str = "so101"
    # What the servos do at the end: "hold", "sit", "off", or "default", the robot's own.
    on_exit: str = "default"
    # How far an action may take a joint from where it was read, in degrees: for all joints, or for
    # each by its name. None: as far as its limits.
    max_relative_target: float | dict[str, float] | None = 10.0
    # Joints that are 0..100 over their range, as LeRobot has its grippers; the others are degrees.
    percent: tuple[str, ...] = ("gripper",)
    # Seconds in which an action is reached: a little more than a period of LeRobot's loop.
    action_s: float = 0.05
    # Seconds between two readings of all joints, as far as the line allows.
    sense_s: float = 0.02
    # Seconds after which a reading is too old to be an observation.
    stale_s: float = 0.5
    cameras: dict[str, CameraConfig] = field(default_factory=dict)


@TeleoperatorConfig.register_subclass("grobo_leader")
@dataclass(kw_only=True)
class GroboLeaderConfig(TeleoperatorConfig):
    # As those of GroboConfig.
    port: str = "auto"
    robot: str = "so101-leader"
    percent: tuple[str, ...] = ("gripper",)
    sense_s: float = 0.01
    stale_s: float = 0.5
