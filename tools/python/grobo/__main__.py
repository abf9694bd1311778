# SPDX-License-Identifier: MIT
"""The command of the wheel: `grctl ...`, or `python -m grobo ...`."""

import os
import subprocess
import sys
from pathlib import Path


def main() -> int:
    """Becomes the grctl that the wheel holds, with the arguments of this program."""
    name = "grctl.exe" if sys.platform == "win32" else "grctl"
    beside = Path(__file__).with_name(name)
    if not beside.exists():
        print("grobo: this package has no grctl; a wheel made by `make wheel` has", file=sys.stderr)
        return 2
    command = [str(beside), *sys.argv[1:]]
    if sys.platform == "win32":  # exec would let the shell go on beside it
        return subprocess.call(command)
    os.execv(command[0], command)


if __name__ == "__main__":
    sys.exit(main())
