# SPDX-License-Identifier: MIT
"""The plugin for LeRobot: by its documented interface against a stand-in of LeRobot, or the real
one (GROBO_LEROBOT=real, with torch or without), and a simulator."""

import dataclasses
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

HERE = Path(__file__).parent
TOP = HERE.parents[2]
PLUGIN = TOP / "tools/python/lerobot_robot_grobo"
REAL = os.environ.get("GROBO_LEROBOT") == "real"
sys.path.insert(0, str(PLUGIN))
if not REAL:
    if sys.version_info < (3, 10):
        raise unittest.SkipTest("LeRobot needs Python 3.12, its stand-in 3.10")
    sys.path.insert(0, str(HERE / "lerobot_stand_in"))
else:
    sys.path.insert(0, str(TOP / "tests/support"))
    from lerobot_alone import import_alone

    import_alone()

import grobo  # noqa: E402
import lerobot_robot_grobo  # noqa: E402
from lerobot.robots import RobotConfig, make_robot_from_config  # noqa: E402
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError  # noqa: E402
from lerobot_robot_grobo import (  # noqa: E402
    Grobo, GroboConfig, GroboLeader, GroboLeaderConfig,
)
from lerobot_robot_grobo.scale import Scale  # noqa: E402

PERIOD_S = 0.02


def until(condition):
    """Polls; the tests' own limit ends one that waits in vain."""
    while not condition():
        time.sleep(0.005)


class Plugin(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def config(self, **options):
        options = {"action_s": 0.04, **options}
        return GroboConfig(port="sim", id="bench", calibration_dir=self.folder, **options)

    def make(self, **options):
        robot = make_robot_from_config(self.config(**options))
        self.addCleanup(robot.disconnect)
        return robot

    def make_leader(self, port="sim"):
        config = GroboLeaderConfig(port=port, id="bench", calibration_dir=self.folder)
        leader = GroboLeader(config)
        self.addCleanup(leader.disconnect)
        return leader

    def drive(self, robot, target, done):
        """As LeRobot's loop: observe, act, each period."""
        while True:
            seen = robot.get_observation()
            if done(seen):
                return seen
            robot.send_action(target)
            time.sleep(PERIOD_S)

    def test_is_found_by_its_name(self):
        project = (PLUGIN / "pyproject.toml").read_text()
        name = re.search(r'^name = "(.*)"', project, re.M).group(1)
        self.assertEqual(name, lerobot_robot_grobo.__name__)
        self.assertTrue(name.startswith("lerobot_robot_"))

    @unittest.skipUnless(REAL, "LeRobot's own search")
    def test_lerobot_finds_it_and_reads_its_options(self):
        import draccus
        from lerobot.utils.import_utils import register_third_party_plugins

        info = self.folder / "lerobot_robot_grobo-0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: lerobot_robot_grobo\nVersion: 0\n")
        sys.path.insert(0, str(self.folder))
        self.addCleanup(sys.path.remove, str(self.folder))
        with self.assertLogs(level="INFO") as log:
            register_third_party_plugins()
        self.assertIn("Imported third-party plugin: lerobot_robot_grobo", "".join(log.output))
        command = dataclasses.make_dataclass("Command", [("robot", RobotConfig)])
        options = "--robot.type=grobo --robot.port=sim --robot.robot=koch --robot.stale_s=1"
        config = draccus.parse(config_class=command, args=options.split()).robot
        self.assertEqual((type(config), config.port, config.robot, config.stale_s, config.on_exit),
                         (GroboConfig, "sim", "koch", 1.0, "default"))

    @unittest.skipUnless(REAL, "LeRobot's own search")
    def test_lerobot_makes_the_leader_of_its_options(self):
        import draccus
        from lerobot.teleoperators import TeleoperatorConfig, make_teleoperator_from_config

        command = dataclasses.make_dataclass("Command", [("teleop", TeleoperatorConfig)])
        options = "--teleop.type=grobo_leader --teleop.port=sim --teleop.id=bench"
        options += f" --teleop.calibration_dir={self.folder}"
        calibration = {"id": 6, "drive_mode": 0, "homing_offset": 0, "range_min": 1948,
                       "range_max": 2148}
        (self.folder / "bench.json").write_text(json.dumps({"gripper": calibration}))
        config = draccus.parse(config_class=command, args=options.split()).teleop
        leader = make_teleoperator_from_config(config)
        self.addCleanup(leader.disconnect)
        self.assertIsInstance(leader, GroboLeader)
        leader.connect()
        self.assertAlmostEqual(leader.get_action()["gripper.pos"], 50, delta=1)

    def test_its_config_makes_it(self):
        robot = self.make()
        self.assertIsInstance(robot, Grobo)
        self.assertIs(Grobo.config_class, GroboConfig)
        self.assertTrue(issubclass(GroboConfig, RobotConfig))

    def test_features_are_known_before_it_is_connected(self):
        robot = self.make()
        self.assertEqual(len(robot.action_features), 6)
        self.assertIs(robot.action_features["elbow_flex.pos"], float)
        self.assertEqual(robot.observation_features, robot.action_features)
        self.assertFalse(robot.is_connected)
        self.assertFalse(robot.is_calibrated)  # nobody has read it yet

    def test_connecting_moves_nothing_and_holds(self):
        robot = self.make()
        robot.connect()
        self.assertTrue(robot.is_connected)
        self.assertTrue(robot.is_calibrated)
        joints = robot._robot.status().joints.values()
        self.assertEqual({joint.torque for joint in joints}, {grobo.Torque.ON})
        self.assertTrue(all(abs(joint.target - joint.angle) < 0.01 for joint in joints))
        with self.assertRaises(DeviceAlreadyConnectedError):
            robot.connect()

    def test_actions_are_followed(self):
        robot = self.make()
        robot.connect()
        target = {"elbow_flex.pos": 12.0, "gripper.pos": 20.0}
        seen = self.drive(robot, target, lambda s: abs(s["elbow_flex.pos"] - 12) < 0.5)
        self.assertEqual(set(seen), set(robot.observation_features))
        self.drive(robot, target, lambda s: abs(s["gripper.pos"] - 20) < 0.5)

    def test_units_of_the_robots_file_hold(self):
        file = self.folder / "lift.yaml"
        file.write_text(
            "name: lift\nfamily: feetech\nexit: off\njoints:\n"
            "  - {name: turn, id: 1, servo: STS3215, limits_deg: [-110, 110]}\n"
            "  - {name: height, id: 2, servo: STS3215, limits_mm: [0, 60], mm_per_turn: 180}\n"
            "  - {name: gripper, id: 3, servo: STS3215, limits_deg: [-20, 90],"
            " percent_deg: [90, -10]}\n"
        )
        scale = Scale(grobo.Description(str(file)), ("gripper",), {})
        joint = mock.Mock()
        for name, shown, deg in ("turn", 30, 30), ("height", 30, 60), ("gripper", 75, 15):
            joint.name = name
            self.assertAlmostEqual(math.degrees(scale.angle(joint, shown)), deg)
            self.assertAlmostEqual(scale.shown(joint, math.radians(deg)), shown)

    def test_a_gripper_is_a_part_of_its_range(self):
        """As LeRobot has it: 0 closed, 100 open; degrees where that is asked for."""
        robot = self.make(max_relative_target=None)
        robot.connect()
        low, high = (math.degrees(end) for end in robot._description.limits["gripper"])
        for percent in 0.0, 50.0, 100.0:
            sent = robot.send_action({"gripper.pos": percent})
            self.assertAlmostEqual(sent["gripper.pos"], percent)
            self.drive(robot, sent, lambda s, percent=percent: abs(s["gripper.pos"] - percent) < 0.5)
            at = robot._robot.status().joints["gripper"].degrees
            self.assertAlmostEqual(at, low + percent / 100 * (high - low), delta=1)
        self.assertEqual(robot.send_action({"gripper.pos": 130.0})["gripper.pos"], 100)
        robot.disconnect()
        robot = self.make(percent=())
        robot.connect()
        self.assertAlmostEqual(robot.send_action({"gripper.pos": 3.0})["gripper.pos"], 3)

    def test_its_range_is_that_of_lerobots_calibration(self):
        one = type("Calibration", (), {"range_min": 2048, "range_max": 2048 + 1024})
        scale = Scale(grobo.Description("so101"), ("gripper",), {"gripper": one})
        joint = grobo.JointStatus("gripper", 0.0, 0.0, None, None, None, None, None)
        self.assertAlmostEqual(scale.shown(joint, math.radians(45)), 50)
        self.assertAlmostEqual(scale.angle(joint, 100), math.radians(90))
        kept = dataclasses.replace(joint, range=(0.0, 1.0))
        scale = Scale(grobo.Description("so101"), ("gripper",), {})
        self.assertAlmostEqual(scale.shown(kept, 0.25), 25)

    def test_a_leader_is_limp_and_tells_where_it_is(self):
        leader = self.make_leader()
        self.assertFalse(leader.is_connected or leader.is_calibrated)
        with self.assertRaises(DeviceNotConnectedError):
            leader.get_action()
        leader.connect()
        self.assertTrue(leader.is_connected and leader.is_calibrated)
        joints = leader._robot.status().joints.values()
        self.assertEqual({joint.torque for joint in joints}, {grobo.Torque.OFF})
        follower = self.make()
        follower.connect()
        action = leader.get_action()
        self.assertEqual(set(action), set(follower.action_features))
        sent = follower.send_action(action)
        self.assertAlmostEqual(sent["wrist_flex.pos"], action["wrist_flex.pos"], delta=0.1)
        self.assertEqual(leader.feedback_features, {})
        leader.send_feedback({})
        leader.disconnect()
        self.assertFalse(leader.is_connected)

    @unittest.skipUnless(os.environ.get("GRCTL"), "needs $GRCTL")
    def test_an_arm_from_the_factory_is_not_calibrated(self):
        link = self.folder / "arm"
        servos = ",".join(f"{i}=STS3215" for i in range(1, 7))
        sim = subprocess.Popen([os.environ["GRCTL"], "sim", "--servo", servos, "--link", str(link)],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(sim.wait)
        self.addCleanup(sim.terminate)
        until(link.exists)
        with mock.patch.dict(os.environ, {"GRCTL_GUARD": os.environ["GRCTL"]}):
            for device in (self.make_leader(port=str(link)),
                           Grobo(dataclasses.replace(self.config(), port=str(link)))):
                with self.assertRaises(grobo.errors.Setup):
                    while True:
                        try:
                            device.connect()
                        except grobo.errors.Busy:  # a guard leaves a pty that was called so
                            time.sleep(0.02)
                self.assertFalse(device.is_connected or device.is_calibrated)

    def test_what_is_returned_is_what_was_sent(self):
        robot = self.make(max_relative_target=None)
        robot.connect()
        high = math.degrees(robot._description.limits["elbow_flex"][1])
        sent = robot.send_action({"elbow_flex.pos": 500.0, "wrist_flex.pos": 1.5})
        self.assertAlmostEqual(sent["elbow_flex.pos"], high)
        self.assertAlmostEqual(sent["wrist_flex.pos"], 1.5)
        self.drive(robot, {"elbow_flex.pos": 500.0}, lambda s: s["elbow_flex.pos"] > high - 0.5)

    def test_a_jump_is_clipped_near_where_the_joint_is(self):
        """A policy that jumps by 100 degrees does not throw the arm."""
        robot = self.make()
        robot.connect()
        most = GroboConfig(port="sim").max_relative_target
        self.assertTrue(0 < most <= 15)
        was = robot.get_observation()["elbow_flex.pos"]
        sent = robot.send_action({"elbow_flex.pos": was - 100, "gripper.pos": 1.0})
        self.assertAlmostEqual(sent["elbow_flex.pos"], was - most, delta=1)
        self.assertAlmostEqual(sent["gripper.pos"], 1.0)
        until(lambda: not robot._robot.status().moving)
        self.assertGreater(robot.get_observation()["elbow_flex.pos"], was - most - 1)

    def test_how_far_an_action_may_go_is_set_for_all_or_each(self):
        joints = grobo.Description("so101").joints
        robot = self.make(max_relative_target={**dict.fromkeys(joints, 90.0), "gripper": 2.0})
        robot.connect()
        was = robot.get_observation()
        sent = robot.send_action({"elbow_flex.pos": was["elbow_flex.pos"] - 50, "gripper.pos": 50.0})
        self.assertAlmostEqual(sent["elbow_flex.pos"], was["elbow_flex.pos"] - 50, delta=1)
        self.assertAlmostEqual(sent["gripper.pos"], was["gripper.pos"] + 2, delta=1)
        for bad in (0, -5.0, math.nan, math.inf, True, "far", {"gripper": 2.0},
                    {**dict.fromkeys(joints, 9.0), "elbow": 5.0},
                    {**dict.fromkeys(joints, 9.0), "gripper": 0.0}):
            with self.assertRaisesRegex(ValueError, "max_relative_target", msg=bad):
                Grobo(self.config(max_relative_target=bad))

    def test_no_action_is_clipped_at_an_old_reading(self):
        robot = self.make(stale_s=0.0)
        robot.connect()
        with self.assertRaises(TimeoutError):
            robot.send_action({"elbow_flex.pos": 1.0})

    def test_bad_actions_are_refused(self):
        robot = self.make()
        with self.assertRaises(DeviceNotConnectedError):
            robot.send_action({"elbow_flex.pos": 0.0})
        with self.assertRaises(DeviceNotConnectedError):
            robot.get_observation()
        robot.connect()
        for action in ({"elbow.pos": 0.0}, {"elbow_flex": 0.0}):
            with self.assertRaises(KeyError):
                robot.send_action(action)
        for bad in (math.nan, math.inf):
            with self.assertRaises(ValueError):
                robot.send_action({"elbow_flex.pos": bad})

    def test_without_actions_it_stands(self):
        robot = self.make()
        robot.connect()
        robot.send_action({"elbow_flex.pos": 2.0})
        until(lambda: not robot._robot.status().moving)
        status = robot._robot.status()
        self.assertAlmostEqual(status.joints["elbow_flex"].target, math.radians(2), delta=0.001)
        self.assertFalse(status.latched)

    def test_an_emergency_stop_ends_the_loop(self):
        robot = self.make()
        robot.connect()
        robot._robot.estop()
        until = time.monotonic() + 10  # what is sent before the loop turns ends with the stop
        with self.assertRaises(grobo.errors.Latched):
            while time.monotonic() < until:
                robot.send_action({"elbow_flex.pos": 1.0})
                time.sleep(0.01)

    def test_old_readings_are_no_observation(self):
        robot = self.make(stale_s=0.0)
        robot.connect()
        with self.assertRaises(TimeoutError):
            robot.get_observation()

    def test_leaving_carries_out_the_policy(self):
        robot = self.make(on_exit="off")
        with robot:
            inner = robot._robot
            self.assertTrue(robot.is_connected)
        self.assertFalse(robot.is_connected)
        self.assertTrue(inner._runner.closing)
        robot.disconnect()  # again: nothing happens
        with self.assertRaises(ValueError):
            Grobo(self.config(on_exit="fall"))

    def test_any_robot_file(self):
        arm = self.folder / "arm.yaml"
        arm.write_text((TOP / "src/robots/so101.yaml").read_text().replace("so101", "arm"))
        robot = self.make(robot=str(arm))
        robot.connect()
        self.drive(robot, {"elbow_flex.pos": 3.0}, lambda s: abs(s["elbow_flex.pos"] - 3) < 0.5)
        arm.write_text("name: arm\nfamily: none\n")
        with self.assertRaises(grobo.errors.Syntax) as caught:
            Grobo(self.config(robot=str(arm)))
        self.assertIn("line 1", str(caught.exception))
        with self.assertRaises(grobo.errors.NoSuchName):
            Grobo(self.config(robot="so999"))

    def test_a_humanoid(self):
        robot = self.make(robot="gr001", sense_s=0.1, stale_s=2)
        robot.connect()
        self.assertEqual(len(robot.get_observation()), 20)
        self.drive(robot, {"NECK_Y.pos": 5.0}, lambda s: abs(s["NECK_Y.pos"] - 5) < 0.5)

    @unittest.skipIf(REAL, "with cameras of the stand-in")
    def test_cameras_are_part_of_an_observation(self):
        robot = self.make(cameras={"front": object()})
        self.assertEqual(robot.observation_features["front"], (2, 3, 3))
        robot.connect()
        self.assertEqual(len(robot.get_observation()["front"]), 2)
        robot.disconnect()
        self.assertFalse(robot.cameras["front"].is_connected)


if __name__ == "__main__":
    unittest.main()
