# SPDX-License-Identifier: MIT
"""What grctl exports, as MuJoCo reads it, has the dynamics of the library's own.

usage: exported.py GRCTL PLANT_PIPE ROBOT|FILE...
"""

import subprocess
import sys

import mujoco
import numpy

POSES = 50


def model_of(grctl, robot, form):
    xml = subprocess.run([grctl, "robot", "export", robot, form], capture_output=True, check=True,
                         text=True).stdout
    return mujoco.MjModel.from_xml_string(xml)


def poses_of(program, robot, n):
    text = subprocess.run([program, "--dynamics", robot, str(POSES)], capture_output=True, check=True,
                          text=True).stdout
    for line in text.splitlines():
        numbers = numpy.array(line.split(), dtype=float)
        yield numbers[:n], numbers[n:2 * n], numbers[2 * n:].reshape(n, n)


def worst(model, names, poses):
    """Largest differences of gravity's torques, and of the mass matrix, relative to the largest."""
    data = mujoco.MjData(model)
    at = [model.joint(name).qposadr[0] for name in names]
    dof = [model.joint(name).dofadr[0] for name in names]
    torque, mass, most = 0.0, 0.0, [0.0, 0.0]
    for angles, ours, matrix in poses:
        data.qpos[at] = angles
        mujoco.mj_forward(model, data)
        whole = numpy.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, whole, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(
            model, data, whole)
        torque = max(torque, abs(data.qfrc_bias[dof] - ours).max())
        mass = max(mass, abs(whole[numpy.ix_(dof, dof)] - matrix).max())
        most = [max(most[0], abs(ours).max()), max(most[1], abs(matrix).max())]
    return torque, mass, most


def main(grctl, program, *robots):
    failed = 0
    for robot in robots:
        for form in ("--mjcf", "--urdf"):
            model = model_of(grctl, robot, form)
            model.opt.gravity[:] = 0, 0, -9.80665
            joints = [j for j in range(model.njnt)
                      if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE]
            shown = subprocess.run([grctl, "--robot", robot, "--json", "joints"],
                                   capture_output=True, check=True, text=True).stdout
            names = names_of(shown)
            assert len(joints) == len(names), (len(joints), len(names))
            torque, mass, most = worst(model, names, poses_of(program, robot, len(names)))
            good = torque < 1e-6 * max(1, most[0]) and mass < 1e-7 * max(1, most[1])
            failed += not good
            print(f"{robot} {form}: {len(names)} joints, {POSES} poses: torques differ by "
                  f"{torque:.1e} of {most[0]:.2g} Nm, masses by {mass:.1e} of {most[1]:.2g} kg m2: "
                  f"{'good' if good else 'BAD'}")
    return 1 if failed else 0


def names_of(text):
    import json

    return [joint["name"] for joint in json.loads(text)["joints"]]


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
