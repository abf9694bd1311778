# SPDX-License-Identifier: MIT
"""The same verbs for asyncio, and the robot's events.

>>> async with await grobo.aio.connect("sim") as robot:
...     await robot.move({"R_ELBOW_P": -0.8})
...     async for event in robot.events():
...         print(event)

The library keeps events in a ring and makes a descriptor readable; the loop of asyncio waits on
that. A task that is cancelled while the robot moves for it stops the robot smoothly.
"""

import asyncio
from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import Any, AsyncIterator, Dict, Iterable, List, Mapping, Optional, Type, Union

from grobo import errors
from grobo._lib import ffi, has, lib, new, quick, us
from grobo.motion import Motion, init_pose, posture
from grobo.robot import Angles, Exit, Status, Torque, log
from grobo.robot import Robot as _Blocking

EVENTS = 256  # kept for a loop that is late


@dataclass(frozen=True)
class Event:
    """Something that happened. `kind` is "job", "joint", "play", "trip", ... as the headers name
    them; of the line "line_up", "line_lost", "line_failed", "line_unguarded". `error` is the
    exception of what failed; `lost` counts the events that had to make way before this one."""

    kind: str
    job: Optional[int] = None
    joint: Optional[str] = None
    value: Optional[float] = None
    state: Optional[str] = None
    reason: Optional[str] = None
    error: Optional[errors.Error] = None
    lost: int = 0


def _word(kind: str, value: int, prefix: str) -> str:
    name: str = ffi.typeof(kind).elements[value]
    return name[len(prefix) :].lower()


class Robot:
    """A connected robot in an asyncio program; of connect()."""

    def __init__(self, robot: _Blocking) -> None:
        self._robot = robot
        # Moves that were joined have one job.
        self._jobs: Dict[int, List["asyncio.Future[int]"]] = {}
        self._readers: List["asyncio.Queue[Optional[Event]]"] = []
        self._event = new("grobo_runner_event")
        self._loop = asyncio.get_running_loop()
        with robot._runner.use() as runner:
            self._socket: int = quick("grobo_runner_event_socket", runner)
        self._loop.add_reader(self._socket, self._drain)

    @property
    def joints(self) -> List[str]:
        return self._robot.joints

    def status(self) -> Status:
        """As grobo.Robot.status(): never waits."""
        return self._robot.status()

    # ---- events ----------------------------------------------------------------------------

    async def events(self) -> AsyncIterator[Event]:
        """Everything that happens from its first turn on, until the robot is closed."""
        if self._robot._runner.closing:
            return
        queue: "asyncio.Queue[Optional[Event]]" = asyncio.Queue()
        self._readers.append(queue)
        try:
            while True:
                event = await queue.get()
                if event is None:
                    return
                yield event
        finally:
            if queue in self._readers:
                self._readers.remove(queue)

    def _drain(self) -> None:
        lost = 0
        with self._robot._runner.use() as runner:
            while quick("grobo_runner_next_event", runner, self._event) == 1:
                event = self._read(self._event)
                lost += event.lost
                for queue in self._readers:
                    queue.put_nowait(event)
                if event.job is not None:
                    self._end(event.job, event.error)
            for job in list(self._jobs) if lost else ():
                if not lib.grobo_robot_is_pending(self._robot._runner.robot, job):
                    result = lib.grobo_runner_wait_job(runner, job, 0)  # known: it has ended
                    self._end(job, errors.error(result, "move") if result < 0 else None)

    def _end(self, job: int, error: Optional[errors.Error]) -> None:
        for future in self._jobs.pop(job, []):
            if future.done():
                continue
            if error is not None:
                future.set_exception(error)
            else:
                future.set_result(0)

    def _read(self, c: Any) -> Event:
        lost = int(c.lost)
        if c.of_line:
            name = _word("grobo_session_event", c.line, "GROBO_SESSION_EVENT_")
            failed = errors.error(c.error, f"line {name}") if c.error < 0 else None
            return Event("line_" + name, error=failed, lost=lost)
        kind = _word("grobo_event_kind", c.event.kind, "GROBO_EVENT_")
        u = c.event.u
        if kind == "job":
            what = _word("grobo_job_kind", u.job.kind, "GROBO_JOB_")
            joint = self._name(u.job.joint)
            value = u.job.value or None
            failed = None
            if u.job.result < 0:
                failed = errors.error(u.job.result, what, joint, value)
                self._robot._tell_angle(failed)
            return Event(kind, u.job.number, joint, value, what, error=failed, lost=lost)
        if kind == "joint":
            joint = self._name(u.joint.joint)
            failed = errors.error(u.joint.result, "read", joint) if u.joint.result < 0 else None
            return Event(kind, joint=joint, error=failed, lost=lost)
        if kind == "play":
            state = _word("grobo_sequencer_state", u.play.to, "GROBO_SEQUENCER_")
            failed = errors.error(u.play.error, "play") if u.play.error < 0 else None
            return Event(kind, state=state, error=failed, lost=lost)
        if kind == "trip":
            reason = ffi.string(lib.grobo_trip_name(u.trip.trip)).decode()
            return Event(kind, joint=self._name(u.trip.joint), value=u.trip.value, reason=reason,
                         lost=lost)
        return Event(kind, lost=lost)

    def _name(self, joint: int) -> Optional[str]:
        return self._robot.joints[joint] if 0 <= joint < len(self._robot.joints) else None

    # ---- verbs -----------------------------------------------------------------------------

    async def init(self, time: Optional[float] = None) -> None:
        """Moves to the initial posture."""
        await self._moved(init_pose(time, self._robot._model))

    async def move(self, angles: Angles, *, time: Optional[float] = None) -> None:
        """Moves joints; several moves of different joints may be under way."""
        await self._moved(posture(angles, time, self._robot._model))

    def send(self, angles: Angles, *, time: float) -> None:
        """Sends a target of a control loop; does not wait: grobo.Robot.send()."""
        self._robot.send(angles, time=time)

    async def drive(self, speeds: Mapping[str, float], *, time: Optional[float] = None) -> None:
        """Has wheels turn: grobo.Robot.drive()."""
        if time is None:
            self._robot.drive(speeds)
        else:
            await self._moved_in_thread(self._robot.drive, speeds, time=time)

    async def _moved(self, target: Any) -> None:
        job = self._robot._move(target)
        future: "asyncio.Future[int]" = self._loop.create_future()
        self._jobs.setdefault(job, []).append(future)
        try:
            await future
        except asyncio.CancelledError:
            waiting = self._jobs.get(job, [])
            if future in waiting:
                waiting.remove(future)
            self._stop_unless_closing()
            await self._obeyed()
            raise

    async def _in_thread(self, function: Any, *args: Any) -> Any:
        return await self._loop.run_in_executor(None, function, *args)

    async def _moved_in_thread(self, function: Any, *args: Any, **options: Any) -> None:
        call = self._loop.run_in_executor(None, partial(function, *args, **options))
        try:
            await asyncio.shield(call)
        except asyncio.CancelledError:
            self._stop_unless_closing()
            await asyncio.wait([call])
            call.exception()
            self._stop_unless_closing()  # what it has begun meanwhile
            await self._obeyed()
            raise

    async def _obeyed(self) -> None:
        """Until a stop has been carried out: what is asked for after it is not for it to cancel."""

        def wait() -> None:
            with self._robot._runner.use() as runner:
                lib.grobo_runner_wait(runner, us(2.0))

        if not self._robot._runner.closing:
            try:
                await asyncio.shield(self._in_thread(wait))
            except errors.Error:
                pass  # it was closed meanwhile

    def _stop_unless_closing(self) -> None:
        if not self._robot._runner.closing:
            self._robot.stop()

    async def play(self, motion: Union[Motion, str], **options: Any) -> None:
        """Plays a motion: the options of grobo.Robot.play()."""
        await self._moved_in_thread(self._robot._begin, motion, **options)
        await self._moved_in_thread(self._robot._await_play)

    async def torque(
        self, state: Union[bool, Torque], joints: Optional[Iterable[str]] = None
    ) -> None:
        """Switches torque, and reads it back."""
        await self._in_thread(self._robot.torque, state, joints)

    async def angles(self, joints: Optional[Iterable[str]] = None) -> Dict[str, float]:
        """Reads joints now, in radians."""
        read: Dict[str, float] = await self._in_thread(self._robot.angles, joints)
        return read

    def stop(self, at_once: bool = False) -> None:
        """Ends what moves; does not wait."""
        self._robot.stop(at_once)

    def estop(self) -> None:
        """Emergency stop; does not wait."""
        self._robot.estop()

    async def reset(self) -> None:
        """Releases a safety stop."""
        await self._loop.run_in_executor(None, self._robot.reset)

    # ---- leaving ---------------------------------------------------------------------------

    async def close(self) -> None:
        """Carries out the exit policy and closes."""
        if self._robot._runner.closing:
            return
        self._loop.remove_reader(self._socket)
        try:
            await self._loop.run_in_executor(None, self._robot.close)
        finally:
            for job in list(self._jobs):
                self._end(job, errors.error(lib.GROBO_ERR_CLOSED, "robot"))
            for queue in self._readers:
                queue.put_nowait(None)

    async def __aenter__(self) -> "Robot":
        return self

    async def __aexit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        try:
            await self.close()
        except errors.Error:
            if kind is None:
                raise
            log.exception("%s: the exit policy failed", self._robot.device)


async def connect(
    device: str = "auto", *, exit: Optional[Exit] = Exit.DEFAULT, **options: Any
) -> Robot:
    """Opens a robot: the options of grobo.Robot."""
    if not has("grobo_runner_next_event"):
        raise errors.error(lib.GROBO_ERR_UNSUPPORTED, "asyncio needs the library's events")
    options.setdefault("events", EVENTS)
    loop = asyncio.get_running_loop()
    call = loop.run_in_executor(None, lambda: _Blocking(device, exit=exit, **options))
    try:
        return Robot(await asyncio.shield(call))
    except asyncio.CancelledError:
        await asyncio.wait([call])
        if call.exception() is None:
            await loop.run_in_executor(None, call.result().close)
        raise
