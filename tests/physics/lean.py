# SPDX-License-Identifier: MIT
"""docs/examples/balance.c stands against a push, in real time: its robot at one pseudo-terminal, the
IMU at another.

usage: lean.py GRCTL BALANCE

GR001 is pushed at the waist by 1.5 N for a second, from the front; without the example it falls
(test_physics.py). Where the machine is too slow for real time, steps are skipped and nothing is
judged, or servos answer too late for the example to begin: it is tried again.
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
    """Whether it stands at the end (None: the example has ended before), what it tilted by at most,
    and the steps that were skipped."""
    body = Body(model, Description("gr001"))
    most, lines = 0.0, ImuLines(body, str(folder / "imu"))
    with Served(body) as served, open(folder / "imu") as imu:
        program = subprocess.Popen([balance, served.device], stdin=imu, stdout=subprocess.PIPE)
        end, upright_from, skipped = time.monotonic() + 60, None, 0
        try:
            while time.monotonic() < end and program.poll() is None:
                served.run(0.02)
                lines.tell()
                if upright_from is None and not body.held:
                    upright_from, skipped = body.time, served.skipped
                    body.push([-1.5, 0, 0], 1.0, after=2.0)
                if upright_from is not None:
                    most = max(most, body.tilt().angle)
                    if body.fallen or body.time > upright_from + 5:
                        return not body.fallen, most, served.skipped - skipped
            return None, most, served.skipped
        finally:
            program.kill()
            program.communicate()
            lines.close()


def main(grctl, balance):
    with tempfile.TemporaryDirectory() as name:
        model = Path(name) / "gr001.xml"
        subprocess.run([grctl, "robot", "export", "gr001", "--mjcf", "-o", str(model)], check=True)
        judged = [stands(model, balance, Path(name))]
        while len(judged) < TRIES and (judged[-1][0] is None or judged[-1][2] > 0):
            judged.append(stands(model, balance, Path(name)))
    stood, most, skipped = judged[-1]
    if stood is None:
        print("balance.c: BAD: it ends before it has switched the torque on")
    elif skipped > 0:
        print("balance.c: not judged: this machine was too slow each time")
    else:
        print(f"balance.c: pushed by 1.5 N for 1 s, it tilts by {math.degrees(most):.1f} degrees: "
              f"{'good' if stood else 'BAD'}")
    return 0 if stood or (stood is not None and skipped > 0) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
