# SPDX-License-Identifier: MIT
"""docs/examples/balance.c stands against a push, in real time: its robot at one pseudo-terminal, the
IMU at another.

usage: lean.py GRCTL BALANCE

GR001 is pushed at the waist by 1.5 N for a second, from the front; without the example it falls
(test_physics.py). Where the machine is too slow for real time, steps are skipped and nothing is judged.
"""

import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from grobo import Description
from grobo.physics import Body, ImuLines, Served

TRIES = 3


def stands(model, balance, folder):
    """Whether it stands at the end, what it tilted by at most, and the steps that were skipped."""
    body = Body(model, Description("gr001"))
    most, lines = 0.0, ImuLines(body, str(folder / "imu"))
    with Served(body) as served, open(folder / "imu") as imu:
        program = subprocess.Popen([balance, served.device], stdin=imu, stdout=subprocess.PIPE)
        end, upright_from = time.monotonic() + 60, None
        try:
            while time.monotonic() < end:
                served.run(0.02)
                lines.tell()
                if upright_from is None and not body.held:
                    upright_from, skipped = body.time, served.skipped
                    body.push([-1.5, 0, 0], 1.0, after=2.0)
                if upright_from is not None:
                    most = max(most, body.tilt().angle)
                    if body.fallen or body.time > upright_from + 5:
                        return not body.fallen, most, served.skipped - skipped
            raise AssertionError("the example does not switch the torque on")
        finally:
            program.kill()
            program.communicate()
            lines.close()


def main(grctl, balance):
    with tempfile.TemporaryDirectory() as name:
        model = Path(name) / "gr001.xml"
        subprocess.run([grctl, "robot", "export", "gr001", "--mjcf", "-o", str(model)], check=True)
        for _ in range(TRIES):
            stood, most, skipped = stands(model, balance, Path(name))
            if skipped == 0:
                print(f"balance.c: pushed by 1.5 N for 1 s, it tilts by {math.degrees(most):.1f} "
                      f"degrees: {'good' if stood else 'BAD'}")
                return 0 if stood else 1
    print("balance.c: not judged: this machine was too slow each time")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
