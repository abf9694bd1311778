# SPDX-License-Identifier: MIT
"""A robot, with verbs that return when they are done."""

import atexit
import enum
import logging
import math
import os
import threading
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from time import monotonic, sleep
from types import TracebackType
from typing import (
    Any, Callable, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Set, Tuple, Type, Union,
)

from grobo import errors
from grobo._lib import ffi, has, lib, new, quick, us
from grobo.description import Description
from grobo.motion import Motion, Posture, init_pose, posture

log = logging.getLogger("grobo")

_STAND_SECONDS = 5.0  # in which wheels that are led to rest were read to stand
SLICE = 0.1  # seconds of one wait in C, so that Ctrl-C is heard
Angles = Union[Mapping[str, float], Sequence[float]]


class Torque(enum.IntEnum):
    OFF = lib.GROBO_TORQUE_OFF
    ON = lib.GROBO_TORQUE_ON
    BRAKE = lib.GROBO_TORQUE_BRAKE


class Exit(enum.IntEnum):
    """What the servos do when the robot is closed."""

    DEFAULT = lib.GROBO_EXIT_DEFAULT
    OFF = lib.GROBO_EXIT_OFF
    HOLD = lib.GROBO_EXIT_HOLD
    SIT = lib.GROBO_EXIT_SIT


@dataclass(frozen=True)
class JointStatus:
    """One joint as the library knows it; None: never read."""

    name: str
    angle: Optional[float]
    age: Optional[float]
    target: Optional[float]
    torque: Optional[Torque]
    temperature_c: Optional[int]
    current_ma: Optional[int]
    voltage_mv: Optional[int]
    ready: Optional[bool] = None
    """False: its servo is not set up as its joint needs it, or was never calibrated."""
    range: Optional[Tuple[float, float]] = None
    """How far a calibrated joint goes, as its servo keeps it, in radians."""
    value: Optional[float] = None
    """Where it is in its unit."""
    unit: str = "deg"
    """What it is given in: "deg", "mm" of a linear joint, "%" of a gripper with a range."""
    speed: Optional[float] = None
    """As its servo tells it, in radians a second."""

    @property
    def degrees(self) -> Optional[float]:
        """`angle` in degrees; None where it was not read."""
        return None if self.angle is None else math.degrees(self.angle)


@dataclass(frozen=True)
class Status:
    """The robot at one moment."""

    connected: bool
    moving: bool
    playing: bool
    latched: bool
    trip: Optional[str]
    joints: Mapping[str, JointStatus]


def _start_guard(device: str) -> Any:
    """A process that stops the robot if this one dies; NULL where there is none, which is logged."""
    made = ffi.new("grobo_guard **")
    if device == "sim" or not has("grobo_guard_new"):
        return ffi.NULL
    config = new("grobo_guard_config")
    program = ffi.NULL
    if os.environ.get("GRCTL_GUARD"):
        program = ffi.new("char[]", os.fsencode(os.environ["GRCTL_GUARD"]))
    config.program = program
    result = lib.grobo_guard_new(config, made)
    if result == lib.GROBO_ERR_UNSUPPORTED:
        return ffi.NULL
    if result < 0:
        reason = errors.error(result, "guard")
        log.warning("%s: no guard (%s): if Python is killed, joints go on to their targets; install "
                    "grctl, or name it in GRCTL_GUARD", device, reason)
        return ffi.NULL
    return made[0]


class _Runner:
    """The C side, and what must live as long as it."""

    def __init__(self, config: Any, keep: List[Any]) -> None:
        made = ffi.new("grobo_runner **")
        self.guard = config.session.guard
        result = lib.grobo_runner_new(config, made)
        if result < 0:
            self.free_guard()
        errors.check(result, "robot")
        self.leaves = not config.skip_exit
        self.handle = made[0]
        self.robot = lib.grobo_runner_robot(self.handle)
        self.keep = keep
        self.process = os.getpid()
        self.lock = threading.RLock()  # not of Python code, where Ctrl-C would leave it locked
        self.idle = threading.Condition(self.lock)
        self.users: Set[object] = set()
        self.closing = False
        self.dropped = False  # its robot was collected, not closed
        _open.add(self)

    @contextmanager
    def use(self) -> Iterator[Any]:
        """The handle, which is not freed meanwhile."""
        if self.process != os.getpid():
            raise errors.error(lib.GROBO_ERR_STATE, "robot of a parent process")
        user = object()
        try:
            if not self.closing:  # its lock is held for as long as an exit takes
                with self.lock:
                    self.users.add(user)
            if self.closing:
                raise errors.error(lib.GROBO_ERR_CLOSED, "robot")
            yield self.handle
        finally:
            with self.lock:
                self.users.discard(user)
                if self.closing:
                    self.idle.notify_all()

    def close(self) -> int:
        """Where Ctrl-C ends it, the next one goes on."""
        if self.process != os.getpid():
            return 0
        with self.lock:
            self.closing = True
            while self.users:
                self.idle.wait(SLICE)  # Ctrl-C may have ended the one that would notify
            if not self.handle:
                return 0
            result: int = lib.grobo_runner_close(self.handle, 0)
            handle, self.handle = self.handle, ffi.NULL
            lib.grobo_runner_free(handle)
            self.free_guard()
            _open.discard(self)
            return result

    def free_guard(self) -> None:
        if self.guard != ffi.NULL:
            lib.grobo_guard_free(self.guard)
        self.guard = ffi.NULL


_open: Set[_Runner] = set()


@atexit.register
def _close_all(dropped: bool = False) -> None:
    for runner in list(_open):
        if runner.dropped or not dropped:
            runner.close()


@contextmanager
def _told_in_degrees(spoken: bool) -> Iterator[None]:
    """An angle that is refused is told in degrees where the caller spoke in degrees."""
    try:
        yield
    except errors.Error as error:
        if spoken and error.unit == "rad" and error.value is not None:
            error.value, error.unit = math.degrees(error.value), "deg"
            if error.limits is not None:
                low, high = error.limits
                error.limits = math.degrees(low), math.degrees(high)
        raise


class Joint:
    """One joint of a robot: robot["R_ELBOW_P"]."""

    def __init__(self, robot: "Robot", name: str) -> None:
        self._robot = robot
        self.name = name

    @property
    def status(self) -> JointStatus:
        """What is known of it, without asking: never waits."""
        return self._robot.status().joints[self.name]

    @property
    def angle(self) -> float:
        """Read now, in radians."""
        return self._robot.angles([self.name])[self.name]

    @property
    def deg(self) -> float:
        """`angle` in degrees."""
        return math.degrees(self.angle)

    @property
    def unit(self) -> str:
        """What its values are: "deg", "mm" or "%"."""
        return self._robot.description.units[self.name]

    @property
    def value(self) -> float:
        """Read now, in its unit."""
        number = self._robot._number(self.name)
        return float(lib.grobo_model_value(self._robot._model, number, self.angle))

    def move(
        self, angle: Optional[float] = None, *, deg: Optional[float] = None,
        value: Optional[float] = None, time: Optional[float] = None
    ) -> None:
        """To an angle in radians, to one in degrees, or to a value in its unit."""
        if (angle is None) + (deg is None) + (value is None) != 2:
            raise TypeError("move() takes an angle, deg= or value=")
        if value is not None:
            number = self._robot._number(self.name)
            angle = float(lib.grobo_model_angle(self._robot._model, number, value))
        target = {self.name: angle if angle is not None else math.radians(deg or 0.0)}
        with _told_in_degrees(deg is not None):
            self._robot.move(target, time=time)

    def torque(self, state: Union[bool, Torque]) -> None:
        """Torque of this joint: True or False, or a Torque. As Robot.torque()."""
        self._robot.torque(state, [self.name])


def _ask_for_realtime(config: Any, priority: Optional[int], cpus: Iterable[int]) -> None:
    """Fills the configuration's wish for the thread that talks to the robot."""
    mask = 0
    for cpu in cpus:
        if not 0 <= cpu < 64:
            raise ValueError(f"cpus: {cpu} is none of 0 to 63")
        mask |= 1 << cpu
    if priority is not None and not 1 <= priority <= 99:
        raise ValueError(f"realtime: {priority} is no priority of 1 to 99")
    if priority is None and not mask:
        return
    if not hasattr(config, "realtime"):
        raise errors.error(lib.GROBO_ERR_UNSUPPORTED, "realtime")
    config.realtime.cpus = mask
    if priority is not None:
        config.realtime.policy = lib.GROBO_REALTIME_FIFO
        config.realtime.priority = priority


class Robot:
    """A robot that is connected; close it, or use it in a `with` statement.

    `device`: a serial port, "tcp:HOST:PORT", "sim" (a simulator in this process), or "auto", the
    first port on which a robot answers. `robot`: what it is, see grobo.Description. `exit` says
    what the servos do when it is closed; None leaves them as they are. `owner_timeout`: after so
    many seconds without a call of this program the exit policy is carried out; 0: never.
    `reply_timeout`: how long a servo's reply is waited for, where a line is slower than its rate
    says; else as `grctl --timeout` has it. `events`: how many events are kept, see grobo.aio. `guard`: a process beside this one (the installed
    grctl, or $GRCTL_GUARD) that stops the joints when Python is killed or stopped. `realtime`: the
    priority, 1 to 99, of the thread that talks to the robot, before other programs, and `cpus` the
    CPUs that it may run on; `Error` where the system refuses (docs/guide/realtime.md).
    """

    def __init__(
        self,
        device: str = "auto",
        *,
        exit: Optional[Exit] = Exit.DEFAULT,
        timeout: float = 5.0,
        owner_timeout: float = 0.0,
        reconnect: bool = False,
        events: int = 0,
        robot: Union[str, "os.PathLike[str]", Description] = "gr001",
        sense_interval: Optional[float] = None,
        reply_timeout: Optional[float] = None,
        guard: bool = True,
        realtime: Optional[int] = None,
        cpus: Iterable[int] = (),
    ) -> None:
        _close_all(dropped=True)  # one of them may have the device
        if not isinstance(robot, Description):
            robot = Description(robot)
        self.description = robot
        config = new("grobo_runner_config")
        session = config.session
        if ffi.typeof(session).kind == "pointer":
            session = config.session = new("grobo_session_config")
        robot_config = new("grobo_robot_config")
        name = ffi.new("char[]", os.fsencode(device))
        session.device = name
        session.reconnect = reconnect
        session.robot = robot_config
        robot.configure(session)
        if sense_interval is not None:
            robot_config.sense_interval_us = us(sense_interval)
        if reply_timeout is not None:
            robot_config.timeout_us = us(reply_timeout)
        robot_config.on_exit = exit or Exit.DEFAULT
        config.skip_exit = exit is None
        config.timeout_us = us(timeout)
        config.owner_timeout_us = us(owner_timeout)
        _ask_for_realtime(config, realtime, cpus)
        if events:
            if not has("grobo_runner_next_event"):
                raise errors.error(lib.GROBO_ERR_UNSUPPORTED, "events")
            config.events = events
        self.device = device
        keep = [name, robot_config, session, robot]
        if guard:
            session.guard = _start_guard(device)
            found_by = ffi.new("char[]", robot._guarded_by)
            session.guard_data = found_by
            session.guard_bytes = len(robot._guarded_by)
            keep.append(found_by)
        self._runner = _Runner(config, keep)
        try:
            with self._runner.use() as runner:
                self.joints = robot.joints
                self._model = robot.model
                errors.check(lib.grobo_runner_start(runner), "runner's thread")
                result = lib.grobo_runner_connect(runner, us(timeout))
                if device == "auto" and result == lib.GROBO_ERR_NOTFOUND:
                    nobody = errors.error(result, "connect")
                    nobody.told = _NO_ADAPTER
                    raise nobody
                errors.check(result, device)
        except BaseException:
            self._runner.close()
            raise
        log.info("%s: connected, %d joints", device, len(self.joints))

    # ---- leaving ---------------------------------------------------------------------------

    def close(self) -> None:
        """Carries out the exit policy and closes. Any thread; a second time nothing happens."""
        was_open = not self._runner.closing
        result = self._runner.close()
        if was_open:
            log.info("%s: closed", self.device)
        errors.check(result, f"{self.device}: exit policy")

    def __repr__(self) -> str:
        state = "closed" if self._runner.closing else f"{len(self.joints)} joints"
        return f"<Robot on {self.device}, {state}>"

    def _repr_html_(self) -> str:
        """A notebook shows what is known of each joint; the robot is not asked."""
        head = f"<p>{escape(repr(self))}</p>"
        if self._runner.closing:
            return head
        try:
            status = self.status()
        except errors.Error as error:
            return f"{head}<p>{escape(str(error))}</p>"
        rows = []
        for name, one in status.joints.items():
            angle = "" if one.degrees is None else f"{one.degrees:.1f}"
            torque = "" if one.torque is None else one.torque.name.lower()
            heat = "" if one.temperature_c is None else f"{one.temperature_c}"
            cells = "".join(f"<td>{escape(cell)}</td>" for cell in (name, angle, torque, heat))
            rows.append(f"<tr>{cells}</tr>")
        stopped = f"<p>stopped: {escape(status.trip)}</p>" if status.trip else ""
        return (
            f"{head}{stopped}<table><tr><th>joint</th><th>deg</th><th>torque</th><th>\u00b0C</th>"
            f"</tr>{''.join(rows)}</table>"
        )

    def __enter__(self) -> "Robot":
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        try:
            self.close()
        except errors.Error:
            if kind is None:
                raise
            log.exception("%s: the exit policy failed", self.device)

    def __del__(self) -> None:
        runner = getattr(self, "_runner", None)
        if runner is not None and not runner.closing and runner.process == os.getpid():
            warnings.warn(f"robot {self.device} was not closed", ResourceWarning, 1, self)
            # Closed by the next robot, or at exit: this may be any thread, which must not wait here.
            runner.dropped = True
            if runner.leaves:
                lib.grobo_runner_post_exit(runner.handle, Exit.DEFAULT)

    # ---- asking ----------------------------------------------------------------------------

    def status(self) -> Status:
        """What is known, without asking the robot: never waits."""
        info = ffi.new("grobo_joint_info *")
        trip = ffi.new("grobo_trip_info *")
        joints: Dict[str, JointStatus] = {}
        with self._runner.use() as runner:
            robot = self._runner.robot
            for j, name in enumerate(self.joints):
                errors.check(quick("grobo_robot_joint", robot, j, info), name)
                joints[name] = _joint_status(name, info, self._model, j)
            quick("grobo_robot_tripped", robot, trip)
            return Status(
                connected=bool(quick("grobo_runner_is_connected", runner) & 1),
                moving=bool(quick("grobo_robot_moving", robot) & 1),
                playing=bool(quick("grobo_robot_is_playing", robot) & 1),
                latched=bool(quick("grobo_runner_is_latched", runner) & 1),
                trip=_trip_name(trip),
                joints=joints,
            )

    def angles(self, joints: Optional[Iterable[str]] = None) -> Dict[str, float]:
        """Reads joints now, in radians. Of all of them those that stay silent are missing, of a
        list the first silent one raises."""
        if joints is not None:
            angle = ffi.new("double *")
            read = {}
            for name in joints:
                with self._runner.use() as runner:
                    number = self._number(name)
                    result = lib.grobo_runner_read_angle(runner, number, angle, 0)
                    self._check(result, "read", name)
                read[name] = float(angle[0])
            return read
        made = ffi.new("grobo_posture *")
        with self._runner.use() as runner:
            self._check(lib.grobo_runner_read_posture(runner, made, 0), "read")
        return dict(Posture(made, self._model))

    def __getitem__(self, name: str) -> Joint:
        self._number(name)
        return Joint(self, name)

    # ---- moving ----------------------------------------------------------------------------

    def init(self, time: Optional[float] = None) -> None:
        """Moves to the initial posture."""
        target = init_pose(time, self._model)
        self._interruptible(lambda: self._wait_job(self._move(target), "init"))

    def move(self, angles: Angles, *, time: Optional[float] = None) -> None:
        """Moves joints: angles in radians by name, or of all joints in joint order (NaN: not this
        one); returns when they are there.

        `time`: seconds; without one as fast as the robot's default allows.
        """
        target = posture(angles, time, self._model)
        self._interruptible(lambda: self._wait_job(self._move(target), "move"))

    def _move(self, target: Any) -> int:
        with self._runner.use():
            return self._check(lib.grobo_robot_move(self._runner.robot, target), "move")

    def send(self, angles: Angles, *, time: float) -> None:
        """Sends a target and does not wait: for a control loop that calls this once a period.

        The target is checked as that of move(), and replaces one that still waits for the line.
        Joints must have torque, and have been read. `time`: seconds to get there, a little more than
        a period.
        """
        target = posture(angles, time, self._model)
        with self._runner.use():
            self._check(quick("grobo_robot_send", self._runner.robot, target), "send")

    @property
    def wheels(self) -> List[str]:
        """The joints that turn on and on: they have speeds, and go to no angle."""
        mask = lib.grobo_model_wheels(self._model)
        return [name for j, name in enumerate(self.joints) if mask >> j & 1]

    def drive(self, speeds: Mapping[str, float], *, time: Optional[float] = None) -> None:
        """Has wheels turn at speeds in radians a second, by name.

        Without `time` it returns at once, and the speeds hold for 0.5 s: for a loop that calls this
        several times a second. The wheels must have torque then, and have been read.
        `time`: torque comes on, the wheels turn for so many seconds and are led to rest; returns
        when they were read to stand.
        """
        mask, rad_s = 0, ffi.new("double[]", len(self.joints))
        for name, speed in speeds.items():
            number = self._number(name)
            mask |= 1 << number
            rad_s[number] = speed
        if time is None:
            self._drive(mask, rad_s)
        else:
            time_s = float(time)
            self.torque(True, list(speeds))
            self._interruptible(lambda: self._drive_for(mask, rad_s, time_s))

    def _drive(self, mask: int, rad_s: Any) -> None:
        with self._runner.use():
            self._check(lib.grobo_robot_drive(self._runner.robot, mask, rad_s), "drive")

    def _drive_for(self, mask: int, rad_s: Any, seconds: float) -> None:
        end = monotonic() + seconds
        while monotonic() < end:
            self._drive(mask, rad_s)
            sleep(min(SLICE, max(end - monotonic(), 0)))
        still = ffi.new("double[]", len(self.joints))
        while not self._stand(mask):
            if monotonic() > end + _STAND_SECONDS:
                raise errors.error(lib.GROBO_ERR_TIMEOUT, "drive")
            self._drive(mask, still)
            sleep(SLICE)

    def _stand(self, mask: int) -> bool:
        info = ffi.new("grobo_wheel_info *")
        with self._runner.use():
            for j in range(len(self.joints)):
                if mask >> j & 1:
                    self._check(lib.grobo_robot_wheel(self._runner.robot, j, info), "drive")
                    if not info.stands:
                        return False
        return True

    def play(
        self,
        motion: Union[Motion, str, "os.PathLike[str]"],
        *,
        speed: float = 1.0,
        repeat: int = 1,
        reverse: bool = False,
        mirror: bool = False,
        rate: Optional[int] = None,
    ) -> None:
        """Plays a motion or a motion file; returns when it has ended, raises what stopped it.

        `speed`: 0.01 to 10. `rate`: frames a second, 1 to 1000; without one a frame for each posture,
        and the servos fill the time.
        """

        def verb() -> None:
            self._begin(motion, speed, repeat, reverse, mirror, rate)
            self._await_play()

        self._interruptible(verb)

    def _begin(
        self,
        motion: Union[Motion, str, "os.PathLike[str]"],
        speed: float = 1.0,
        repeat: int = 1,
        reverse: bool = False,
        mirror: bool = False,
        rate: Optional[int] = None,
    ) -> None:
        if not isinstance(motion, Motion):
            motion = Motion.load(Path(motion), self.description)
        self._check_joints(motion)
        options = new("grobo_play_options")
        options.speed_pct = _within(round(speed * 100), lib.GROBO_PLAY_SPEED_MAX_PCT, "speed")
        options.mirror = mirror
        options.repeat = repeat
        options.reverse = reverse
        if rate is not None:
            options.mode = lib.GROBO_PLAY_RATE
            options.rate_hz = _within(rate, lib.GROBO_PLAY_RATE_MAX_HZ, "rate")
        if len(motion) == 0:
            reason = "the motion has no posture"
            raise errors.error(lib.GROBO_ERR_EMPTY, "play", reason=reason)
        with self._runner.use() as runner:
            self._check(lib.grobo_runner_set_motion(runner, motion._c), "play")
            self._check(lib.grobo_runner_play_motion(runner, options), "play")

    def _check_joints(self, motion: Motion) -> None:
        """The joints of a motion are those of the robot, and not the first of them by chance."""
        joints = self.joints
        if motion.joints != len(joints):
            raise ValueError(f"play: the motion has {motion.joints} joints, the robot {len(joints)}")
        if motion._robot and motion._robot.joints != joints:
            other = next(n for n in motion._robot.joints if n not in joints)
            raise ValueError(
                f"play: the motion is for {motion._robot.name}: the robot "
                f"({self.description.name}) has no joint {other}"
            )

    def _await_play(self) -> None:
        while True:
            with self._runner.use() as runner:
                result = lib.grobo_runner_wait(runner, us(SLICE))
                if result == lib.GROBO_ERR_PENDING:
                    continue
                self._check(result, "play")
                return

    def torque(
        self, state: Union[bool, Torque], joints: Optional[Iterable[str]] = None
    ) -> None:
        """Switches the torque of joints, all without a list, and reads it back."""
        mask = (1 << len(self.joints)) - 1
        if joints is not None:
            mask = sum(1 << self._number(name) for name in set(joints))
        if state not in tuple(Torque):
            raise ValueError(
                f"torque {state!r}: True, False, Torque.ON, Torque.OFF or Torque.BRAKE"
            )
        with self._runner.use() as runner:
            result = lib.grobo_runner_torque(runner, mask, int(state), 0)
            self._check(result, "torque")

    # ---- stopping --------------------------------------------------------------------------

    def stop(self, at_once: bool = False) -> None:
        """Ends what moves, smoothly; nothing happens where nothing moves. Any thread."""
        with self._runner.use() as runner:
            errors.check(lib.grobo_runner_post_stop(runner, at_once), "stop")

    def estop(self) -> None:
        """Emergency stop; the robot stays stopped until reset(). Any thread; never waits."""
        with self._runner.use() as runner:
            errors.check(lib.grobo_runner_estop(runner), "estop")
        log.warning("%s: emergency stop", self.device)

    def reset(self) -> None:
        """Releases a safety stop."""
        with self._runner.use() as runner:
            lib.grobo_runner_wait(runner, 0)  # until the stop has been carried out
            errors.check(lib.grobo_runner_reset(runner), "reset")

    # ---- inside ----------------------------------------------------------------------------

    def _number(self, name: str) -> int:
        if name not in self.joints:
            raise errors.error(lib.GROBO_ERR_NOTFOUND, "joint", name)
        return self.joints.index(name)

    def _interruptible(self, verb: Callable[[], None]) -> None:
        """Ctrl-C stops what it has begun."""
        try:
            verb()
        except KeyboardInterrupt:
            self.stop()
            raise

    def _wait_job(self, job: int, what: str) -> None:
        while True:
            with self._runner.use() as runner:
                result = lib.grobo_runner_wait_job(runner, job, us(SLICE))
                if result == lib.GROBO_ERR_PENDING:
                    continue
                self._check(result, what)
                return

    def _check(self, result: int, what: str, joint: Optional[str] = None) -> int:
        """The result, or its exception with joint and value where the library names them."""
        if result >= 0:
            return result
        value, reason, unit = None, None, None
        if result in (lib.GROBO_ERR_LIMIT, lib.GROBO_ERR_NAN):
            at = ffi.new("double *")
            number = lib.grobo_robot_fault(self._runner.robot, at)
            if number >= 0:
                joint, value = self.joints[number], float(at[0])
        elif result in (lib.GROBO_ERR_LATCHED, lib.GROBO_ERR_CANCELED):
            trip = ffi.new("grobo_trip_info *")
            lib.grobo_robot_tripped(self._runner.robot, trip)
            reason = _trip_name(trip)
            if reason and trip.latched:
                result = lib.GROBO_ERR_LATCHED  # what it has canceled is stopped as well
            if trip.joint >= 0 and reason:
                joint, value = self.joints[trip.joint], float(trip.value)
                unit = _TRIP_UNITS.get(trip.trip)
            if result == lib.GROBO_ERR_LATCHED and not reason:
                reason = "emergency stop"  # asked for, and not yet taken up by the runner's thread
        raised = errors.error(result, what, joint, value, reason)
        raised.unit = unit
        self._tell_angle(raised)
        raise raised

    def _tell_angle(self, error: errors.Error) -> None:
        """The library tells an angle that it refuses in degrees: here it is in radians, as angles
        are given, with its limits."""
        if error.code in (lib.GROBO_ERR_LIMIT, lib.GROBO_ERR_NAN) and error.value is not None:
            error.value, error.unit = math.radians(error.value), "rad"
            if error.joint in self.wheels:
                joint = lib.grobo_model_joint(self._model, self.joints.index(error.joint))
                error.unit = "rad/s"
                error.limits = (-joint.max_speed_rad_s, joint.max_speed_rad_s)
            elif error.code == lib.GROBO_ERR_LIMIT and error.joint in self.joints:
                error.limits = self.description.limits[error.joint]


_NO_ADAPTER = (
    "no robot answers on a serial port: plug its adapter in, or name the port; 'sim' is a simulator"
)

_TRIP_UNITS = {
    lib.GROBO_TRIP_TEMPERATURE: "°C",
    lib.GROBO_TRIP_OVERHEATED: "°C",
    lib.GROBO_TRIP_CURRENT: "mA",
    lib.GROBO_TRIP_VOLTAGE: "mV",
    lib.GROBO_TRIP_LIMIT: "deg",
    lib.GROBO_TRIP_HOST_STALL: "ms",
}


def _within(number: int, most: int, what: str) -> int:
    """An option that is 0 in C is the default there."""
    if not 1 <= number <= most:
        raise errors.error(lib.GROBO_ERR_ARG, what)
    return number


def _trip_name(trip: Any) -> Optional[str]:
    if trip.trip == lib.GROBO_TRIP_NONE:
        return None
    text: str = ffi.string(lib.grobo_trip_name(trip.trip)).decode()
    return text


def _joint_status(name: str, info: Any, model: Any, joint: int) -> JointStatus:
    state = info.state
    unit = ffi.string(lib.grobo_unit_name(lib.grobo_model_unit(model, joint))).decode()

    def known(bit: int, value: Any) -> Any:
        return value if state.valid & bit else None

    never = info.angle_age_us == 0x7FFFFFFFFFFFFFFF
    return JointStatus(
        name=name,
        angle=None if never else state.angle_rad,
        age=None if never else info.angle_age_us / 1e6,
        target=info.target_rad if info.has_target else None,
        torque=Torque(state.torque) if info.torque_known else None,
        temperature_c=known(lib.GROBO_FIELD_TEMPERATURE, state.temperature_c),
        current_ma=known(lib.GROBO_FIELD_CURRENT, state.current_ma),
        voltage_mv=known(lib.GROBO_FIELD_VOLTAGE, state.voltage_mv),
        ready=False if info.status == lib.GROBO_ERR_SETUP else None if never else True,
        range=known(lib.GROBO_FIELD_RANGE, (state.low_rad, state.high_rad)),
        value=None if never else lib.grobo_model_value(model, joint, state.angle_rad),
        unit=unit,
        speed=known(lib.GROBO_FIELD_SPEED, math.radians(state.speed_dps)),
    )


def connect(device: str = "auto", **options: Any) -> Robot:
    """Opens a robot: see Robot."""
    return Robot(device, **options)
