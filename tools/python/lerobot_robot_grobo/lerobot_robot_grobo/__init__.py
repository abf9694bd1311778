# SPDX-License-Identifier: MIT
"""Any robot of libgrobo as a robot of LeRobot: --robot.type=grobo."""

from lerobot_robot_grobo.config_grobo import GroboConfig
from lerobot_robot_grobo.grobo import Grobo

__all__ = ["Grobo", "GroboConfig"]
