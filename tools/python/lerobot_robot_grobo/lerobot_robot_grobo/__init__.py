# SPDX-License-Identifier: MIT
"""Any robot of libgrobo as a robot of LeRobot, --robot.type=grobo, and as a leader that a hand
moves, --teleop.type=grobo_leader."""

from lerobot_robot_grobo.config_grobo import GroboConfig, GroboLeaderConfig
from lerobot_robot_grobo.grobo import Grobo
from lerobot_robot_grobo.grobo_leader import GroboLeader

__all__ = ["Grobo", "GroboConfig", "GroboLeader", "GroboLeaderConfig"]
