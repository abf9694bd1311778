# SPDX-License-Identifier: MIT
"""The blocking face, against simulators in this process and one behind a pty."""

import _thread
import gc
import glob
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
from pathlib import Path
from unittest import mock

import grobo
from grobo import errors
from grobo import robot as robot_module
from grobo.robot import Torque

GREET = "motions/greet.pseq"


def connect(link, **options):
    """To a simulator behind a pty, which answers late on a busy machine. A guard that another test
    left may still be about to leave a pty that had this one's name."""
    while True:
        try:
            return grobo.connect(str(link), reply_timeout=0.5, **options)
        except errors.Busy:
            time.sleep(0.02)


def until(condition):
    """Polls; the tests' own limit ends one that waits in vain."""
    while not condition():
        time.sleep(0.005)


class Wheels(unittest.TestCase):
    ROVER = "docs/examples/robots/rover.yaml"

    def test_wheels_turn_for_a_time_and_stand(self):
        with grobo.connect("sim", robot=self.ROVER) as robot:
            self.assertEqual(robot.wheels, ["left", "right"])
            seen = []
            done = threading.Event()

            def look():
                while not done.wait(0.05):
                    seen.append(robot.status().joints["left"].speed)

            looker = threading.Thread(target=look)
            looker.start()
            robot.drive({"left": math.radians(90), "right": math.radians(-45)}, time=1.0)
            done.set()
            looker.join()
            self.assertAlmostEqual(max(s for s in seen if s is not None), math.radians(90), delta=0.1)
            self.assertAlmostEqual(robot.status().joints["left"].speed, 0, delta=0.02)
            self.assertFalse(robot.status().moving)

    def test_a_speed_ends_by_itself_and_is_checked(self):
        with grobo.connect("sim", robot=self.ROVER) as robot:
            with self.assertRaises(errors.Error):
                robot.drive({"left": 1.0})  # no torque
            robot.torque(True, ["left"])
            robot.drive({"left": 1.0})
            until(lambda: robot.status().moving)
            until(lambda: not robot.status().moving)
            with self.assertRaises(errors.Limit) as refused:
                robot.drive({"left": 10.0})
            self.assertEqual((refused.exception.joint, refused.exception.unit), ("left", "rad/s"))
            self.assertAlmostEqual(refused.exception.value, 10.0)
            self.assertAlmostEqual(refused.exception.limits[1], math.radians(180))
            with self.assertRaises(errors.Error):
                robot.drive({"pan": 1.0})
            with self.assertRaises(errors.Error):
                robot.move({"left": 0.1})


LIFT = """
name: lift
family: feetech
exit: off
joints:
  - {name: turn, id: 1, servo: STS3215, limits_deg: [-110, 110]}
  - {name: height, id: 2, servo: STS3215, limits_mm: [0, 60], mm_per_turn: 180}
  - {name: grip, id: 3, servo: STS3215, limits_deg: [-10, 90], percent_deg: [90, -10]}
"""


class Units(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name, "lift.yaml")
        self.file.write_text(LIFT)

    def test_a_joint_is_given_in_its_unit(self):
        with grobo.connect("sim", robot=self.file) as robot:
            self.assertEqual(robot.description.units, {"turn": "deg", "height": "mm", "grip": "%"})
            for name, value, deg in ("turn", -20, -20), ("height", 30, 60), ("grip", 75, 15):
                joint = robot[name]
                joint.move(value=value, time=0.3)
                self.assertAlmostEqual(joint.value, value, delta=0.3)
                self.assertAlmostEqual(joint.deg, deg, delta=0.3)
                self.assertEqual(joint.unit, robot.description.units[name])
                self.assertAlmostEqual(joint.status.value, value, delta=0.3)
                self.assertEqual(joint.status.unit, joint.unit)
            with self.assertRaises(errors.Limit):
                robot["height"].move(value=61)
            with self.assertRaises(TypeError):
                robot["height"].move(value=1, deg=1)


class Moving(unittest.TestCase):
    def setUp(self):
        self.robot = grobo.connect("sim")
        self.addCleanup(self.robot.close)

    def test_a_move_ends_where_it_was_sent(self):
        self.robot.init()
        self.robot.move({"R_ELBOW_P": -0.8, "L_ELBOW_P": -0.4}, time=0.2)
        angles = self.robot.angles(["R_ELBOW_P", "L_ELBOW_P"])
        self.assertAlmostEqual(angles["R_ELBOW_P"], -0.8, delta=0.01)
        self.assertAlmostEqual(angles["L_ELBOW_P"], -0.4, delta=0.01)
        self.assertEqual(len(self.robot.angles()), 20)

    def test_a_joint_moves_and_is_read_by_itself(self):
        self.robot["R_ELBOW_P"].move(deg=-30, time=0.2)
        self.assertAlmostEqual(self.robot["R_ELBOW_P"].deg, -30, delta=0.5)
        with self.assertRaises(TypeError):
            self.robot["R_ELBOW_P"].move()

    def test_angles_may_come_in_joint_order(self):
        angles = [float("nan")] * 20
        angles[self.robot.joints.index("R_ELBOW_P")] = -0.5
        self.robot.move(angles, time=0.2)
        self.assertAlmostEqual(self.robot["R_ELBOW_P"].angle, -0.5, delta=0.01)

    def test_a_list_has_an_angle_for_each_joint(self):
        """Three angles are not the first three of twenty joints."""
        for wrong in ([0.0, 0.0, 1.0], [0.0] * 19, [0.0] * 21, []):
            for verb in (lambda a: self.robot.move(a, time=0.2),
                         lambda a: self.robot.send(a, time=0.2)):
                with self.assertRaisesRegex(ValueError, f"^{len(wrong)} angles for 20 joints"):
                    verb(wrong)
        self.assertFalse(self.robot.status().moving)

    def test_a_motion_for_another_number_of_joints_is_not_played(self):
        motion = grobo.Motion.of([0.2], [[0.1, 0.2, 0.3]])
        with self.assertRaisesRegex(ValueError, "3 joints.*20"):
            self.robot.play(motion)
        wave = grobo.Motion.load("motions/so101-wave.yaml", grobo.Description("so101"))
        with self.assertRaisesRegex(ValueError, "6 joints.*20"):
            self.robot.play(wave)
        self.assertFalse(self.robot.status().playing)

    def test_status_says_what_was_read(self):
        self.robot.torque(True)
        self.robot.move({"R_ELBOW_P": -0.5}, time=0.2)
        self.robot.angles()
        status = self.robot.status()
        joint = status.joints["R_ELBOW_P"]
        self.assertTrue(status.connected)
        self.assertFalse(status.latched)
        self.assertIsNone(status.trip)
        self.assertEqual(joint.torque, Torque.ON)
        self.assertAlmostEqual(joint.angle, -0.5, delta=0.01)
        self.assertAlmostEqual(joint.target, -0.5)
        self.assertGreaterEqual(joint.age, 0)
        self.assertTrue(6000 < joint.voltage_mv < 9000)

    def test_torque_of_some_joints(self):
        self.robot.torque(True)
        self.robot.torque(Torque.BRAKE, ["R_ELBOW_P"])
        joints = self.robot.status().joints
        self.assertEqual(joints["R_ELBOW_P"].torque, Torque.BRAKE)
        self.assertEqual(joints["L_ELBOW_P"].torque, Torque.ON)

    def test_a_motion_is_played_from_file_and_memory(self):
        self.robot.play(GREET, speed=5.0)
        self.assertFalse(self.robot.status().playing)
        motion = grobo.Motion.of([0.2, 0.4], [posture_row(self.robot, 0.0), posture_row(self.robot, -0.6)])
        self.robot.play(motion)
        self.assertAlmostEqual(self.robot["R_ELBOW_P"].angle, -0.6, delta=0.02)
        self.robot.play(motion, reverse=True)
        self.assertAlmostEqual(self.robot["R_ELBOW_P"].angle, 0.0, delta=0.02)

    def test_a_stop_of_another_thread_ends_a_play(self):
        def stop():
            until(lambda: self.robot.status().playing)
            self.robot.stop()

        thread = threading.Thread(target=stop)
        thread.start()
        with self.assertRaises(errors.Canceled):
            self.robot.play(GREET)
        thread.join()

    def test_ctrl_c_ends_a_move_and_stops_it(self):
        def interrupt():
            until(lambda: self.robot.status().moving)
            _thread.interrupt_main()

        thread = threading.Thread(target=interrupt)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            self.robot.move({"R_ELBOW_P": -1.0}, time=20)
        thread.join()
        until(lambda: not self.robot.status().moving)
        self.assertGreater(self.robot["R_ELBOW_P"].angle, -0.9)

    def test_an_emergency_stop_is_latched_until_reset(self):
        self.robot.estop()
        self.assertTrue(self.robot.status().latched)
        with self.assertRaises(errors.Latched) as caught:
            self.robot.move({"R_ELBOW_P": 0.0})
        self.assertEqual(caught.exception.reason, "emergency stop")
        self.assertIn("emergency stop", str(caught.exception))
        self.robot.reset()
        self.robot.move({"R_ELBOW_P": -0.2}, time=0.2)

    def test_no_target_is_taken_right_behind_an_emergency_stop(self):
        for _ in range(10):
            self.robot.estop()
            with self.assertRaises(errors.Latched):
                self.robot.send({"R_ELBOW_P": 0.0}, time=0.1)
            self.robot.reset()

    def test_what_is_refused_says_which_joint_and_which_value(self):
        with self.assertRaises(errors.Limit) as caught:
            self.robot.move({"R_ELBOW_P": 3.0})
        self.assertEqual(caught.exception.joint, "R_ELBOW_P")
        self.assertAlmostEqual(caught.exception.value, 3.0, places=6)
        self.assertEqual(caught.exception.unit, "rad")
        self.assertIsInstance(caught.exception, ValueError)
        with self.assertRaises(errors.NotFinite):
            self.robot.move({"R_ELBOW_P": float("inf")})
        with self.assertRaises(LookupError) as caught:
            self.robot.move({"NOSE": 0.0})
        self.assertEqual(caught.exception.joint, "NOSE")
        with self.assertRaises(LookupError):
            self.robot["NOSE"]
        with self.assertRaises(LookupError) as caught:
            self.robot.move({0: 0.0})  # a number is no name
        self.assertIn("(0)", str(caught.exception))

    def test_nobody_at_any_port_is_told_as_that(self):
        class Nobody:
            """The library, where no port has a robot."""

            def __getattr__(self, name, real=robot_module.lib):
                if name == "grobo_runner_connect":
                    return lambda runner, time: real.GROBO_ERR_NOTFOUND
                return getattr(real, name)

        with mock.patch.object(robot_module, "lib", Nobody()):
            with self.assertRaises(errors.NoSuchName) as caught:
                grobo.connect(guard=False)
        self.assertEqual(str(caught.exception), "connect: no robot answers on a serial port: plug its "
                         "adapter in, or name the port; 'sim' is a simulator")

    def test_torque_is_one_of_what_there_is(self):
        for wrong in ("up", "on", 7, None):
            with self.assertRaises(ValueError) as caught:
                self.robot.torque(wrong)
            self.assertEqual(str(caught.exception), f"torque {wrong!r}: True, False, Torque.ON, "
                             "Torque.OFF or Torque.BRAKE")

    def test_a_limit_is_told_in_the_unit_of_the_caller(self):
        low, high = self.robot.description.limits["R_ELBOW_P"]
        with self.assertRaises(errors.Limit) as caught:
            self.robot.move({"R_ELBOW_P": -45.0})  # degrees, where radians are asked for
        self.assertEqual(caught.exception.limits, (low, high))
        self.assertEqual(str(caught.exception),
                         f"move: outside a joint's limits (R_ELBOW_P, -45 rad is not within {low:.4g} to "
                         f"{high:.4g} rad)")
        with self.assertRaises(errors.Limit) as caught:
            self.robot["R_ELBOW_P"].move(deg=-160)
        self.assertAlmostEqual(caught.exception.value, -160)
        self.assertEqual(caught.exception.unit, "deg")
        self.assertIn(f"R_ELBOW_P, -160 deg is not within {math.degrees(low):.4g} to "
                      f"{math.degrees(high):.4g} deg", str(caught.exception))
        with self.assertRaises(errors.Limit) as caught:
            self.robot["R_ELBOW_P"].move(-45)
        self.assertEqual(caught.exception.unit, "rad")
        self.assertFalse(self.robot.status().moving)

    def test_no_number_means_a_default_that_was_not_asked_for(self):
        for options in ({"speed": 0}, {"speed": 0.004}, {"speed": -1.0}, {"speed": 700.0},
                        {"rate": 0}, {"rate": -5}, {"rate": 1001}):
            with self.assertRaises(errors.Arg, msg=options):
                self.robot.play(GREET, **options)
        for verb in (self.robot.init, lambda time: self.robot.move({"R_ELBOW_P": 0.0}, time=time),
                     lambda time: self.robot.send({"R_ELBOW_P": 0.0}, time=time)):
            with self.assertRaises(errors.Arg):
                verb(time=-1.0)
        self.assertFalse(self.robot.status().moving)


class Nothing(unittest.TestCase):
    """What is asked for where there is nothing."""

    @unittest.skipIf(glob.glob("/dev/ttyUSB*") + glob.glob("/dev/ttyACM*"), "there is an adapter")
    def test_a_priority_or_a_cpu_that_nobody_has(self):
        for wrong in ({"realtime": 0}, {"realtime": 100}, {"cpus": [64]}, {"cpus": [-1]}):
            with self.assertRaises(ValueError):
                grobo.connect("sim", **wrong)
        if (os.cpu_count() or 64) < 64 and sys.platform == "linux":
            with self.assertRaises(grobo.Error):
                grobo.connect("sim", cpus=[63])

    def test_the_robots_thread_keeps_to_its_cpu(self):
        mine = getattr(os, "sched_getaffinity", lambda pid: set())(0)
        if 0 not in mine or len(mine) < 2:
            self.skipTest("no CPU 0, or no other")
        with grobo.connect("sim", cpus=[0]):
            threads = [int(name) for name in os.listdir("/proc/self/task")]
            kept = [t for t in threads if os.sched_getaffinity(t) == {0}]
            self.assertTrue(kept)
            self.assertNotIn(threading.get_native_id(), kept)

    def test_auto_says_what_to_do(self):
        with self.assertRaises(errors.NoSuchName) as caught:
            grobo.connect()
        self.assertIn("plug its adapter in, or name the port; 'sim'", str(caught.exception))

    def test_a_motion_is_saved_in_a_format_that_its_name_says(self):
        motion = grobo.Motion.of([0, 1], [[0.0] * 20] * 2)
        for wrong in ("x.doc", "x", "m"):
            with self.assertRaises(ValueError) as caught:
                motion.save(wrong)
            self.assertEqual(str(caught.exception), f"{wrong}: a motion file ends in .m, .pseq, "
                             ".mseq, .yaml, .yml, .seq")
            self.assertFalse(os.path.exists(wrong))

    def test_an_empty_motion_is_called_so(self):
        with grobo.connect("sim") as robot, self.assertRaises(errors.Empty) as caught:
            robot.play(grobo.Motion())
        self.assertIn("the motion has no posture", str(caught.exception))

    def test_rows_by_name_are_refused(self):
        with self.assertRaisesRegex(TypeError, "append.. takes angles by name"):
            grobo.Motion.of([0], [{"R_ELBOW_P": 0.1}])

    def test_a_notebook_shows_the_joints(self):
        with grobo.connect("sim") as robot:
            robot.init()
            shown = robot._repr_html_()
            self.assertEqual(shown.count("<tr>"), 21)
            self.assertIn("<td>R_KNEE_P</td><td>-40.0</td><td>on</td>", shown)
            self.assertIn("sim, 20 joints", repr(robot))
        self.assertEqual(robot._repr_html_(), "<p>&lt;Robot on sim, closed&gt;</p>")

    def test_names_of_errors_are_words(self):
        self.assertTrue(issubclass(errors.NoSuchFile, FileNotFoundError))
        with self.assertRaises(errors.NoSuchFile):
            grobo.Motion.load("no such.m")


class Others(unittest.TestCase):
    """Robots beside GR001."""

    def test_a_robot_of_the_library(self):
        with grobo.connect("sim", robot="so101") as robot:
            self.assertEqual(len(robot.joints), 6)
            self.assertEqual(robot.description.name, "so101")
            low, high = robot.description.limits["elbow_flex"]
            self.assertTrue(low < 0 < high)
            robot.move({"elbow_flex": 0.2}, time=0.2)
            self.assertAlmostEqual(robot["elbow_flex"].angle, 0.2, delta=0.01)
            with self.assertRaises(errors.NoSuchName):
                robot["R_ELBOW_P"]

    def test_a_motion_has_the_joints_of_its_robot(self):
        motion = grobo.Motion.load("motions/so101-wave.yaml", grobo.Description("so101"))
        self.assertIn("gripper", motion[0])
        self.assertIn("gripper", motion.copy()[-1])

    def test_a_robot_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "arm.yaml")
            path.write_text(Path("src/robots/so101.yaml").read_text().replace("so101", "arm"))
            with grobo.connect("sim", robot=path) as robot:
                robot.move({"gripper": 0.1}, time=0.1)
            path.write_text("name: [\n")
            with self.assertRaises(errors.Syntax) as caught:
                grobo.Description(path)
            self.assertIn("arm.yaml", str(caught.exception))
        with self.assertRaises(FileNotFoundError):
            grobo.Description("./none.yaml")

    def test_a_servo_beside_a_robots_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path, servo = Path(folder, "arm.yaml"), Path(folder, "mine.yaml")
            path.write_text("name: arm\nfamily: feetech\njoints:\n  - {name: x, id: 1, "
                            "servo: ./mine.yaml, limits_deg: [-9, 9]}\n")
            servo.write_text("name: Mine\nlike: STS3215\nnumber: 4711\n")
            with grobo.connect("sim", robot=path) as robot:
                robot.move({"x": 0.1}, time=0.2)
            servo.write_text("name: Mine\nlike: STS3215\nnumbr: 4711\n")
            with self.assertRaises(errors.Syntax) as caught:
                grobo.Description(path)
            self.assertIn("mine.yaml, line 3: no key", str(caught.exception))

    def test_a_loop_of_ones_own_sends_targets(self):
        with grobo.connect("sim", robot="so101", sense_interval=0.02) as robot:
            with self.assertRaises(errors.Error):
                robot.send({"elbow_flex": 0.1}, time=0.1)  # limp
            robot.torque(True)
            for step in range(10):
                robot.send({"elbow_flex": 0.01 * step}, time=0.05)
                time.sleep(0.02)
            until(lambda: abs(robot.status().joints["elbow_flex"].angle - 0.09) < 0.005)
            with self.assertRaises(errors.Limit) as caught:
                robot.send({"elbow_flex": 9.0}, time=0.1)
            self.assertEqual(caught.exception.joint, "elbow_flex")


class Leaving(unittest.TestCase):
    def test_a_closed_robot_refuses_everything(self):
        with grobo.connect("sim") as robot:
            pass
        robot.close()
        for verb in (robot.status, robot.init, robot.stop, robot.estop, robot.angles):
            with self.assertRaises(ConnectionError):
                verb()

    def test_closing_ends_what_another_thread_waits_for(self):
        robot = grobo.connect("sim")
        ended = []

        def play():
            try:
                robot.play(GREET)
            except grobo.Error as error:
                ended.append(error)

        thread = threading.Thread(target=play)
        thread.start()
        until(lambda: robot.status().playing)
        robot.close()
        thread.join()
        self.assertEqual(len(ended), 1)

    def test_a_close_that_is_interrupted_is_made_up_for(self):
        robot = grobo.connect("sim")
        runner = robot._runner

        def interrupt():
            until(lambda: runner.closing)
            _thread.interrupt_main()

        with runner.use():  # close() waits for it
            thread = threading.Thread(target=interrupt)
            thread.start()
            with self.assertRaises(KeyboardInterrupt):
                robot.close()
            thread.join()
        with self.assertRaises(errors.Closed):
            robot.status()
        robot.close()
        self.assertFalse(runner.handle)
        robot.close()

    def test_an_interrupt_anywhere_leaves_a_robot_that_closes(self):
        """Ctrl-C is heard where a function begins, and behind each call."""
        robot = grobo.connect("sim")
        at, left = 0, 0

        def interrupt(_frame, event, _arg):
            nonlocal left
            if event in ("call", "c_return"):
                left -= 1
                if left == 0:
                    sys.setprofile(None)
                    raise KeyboardInterrupt

        while left <= 0:
            at, left = at + 1, at + 1
            try:
                sys.setprofile(interrupt)
                robot.stop()
            except KeyboardInterrupt:
                pass
            finally:
                sys.setprofile(None)
            thread = threading.Thread(target=robot.status, daemon=True)
            thread.start()
            thread.join(5)
            self.assertFalse(thread.is_alive(), f"locked behind call {at}")
            self.assertFalse(robot._runner.users, f"in use behind call {at}")
        self.assertGreater(at, 5)
        robot.close()

    def test_a_robot_that_is_not_closed_warns(self):
        robot = grobo.connect("sim")
        runner = robot._runner
        with self.assertWarns(ResourceWarning):
            del robot
            gc.collect()
        runner.close()

    def test_a_forked_child_is_refused(self):
        with grobo.connect("sim") as robot:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of newer versions, of a fork beside threads
                child = os.fork()
            if child == 0:
                try:
                    robot.status()
                except errors.State:
                    os._exit(7)
                os._exit(1)
            self.assertEqual(os.waitpid(child, 0)[1] >> 8, 7)

    def test_a_child_forked_while_a_thread_asks_leaves_at_once(self):
        with grobo.connect("sim") as robot:
            locked, forked = threading.Event(), threading.Event()

            def hold():
                with robot._runner.lock:
                    locked.set()
                    forked.wait()

            thread = threading.Thread(target=hold)
            thread.start()
            locked.wait()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                child = os.fork()
            if child == 0:
                signal.alarm(10)
                with self.assertRaises(errors.State):
                    robot.status()
                robot.close()
                os._exit(7)
            forked.set()
            thread.join()
            self.assertEqual(os.waitpid(child, 0)[1], 7 << 8)

    def test_many_robots_leave_no_thread_and_no_descriptor(self):
        def count():
            return len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))

        with grobo.connect("sim"):
            pass
        before = count()
        for _ in range(20):
            with grobo.connect("sim"):
                pass
        self.assertEqual(count(), before)

    def test_no_robot(self):
        with self.assertRaises(FileNotFoundError) as caught:
            grobo.connect("/dev/no-such-port")
        self.assertIn("/dev/no-such-port", str(caught.exception))


@unittest.skipUnless(os.environ.get("GRCTL"), "needs $GRCTL")
class Exiting(unittest.TestCase):
    """A robot that stays when the program has left it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.link = Path(folder.name, "gr001")
        command = [os.environ["GRCTL"], "sim", "--link", str(self.link)]
        sim = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(sim.wait)
        self.addCleanup(sim.terminate)
        until(self.link.exists)

    def torque_after(self, policy, after=None):
        with connect(self.link, exit=policy) as robot:
            robot.torque(True)
        with connect(self.link, exit=None) as robot:
            robot.angles()
            return {joint.torque for joint in robot.status().joints.values()}

    def test_each_exit_policy_is_carried_out(self):
        self.assertEqual(self.torque_after(grobo.Exit.OFF), {Torque.OFF})
        self.assertEqual(self.torque_after(grobo.Exit.HOLD), {Torque.ON})
        self.assertEqual(self.torque_after(None), {Torque.ON})

    def test_a_robot_that_was_dropped_makes_way_for_the_next(self):
        robot = connect(self.link)
        robot.torque(True)
        with self.assertWarns(ResourceWarning):
            del robot
            gc.collect()
        with connect(self.link) as robot:
            self.assertEqual(len(robot.angles()), 20)

    def test_a_robot_that_was_dropped_is_left_as_was_asked_for(self):
        for policy, posted in ((grobo.Exit.OFF, 1), (None, 0)):
            robot = grobo.connect("sim", exit=policy)
            with mock.patch.object(robot_module, "lib", wraps=robot_module.lib) as lib:
                with self.assertWarns(ResourceWarning):
                    del robot
                    gc.collect()
                self.assertEqual(lib.grobo_runner_post_exit.call_count, posted)
            robot_module._close_all()

    def test_it_is_carried_out_where_an_exception_leaves(self):
        with self.assertRaises(ZeroDivisionError):
            with connect(self.link, exit=grobo.Exit.OFF) as robot:
                robot.torque(True)
                raise ZeroDivisionError
        with connect(self.link, exit=None) as robot:
            robot.angles()
            self.assertEqual(robot.status().joints["R_ELBOW_P"].torque, Torque.OFF)


@unittest.skipUnless(os.environ.get("GRCTL") and sys.platform == "linux", "needs $GRCTL")
class Guarded(unittest.TestCase):
    """A second process stops the joints when Python is killed, unless a program says guard=False."""

    PROGRAM = (
        "import sys, time, grobo\n"
        "robot = None\n"
        "while robot is None:\n"
        "    try:\n"
        "        robot = grobo.connect(sys.argv[1], robot=sys.argv[2], reply_timeout=0.5,\n"
        "                              guard=sys.argv[3] == 'True', sense_interval=0.02)\n"
        "    except grobo.errors.Busy:\n"  # as in connect() above
        "        time.sleep(0.02)\n"
        "robot.torque(True)\n"
        "robot.angles()\n"
        "joint, was = robot.joints[0], robot.status().joints[robot.joints[0]].angle\n"
        "robot._move(grobo.robot.posture({joint: was - 0.5}, 15, robot._model))\n"
        "end = time.monotonic() + 20\n"
        "while robot.status().joints[joint].angle > was - 0.05:\n"
        "    time.sleep(0.01)\n"
        "    if time.monotonic() > end:\n"
        "        sys.exit('it does not move')\n"
        "print('moves', flush=True)\n"
        "time.sleep(60)\n"
    )

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.link = Path(folder.name, "arm")

    def simulate(self, robot):
        command = [os.environ["GRCTL"], "sim", "--robot", robot, "--link", str(self.link)]
        sim = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(sim.wait)
        self.addCleanup(sim.terminate)
        until(self.link.exists)

    def moved_after_a_kill(self, robot, guard):
        """How far a joint moves within half a second, once the port is free again."""
        self.simulate(robot)
        for _ in range(3):  # a machine that is away for 250 ms ends the move
            program = subprocess.Popen(
                [sys.executable, "-c", self.PROGRAM, str(self.link), robot, str(guard)],
                stdout=subprocess.PIPE, env={**os.environ, "GRCTL_GUARD": os.environ["GRCTL"]},
            )
            line = program.stdout.readline()
            if line:
                break
            program.wait()
            program.stdout.close()
        self.assertEqual(line, b"moves\n")
        program.kill()
        program.wait()
        program.stdout.close()
        with connect(self.link, robot=robot, exit=None, guard=False) as reader:
            time.sleep(0.3)  # it may have been on its way when it was stopped
            joint = reader[reader.joints[0]]
            before = joint.angle
            time.sleep(0.5)
            return before - joint.angle

    def test_a_killed_program_leaves_no_joint_moving(self):
        self.assertAlmostEqual(self.moved_after_a_kill("gr001", True), 0, delta=0.003)

    def test_so_of_another_robot(self):
        self.assertAlmostEqual(self.moved_after_a_kill("so101", True), 0, delta=0.003)

    def test_so_of_a_file(self):
        arm = self.folder / "arm.yaml"
        arm.write_text(Path("src/robots/so101.yaml").read_text())
        self.assertAlmostEqual(self.moved_after_a_kill(str(arm), True), 0, delta=0.003)

    def test_without_a_guard_it_goes_on(self):
        self.assertGreater(self.moved_after_a_kill("gr001", False), 0.005)

    def test_where_there_is_no_guard_that_is_said_once(self):
        self.simulate("so101")
        with mock.patch.dict(os.environ, {"GRCTL_GUARD": "/nonexistent"}):
            with self.assertLogs("grobo", "WARNING") as log:
                connect(self.link, robot="so101", exit=None).close()
        self.assertEqual(len(log.output), 1)
        self.assertIn("no guard", log.output[0])


def posture_row(robot, elbow):
    row = [float("nan")] * len(robot.joints)
    row[robot.joints.index("R_ELBOW_P")] = elbow
    return row


if __name__ == "__main__":
    unittest.main()
