# SPDX-License-Identifier: MIT
"""What a body of MuJoCo costs: CPU time beside the time that is simulated.

usage: cost.py GRCTL

One joint with a lever on a fixed base, and GR001's 20 joints on its feet; with the library's engine in
virtual time, which senses all joints all the time, and behind a pseudo-terminal in real time, where
nobody asks.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from grobo import Description
from grobo.physics import Body, Served, Virtual

SECONDS = 10
LEVER = """<mujoco><option gravity="0 0 -9.80665"/><worldbody><body name="arm" pos="0 0 0.3">
<joint name="one" axis="0 -1 0"/><inertial pos="0.1 0 0" mass="0.1" diaginertia="1e-5 1e-5 1e-5"/>
</body></worldbody></mujoco>"""
ONE = """name: one
family: feetech
line: {baud: 1000000}
joints:
  - {name: one, id: 1, servo: STS3215, limits_deg: [-90, 90]}
"""


def virtual(model, robot):
    with Virtual(Body(model, robot)) as made:
        made.init()
        made.run(1)
        cpu, real = time.process_time(), time.monotonic()
        made.run(SECONDS)
        return time.process_time() - cpu, time.monotonic() - real


def served(model, robot):
    with Served(Body(model, robot)) as made:
        made.run(0.5)
        cpu, skipped = time.process_time(), made.skipped
        made.run(SECONDS)
        return time.process_time() - cpu, made.skipped - skipped


def main(grctl):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "one.xml").write_text(LEVER)
        (folder / "one.yaml").write_text(ONE)
        subprocess.run([grctl, "robot", "export", "gr001", "--mjcf", "-o", str(folder / "gr001.xml")],
                       check=True)
        for model, robot in (("one.xml", folder / "one.yaml"), ("gr001.xml", "gr001")):
            description = Description(robot)
            n = len(description.joints)
            cpu, real = virtual(folder / model, description)
            print(f"{n} joints, {SECONDS} s in virtual time: CPU {cpu:.2f} s, real {real:.2f} s")
            cpu, skipped = served(folder / model, description)
            print(f"{n} joints, {SECONDS} s in real time: CPU {cpu:.2f} s, {skipped} steps skipped")


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
