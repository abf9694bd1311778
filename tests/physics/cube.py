# SPDX-License-Identifier: MIT
"""An SO-101 picks up a cube, driven by the library's engine in virtual time.

usage: cube.py GRCTL [STRIP.png]

The exported arm has boxes for its links; a finger, the jaw's pad and a cube of 25 mm and 20 g, 0.22 m
before the base, are put into the file. The arm goes down with the jaw open, closes it, and lifts. The
exit status is 1 where the cube does not hang in the gripper at the end.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from grobo import Description, Motion
from grobo.physics import Body, Virtual

GRIPS = 'type="box" friction="1 0.005 0.0001" rgba="0.9 0.5 0.1 1"/>\n'
FINGER = '<geom pos="-0.0125 0 -0.078" size="0.004 0.01 0.024" ' + GRIPS
PAD = '<geom pos="-0.004 -0.056 0.0188" size="0.004 0.024 0.01" ' + GRIPS
CUBE = ('<body name="cube" pos="0.22 0 0.0125"><freejoint/><geom type="box" size="0.0125 0.0125 0.0125" '
        'mass="0.02" contype="1" friction="1 0.005 0.0001" condim="4" rgba="0.8 0.1 0.1 1"/></body>\n')
FLOOR = ('<geom name="floor" type="plane" size="5 5 0.1" contype="1" rgba="0.8 0.8 0.8 1"/>\n'
         '<light pos="0 0 3" dir="0 0 -1"/>\n')
# Radians in the order of the joints: the gripper points down, 90 mm and 17 mm above the floor.
ABOVE = [0, -0.1569, 0.1292, 1.5985, 0]
DOWN = [0, -0.0287, 0.5430, 1.0565, 0]
OPEN, SHUT = 0.9, -0.1


def scene(grctl):
    text = subprocess.run([grctl, "robot", "export", "so101", "--mjcf"], capture_output=True,
                          text=True, check=True).stdout
    floor = "" if 'type="plane"' in text else FLOOR
    for mark, more in (('<body name="jaw"', FINGER), ('<joint name="gripper"', PAD),
                       ('<body name="base"', floor + CUBE)):
        assert mark in text, mark
        text = text.replace(mark, more + mark, 1)
    return text


def main(grctl, strip=None):
    robot = Description("so101")
    motion = Motion.of([2, 4, 5, 5.5, 7.5, 8.5],
                       [[*ABOVE, OPEN], [*DOWN, OPEN], [*DOWN, SHUT], [*DOWN, SHUT], [*ABOVE, SHUT],
                        [*ABOVE, SHUT]], kind="keys", robot=robot)
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "scene.xml"
        path.write_text(scene(grctl))
        body, film = Body(path, robot), None
        if strip:
            from grobo._film import Film

            film = Film(body)
            film._camera.distance = 0.75
            body.on_step = film.look
        with Virtual(body) as made:
            made.init()
            made.play(motion)
            made.run(0.5)
            height, trips = float(body.data.body("cube").xpos[2]), made.trips
    if film:
        film.frames = film.frames[len(film.frames) // 4:]
        film.save(None, strip)
    good = height > 0.05 and not trips
    print(f"the cube is at {height * 1000:.0f} mm, {len(trips)} stops: {'good' if good else 'BAD'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
