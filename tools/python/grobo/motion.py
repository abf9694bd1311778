# SPDX-License-Identifier: MIT
"""Postures and motions. Arrays are numpy's where numpy is installed, else lists."""

import importlib
import math
import os
from html import escape
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from grobo._lib import ffi, lib, new, us
from grobo.description import Description, first_error
from grobo.errors import check, error

numpy: Any = None
try:
    numpy = importlib.import_module("numpy")
except ImportError:
    pass

KINDS = ("postures", "keys", "steps", "frames")
EXTENSIONS = (".m", ".pseq", ".mseq", ".yaml", ".yml", ".seq")
DEFAULT_STEP = 0.25  # GROBO_MOTION_DEFAULT_US
MOST_STEP = 10.0  # GROBO_MOTION_STEP_MAX_US


def _array(rows: List[Any]) -> Any:
    return rows if numpy is None else numpy.array(rows, dtype=float)


def joint_names(model: Any) -> List[str]:
    return [ffi.string(lib.grobo_model_joint(model, j).name).decode() for j in range(model.n_joints)]


GR001 = lib.grobo_gr001_model()


class Posture(Mapping[str, float]):
    """Angles in radians by joint name; joints that it does not set are not in it."""

    def __init__(self, struct: Any, model: Any = None) -> None:
        self._struct = struct
        self._names = joint_names(model or GR001)

    @property
    def time(self) -> float:
        """Seconds to reach it; 0: the default time."""
        return int(self._struct.time_us) / 1e6

    @property
    def degrees(self) -> Dict[str, float]:
        """The same in degrees, by joint name."""
        return {name: math.degrees(angle) for name, angle in self.items()}

    @property
    def angles(self) -> Any:
        """By joint order; NaN where it is not set."""
        return _array(
            [
                self._struct.angle_rad[j] if self._struct.set >> j & 1 else math.nan
                for j in range(self._struct.n_joints)
            ]
        )

    def __getitem__(self, name: str) -> float:
        joint = self._names.index(name) if name in self._names else -1
        if joint < 0 or not self._struct.set >> joint & 1:
            raise KeyError(name)
        return float(self._struct.angle_rad[joint])

    def __iter__(self) -> Iterator[str]:
        return (n for j, n in enumerate(self._names) if self._struct.set >> j & 1)

    def __len__(self) -> int:
        return bin(self._struct.set).count("1")

    def __repr__(self) -> str:
        return f"Posture({ {n: round(a, 4) for n, a in self.items()} }, time={self.time})"


def posture(
    angles: Union[Mapping[str, float], Sequence[float]], time: Optional[float], model: Any,
    joints: Optional[int] = None,
) -> Any:
    """A C posture of names and angles, or of all angles in joint order (NaN: not set).

    A list that is too short is refused: the angles are perhaps those of other joints. `joints`:
    how many there are, without it those of the model.
    """
    names = joint_names(model)
    joints = len(names) if joints is None else joints
    made = ffi.new("grobo_posture *")
    check(lib.grobo_posture_init(made, joints), "posture")
    made.time_us = _time_us(time)
    if not isinstance(angles, Mapping):
        if len(angles) != joints:
            raise ValueError(
                f"{len(angles)} angles for {joints} joints: a list has one for each joint (NaN: "
                "not set); a dict names joints"
            )
        for joint, angle in enumerate(angles):
            if not math.isnan(angle):
                result = lib.grobo_posture_set_rad(made, joint, angle)
                if result < 0:
                    raise error(result, "posture", (names + [None] * joints)[joint])
        return made
    for name, angle in angles.items():
        if name not in names:
            raise error(lib.GROBO_ERR_NOTFOUND, "joint", name)
        result = lib.grobo_posture_set_rad(made, names.index(name), angle)
        if result < 0:
            raise error(result, "posture", name)
    return made


def init_pose(time: Optional[float], model: Any) -> Any:
    """The model's initial posture, as a C posture."""
    made = ffi.new("grobo_posture *")
    lib.grobo_posture_init_pose(made, model)
    made.time_us = _time_us(time)
    return made


def _time_us(time: Optional[float]) -> int:
    """Of a posture; 0: the default time."""
    if time is not None and time < 0:
        raise error(lib.GROBO_ERR_ARG, "time")
    return us(time) if time is not None else 0


def _check_steps(times: Sequence[float], kind: str) -> None:
    """Any other step would be taken for the default time."""
    before = 0.0
    for n, time in enumerate(map(float, times)):
        if (n > 0 or time != 0) and not 0 < time - before < MOST_STEP:
            raise ValueError(
                f"times[{n}] is {time:g} after {before:g}; {kind} rise by more than 0 and less "
                f"than {MOST_STEP:g} s (kind='keys' takes any)"
            )
        before = time


STILL_RAD = 1e-3  # a joint that moves less is not drawn
MOST_ROWS = 400  # points of a line that is drawn: more are not seen


def _plot(lines: Sequence[Tuple[str, Sequence[Tuple[float, float]]]], length: float) -> str:
    """Lines over time in one picture, SVG; degrees, as people read them."""
    if not lines or length <= 0:
        return "<p>no joint moves</p>"
    width, height = 640, 240
    angles = [math.degrees(a) for _, points in lines for _, a in points]
    low, high = min(angles), max(angles)
    drawn = []
    for n, (name, points) in enumerate(lines):
        color = f"hsl({360 * n // len(lines)}, 70%, 40%)"
        step = -(-len(points) // MOST_ROWS)
        path = " ".join(
            f"{t / length * width:.1f},{(high - math.degrees(a)) / (high - low) * height:.1f}"
            for t, a in [*points[::step], points[-1]]
        )
        drawn.append(
            f'<polyline fill="none" stroke="{color}" points="{path}">'
            f"<title>{escape(name)}</title></polyline>"
        )
    names = ", ".join(escape(name) for name, _ in lines)
    return (
        f'<svg width="{width}" height="{height}" viewBox="0 -4 {width} {height + 8}">'
        f"{''.join(drawn)}</svg><p>{low:.1f} to {high:.1f} deg in {length:g} s: {names}</p>"
    )


class Motion:
    """A motion in memory: postures, each reached some time after the one before."""

    def __init__(
        self, kind: str = "postures", joints: Optional[int] = None, _owned: Any = None,
        _model: Any = None
    ) -> None:
        self._model = _model or GR001
        if _owned is None:
            if kind not in KINDS[:-1]:
                raise ValueError(f"kind {kind!r}: {', '.join(KINDS[:-1])}; frames are read of files")
            made = ffi.new("grobo_motion **")
            joints = self._model.n_joints if joints is None else joints
            check(lib.grobo_motion_new(KINDS.index(kind), joints, ffi.NULL, made), "motion")
            _owned = made[0]
        self._c = ffi.gc(_owned, lib.grobo_motion_free)
        self._robot: Optional[Description] = None  # whose model it is

    @classmethod
    def load(
        cls, path: Union[str, "os.PathLike[str]"], robot: Optional[Description] = None
    ) -> "Motion":
        """Reads .m, .pseq, .mseq, .yaml or .seq; for anything wrong names the line.

        `robot`: whose joints the file names; without one GR001.
        """
        made = ffi.new("grobo_motion **")
        problems = ffi.new("grobo_diagnostics **")
        check(lib.grobo_diagnostics_new(ffi.NULL, problems), "motion")
        found = ffi.gc(problems[0], lib.grobo_diagnostics_free)
        options = new("grobo_read_options")
        model = options.model = robot.model if robot else GR001
        name = os.fspath(path)
        result = lib.grobo_motion_read_file(os.fsencode(name), options, found, made)
        if result < 0:
            raise error(result, name, reason=first_error(found))
        motion = cls(_owned=made[0], _model=model)
        motion._robot = robot
        return motion

    @classmethod
    def of(
        cls, times: Sequence[float], angles: Sequence[Sequence[float]], kind: str = "postures",
        robot: Optional[Description] = None,
    ) -> "Motion":
        """A motion of arrays: `times` in seconds from the beginning, not falling, and for each a
        row of angles in radians by joint order (NaN: this posture does not set the joint).

        Postures and steps rise from time to time by less than 10 s, as their files have no other
        steps.

        All rows have as many angles as `robot` has joints, or without one as each other.

        >>> wave = Motion.of([0, 1, 2], [[0.0, 0.0], [0.5, 0.0], [0.0, 0.0]])
        >>> wave
        <Motion of 3 postures, 2 s>
        >>> [float(at) for at in wave.times]
        [0.0, 1.0, 2.0]
        >>> wave.crop(0.5, 1.5).length
        1.0
        >>> wave.reverse()[1].angles[0] == wave[1].angles[0]
        True
        >>> Motion.of([0, 1], [[0.0]])
        Traceback (most recent call last):
        ValueError: 2 times for 1 postures
        """
        if len(times) != len(angles):
            raise ValueError(f"{len(times)} times for {len(angles)} postures")
        if any(isinstance(row, Mapping) for row in angles):
            raise TypeError("rows are angles by joint order; append() takes angles by name")
        if kind in ("postures", "steps"):
            _check_steps(times, kind)
        if robot:
            motion = cls(kind, _model=robot.model)
            motion._robot = robot
        else:
            motion = cls(kind, max((len(row) for row in angles), default=0))
        before = 0.0
        for time, row in zip(times, angles):
            motion.append(row, float(time) - before)
            before = float(time)
        return motion

    def append(self, angles: Union[Mapping[str, float], Sequence[float]], time: float) -> None:
        """Appends a posture that is reached `time` seconds after the last one.

        >>> nod = Motion()
        >>> nod.append({"NECK_Y": 0.2}, 0.5)
        >>> nod[0]["NECK_Y"], nod[0].time
        (0.2, 0.5)
        >>> "R_ELBOW_P" in nod[0]
        False
        """
        made = posture(angles, time, self._model, self.joints)
        check(lib.grobo_motion_append(self._c, made), "append")

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the file whose format its extension names: .m, .pseq, .mseq, .yaml (.yml) or
        .seq."""
        options = new("grobo_write_options")
        options.model = self._model
        name = os.fspath(path)
        if not os.fsdecode(name).lower().endswith(EXTENSIONS):
            raise ValueError(f"{name}: a motion file ends in {', '.join(EXTENSIONS)}")
        result = lib.grobo_motion_save(
            self._c, lib.grobo_files_os(), os.fsencode(name), options, ffi.NULL
        )
        check(result, name)

    @property
    def kind(self) -> str:
        """One of "postures", "steps", "keys" and "frames"."""
        return KINDS[lib.grobo_motion_get_kind(self._c)]

    @property
    def joints(self) -> int:
        """How many joints its postures have."""
        return int(lib.grobo_motion_joints(self._c))

    @property
    def length(self) -> float:
        """Seconds until the last posture is reached."""
        return int(lib.grobo_motion_length_us(self._c, -1)) / 1e6

    @property
    def times(self) -> Any:
        """When each posture is reached, in seconds from the beginning."""
        reached, now = [], 0.0
        steps = self.kind in ("postures", "steps")
        at = ffi.new("double *")
        for n, one in enumerate(self):
            begins = n == 0 and lib.grobo_motion_time_s(self._c, 0, at) == 0 and at[0] == 0
            waits = steps and not begins and one.time == 0  # a step without a time: the default
            now += DEFAULT_STEP if waits else one.time
            reached.append(now)
        return _array(reached)

    @property
    def angles(self) -> Any:
        """Radians, a row for each posture and a column for each joint; NaN where it is not set."""
        return _array([list(one.angles) for one in self])

    def mirror(self) -> "Motion":
        """A copy with left and right exchanged."""
        copy = self.copy()
        check(lib.grobo_motion_mirror(copy._c, self._model), "mirror")
        return copy

    def reverse(self) -> "Motion":
        """A copy that runs backwards."""
        copy = self.copy()
        check(lib.grobo_motion_reverse(copy._c), "reverse")
        return copy

    def crop(self, begin: float, end: float) -> "Motion":
        """A copy of what lies between two times."""
        copy = self.copy()
        check(lib.grobo_motion_crop(copy._c, us(begin), us(end)), "crop")
        return copy

    def copy(self) -> "Motion":
        """Another one with the same postures."""
        made = ffi.new("grobo_motion **")
        check(lib.grobo_motion_dup(self._c, made), "copy")
        copy = Motion(_owned=made[0], _model=self._model)
        copy._robot = self._robot
        return copy

    def __len__(self) -> int:
        return int(lib.grobo_motion_size(self._c))

    def __getitem__(self, n: int) -> Posture:
        n += len(self) if n < 0 else 0
        made = ffi.new("grobo_posture *")
        if n < 0 or lib.grobo_motion_get(self._c, n, made) < 0:
            raise IndexError(f"posture {n} of {len(self)}")
        return Posture(made, self._model)

    def __iter__(self) -> Iterator[Posture]:
        return (self[n] for n in range(len(self)))

    def __repr__(self) -> str:
        return f"<Motion of {len(self)} {self.kind}, {self.length:g} s>"

    def _repr_html_(self) -> str:
        """A notebook shows what moves: a line for each joint that changes its angle."""
        rows = [list(one.angles) for one in self]
        times = [float(time) for time in self.times]
        lines = []
        for j, name in enumerate(joint_names(self._model)[: self.joints]):
            points = [(t, row[j]) for t, row in zip(times, rows) if row[j] == row[j]]
            if points and max(a for _, a in points) - min(a for _, a in points) > STILL_RAD:
                lines.append((name, points))
        return f"<p>{escape(repr(self))}</p>" + _plot(lines, self.length)
