# SPDX-License-Identifier: MIT
import abc
import dataclasses


@dataclasses.dataclass(kw_only=True)
class TeleoperatorConfig:
    id: "str | None" = None
    calibration_dir: "object" = None

    known = {}

    @classmethod
    def register_subclass(cls, name):
        def register(subclass):
            cls.known[name] = subclass
            return subclass

        return register


class Teleoperator(abc.ABC):  # noqa: B024 (as theirs)
    def __init__(self, config):
        self.id = config.id
        self.calibration = {}

    def __str__(self):
        return f"{self.id} {type(self).__name__}"


for member in ("action_features", "feedback_features", "is_connected", "is_calibrated"):
    setattr(Teleoperator, member, property(abc.abstractmethod(lambda self: None)))
for member in ("connect", "calibrate", "configure", "get_action", "send_feedback", "disconnect"):
    setattr(Teleoperator, member, abc.abstractmethod(lambda self: None))
abc.update_abstractmethods(Teleoperator)
