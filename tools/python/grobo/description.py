# SPDX-License-Identifier: MIT
"""What a robot is made of: one that comes with the library, or a file."""

import itertools
import os
from typing import Any, Dict, List, Optional, Tuple, Union

from grobo._lib import ffi, lib
from grobo.errors import check, error


def joints_of(model: Any) -> List[Any]:
    """The joints of a model, whatever version of the library made it."""
    return [lib.grobo_model_joint(model, j) for j in range(model.n_joints)]


class Description:
    """A robot's joints, servos, line and limits.

    `name`: a robot of the library ("gr001", "so101"), or a file where it has a slash or a dot, as
    for grctl --robot.

    >>> arm = Description("so101")
    >>> arm.joints[:2]
    ['shoulder_pan', 'shoulder_lift']
    >>> low, high = arm.limits["gripper"]
    >>> low < high
    True
    """

    def __init__(self, name: Union[str, "os.PathLike[str]"] = "gr001") -> None:
        text = os.fspath(name)
        self._place = text  # by which a guard finds it
        shipped = isinstance(name, str) and not set(text) & {"/", os.sep, "."}
        self._c = _shipped(text) if shipped else _read(text)
        self.model = self._c.model
        self._driver = ffi.new("grobo_driver *")
        self._driver.size = ffi.sizeof("grobo_driver")
        self._sim = ffi.new("grobo_robot_sim *")
        check(lib.grobo_robot_def_driver(self._c, self._c.wiring, self._driver), text)
        check(lib.grobo_robot_def_sim(self._c, self._c.wiring, self._sim), text)

    @property
    def name(self) -> str:
        """What the command line calls it."""
        name: str = ffi.string(self._c.name).decode()
        return name

    @property
    def joints(self) -> List[str]:
        """Names of joints, in the order that lists of angles have."""
        return [ffi.string(joint.name).decode() for joint in joints_of(self.model)]

    @property
    def units(self) -> Dict[str, str]:
        """What each joint is given in: "deg", "mm" of a linear one, "%" of a gripper with a range."""
        return {
            name: ffi.string(lib.grobo_unit_name(lib.grobo_model_unit(self.model, j))).decode()
            for j, name in enumerate(self.joints)
        }

    @property
    def limits(self) -> Dict[str, Tuple[float, float]]:
        """The range of each joint in radians."""
        return {
            name: (float(joint.min_rad), float(joint.max_rad))
            for name, joint in zip(self.joints, joints_of(self.model))
        }

    @property
    def _guarded_by(self) -> bytes:
        """How the guard's program, in a folder of its own, finds this robot."""
        shipped = not set(self._place) & {"/", os.sep, "."}
        return os.fsencode(self._place if shipped else os.path.abspath(self._place)) + b"\0"

    def configure(self, session: Any) -> None:
        """Has a session talk to this robot, which must live as long as it."""
        session.driver = self._driver
        session.sim = ffi.addressof(self._sim, "config")
        session.baud_bps = self._c.baud_bps


def _shipped(name: str) -> Any:
    names, n = [], 0
    while (known := lib.grobo_robot_def_at(n)) != ffi.NULL:
        names.append(ffi.string(known.name).decode())
        if names[-1] == name:
            return known
        n += 1
    raise error(lib.GROBO_ERR_NOTFOUND, f"robot {name!r}", reason=", ".join(names))


def _read(path: str) -> Any:
    problems = ffi.new("grobo_diagnostics **")
    check(lib.grobo_diagnostics_new(ffi.NULL, problems), path)
    found = ffi.gc(problems[0], lib.grobo_diagnostics_free)
    made = ffi.new("grobo_robot_def **")
    result = lib.grobo_robot_def_read_file(os.fsencode(path), found, ffi.NULL, made)
    if result < 0:
        raise error(result, path, reason=first_error(found, path))
    return ffi.gc(made[0], lib.grobo_robot_def_free)


def first_error(found: Any, path: str = "") -> Optional[str]:
    """What is wrong and where: with its file where that is not `path`, as of a servo beside it."""
    problem = ffi.new("grobo_diagnostic *")
    for i in itertools.count():
        if lib.grobo_diagnostics_get(found, i, problem) < 0:
            return None
        if problem.severity == lib.GROBO_SEVERITY_ERROR:
            text: str = ffi.string(problem.message).decode()
            file = os.fsdecode(ffi.string(problem.file))
            place = f"{file}, " if path and file not in ("", path) else ""
            return f"{place}line {problem.line}: {text}" if problem.line else f"{place}{text}"
    return None
