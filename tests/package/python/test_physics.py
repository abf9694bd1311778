# SPDX-License-Identifier: MIT
"""Servos of the library in front of a body of MuJoCo."""

import collections
import ctypes
import importlib.util
import math
import os
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import grobo
from grobo import Description, Motion, errors

HERE = all(importlib.util.find_spec(name) for name in ("mujoco", "numpy"))
if HERE:
    from grobo import _film
    from grobo._lib import ffi, lib
    from grobo.physics import Body, Virtual
needs_mujoco = unittest.skipUnless(HERE, "no MuJoCo (make check-physics gets it from PyPI)")

# A pan-tilt head whose arm has 0.1 kg at 0.15 m, on a box that stands on the floor where BASE is a
# free joint.
HEAD = """<mujoco><option gravity="0 0 -9.80665"/><worldbody>
<geom name="floor" type="plane" size="2 2 0.1"/>
<body name="base" pos="0 0 0.1">BASE
 <inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
 <geom type="box" size="0.04 0.04 0.05"/>
 <body name="yoke" pos="0 0 0.06"><joint name="pan" axis="0 0 1"/>
  <inertial pos="0 0 0" mass="0.05" diaginertia="1e-5 1e-5 1e-5"/>
  <body name="arm" pos="0 0 0.02"><joint name="tilt" axis="0 1 0"/>
   <inertial pos="0.15 0 0" mass="0.1" diaginertia="1e-5 1e-5 1e-5"/>
   <geom type="sphere" pos="0.15 0 0" size="0.02" contype="0" conaffinity="0"/>
</body></body></body></worldbody></mujoco>"""


class Heads(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.fixed = self.folder / "fixed.xml"
        self.fixed.write_text(HEAD.replace("BASE", ""))
        self.free = self.folder / "free.xml"
        self.free.write_text(HEAD.replace("BASE", '<freejoint name="root"/>'))
        self.robot = Description("pan-tilt")

    def virtual(self, path, **options):
        made = Virtual(Body(path, self.robot, **options))
        self.addCleanup(made.close)
        return made


@needs_mujoco
class InVirtualTime(Heads):
    def test_the_engine_moves_a_body_and_it_sags(self):
        robot = self.virtual(self.fixed)
        robot.init()
        robot.run(2)
        pan, tilt = robot.body.data.joint("pan").qpos[0], robot.body.data.joint("tilt").qpos[0]
        self.assertAlmostEqual(math.degrees(pan), 0, delta=0.3)
        # 0.147 Nm at a spring of 17.8 Nm/rad less friction: it hangs by up to 0.5 degrees.
        self.assertGreater(math.degrees(tilt), -0.1)
        self.assertLess(math.degrees(tilt), 0.8)
        self.assertEqual(robot.trips, [])

    def test_each_run_gives_the_same(self):
        ends = []
        for _ in range(2):
            robot = self.virtual(self.free)
            robot.init()
            robot.body.push([1.0, 0, 0], 0.1)
            robot.run(0.5)
            ends.append(tuple(robot.body.data.qpos))
        self.assertEqual(ends[0], ends[1])

    def test_a_free_base_is_held_until_the_joints_have_torque(self):
        robot = self.virtual(self.free)
        robot.run(0.5)
        self.assertTrue(robot.body.held)
        self.assertEqual(robot.body.tilt().angle, 0)
        robot.init()
        robot.run(1)
        self.assertFalse(robot.body.held)
        self.assertFalse(robot.body.fallen)
        self.assertLess(robot.body.tilt().angle, math.radians(2))

    def test_it_falls_when_it_is_pushed(self):
        robot = self.virtual(self.free)
        robot.init()
        robot.run(0.5)
        robot.body.push([0, 8.0, 0], 0.3)
        robot.run(2)
        self.assertTrue(robot.body.fallen)
        self.assertGreater(robot.body.tilt().angle, math.radians(45))

    def test_faults_and_hands_of_the_simulator_work_there(self):
        robot = self.virtual(self.fixed)
        robot.init()
        robot.hand("pan", 5.0)
        robot.run(1)
        self.assertGreater(math.degrees(robot.body.data.joint("pan").qpos[0]), 5)
        robot.hand("pan", 0)
        robot.block("tilt", True)
        robot.run(0.1)
        at = robot.body.data.joint("tilt").qpos[0]
        robot.hand("tilt", -3)
        robot.run(1)
        self.assertAlmostEqual(robot.body.data.joint("tilt").qpos[0], at, delta=0.01)
        robot.set_faults("silent=1")
        robot.hand("tilt", 0)
        robot.block("tilt", False)
        with self.assertRaises(errors.Error):
            robot.init()
        with self.assertRaises(errors.Error):
            robot.set_faults("nonsense=1")

    def test_a_payload_weighs(self):
        body = Body(self.fixed, self.robot)
        arm = body.model.body("arm").id
        body.set_payload(0.1, "arm")
        self.assertAlmostEqual(body.model.body_mass[arm], 0.2)
        self.assertAlmostEqual(body.model.body_ipos[arm][0], 0.075)
        # 2 masses of 0.1 kg at 75 mm of their centre.
        self.assertAlmostEqual(max(body.model.body_inertia[arm]), 1e-5 + 0.2 * 0.075**2)
        with self.assertRaises(errors.Error):
            body.set_payload(0.1, "nose")

    def test_a_fixed_base_is_freed_and_stands_on_a_floor(self):
        urdf = self.folder / "head.urdf"
        link = ('<link name="{0}"><inertial><origin xyz="{1}"/><mass value="{2}"/><inertia ixx="1e-4"'
                ' iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>{3}</link>')
        box = '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
        joint = ('<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin '
                 'xyz="0 0 {3}"/><axis xyz="{4}"/><limit lower="-2" upper="2" effort="9" '
                 'velocity="9"/></joint>')
        urdf.write_text('<robot name="head">' + link.format("base", "0 0 0", 1, box)
                        + link.format("yoke", "0 0 0", 0.05, "")
                        + link.format("arm", "0.05 0 0", 0.05, "")
                        + joint.format("pan", "base", "yoke", 0.06, "0 0 1")
                        + joint.format("tilt", "yoke", "arm", 0.02, "0 1 0") + "</robot>")
        robot = self.virtual(urdf, free=True)
        robot.init()
        robot.run(1)
        self.assertFalse(robot.body.fallen)
        self.assertAlmostEqual(robot.body.tilt().height, 0.05, delta=0.01)

    def test_what_a_file_lacks_is_named(self):
        with self.assertRaisesRegex(LookupError, "no joint R_HIP_Y; its joints: pan, tilt"):
            Body(self.fixed, Description("gr001"))
        with self.assertRaisesRegex(FileNotFoundError, "nowhere.xml"):
            Body("nowhere.xml", self.robot)
        bad = self.folder / "bad.xml"
        bad.write_text("<mujoco><nonsense/></mujoco>")
        with self.assertRaisesRegex(ValueError, "bad.xml"):
            Body(bad, self.robot)


@needs_mujoco
class InRealTime(Heads):
    def serve(self, *options):
        command = [sys.executable, "-m", "grobo.physics", str(self.free), "--robot", "pan-tilt",
                   *options]
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)

        def end():
            process.kill()
            process.communicate()

        self.addCleanup(end)
        return process, process.stdout.readline().strip()

    def test_a_program_drives_it_behind_a_pty(self):
        link = self.folder / "head"
        process, device = self.serve("--link", str(link))
        self.assertTrue(os.path.exists(device))
        with grobo.connect(str(link), robot="pan-tilt", guard=False) as robot:
            robot.init()
            robot.move({"pan": 0.5}, time=0.3)
            self.assertAlmostEqual(robot.angles(["pan"])["pan"], 0.5, delta=0.05)
        process.stdin.write("look\npush 0 12 0 400\nnonsense\n")
        process.stdin.flush()
        said = ""
        while "it fell" not in said:
            line = process.stderr.readline()
            self.assertTrue(line, said)
            said += line
        self.assertIn("what is 'nonsense'?", said)
        out, _ = process.communicate("quit\n", timeout=60)
        self.assertEqual(process.returncode, 0)
        self.assertFalse(link.exists())

    def test_a_tcp_port_serves_too(self):
        process, device = self.serve("--tcp", "0", "--no-pty")
        self.assertRegex(device, r"^tcp:127\.0\.0\.1:\d+$")
        with socket.create_connection(("127.0.0.1", int(device.rsplit(":", 1)[1]))) as line:
            line.sendall(bytes([255, 255, 1, 2, 1, 251]))  # a ping
            line.settimeout(60)
            self.assertEqual(line.recv(64)[:3], bytes([255, 255, 1]))
        process.terminate()
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 128 + 15)

    def test_mistakes_are_told(self):
        done = subprocess.run([sys.executable, "-m", "grobo.physics", "nowhere.xml"],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("nowhere.xml: no such file", done.stderr)


GRCTL = os.environ.get("GRCTL", "")
HEXAPOD = "tests/physics/hexapod.yaml"


@needs_mujoco
@unittest.skipUnless(GRCTL, "no GRCTL")
class Exported(Heads):
    def stand(self, robot, *options):
        path = self.folder / "robot.xml"
        subprocess.run([GRCTL, "robot", "export", robot, "--mjcf", "-o", str(path), *options],
                       check=True)
        made = Virtual(Body(path, Description(robot)))
        self.addCleanup(made.close)
        made.init()
        made.run(1)
        return made

    def test_gr001_stands_on_its_feet(self):
        robot = self.stand("gr001")
        self.assertFalse(robot.body.held)
        self.assertLess(math.degrees(robot.body.tilt().angle), 3)
        self.assertGreater(robot.body.tilt().height, 0.14)
        self.assertEqual(robot.trips, [])

    def test_gr001_steps_in_place(self):
        robot = self.stand("gr001")
        feet, lifted = [robot.body.data.body(n) for n in ("R_ANKLE_R", "L_ANKLE_R")], [0.0, 0.0]
        ground = [float(foot.xpos[2]) for foot in feet]

        def look(_body):
            for n, foot in enumerate(feet):
                lifted[n] = max(lifted[n], float(foot.xpos[2]) - ground[n])

        robot.body.on_step = look
        robot.play("motions/step.pseq")
        robot.run(1)
        self.assertFalse(robot.body.fallen)
        self.assertGreater(min(lifted), 0.004)

    def test_gr001_falls_when_it_is_pushed(self):
        robot = self.stand("gr001")
        robot.body.push([-6.0, 0, 0], 0.2)
        robot.run(2)
        self.assertTrue(robot.body.fallen)

    def pushed(self, stabilizer):
        path = self.folder / "robot.xml"
        subprocess.run([GRCTL, "robot", "export", "gr001", "--mjcf", "-o", str(path), "--yes"],
                       check=True)
        gr001 = Description("gr001")
        initial = [float(gr001.model.joints[j].init_rad) for j in range(20)]
        robot = Virtual(Body(path, gr001), stabilizer=stabilizer)
        self.addCleanup(robot.close)
        robot.init()
        robot.run(0.6)
        self.upright = robot.body.tilt().pitch
        robot.body.push([-1.5, 0, 0], 1.0, after=1.0)
        robot.play(Motion.of([0.5, 4], [initial, initial], kind="keys", robot=gr001))
        return robot

    def test_a_stabilizer_stands_against_a_push(self):
        right, left = (Description("gr001").joints.index(n) for n in ("R_ANKLE_P", "L_ANKLE_P"))
        self.upright, seen = 0.0, []

        def lean(tilt, sensed, target):
            turn = max(-0.3, min(0.3, tilt.pitch - self.upright + 0.1 * tilt.rates[1]))
            target[right] += turn
            target[left] -= turn
            seen.append((sensed[right], target[right]))

        self.assertTrue(self.pushed(None).body.fallen)
        robot = self.pushed(lean)
        self.assertFalse(robot.body.fallen)
        self.assertLess(math.degrees(robot.body.tilt().angle), 5)
        self.assertEqual(robot.trips, [])
        # What it gave is what the servos were told: read again it is there, by and by.
        self.assertGreater(len(seen), 100)
        self.assertLess(sum(abs(was - goal) for was, goal in seen) / len(seen), 0.1)

    def example(self):
        """The stabilizer of docs/examples/balance.c: a C function."""
        made = self.folder / "balance.so"
        source = ('#define main of_the_example\n#include "docs/examples/balance.c"\n'
                  "extern const void *const leans;\nconst void *const leans = (const void *)lean;\n")
        subprocess.run([os.environ.get("CC", "cc"), "-x", "c", "-shared", "-fPIC", "-I.", "-Iinclude", "-Iports/posix/include",
                        "-o", str(made), "-"], input=source, text=True, check=True)
        self.loaded = ctypes.CDLL(str(made), mode=os.RTLD_LAZY)  # its main() is never called
        address = ctypes.c_void_p.in_dll(self.loaded, "leans").value
        return ffi.cast("void *", address)

    def leant(self, force, example):
        """GR001 is told to stand each 20 ms, as by the example, and pushed for a second. Its IMU
        tells what was 60 ms ago: two lines that wait."""
        path = self.folder / "robot.xml"
        subprocess.run([GRCTL, "robot", "export", "gr001", "--mjcf", "-o", str(path), "--yes"],
                       check=True)

        class Late(Body):
            past = collections.deque(maxlen=60)  # a step of 1 ms each

            def _advance(self, *of_a_step):
                super()._advance(*of_a_step)
                self.past.append(super().tilt())

            def tilt(self):
                return self.past[0] if self.past else super().tilt()

        class Leaning(Virtual):
            def _driver(self):
                made = super()._driver()
                made.stabilize_by = ffi.cast(ffi.typeof(made.stabilize_by), example)
                return made

        body = Late(path, Description("gr001"))
        robot = Leaning(body, stabilizer=lambda *_: None) if example else Virtual(body)
        self.addCleanup(robot.close)
        robot.init()
        still = ffi.new("grobo_posture *")
        lib.grobo_posture_init_pose(still, body.robot.model)
        still.time_us = 40000
        body.push([force, 0, 0], 1.0, after=1.5)
        for _ in range(200):
            self.assertEqual(lib.grobo_robot_send(robot.robot, still), 0)
            robot.run(0.02)
        self.assertEqual(robot.trips, [])
        return body

    def test_the_example_in_c_stands_against_a_push(self):
        self.assertTrue(self.leant(-1.5, None).fallen)
        for force in (-1.5, 1.2):
            body = self.leant(force, self.example())
            self.assertFalse(body.fallen, force)
            self.assertLess(math.degrees(body.tilt().angle), 3)

    def test_the_guides_programs_run(self):
        guide = Path("docs/guide/body.md").read_text()
        programs = [part.partition("```")[0] for part in guide.split("```python\n")[1:]]
        subprocess.run([GRCTL, "robot", "export", "gr001", "--mjcf", "-o",
                        str(self.folder / "gr001.xml")], check=True)
        said = [subprocess.run([sys.executable, "-c", program], cwd=self.folder, text=True,
                               capture_output=True, check=True).stdout for program in programs]
        pushed, leant = said
        self.assertRegex(pushed, r"^Tilt\(roll=.* False$")
        self.assertEqual(leant, "False\n")

    def test_a_stabilizer_is_judged_and_its_errors_are_told(self):
        def far(tilt, sensed, target):
            target[:] = 9.0

        def wrong(tilt, sensed, target):
            raise ZeroDivisionError("of the stabilizer")

        with self.assertRaisesRegex(errors.Error, "limits"):
            self.pushed(far)
        with self.assertRaisesRegex(Exception, "canceled|of the stabilizer"):
            self.pushed(wrong)

    def test_a_hexapod_stands(self):
        robot = self.stand("./" + HEXAPOD, "--free")
        self.assertFalse(robot.body.held)
        self.assertFalse(robot.body.fallen)
        self.assertLess(math.degrees(robot.body.tilt().angle), 3)
        self.assertGreater(robot.body.tilt().height, 0.05)


@unittest.skipUnless(HERE, "no numpy")
class Films(unittest.TestCase):
    def test_a_picture_is_a_png(self):
        import zlib

        import numpy

        frame = numpy.arange(5 * 4 * 3, dtype=numpy.uint8).reshape(5, 4, 3)
        data = _film.png(frame)
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        length = int.from_bytes(data[33:37], "big")
        self.assertEqual(data[37:41], b"IDAT")
        rows = zlib.decompress(data[41:41 + length])
        above = [0] * 12
        for y in range(5):  # undone as the standard says
            row = rows[y * 13:(y + 1) * 13]
            self.assertEqual(row[0], 2)
            above = [(b + a) % 256 for a, b in zip(above, row[1:])]
            self.assertEqual(above, list(frame[y].flatten()))
        film = _film.animated([frame, frame, frame], 25)
        self.assertEqual((film.count(b"fcTL"), film.count(b"fdAT")), (3, 2))


class Without(unittest.TestCase):
    def test_without_mujoco_it_says_what_to_install(self):
        code = ("import sys; sys.modules['mujoco'] = None\n"
                "from grobo.physics import main; sys.exit(main(['x.xml']))")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("MuJoCo is missing: pip install mujoco numpy", done.stderr)


if __name__ == "__main__":
    unittest.main()
