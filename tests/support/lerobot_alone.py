# SPDX-License-Identifier: MIT
"""LeRobot's motors and robots without torch: its packages ask for what only learning needs."""
import importlib.util
import sys
import types

# What they ask for without looking whether it is there, in LeRobot 0.4; in 0.6 it is torch alone.
OF_LEARNING = ("accelerate", "datasets", "datasets.utils", "datasets.utils.logging",
               "lerobot.processor")


class Absent(types.ModuleType):
    """Stands for a package that is not installed: its names are empty classes."""

    __path__: "list[str]" = []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


def import_alone():
    """Before the first import of lerobot; nothing where torch is installed."""
    if "torch" not in sys.modules and importlib.util.find_spec("torch") is None:
        looks = importlib.util.find_spec("lerobot.lerobot_types") is not None
        for name in ("torch", *(() if looks else OF_LEARNING)):
            sys.modules[name] = Absent(name)
