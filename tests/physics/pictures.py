# SPDX-License-Identifier: MIT
"""The strips of frames of docs/guide/body.md.

usage: pictures.py GRCTL FOLDER

GR001 steps, is pushed and falls, leans against a push; an SO-101 picks up a cube; a hexapod is put on
the floor and stands. Each shows what the guide says it does, or the exit status is 1.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import cube

from grobo import Description
from grobo._film import Film
from grobo.physics import Body, Virtual

GUIDE = Path("docs/guide/body.md")
HEXAPOD = "./tests/physics/hexapod.yaml"


class Filmed(Body):
    """A body that is filmed from the first moment on."""

    last = None

    def __init__(self, *args, **options):
        super().__init__(*args, **options)
        self.film = Film(self)
        self.on_step = self.film.look
        Filmed.last = self


def export(grctl, robot, folder, *options):
    path = folder / "robot.xml"
    subprocess.run([grctl, "robot", "export", robot, "--mjcf", "-o", str(path), "--yes", *options],
                   check=True)
    return path


def steps(grctl, folder):
    body = Filmed(export(grctl, "gr001", folder), Description("gr001"))
    with Virtual(body) as robot:
        robot.init()
        robot.run(1)
        robot.play("motions/step.pseq")
    return body, not body.fallen


def falls(grctl, folder):
    body = Filmed(export(grctl, "gr001", folder), Description("gr001"))
    with Virtual(body) as robot:
        robot.init()
        robot.run(0.5)
        body.film.frames = body.film.frames[-2:]
        body.push([-6.0, 0, 0], 0.2)
        robot.run(1)
    return body, body.fallen


def leans(grctl, folder):
    """The guide's own program."""
    program = next(part for part in GUIDE.read_text().split("```python\n") if "def lean" in part)
    model = export(grctl, "gr001", folder)
    program = program.partition("```")[0].replace('"gr001.xml"', repr(str(model)))
    program = program.replace("import Body, Virtual", "import Virtual")
    exec(compile(program, str(GUIDE), "exec"), {"Body": Filmed})
    body = Filmed.last
    body.film.frames = body.film.frames[-80:]  # the push begins 3 s before the end
    return body, not body.fallen


def stands(grctl, folder):
    body = Filmed(export(grctl, HEXAPOD, folder, "--free"), Description(HEXAPOD))
    body.film._camera.distance = 1.1
    with Virtual(body) as robot:
        robot.init()
        robot.run(1)
    return body, not body.fallen


def main(grctl, to):
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        for what, made in (("step", steps), ("push", falls), ("lean", leans), ("hexapod", stands)):
            body, good = made(grctl, Path(name))
            body.film.save(None, str(Path(to) / f"body-{what}.png"))
            print(f"body-{what}.png: {'good' if good else 'BAD'}", flush=True)
            failed += not good
    return 1 if failed or cube.main(grctl, str(Path(to) / "body-cube.png")) else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
