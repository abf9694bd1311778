# SPDX-License-Identifier: MIT
"""The face for asyncio, against simulators in this process."""

import asyncio
import threading
import time
import unittest

import grobo
import grobo.aio
from grobo import _lib, errors
from grobo import robot as robot_module

GREET = "motions/greet.pseq"


@unittest.skipUnless(_lib.has("grobo_runner_next_event"), "the library keeps no events")
class Aio(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        self.robot = await grobo.aio.connect("sim")
        self.events = []
        self.watcher = asyncio.create_task(self.watch())
        await asyncio.sleep(0)  # its turn comes

    async def asyncTearDown(self):
        await self.robot.close()
        await self.watcher

    async def watch(self):
        async for event in self.robot.events():
            self.events.append(event)

    async def until(self, condition):
        end = asyncio.get_running_loop().time() + 60
        while not condition():
            self.assertLess(asyncio.get_running_loop().time(), end, "it does not come about")
            await asyncio.sleep(0.005)

    async def test_moves_of_different_joints_are_under_way_together(self):
        await self.robot.init()
        await asyncio.gather(
            self.robot.move({"R_ELBOW_P": -0.8}, time=0.3),
            self.robot.move({"L_ELBOW_P": -0.4}, time=0.3),
        )
        angles = await self.robot.angles()
        self.assertAlmostEqual(angles["R_ELBOW_P"], -0.8, delta=0.02)
        self.assertAlmostEqual(angles["L_ELBOW_P"], -0.4, delta=0.02)
        jobs = [e for e in self.events if e.kind == "job" and e.state == "move"]
        self.assertIn(len(jobs), (2, 3))  # they may have been joined to one
        self.assertEqual({e.error for e in jobs}, {None})

    async def test_the_loop_turns_while_the_robot_moves(self):
        moving = asyncio.create_task(self.robot.init(time=0.5))
        await self.until(lambda: self.robot.status().moving)
        self.assertFalse(moving.done())
        await moving
        self.assertTrue(any(e.kind == "joint" for e in self.events))

    async def test_a_play_tells_its_states(self):
        await self.robot.play(GREET, speed=5.0)
        await self.until(lambda: any(e.state == "finished" for e in self.events))
        states = [e.state for e in self.events if e.kind == "play"]
        self.assertIn("playing", states)

    async def test_a_cancelled_task_stops_the_robot(self):
        for verb in (self.robot.play(GREET), self.robot.move({"R_ELBOW_P": -1.0}, time=20)):
            task = asyncio.create_task(verb)
            await self.until(lambda task=task: self.robot.status().moving or task.done())
            self.assertFalse(task.done() and task.exception(), "it was refused")
            task.cancel()
            with self.assertRaises(asyncio.CancelledError):
                await task
            await self.until(lambda: not self.robot.status().moving)
        angles = await self.robot.angles(["R_ELBOW_P"])
        self.assertGreater(angles["R_ELBOW_P"], -0.9)

    async def test_a_play_that_is_cancelled_before_it_begins_does_not_last(self):
        asked, given_up = threading.Event(), threading.Event()

        class Late:
            """The name of a file, which comes when the play has been cancelled."""

            def __fspath__(self):
                asked.set()
                given_up.wait()
                return GREET

        task = asyncio.create_task(self.robot.play(Late()))
        await self.until(asked.is_set)
        task.cancel()
        await asyncio.sleep(0)  # it is told
        given_up.set()
        since = time.monotonic()
        with self.assertRaises(asyncio.CancelledError):
            await task
        await self.until(lambda: not self.robot.status().moving)
        self.assertLess(time.monotonic() - since, 3)  # it takes 5 s to its end

    async def test_a_reading_that_is_cancelled_stops_nothing(self):
        moving = asyncio.create_task(self.robot.init(time=0.5))
        await self.until(lambda: self.robot.status().moving)
        reading = asyncio.create_task(self.robot.angles())
        await asyncio.sleep(0.001)
        reading.cancel()
        with self.assertRaises(asyncio.CancelledError):
            await reading
        await moving

    async def test_an_emergency_stop_is_an_event_and_ends_a_move(self):
        task = asyncio.create_task(self.robot.move({"R_ELBOW_P": -1.0}, time=20))
        await self.until(lambda: self.robot.status().moving)
        self.robot.estop()
        with self.assertRaises(grobo.Error):
            await task
        await self.until(lambda: any(e.kind == "trip" for e in self.events))
        trip = next(e for e in self.events if e.kind == "trip")
        self.assertEqual(trip.reason, "emergency stop")
        await self.robot.reset()
        await self.robot.move({"R_ELBOW_P": -0.2}, time=0.2)

    async def test_what_is_refused_raises_at_once(self):
        with self.assertRaises(errors.Limit) as caught:
            await self.robot.move({"R_ELBOW_P": 3.0})
        self.assertEqual(caught.exception.joint, "R_ELBOW_P")

    async def test_closing_ends_events_and_what_is_awaited(self):
        task = asyncio.create_task(self.robot.move({"R_ELBOW_P": -1.0}, time=20))
        await self.until(lambda: self.robot.status().moving)
        await self.robot.close()
        with self.assertRaises(grobo.Error):
            await task
        await self.watcher
        self.assertEqual(self.events[0].kind, "line_up")
        async for event in self.robot.events():
            self.fail(event)


@unittest.skipUnless(_lib.has("grobo_runner_next_event"), "the library keeps no events")
class Aside(unittest.IsolatedAsyncioTestCase):
    """What goes wrong beside the robot."""

    async def test_a_loop_that_was_held_up_hears_of_the_end_all_the_same(self):
        async with await grobo.aio.connect("sim", events=1) as robot:
            await robot.init()
            moves = [
                asyncio.create_task(robot.move({name: angle}, time=0.1))
                for name, angle in (("R_ELBOW_P", -0.2), ("L_ELBOW_P", -0.2), ("NECK_Y", 0.1))
            ]
            await asyncio.sleep(0)  # they begin
            while robot.status().moving:
                time.sleep(0.01)
            await asyncio.wait_for(asyncio.gather(*moves), 5)

    async def test_a_connection_that_is_given_up_is_closed(self):
        connecting = asyncio.create_task(grobo.aio.connect("sim"))
        while not robot_module._open:
            await asyncio.sleep(0)
        connecting.cancel()
        with self.assertRaises(asyncio.CancelledError):
            await connecting
        self.assertEqual(robot_module._open, set())

    async def test_leaving_keeps_the_exception_that_leaves(self):
        with self.assertRaises(ZeroDivisionError):
            async with await grobo.aio.connect("sim") as robot:
                robot._robot.close = lambda: errors.check(-1, "exit policy")
                raise ZeroDivisionError
        self.assertEqual(len(robot_module._open), 1)
        robot_module._close_all()


@unittest.skipIf(_lib.has("grobo_runner_next_event"), "the library keeps events")
class NoEvents(unittest.IsolatedAsyncioTestCase):
    async def test_it_is_refused(self):
        with self.assertRaises(errors.Unsupported):
            await grobo.aio.connect("sim")


if __name__ == "__main__":
    unittest.main()
