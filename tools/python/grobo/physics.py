# SPDX-License-Identifier: MIT
"""A simulated robot whose body is MuJoCo's: it stands, falls, and meets what is around it.

    python -m grobo.physics MODEL.xml --robot gr001 --link /tmp/gr001

The servos are those of the library: their bytes, registers, position loops, motors and friction.
What they move is a body of an MJCF or URDF file, whose joints are called as the robot's. MuJoCo
is the wheel's extra `physics`.

Body is the body, Served a simulator behind a pseudo-terminal or TCP in real time, Virtual one with
the library's engine in virtual time.
"""

import argparse
import importlib
import math
import os
import signal
import sys
import traceback
from pathlib import Path
from types import TracebackType
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Type, Union

from grobo import errors
from grobo._film import Film
from grobo._lib import ffi, lib, new, us
from grobo.description import Description
from grobo.motion import Motion, init_pose

STEP = 0.001  # GROBO_SIM_STEP_US
STOPPER = 1e4  # Nm s/rad: what a stop or a hand does to a speed that cannot be
HELD_KG = 1e6  # of a base that is held
FALLEN = math.radians(45)


class Missing(ImportError):
    """MuJoCo is not installed."""


def _mujoco() -> Any:
    try:
        return importlib.import_module("mujoco")
    except ImportError as missing:
        raise Missing("MuJoCo is missing: pip install mujoco numpy") from missing


class Tilt(NamedTuple):
    """How the base stands, as an IMU in it would tell."""

    roll: float
    """rad, about x ahead"""
    pitch: float
    """rad, about y to the left"""
    angle: float
    """rad, between the base's z and the vertical"""
    rates: Tuple[float, float, float]
    """rad/s about the base's own axes"""
    height: float
    """m"""


Stabilizer = Callable[[Tilt, Any, Any], None]
"""Corrects a target before the engine judges and sends it: tilt and rates of the base, the angles read
last and the target's, arrays in radians in the order of the joints (NaN: not read, not asked for).
It changes the target's in place."""


class Body:
    """A body of MuJoCo, for one simulator.

    `path`: MJCF or URDF. `robot`: its joints must be the names of hinges in the file. `free`: a base
    that the file fixes is freed, and a floor is there. `held`: a free base is held in the air, with
    the feet at the floor, until release().
    """

    def __init__(
        self, path: Union[str, "os.PathLike[str]"], robot: Description, *, free: bool = False,
        held: bool = True,
    ) -> None:
        self.mujoco = _mujoco()
        self.robot = robot
        self.problem: Optional[str] = None  # what a step has raised
        self.model = self._compile(os.fspath(path), free)
        self.data = self.mujoco.MjData(self.model)
        numpy: Any = importlib.import_module("numpy")
        self._numpy = numpy
        names = robot.joints
        joints = [self._joint(name, os.fspath(path)) for name in names]
        self.n = len(names)
        self._qpos = numpy.array([self.model.jnt_qposadr[j] for j in joints])
        self._dof = numpy.array([self.model.jnt_dofadr[j] for j in joints])
        kinds = self.model.jnt_type
        self.base_joint = next((j for j in range(self.model.njnt)
                                if kinds[j] == self.mujoco.mjtJoint.mjJNT_FREE
                                and self._carries(j, joints)), -1)
        self.base = int(self.model.jnt_bodyid[self.base_joint]) if self.base_joint >= 0 else -1
        self.held = held and self.base >= 0
        self._held_at: Any = None
        self._base_armature: Any = None
        self._begun = False
        self._pushes: List[Tuple[float, float, int, Tuple[float, ...]]] = []  # from, until, body, N
        self.on_step: Optional[Callable[["Body"], None]] = None
        self._callback = ffi.callback(
            "int(void *, const grobo_sim_drive *, double, grobo_sim_state *)", self._step)
        self._plant = ffi.new("grobo_sim_plant *")
        self._plant.step = self._callback
        self._imu_callback = ffi.callback("int(void *, struct grobo_imu *)", self._imu)
        self._plant.imu = self._imu_callback

    # ---- the file ----------------------------------------------------------------------------

    def _compile(self, path: str, free: bool) -> Any:
        mujoco = self.mujoco
        if not Path(path).is_file():
            raise FileNotFoundError(f"{path}: no such file")
        try:
            spec = mujoco.MjSpec.from_file(path)
        except (ValueError, mujoco.FatalError) as bad:
            raise ValueError(f"{path}: {bad}") from bad
        spec.option.timestep = STEP
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION  # the servos are ours
        if free:
            if not spec.worldbody.bodies:
                raise ValueError(f"{path}: has no body to free")
            root = spec.worldbody.bodies[0]
            if not any(j.type == mujoco.mjtJoint.mjJNT_FREE for j in root.joints):
                root.add_freejoint()
            planes = [g for g in spec.worldbody.geoms if g.type == mujoco.mjtGeom.mjGEOM_PLANE]
            if not planes:
                spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5, 5, 0.1],
                                        rgba=[0.8, 0.8, 0.8, 1])
                spec.worldbody.add_light(pos=[0, 0, 3], dir=[0, 0, -1])
        try:
            return spec.compile()
        except (ValueError, mujoco.FatalError) as bad:
            raise ValueError(f"{path}: {bad}") from bad

    def _joint(self, name: str, path: str) -> int:
        mujoco = self.mujoco
        found = int(mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name))
        if found < 0:
            others = ", ".join(self.model.joint(j).name for j in range(self.model.njnt))
            raise errors.error(lib.GROBO_ERR_NOTFOUND, path,
                               reason=f"no joint {name}; its joints: {others or 'none'}")
        if self.model.jnt_type[found] != mujoco.mjtJoint.mjJNT_HINGE:
            raise ValueError(f"{path}: the joint {name} is not a hinge")
        return found

    def _carries(self, base_joint: int, joints: List[int]) -> bool:
        """Whether a free body is the robot's, not a thing that lies around."""
        root = self.model.body_rootid[self.model.jnt_bodyid[joints[0]]]
        return bool(self.model.jnt_bodyid[base_joint] == root)

    # ---- how it begins -----------------------------------------------------------------------

    def _begin(self, drive: Any, state: Any) -> None:
        """The model's constants with the motors' armature, and the body on the floor."""
        mujoco, model, data = self.mujoco, self.model, self.data
        model.dof_armature[self._dof] = drive[:, 3]
        mujoco.mj_setConst(model, data)
        mujoco.mj_resetData(model, data)
        if model.nkey > 0:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        data.qpos[self._qpos] = state[:, 0]
        mujoco.mj_forward(model, data)
        if self.base >= 0:
            self._put_down()
            self.standing_height = float(data.xpos[self.base][2])
            at = int(model.jnt_dofadr[self.base_joint])
            self._base_armature = model.dof_armature[at:at + 6].copy()
            self._hold(self.held)
        self._begun = True

    def _put_down(self) -> None:
        """The lowest point of the robot touches the plane that is the floor."""
        mujoco, model, data = self.mujoco, self.model, self.data
        planes = [g for g in range(model.ngeom)
                  if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_PLANE]
        own = [g for g in range(model.ngeom)
               if model.body_rootid[model.geom_bodyid[g]] == self.base
               and (model.geom_contype[g] or model.geom_conaffinity[g])]
        if not planes or not own:
            return
        nearest = min(mujoco.mj_geomDistance(model, data, planes[0], g, 100.0, None) for g in own)
        z = int(model.jnt_qposadr[self.base_joint]) + 2
        data.qpos[z] -= nearest
        mujoco.mj_forward(model, data)

    def _hold(self, held: bool) -> None:
        """A held base is so heavy that nothing moves it: the joints feel their weight."""
        qpos = int(self.model.jnt_qposadr[self.base_joint])
        dof = int(self.model.jnt_dofadr[self.base_joint])
        self.held = held
        self._held_at = self.data.qpos[qpos:qpos + 7].copy() if held else None
        self.model.dof_armature[dof:dof + 6] = HELD_KG if held else self._base_armature
        self.data.qvel[dof:dof + 6] = 0

    def release(self) -> None:
        """A base that is held stands by itself from now on."""
        if self.base >= 0 and self._begun and self.held:
            self._hold(False)
        self.held = False

    # ---- a step ------------------------------------------------------------------------------

    def _step(self, _ctx: Any, drives: Any, _dt: float, states: Any) -> int:
        try:
            numpy = self._numpy
            drive = numpy.frombuffer(ffi.buffer(drives, self.n * ffi.sizeof("grobo_sim_drive")))
            state = numpy.frombuffer(ffi.buffer(states, self.n * ffi.sizeof("grobo_sim_state")))
            self._advance(drive.reshape(self.n, -1), state.reshape(self.n, -1))
            if self.on_step is not None:
                self.on_step(self)
            return 0
        except Exception:  # nothing may leave a callback
            self.problem = self.problem or traceback.format_exc()
            return int(lib.GROBO_ERR_IO)

    def _advance(self, drive: Any, state: Any) -> None:
        model, data, dof = self.model, self.data, self._dof
        if not self._begun:
            self._begin(drive, state)
        data.qpos[self._qpos] = state[:, 0]
        data.qvel[dof] = state[:, 1]
        model.dof_frictionloss[dof] = drive[:, 2]
        model.dof_armature[dof] = drive[:, 3]
        self._apply_pushes()
        begin = data.time, data.qpos.copy(), data.qvel.copy(), data.qacc_warmstart.copy()
        stopped = self._numpy.zeros(self.n, dtype=bool)
        low, high = drive[:, 4], drive[:, 5]
        for _ in range(4):
            bound = self._numpy.clip(data.qvel[dof], low, high)
            model.dof_damping[dof] = drive[:, 1] + STOPPER * stopped
            data.qfrc_applied[dof] = drive[:, 0] + STOPPER * self._numpy.where(stopped, bound, 0)
            self.mujoco.mj_step(model, data)
            speed = data.qvel[dof]
            beyond = ((speed < low - 1e-3) | (speed > high + 1e-3)) & ~stopped
            if not beyond.any():
                break
            stopped |= beyond
            limited = self._numpy.clip(speed, low, high)
            data.time, data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = begin
            data.qvel[dof] = self._numpy.where(stopped, limited, data.qvel[dof])
        if self._held_at is not None:
            at = int(model.jnt_qposadr[self.base_joint])
            data.qpos[at:at + 7] = self._held_at
        state[:, 0] = data.qpos[self._qpos]
        state[:, 1] = data.qvel[dof]
        state[:, 2] = self._load()

    def _load(self) -> Any:
        """What links, floor and things put on the joints, without what friction gives back."""
        data, kinds = self.data, self.mujoco.mjtConstraint
        load = data.qfrc_constraint - data.qfrc_bias
        if data.nefc:
            ids = data.efc_id[: data.nefc]
            friction = data.efc_type[: data.nefc] == kinds.mjCNSTR_FRICTION_DOF
            self._numpy.subtract.at(load, ids[friction], data.efc_force[: data.nefc][friction])
        return load[self._dof]

    # ---- what is done to it ------------------------------------------------------------------

    def push(
        self, force: Sequence[float], time: float, link: Optional[str] = None, *, after: float = 0.0,
    ) -> None:
        """Pushes a link's centre of mass for a time, with a force in N, in world axes; without a link
        the base. It begins `after` seconds from now."""
        begin = self.data.time + after
        self._pushes.append((begin, begin + time, self._body(link), tuple(force)))

    def _apply_pushes(self) -> None:
        """The pushes that go on; several at one link add up."""
        now = self.data.time
        for _begin, _end, at, _force in self._pushes:
            self.data.xfrc_applied[at, :3] = 0
        for begin, end, at, force in self._pushes:
            if begin <= now < end:
                self.data.xfrc_applied[at, :3] += force
        self._pushes = [one for one in self._pushes if now < one[1]]

    def _body(self, link: Optional[str]) -> int:
        mujoco = self.mujoco
        if link is None:
            return self.base if self.base >= 0 else int(self.model.jnt_bodyid[-1])
        found = int(mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, link))
        if found < 0:
            raise errors.error(lib.GROBO_ERR_NOTFOUND, "link", link)
        return found

    def set_payload(self, kg: float, link: Optional[str] = None) -> None:
        """Adds a mass at a link's origin; without a link at the last one's. It stays."""
        mujoco, model, numpy = self.mujoco, self.model, self._numpy
        at = self._body(link) if link is not None else int(model.nbody) - 1
        if not 0 <= kg <= 100:
            raise errors.error(lib.GROBO_ERR_ARG, "payload", value=kg)
        mass, com = float(model.body_mass[at]), model.body_ipos[at].copy()
        turn = numpy.zeros(9)
        mujoco.mju_quat2Mat(turn, model.body_iquat[at])
        turn = turn.reshape(3, 3)
        inertia = turn @ numpy.diag(model.body_inertia[at]) @ turn.T
        if mass + kg <= 0:
            return
        centre = com * mass / (mass + kg)
        for part, place in ((mass, com - centre), (kg, -centre)):
            inertia += part * (place @ place * numpy.eye(3) - numpy.outer(place, place))
        values, axes = numpy.linalg.eigh(inertia)
        axes[:, 2] *= numpy.sign(numpy.linalg.det(axes))
        quat = numpy.zeros(4)
        mujoco.mju_mat2Quat(quat, axes.flatten())
        model.body_mass[at], model.body_ipos[at] = mass + kg, centre
        model.body_inertia[at], model.body_iquat[at] = values, quat
        state = self.data.qpos.copy(), self.data.qvel.copy()
        mujoco.mj_setConst(model, self.data)
        self.data.qpos[:], self.data.qvel[:] = state

    # ---- how it is ---------------------------------------------------------------------------

    @property
    def time(self) -> float:
        return float(self.data.time)

    def tilt(self) -> Tilt:
        """Of a free base; one that is fixed does not tilt."""
        if self.base < 0:
            return Tilt(0.0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.0)
        turn = self._numpy.zeros(9)
        at, dof = (int(self.model.jnt_qposadr[self.base_joint]),
                   int(self.model.jnt_dofadr[self.base_joint]))
        self.mujoco.mju_quat2Mat(turn, self.data.qpos[at + 3:at + 7])
        roll, pitch = math.atan2(turn[7], turn[8]), math.asin(max(-1.0, min(1.0, -turn[6])))
        rates = self.data.qvel[dof + 3:dof + 6]
        return Tilt(roll, pitch, math.acos(max(-1.0, min(1.0, turn[8]))),
                    (float(rates[0]), float(rates[1]), float(rates[2])),
                    float(self.data.qpos[at + 2]))

    def _imu(self, _ctx: Any, imu: Any) -> int:
        """What the engine is told of the base."""
        try:
            if self.base < 0 or not self._begun:
                return int(lib.GROBO_ERR_UNSUPPORTED)
            tilt = self.tilt()
            imu.roll_rad, imu.pitch_rad = tilt.roll, tilt.pitch
            for i, rate in enumerate(tilt.rates):
                imu.rate_rad_s[i] = rate
            return 0
        except Exception:  # nothing may leave a callback
            self.problem = self.problem or traceback.format_exc()
            return int(lib.GROBO_ERR_IO)

    @property
    def fallen(self) -> bool:
        """More than 45 degrees from upright, or lower than a third of its height at the begin."""
        if self.base < 0 or not self._begun:
            return False
        tilt = self.tilt()
        return tilt.angle > FALLEN or tilt.height < self.standing_height / 3

    def world(self, real_time: bool) -> Any:
        """The motors that move it, for grobo_sim_config.physics."""
        made = ffi.new("grobo_sim_physics **")
        result = lib.grobo_robot_def_plant(self.robot._c, self._plant, real_time, ffi.NULL, made)
        errors.check(result, self.robot.name)
        return made[0]


class _Simulated:
    """What a simulator in front of a body has, however its time goes."""

    body: Body
    _sim: Any = ffi.NULL
    _physics: Any = ffi.NULL

    def _config(self, real_time: bool, seed: int) -> Any:
        self._physics = self.body.world(real_time)
        config = ffi.new("grobo_sim_config *", self.body.robot._sim.config)
        config.physics = self._physics
        config.seed = seed
        return config

    def set_faults(self, faults: str) -> None:
        """Rates by a list "drop=0.01,silent=0.02", as for grctl sim --fault."""
        text = faults.encode()
        errors.check(lib.grobo_sim_set_faults(self._sim, text, len(text)), f"faults {faults!r}")

    def torques(self) -> List[int]:
        """What each servo does: grobo.Torque."""
        return [int(view.torque) for view in self.look()]

    def look(self) -> List[Any]:
        """Each servo as it is: grobo_sim_view of sim.h."""
        views = ffi.new("grobo_sim_view[]", self.body.n)
        for j in range(self.body.n):
            errors.check(lib.grobo_sim_look(self._sim, j, ffi.addressof(views, j)), "look")
        return list(views)

    def hand(self, joint: str, torque: float) -> None:
        """Pushes a joint with a torque in Nm until it is told otherwise; 0: it is gone."""
        errors.check(lib.grobo_sim_push(self._sim, self._number(joint), torque), joint)

    def block(self, joint: str, on: bool) -> None:
        """Holds a joint fast, or releases it."""
        errors.check(lib.grobo_sim_set_blocked(self._sim, self._number(joint), on), joint)

    def cable(self, joint: str, state: str) -> None:
        """"in", "mute" or "out"."""
        states = ("in", "mute", "out")
        if state not in states:
            raise errors.error(lib.GROBO_ERR_ARG, f"cable {state!r}", reason="in, mute or out")
        errors.check(
            lib.grobo_sim_set_cable(self._sim, self._number(joint), states.index(state)), joint)

    def set_supply(self, volts: float) -> None:
        """The battery's voltage."""
        lib.grobo_sim_set_supply(self._sim, round(volts * 1000))

    def _number(self, joint: str) -> int:
        names = self.body.robot.joints
        if joint not in names:
            raise errors.error(lib.GROBO_ERR_NOTFOUND, "joint", joint)
        return names.index(joint)

    def _watch(self) -> None:
        """What a step has raised; and who holds the base lets go when all joints have torque."""
        if self.body.problem:
            raise RuntimeError(self.body.problem)
        if self.body.held and all(t == lib.GROBO_TORQUE_ON for t in self.torques()):
            self.body.release()


class Served(_Simulated):
    """A simulator behind a pseudo-terminal, and TCP, in real time: for any program."""

    def __init__(
        self, body: Body, *, link: Optional[str] = None, tcp: Optional[int] = None,
        pty: bool = True, seed: int = 0,
    ) -> None:
        self.body = body
        self._server: Any = ffi.NULL
        self._loop = lib.grobo_loop_new()
        if self._loop == ffi.NULL:
            raise MemoryError("no loop")
        config = new("grobo_sim_server_config")
        sim = config.sim = self._config(True, seed)
        keep = [os.fsencode(link) if link else None,
                f"tcp:127.0.0.1:{tcp}".encode() if tcp is not None else None]
        texts = [ffi.new("char[]", text) if text else ffi.NULL for text in keep]
        config.base, config.link, config.tcp = self._loop, texts[0], texts[1]
        config.no_pty = not pty
        made, cause = ffi.new("grobo_sim_server **"), ffi.new("grobo_os_cause *")
        result = lib.grobo_sim_server_new(config, made, cause)
        if result < 0:
            self.close()
            raise errors.error(result, link or "simulator",
                               reason=ffi.string(cause.text).decode() or None)
        self._server, self._keep = made[0], sim
        self._sim = lib.grobo_sim_server_sim(self._server)

    @property
    def device(self) -> str:
        """What a program opens."""
        name: str = ffi.string(lib.grobo_sim_server_device(self._server)).decode()
        return name

    @property
    def tcp_port(self) -> int:
        """0: none."""
        return int(lib.grobo_sim_server_tcp_port(self._server))

    @property
    def skipped(self) -> int:
        """Steps of 1 ms that this machine was too slow for."""
        return int(lib.grobo_sim_physics_skipped(self._physics))

    def run(self, seconds: float) -> None:
        """Serves for a time."""
        errors.check(lib.grobo_loop_run(self._loop, us(seconds)), "loop")
        self._watch()

    def close(self) -> None:
        if self._server != ffi.NULL:
            lib.grobo_sim_server_free(self._server)
        if self._physics != ffi.NULL:
            lib.grobo_sim_physics_free(self._physics)
        if self._loop != ffi.NULL:
            lib.grobo_loop_free(self._loop)
        self._server = self._sim = self._physics = self._loop = ffi.NULL

    def __enter__(self) -> "Served":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


class Virtual(_Simulated):
    """The library's engine with a body, in virtual time: as fast as the machine can.

    `stabilizer`: sees each target of a move or a motion, with what an IMU in the base would tell.
    """

    def __init__(self, body: Body, *, seed: int = 0, stabilizer: Optional[Stabilizer] = None) -> None:
        self.body = body
        self._handle: Any = ffi.NULL
        self._stabilizer = stabilizer
        self._ended: Dict[int, int] = {}
        self._played: Optional[int] = None
        self.trips: List[str] = []
        config = new("grobo_virtual_config")
        config.driver = self._driver() if stabilizer else body.robot._driver
        config.sim = self._config(False, seed)
        made = ffi.new("grobo_virtual **")
        result = lib.grobo_virtual_new(config, made)
        if result < 0:
            self.close()
            raise errors.error(result, body.robot.name)
        self._handle = made[0]
        self.robot = lib.grobo_virtual_robot(self._handle)
        self._sim = lib.grobo_virtual_sim(self._handle)
        self._on_event = ffi.callback("void(void *, const grobo_event *)", self._event)
        lib.grobo_robot_on_event(self.robot, self._on_event, ffi.NULL)

    def _driver(self) -> Any:
        """The robot's driver with the stabilizer in it."""
        self._stabilized = ffi.new("grobo_driver *")  # as long as the engine uses it
        self._stabilized.size = ffi.sizeof("grobo_driver")
        lib.grobo_driver_copy(self._stabilized, self.body.robot._driver)
        self._stabilize_c = ffi.callback(
            ffi.typeof(self._stabilized.stabilize_by), self._stabilize)
        self._stabilized.stabilize_by = self._stabilize_c
        return self._stabilized

    def _stabilize(self, _driver: Any, _ctx: Any, imu: Any, sensed: Any, target: Any) -> int:
        """Hands a target to the stabilizer before it is judged and sent."""
        numpy, n = self.body._numpy, self.body.n
        try:
            now = numpy.array([sensed.angle_rad[j] if sensed.set >> j & 1 else math.nan
                               for j in range(n)])
            goal = numpy.array([target.angle_rad[j] if target.set >> j & 1 else math.nan
                                for j in range(n)])
            assert self._stabilizer is not None
            self._stabilizer(self._seen(imu), now, goal)
            for j in range(n):
                if target.set >> j & 1:
                    target.angle_rad[j] = goal[j]
            return 0
        except Exception:  # nothing may leave a callback
            self.body.problem = self.body.problem or traceback.format_exc()
            return int(lib.GROBO_ERR_CANCELED)

    def _seen(self, imu: Any) -> Tilt:
        """The reading that the engine hands over; upright where there is none."""
        if imu == ffi.NULL:
            return Tilt(0.0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.0)
        x, y, z = imu.rate_rad_s
        return Tilt(imu.roll_rad, imu.pitch_rad, lib.grobo_imu_tilt(imu), (x, y, z),
                    self.body.tilt().height)

    def _event(self, _ctx: Any, event: Any) -> None:
        if event.kind == lib.GROBO_EVENT_JOB:
            self._ended[event.u.job.number] = event.u.job.result
        elif event.kind == lib.GROBO_EVENT_PLAY and event.u.play.to in (
            lib.GROBO_SEQUENCER_IDLE, lib.GROBO_SEQUENCER_FINISHED, lib.GROBO_SEQUENCER_FAILED
        ):
            self._played = int(event.u.play.error)
        elif event.kind == lib.GROBO_EVENT_TRIP:
            self.trips.append(ffi.string(lib.grobo_trip_name(event.u.trip.trip)).decode())

    @property
    def now(self) -> float:
        """Seconds since it was made."""
        return int(lib.grobo_virtual_now_us(self._handle)) / 1e6

    def run(self, seconds: float) -> None:
        """Lets time pass."""
        end = us(seconds)
        while end > 0:
            part = min(end, 20000)
            errors.check(lib.grobo_virtual_run(self._handle, part), "run")
            self._watch()
            end -= part

    def init(self, time: Optional[float] = None) -> None:
        """Moves to the initial posture, which switches the torque on, and waits for it."""
        target = init_pose(time, self.body.robot.model)
        job = errors.check(lib.grobo_robot_move(self.robot, target), "init")
        self._until(lambda: job in self._ended, "init")
        errors.check(self._ended[job], "init")

    def play(self, motion: Union[Motion, str, "os.PathLike[str]"], *, speed: float = 1.0) -> None:
        """Plays a motion to its end. Link targets of a robot with feet are solved for its legs."""
        if not isinstance(motion, Motion):
            motion = Motion.load(motion, self.body.robot)
        options = new("grobo_play_options")
        options.mode = lib.GROBO_PLAY_RATE
        options.speed_pct = round(speed * 100)
        self._clip = _Clip(motion, self.body.robot)  # as long as it may be played
        self._played = None
        errors.check(lib.grobo_robot_play(self.robot, self._clip.c, options), "play")
        self._until(lambda: self._played is not None, "play")
        errors.check(self._played or 0, "play")

    def _until(self, done: Callable[[], bool], what: str, most: float = 600) -> None:
        end = self.now + most
        while not done():
            if self.now > end:
                raise errors.error(lib.GROBO_ERR_TIMEOUT, what)
            self.run(0.02)

    def close(self) -> None:
        if self._handle != ffi.NULL:
            lib.grobo_virtual_free(self._handle)
        if self._physics != ffi.NULL:
            lib.grobo_sim_physics_free(self._physics)
        self._handle = self._sim = self._physics = ffi.NULL

    def __enter__(self) -> "Virtual":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


class _Clip:
    """A motion as the engine plays it, with the legs solved where it has targets for them."""

    def __init__(self, motion: Motion, robot: Description) -> None:
        self.c = ffi.new("grobo_clip *")
        self._motion = motion
        self._shape = ffi.new("grobo_robot_body *")
        self._body: Any = None
        legs = lib.grobo_robot_def_body(robot._c, self._shape) == 0
        if legs and lib.grobo_body_wanted(ffi.addressof(self._shape, "model"), motion._c):
            options = new("grobo_body_options")
            options.rate_hz = 50
            made = ffi.new("grobo_body **")
            result = lib.grobo_body_new(ffi.addressof(self._shape, "model"), motion._c, options,
                                        ffi.NULL, made)
            errors.check(result, "legs")
            self._body = ffi.gc(made[0], lib.grobo_body_free)
            lib.grobo_body_clip(self._body, False, self.c)
        else:
            errors.check(lib.grobo_motion_clip(motion._c, ffi.NULL, self.c), "motion")


# ---- the command ---------------------------------------------------------------------------------

CONSOLE = """While it serves, it takes commands on standard input:
  push [LINK] FX FY FZ MS   pushes a link (the base) with a force in N for a time
  payload KG [LINK]         adds a mass at a link's origin (the last link)
  hand JOINT NM             pushes a joint; 0: the hand is gone
  block JOINT on|off        holds a joint fast
  cable JOINT in|mute|out   how a servo is connected
  fault LIST                drop=0.01,silent=0.02: as grctl sim --fault
  voltage V                 of the battery
  release                   lets go of a base that is held
  look                      tilt of the base, and each servo
  quit
"""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m grobo.physics", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Simulate the servos of a robot in front of a body of MuJoCo.", epilog=CONSOLE)
    parser.add_argument("model", help="MJCF or URDF whose hinges are called as the robot's joints")
    parser.add_argument("--robot", default="gr001", metavar="NAME|FILE", help="as of grctl (gr001)")
    parser.add_argument("--link", metavar="PATH", help="keep a symbolic link to the pty")
    parser.add_argument("--tcp", type=int, metavar="PORT", help="listen on 127.0.0.1 too; 0: any")
    parser.add_argument("--imu", metavar="PATH",
                        help="keep a link to a second pty, with an IMU's lines: grctl serve --imu PATH")
    parser.add_argument("--no-pty", action="store_true", help="serve by TCP only")
    parser.add_argument("--free", action="store_true",
                        help="free a base that the file fixes, and add a floor")
    parser.add_argument("--drop", action="store_true",
                        help="do not hold a free base until all joints have torque")
    parser.add_argument("--fault", metavar="LIST", help="as of grctl sim: drop=0.01,silent=0.02")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of all random numbers")
    parser.add_argument("--play", metavar="MOTION", nargs="+",
                        help="serve nobody: play motions in virtual time, and report a fall")
    parser.add_argument("--view", action="store_true", help="show it in MuJoCo's window")
    parser.add_argument("--video", metavar="FILE",
                        help="film it: .png (animated), or what ffmpeg writes")
    parser.add_argument("--strip", metavar="FILE", help="six frames side by side, a .png")
    return parser


def _say(text: str) -> None:
    print(f"grobo.physics: {text}", file=sys.stderr, flush=True)


def _obey(served: Served, line: str) -> bool:
    """Does what a line of the console says; False: quit."""
    words = line.split()
    if not words:
        return True
    verb, rest = words[0], words[1:]
    body = served.body
    if verb == "quit" and not rest:
        return False
    if verb == "look" and not rest:
        tilt = body.tilt()
        _say(f"tilt {math.degrees(tilt.angle):.1f} deg, roll {math.degrees(tilt.roll):.1f}, pitch "
             f"{math.degrees(tilt.pitch):.1f}, height {tilt.height * 1000:.0f} mm"
             f"{', fallen' if body.fallen else ''}{', held' if body.held else ''}")
        for name, view in zip(body.robot.joints, served.look()):
            _say(f"{name:14} {view.angle_mdeg / 1000:7.1f} deg, to {view.target_mdeg / 1000:7.1f}, "
                 f"torque {('off', 'on', 'brake')[view.torque]}, {view.current_ma} mA")
    elif verb == "push" and len(rest) in (4, 5):
        force = [float(word) for word in rest[-4:-1]]
        body.push(force, float(rest[-1]) / 1000, rest[0] if len(rest) == 5 else None)
    elif verb == "payload" and len(rest) in (1, 2):
        body.set_payload(float(rest[0]), rest[1] if len(rest) == 2 else None)
    elif verb == "hand" and len(rest) == 2:
        served.hand(rest[0], float(rest[1]))
    elif verb == "block" and len(rest) == 2 and rest[1] in ("on", "off"):
        served.block(rest[0], rest[1] == "on")
    elif verb == "cable" and len(rest) == 2:
        served.cable(rest[0], rest[1])
    elif verb == "fault" and len(rest) == 1:
        served.set_faults(rest[0])
    elif verb == "voltage" and len(rest) == 1:
        served.set_supply(float(rest[0]))
    elif verb == "release" and not rest:
        body.release()
    else:
        _say(f"what is '{line.strip()}'? " + CONSOLE)
    return True


class _Lines:
    """Lines of standard input that are there, without waiting for more."""

    def __init__(self) -> None:
        self.open = True
        self.rest = b""
        os.set_blocking(0, False)

    def take(self) -> List[str]:
        if not self.open:
            return []
        try:
            got = os.read(0, 4096)
            self.open = bool(got)
        except BlockingIOError:
            return []
        except OSError:
            self.open = False
            return []
        *lines, self.rest = (self.rest + got).split(b"\n")
        return [line.decode(errors="replace") for line in lines]


class ImuLines:
    """An IMU behind a pseudo-terminal: 50 lines a second of roll, pitch (degrees) and three rates
    (degrees a second), as a microcontroller prints them. Lines that nobody reads are dropped."""

    def __init__(self, body: Body, link: str) -> None:
        import termios
        import tty

        self.body, self.link, self._flush = body, link, termios.tcflush
        self._own, self._other = os.openpty()
        tty.setraw(self._other)
        os.set_blocking(self._own, False)
        path = Path(link)
        if path.is_symlink():
            path.unlink()
        path.symlink_to(os.ttyname(self._other))

    def tell(self) -> None:
        tilt = self.body.tilt()
        numbers = tilt.roll, tilt.pitch, *tilt.rates
        line = " ".join(f"{math.degrees(n):.2f}" for n in numbers) + "\n"
        try:
            os.write(self._own, line.encode())
        except BlockingIOError:
            self._flush(self._other, 0)  # TCIFLUSH: what is old is dropped

    def close(self) -> None:
        path = Path(self.link)
        if path.is_symlink():
            path.unlink()
        os.close(self._own)
        os.close(self._other)


def _serve(body: Body, args: argparse.Namespace) -> int:
    imu = ImuLines(body, args.imu) if args.imu else None
    try:
        return _serve_lines(body, args, imu)
    finally:
        if imu is not None:
            imu.close()


def _serve_lines(body: Body, args: argparse.Namespace, imu: Optional[ImuLines]) -> int:
    stop: List[int] = []
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, lambda n, _frame: stop.append(n))
    with Served(body, link=args.link, tcp=args.tcp, pty=not args.no_pty, seed=args.seed) as served:
        if args.fault:
            served.set_faults(args.fault)
        print(served.device, flush=True)
        if served.tcp_port and not args.no_pty:
            _say(f"also at tcp:127.0.0.1:{served.tcp_port}")
        _say("SIMULATED robot, no motor moves anywhere; Ctrl-C ends it")
        if body.held:
            _say("its base is held until all joints have torque")
        lines, fell = _Lines(), False
        viewer = _viewer(body) if args.view else None
        while not stop and (viewer is None or viewer.is_running()):
            served.run(0.02)
            if imu is not None:
                imu.tell()
            if viewer is not None:
                viewer.sync()
            if body.fallen != fell:
                fell = body.fallen
                _say(f"{'it fell' if fell else 'it is up again'} at {body.time:.2f} s, tilt "
                     f"{math.degrees(body.tilt().angle):.0f} deg")
            for line in lines.take():
                try:
                    if not _obey(served, line):
                        stop.append(0)
                except (errors.Error, ValueError) as bad:
                    _say(str(bad))
        if served.skipped:
            _say(f"{served.skipped} steps of 1 ms were skipped: this machine was too slow or slept")
    return 128 + stop[0] if stop and stop[0] else 0


def _viewer(body: Body) -> Any:
    """MuJoCo's own window."""
    viewer: Any = importlib.import_module("mujoco.viewer")
    return viewer.launch_passive(body.model, body.data)


def _play(body: Body, args: argparse.Namespace, film: Optional[Film]) -> int:
    status, most = 0, 0.0

    def watch(one: Body) -> None:
        nonlocal most
        most = max(most, one.tilt().angle)
        if film is not None:
            film.look(one)

    body.on_step = watch
    with Virtual(body, seed=args.seed) as robot:
        if args.fault:
            robot.set_faults(args.fault)
        robot.init()
        robot.run(1)
        for motion in args.play:
            before, most, ended = body.time, 0.0, ""
            try:
                robot.play(motion)
                robot.run(1)
            except errors.Error as bad:
                ended, status = f": {bad}", 1
            print(f"{motion}: {'fell' if body.fallen else 'stands'}, largest tilt "
                  f"{math.degrees(most):.1f} deg in {body.time - before:.1f} s{ended}", flush=True)
            if body.fallen:
                return 3
    return status


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """0: done; 1: it cannot; 2: wrong arguments; 3: it fell (--play)."""
    args = _parser().parse_args(arguments)
    film: Optional[Film] = None
    try:
        body = Body(args.model, Description(args.robot), free=args.free, held=not args.drop)
        if args.video or args.strip:
            film = Film(body)
            body.on_step = film.look
        status = _play(body, args, film) if args.play else _serve(body, args)
        if film:
            film.save(args.video, args.strip)
        return status
    except (Missing, errors.Error, ValueError, OSError, RuntimeError) as bad:
        _say(str(bad))
        return 1


if __name__ == "__main__":
    sys.exit(main())
