# SPDX-License-Identifier: MIT
"""The links of a simulated SO-101 in MuJoCo: usage: mujoco_plant.py PLANT_PIPE (plant_pipe.c)."""
import subprocess
import sys

import mujoco
import numpy as np


def main(program):
    xml = subprocess.run([program, "--mjcf"], capture_output=True, check=True, text=True).stdout
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    names = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
    at = [model.joint(name).dofadr[0] for name in names]
    robot = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    size = len(at) * 6 * 8
    steps = 0
    while len(block := robot.stdout.read(size)) == size:
        torque, damping, friction, armature, angle, speed = np.frombuffer(block).reshape(-1, 6).T
        data.qfrc_applied[at] = torque
        model.dof_damping[at] = damping
        model.dof_frictionloss[at] = friction
        model.dof_armature[at] = armature
        data.qpos[at] = angle
        data.qvel[at] = speed
        mujoco.mj_step(model, data)
        load = -data.qfrc_bias[at]
        robot.stdin.write(np.stack([data.qpos[at], data.qvel[at], load], axis=1).tobytes())
        robot.stdin.flush()
        steps += 1
    print(f"MuJoCo {mujoco.__version__}: {steps} steps", flush=True)
    return robot.wait()


sys.exit(main(sys.argv[1]))
