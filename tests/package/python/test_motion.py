# SPDX-License-Identifier: MIT
"""Motions as arrays, errors by code, and what cffi knows of the library."""

import math
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import grobo
from grobo import _lib, errors

GREET = "motions/greet.pseq"
NAN = float("nan")


class Motions(unittest.TestCase):
    def test_arrays_come_back_as_they_were(self):
        rows = [[0.0, -0.5, NAN], [0.1, NAN, 0.25]]
        motion = grobo.Motion.of([0.5, 1.25], rows)
        self.assertEqual(len(motion), 2)
        self.assertEqual(motion.kind, "postures")
        self.assertEqual([float(t) for t in motion.times], [0.5, 1.25])
        for row, back in zip(rows, motion.angles):
            for angle, one in zip(row, back):
                self.assertTrue(angle == one or (math.isnan(angle) and math.isnan(one)))
        self.assertEqual(motion.length, 1.25)
        for kind in ("keys", "steps"):
            self.assertEqual(grobo.Motion.of([0.5, 1.25], rows, kind).length, 1.25)
        for kind in ("frames", "key"):  # frames have a rate instead of times
            with self.assertRaisesRegex(ValueError, kind):
                grobo.Motion.of([0.5, 1.25], rows, kind)

    def test_a_motion_lasts_as_long_as_its_times(self):
        rows = [[0.0] * 20, [0.1] * 20, [0.2] * 20]
        ends = (".m", ".mseq", ".pseq", ".yaml", ".seq")
        for times, kinds in (
            ([0, 1, 2], ("postures", "keys")),
            ([0.5, 1, 2], ("postures", "keys", "steps")),
            ([0, 0.5, 1.41], ("postures", "keys")),  # between two frames of 50 per second
        ):
            for kind in kinds:
                motion = grobo.Motion.of(times, rows, kind)
                self.assertEqual(motion.length, times[-1])
                with tempfile.TemporaryDirectory() as folder:
                    for end in ends:
                        motion.save(Path(folder, "copy" + end))
                        copy = grobo.Motion.load(Path(folder, "copy" + end))
                        self.assertEqual(copy.length, times[-1], (kind, end))
        for times in ([0, 1, 1], [0, 12, 13], [-1, 0, 1], [0, NAN, 2]):
            with self.assertRaisesRegex(ValueError, r"times\[\d\]"):
                grobo.Motion.of(times, rows)
        self.assertEqual(grobo.Motion.of([0, 1, 2], rows, "steps").length, 2.0)
        self.assertEqual(grobo.Motion.of([0, 12, 13], rows, "keys").length, 13.0)

    def test_a_notebook_shows_what_moves(self):
        rows = [[0.1 * i if j == 16 else 0.0 for j in range(20)] for i in range(3)]
        shown = grobo.Motion.of([0, 1, 2], rows)._repr_html_()
        self.assertEqual(shown.count("<polyline"), 1)
        self.assertIn("R_ELBOW_P", shown)
        self.assertIn("0.0 to 11.5 deg in 2 s", shown)
        self.assertIn("0.0,240.0", shown)
        self.assertIn("640.0,0.0", shown)
        self.assertIn("no joint moves", grobo.Motion.of([0, 1], rows[:1] * 2)._repr_html_())
        self.assertIn("no joint moves", grobo.Motion()._repr_html_())

    def test_rows_have_an_angle_for_each_joint(self):
        with self.assertRaisesRegex(ValueError, "^1 angles for 2 joints"):
            grobo.Motion.of([0.5, 1.0], [[0.0, 0.5], [0.1]])
        motion = grobo.Motion()
        for wrong in ([0.0, 0.0, 1.0], [0.0] * 21):
            with self.assertRaisesRegex(ValueError, f"^{len(wrong)} angles for 20 joints"):
                motion.append(wrong, 0.5)
        self.assertEqual(len(motion), 0)
        arm = grobo.Motion.of([0.5], [[0.0] * 6], robot=grobo.Description("so101"))
        self.assertIn("gripper", arm[0])
        arm.append({"gripper": 0.1}, 0.5)
        with self.assertRaisesRegex(ValueError, "^20 angles for 6 joints"):
            arm.append([0.0] * 20, 0.5)
        with self.assertRaisesRegex(ValueError, "^5 angles for 6 joints"):
            grobo.Motion.of([0.5], [[0.0] * 5], robot=grobo.Description("so101"))

    def test_a_file_is_read_and_written(self):
        motion = grobo.Motion.load(GREET)
        self.assertEqual(motion.kind, "keys")
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder, "copy.pseq")
            motion.save(copy)
            again = grobo.Motion.load(str(copy))
        self.assertEqual(list(motion.times), list(again.times))
        self.assertEqual([dict(p) for p in motion], [dict(p) for p in again])

    def test_mirror_reverse_and_crop_make_copies(self):
        motion = grobo.Motion.load(GREET)
        twice = motion.mirror().mirror()
        self.assertEqual([dict(p) for p in motion], [dict(p) for p in twice])
        mirrored = motion.mirror()
        self.assertEqual(motion[1]["R_ELBOW_P"], -mirrored[1]["L_ELBOW_P"])
        backwards = motion.reverse()
        self.assertEqual(dict(motion[0]), dict(backwards[-1]))
        self.assertAlmostEqual(motion.crop(1.0, 2.0).length, 1.0)

    def test_postures_are_mappings(self):
        posture = grobo.Motion.load(GREET)[0]
        name = next(iter(posture))
        self.assertAlmostEqual(posture.degrees[name], math.degrees(posture[name]))
        self.assertEqual(len(posture), len(list(posture)))
        with self.assertRaises(KeyError):
            posture["NOSE"]
        with self.assertRaises(IndexError):
            grobo.Motion()[0]

    def test_a_broken_file_names_the_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "bad.m")
            path.write_text("100 0 0\n100 what 0\n")
            with self.assertRaises(errors.Syntax) as caught:
                grobo.Motion.load(path)
        self.assertIn("line 2: ", str(caught.exception))
        with self.assertRaises(FileNotFoundError):
            grobo.Motion.load("no-such.pseq")

    @unittest.skipIf(grobo.motion.numpy is None, "needs numpy")
    def test_arrays_are_those_of_numpy(self):
        motion = grobo.Motion.load(GREET)
        self.assertEqual(motion.angles.shape, (len(motion), 20))
        again = grobo.Motion.of(motion.times, motion.angles, "keys")
        grobo.motion.numpy.testing.assert_array_equal(motion.angles, again.angles)


class Binding(unittest.TestCase):
    def test_every_error_has_its_exception(self):
        listed = re.findall(r"X\((\w+), (-\d+),", Path("include/grobo/error.h").read_text())
        self.assertGreater(len(listed), 30)
        for name, code in listed:
            made = errors.error(int(code), "x")
            called = errors._NAMES.get(name, name.capitalize())
            self.assertIs(type(made), getattr(errors, called))
            self.assertEqual(made.code, int(code))
        self.assertIsInstance(errors.error(-13, "x"), TimeoutError)
        self.assertIsInstance(errors.error(-20, "x"), ConnectionError)
        self.assertEqual(str(errors.error(-13, "read", "HEAD")), "read: no reply in time (HEAD)")

    def test_every_exported_name_is_known(self):
        """But for those that work in storage of a C program: lines.h, static.h, sim_static.h, locks."""
        def declared(*names):
            text = "".join(Path("include/grobo", name).read_text() for name in names)
            return re.findall(r"GROBO_API [^;]*?\b(grobo_\w+)\(", text)

        listed = re.findall(r"^\s*(grobo_\w+);", Path("src/libgrobo.map").read_text(), re.M)
        in_storage = declared("core/lines.h", "core/static.h", "core/sim_static.h")
        in_storage += [n for n in declared("core/port.h") if re.match("grobo_(mutex|cond)_", n)]
        self.assertGreater(len(listed), 500)
        self.assertEqual([n for n in listed if not hasattr(_lib.lib, n)], sorted(in_storage))

    def test_another_version_is_refused(self):
        lib = mock.Mock(wraps=_lib.lib, GROBO_VERSION_MAJOR=0, GROBO_VERSION_MINOR=999)
        with mock.patch.object(_lib, "lib", lib):
            with self.assertRaisesRegex(ImportError, "this package needs 0.999"):
                _lib._check_version()

    @unittest.skipUnless(os.environ.get("CC"), "needs $CC")
    def test_a_compiler_agrees_with_every_layout(self):
        """cffi has it check sizes, offsets and constants of the same declarations."""
        try:
            import setuptools  # noqa: F401
        except ImportError:
            self.skipTest("needs python3-setuptools")
        if not os.path.exists(sysconfig.get_config_h_filename()):
            self.skipTest("needs python3-dev")
        import cffi

        text = subprocess.run(
            [sys.executable, "tools/python/generate.py", ".", os.environ["CC"], "--print"],
            stdout=subprocess.PIPE, text=True, check=True,
        ).stdout
        headers = [*Path("include/grobo").glob("*.h"), *Path("include/grobo").glob("core/*.h")]
        includes = "".join(f"#include <{p.relative_to('include')}>\n" for p in headers)
        with tempfile.TemporaryDirectory() as folder:
            ffi = cffi.FFI()
            ffi.cdef(text)
            ffi.set_source(
                "proof", includes,
                include_dirs=[os.path.abspath("include"), os.path.abspath("ports/posix/include")],
                extra_compile_args=["-O0", "-w"], extra_link_args=["-Wl,-z,lazy"],
            )
            ffi.compile(tmpdir=folder)
            library = os.path.join(os.path.dirname(grobo.__file__), _lib.NAME)
            check = (
                f"import ctypes, sys; sys.path.insert(0, {folder!r})\n"
                f"ctypes.CDLL({library!r}, ctypes.RTLD_GLOBAL)\n"
                "import proof\n"
                "kinds = [k for kind in proof.ffi.list_types() for k in kind]\n"
                "for kind in kinds:\n"
                "    try: proof.ffi.sizeof(kind)\n"
                "    except proof.ffi.error as e:\n"
                "        if 'know the size' not in str(e) and 'undefined type' not in str(e): raise\n"
                "print(len(kinds))\n"
            )
            done = subprocess.run([sys.executable, "-c", check], stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0)
            self.assertGreater(int(done.stdout), 100)


if __name__ == "__main__":
    unittest.main()
