# SPDX-License-Identifier: MIT
"""The links of a simulated SO-101 in MuJoCo.

usage: mujoco_plant.py PLANT_PIPE                   plant_pipe.c judges a hold, moves, a stop, a fall
       mujoco_plant.py PLANT_PIPE PROGRAM [ARG...]  the program finds the plant by GROBO_PLANT
                                                    (tests/support/weight_kit.h)
"""
import os
import subprocess
import sys

import mujoco
import numpy as np


def start(program):
    """Starts who steps the plant. @return it, what it sends, what it gets"""
    if len(program) == 1:
        robot = subprocess.Popen(program, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        return robot, robot.stdout, robot.stdin
    sent, its_out = os.pipe()
    its_in, got = os.pipe()
    robot = subprocess.Popen(
        program[1:],
        pass_fds=(its_in, its_out),
        env={**os.environ, "GROBO_PLANT": f"{its_in},{its_out}"},
    )
    os.close(its_in)
    os.close(its_out)
    return robot, os.fdopen(sent, "rb"), os.fdopen(got, "wb")


def main(program):
    xml = subprocess.run([program[0], "--mjcf"], capture_output=True, check=True, text=True).stdout
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    names = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
    at = [model.joint(name).dofadr[0] for name in names]
    robot, sent, got = start(program)
    size = len(at) * 6 * 8
    steps = 0
    while len(block := sent.read(size)) == size:
        torque, damping, friction, armature, angle, speed = np.frombuffer(block).reshape(-1, 6).T
        data.qfrc_applied[at] = torque
        model.dof_damping[at] = damping
        model.dof_frictionloss[at] = friction
        model.dof_armature[at] = armature
        data.qpos[at] = angle
        data.qvel[at] = speed
        mujoco.mj_step(model, data)
        load = -data.qfrc_bias[at]
        got.write(np.stack([data.qpos[at], data.qvel[at], load], axis=1).tobytes())
        got.flush()
        steps += 1
    print(f"MuJoCo {mujoco.__version__}: {steps} steps", flush=True)
    return robot.wait()


sys.exit(main(sys.argv[1:]))
