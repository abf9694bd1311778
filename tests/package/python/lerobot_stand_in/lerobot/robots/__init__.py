# SPDX-License-Identifier: MIT
import abc
import dataclasses
import importlib


@dataclasses.dataclass(kw_only=True)
class RobotConfig:
    id: "str | None" = None
    calibration_dir: "object" = None

    known = {}

    @classmethod
    def register_subclass(cls, name):
        def register(subclass):
            cls.known[name] = subclass
            return subclass

        return register


class Robot(abc.ABC):  # noqa: B024 (as theirs)
    def __init__(self, config):
        self.robot_type = self.name
        self.id = config.id

    def __str__(self):
        return f"{self.id} {type(self).__name__}"

    def __enter__(self):
        self.connect()
        return self

    def __exit__(self, *_):
        self.disconnect()

    def __del__(self):
        try:
            if self.is_connected:
                self.disconnect()
        except Exception:
            pass


for member in ("observation_features", "action_features", "is_connected", "is_calibrated"):
    setattr(Robot, member, property(abc.abstractmethod(lambda self: None)))
for member in ("connect", "calibrate", "configure", "get_observation", "send_action", "disconnect"):
    setattr(Robot, member, abc.abstractmethod(lambda self: None))
abc.update_abstractmethods(Robot)


def make_robot_from_config(config):
    """The class whose name is the config's without Config, in the package of the config's module."""
    package = type(config).__module__.rpartition(".")[0]
    name = type(config).__name__
    assert name.endswith("Config")
    return getattr(importlib.import_module(package), name[: -len("Config")])(config)
