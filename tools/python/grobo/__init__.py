# SPDX-License-Identifier: MIT
"""Robots made of serial command servos.

>>> import grobo
>>> with grobo.connect("sim") as robot:
...     robot.init()
...     robot.move({"R_ELBOW_P": -0.8}, time=0.6)

Angles are radians, times are seconds. A thread of the library runs the robot; no Python code runs
there, so a busy interpreter delays nothing that moves.
"""

from grobo._lib import version
from grobo.description import Description
from grobo.errors import Error
from grobo.motion import Motion, Posture
from grobo.robot import Exit, Joint, JointStatus, Robot, Status, Torque, connect

__version__ = version()
__all__ = [
    "Description",
    "Error",
    "Exit",
    "Joint",
    "JointStatus",
    "Motion",
    "Posture",
    "Robot",
    "Status",
    "Torque",
    "connect",
    "version",
]
