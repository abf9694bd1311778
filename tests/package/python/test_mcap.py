# SPDX-License-Identifier: MIT
"""MCAP files: written by grobo.mcap, read by the reader of the package mcap."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import grobo
from grobo.mcap import Writer, convert, packets

try:
    from mcap.reader import make_reader
except ImportError:
    make_reader = None

GRCTL = os.environ.get("GRCTL", "build/grctl")


def read(path):
    """(topic, time in s, content) of each message, in the order of time."""
    with open(path, "rb") as file:
        return [
            (channel.topic, message.log_time / 1e9, json.loads(message.data), schema.name)
            for schema, channel, message in make_reader(file).iter_messages()
        ]


class Trace(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.trace = Path(self.folder.name, "line.pcapng")

    def record(self):
        command = [GRCTL, "-d", "sim", "--trace", str(self.trace), "move", "R_ELBOW_P", "-20", "100"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    @unittest.skipUnless(os.access(GRCTL, os.X_OK), "no grctl")
    def test_packets_are_those_of_the_trace(self):
        self.record()
        found = packets(self.trace)
        told = subprocess.run(
            [GRCTL, "--json", "decode", str(self.trace)], check=True, capture_output=True, text=True
        )
        frames = [json.loads(line) for line in told.stdout.splitlines()]
        sent = "".join(f["hex"].replace(" ", "") for f in frames if f.get("from") == "host").lower()
        if sent:
            self.assertEqual("".join(p.data.hex() for p in found if p.sent), sent)
        self.assertTrue(any(p.sent for p in found) and any(not p.sent for p in found))
        self.assertEqual(sorted(p.time for p in found), [p.time for p in found])
        whole = self.trace.read_bytes()
        self.trace.write_bytes(whole[:-5])  # killed while it wrote
        self.assertEqual(packets(self.trace), found[:-1])

    def test_another_file_is_none(self):
        for text in (b"", b"type: PoseSeq\n", b"\x0a\x0d"):
            self.trace.write_bytes(text)
            with self.assertRaisesRegex(ValueError, "is not a pcapng file"):
                packets(self.trace)

    @unittest.skipUnless(make_reader, "no mcap")
    @unittest.skipUnless(os.access(GRCTL, os.X_OK), "no grctl")
    def test_a_trace_and_a_motion_in_a_file(self):
        self.record()
        target = Path(self.folder.name, "both.mcap")
        convert(["motions/greet.pseq", self.trace], target)
        messages = read(target)
        motion = grobo.Motion.load("motions/greet.pseq")
        joints = [m for m in messages if m[0] == "/joints"]
        line = [m for m in messages if m[0] == "/line"]
        self.assertEqual([m[1] for m in joints], [round(float(t), 9) for t in motion.times])
        self.assertEqual([m[2]["angles"] for m in joints], [dict(p) for p in motion])
        found = packets(self.trace)
        self.assertEqual([bytes.fromhex(m[2]["hex"]) for m in line], [p.data for p in found])
        self.assertEqual([m[2]["direction"] == "sent" for m in line], [p.sent for p in found])
        self.assertEqual({m[3] for m in messages}, {"grobo.JointAngles", "grobo.LineBytes"})


class Recording(unittest.TestCase):
    @unittest.skipUnless(make_reader, "no mcap")
    def test_times_are_those_when_postures_are_reached(self):
        rows = [[0.0] * 20, [0.1] * 20, [0.2] * 20]
        motion = grobo.Motion.of([0, 1, 2], rows)
        with tempfile.TemporaryDirectory() as folder:
            target = Path(folder, "motion.mcap")
            with Writer(target) as writer:
                writer.motion(motion, "/mine")
            messages = read(target)
        self.assertEqual([(m[0], m[1]) for m in messages], [("/mine", 0), ("/mine", 1), ("/mine", 2)])
        self.assertEqual(messages[1][2]["angles"]["R_ELBOW_P"], 0.1)

    def test_times_and_length_agree(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "equal.m")
            path.write_text("".join(f"{t}{' 0' * 20}\n" for t in (0, 500, 500, 1000, 200)))
            motion = grobo.Motion.load(path)
        self.assertEqual([round(float(t), 6) for t in motion.times], [0, 0.5, 0.75, 1.25, 1.5])
        self.assertEqual(motion.length, 1.5)


if __name__ == "__main__":
    unittest.main()
