# SPDX-License-Identifier: MIT
"""LeRobot's own SO-101 follower picks up a cube in a body, led by LeRobot's own SO-101 leader.

usage: teleoperation.py GRCTL PYTHON [STRIP.png]   PYTHON has LeRobot and what its arms need
       teleoperation.py --lead LEADER FOLLOWER     what PYTHON runs

The follower is the arm and the cube of cube.py, behind a pseudo-terminal; the leader is a simulated
arm whose shafts are turned from outside, as by a hand. Between them is LeRobot 0.4 without torch: its
SO101Leader, its SO101Follower, and the loop of lerobot-teleoperate. Its script imports all of LeRobot,
so that function is taken out of the file. The judge is the cube, which has to hang in the gripper.
"""

import ast
import dataclasses
import json
import math
import select
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FPS = 50


# ---- LeRobot ---------------------------------------------------------------------------------------


def the_loop():
    """teleop_loop() of lerobot-teleoperate, word for word."""
    import lerobot
    from lerobot.utils.robot_utils import precise_sleep

    path = Path(lerobot.__file__).parent / "scripts/lerobot_teleoperate.py"
    found = next(part for part in ast.parse(path.read_text()).body
                 if isinstance(part, ast.FunctionDef) and part.name == "teleop_loop")
    found.args.args = [ast.arg(one.arg) for one in found.args.args]  # its types are not imported
    module = ast.fix_missing_locations(ast.Module([found], []))
    names = {"time": time, "precise_sleep": precise_sleep, "move_cursor_up": lambda lines: None,
             "print": lambda *words: None}
    exec(compile(module, str(path), "exec"), names)
    return names["teleop_loop"]


def calibrated(clients, port, folder, name):
    """LeRobot's calibration file of an arm that is calibrated already: what the servos keep."""
    bus, _ = clients.lerobot_bus(port)
    kept = bus.read_calibration()
    bus.disconnect(disable_torque=False)
    (folder / f"{name}.json").write_text(
        json.dumps({motor: dataclasses.asdict(one) for motor, one in kept.items()}))


def lead(leader_port, follower_port):
    sys.path.insert(0, str(Path(__file__).parents[1] / "families"))
    import clients

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        calibrated(clients, leader_port, folder, "leader")
        calibrated(clients, follower_port, folder, "follower")
        from lerobot.robots.so_follower import SO101Follower, SO101FollowerConfig
        from lerobot.teleoperators.so_leader import SO101Leader, SO101LeaderConfig

        leader = SO101Leader(SO101LeaderConfig(port=leader_port, id="leader", calibration_dir=folder))
        follower = SO101Follower(SO101FollowerConfig(
            port=follower_port, id="follower", calibration_dir=folder,
            disable_torque_on_disconnect=False))
        for arm in (leader, follower):
            clients.patient(arm.bus.port_handler)
            arm.connect()
        print("leads", flush=True)

        def same(pair):
            return pair[0]

        the_loop()(leader, follower, FPS, same, same, same, duration=float(sys.stdin.readline()))
        leader.disconnect()
        follower.disconnect()
        print("led", flush=True)


# ---- the arms --------------------------------------------------------------------------------------


class Hand:
    """Turns the leader's shafts, through the console of its simulator."""

    def __init__(self, grctl, link, names):
        self.names = names
        self.arm = subprocess.Popen(
            [grctl, "--physics", "off", "sim", "--robot", "so101-leader", "--link", link],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.arm.stdout.readline()

    def to(self, angles, seconds):
        for name, angle in zip(self.names, angles):
            print(f"turn {name} {math.degrees(angle):.2f} {round(seconds * 1000)}",
                  file=self.arm.stdin, flush=True)

    def close(self):
        self.arm.kill()
        self.arm.communicate()


def main(grctl, python, strip=None):
    import cube

    from grobo import Description
    from grobo.physics import Body, Served

    robot = Description("so101")
    path = [([*cube.ABOVE, cube.OPEN], 2), ([*cube.DOWN, cube.OPEN], 2), ([*cube.DOWN, cube.SHUT], 1.5),
            ([*cube.ABOVE, cube.SHUT], 2), ([*cube.ABOVE, cube.SHUT], 1)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.xml").write_text(cube.scene(grctl))
        body, film = Body(folder / "scene.xml", robot), None
        if strip:
            from grobo._film import Film

            film = Film(body)
            film._camera.distance = 0.75
        hand = Hand(grctl, str(folder / "leader"), robot.joints)
        with Served(body) as served:
            for joint in robot.joints:  # somebody holds the arm until LeRobot does
                served.block(joint, True)
            program = subprocess.Popen([python, __file__, "--lead", str(folder / "leader"),
                                        served.device], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            try:
                good = teleoperate(body, served, program, hand, path, film)
            finally:
                program.kill()
                wrong = program.communicate()[1].strip().rpartition("\n")[2]
                hand.close()
        height = float(body.data.body("cube").xpos[2])
    if film and film.frames:
        film.save(None, strip)
    good = good and height > 0.05
    print(f"LeRobot teleoperates: the cube is at {height * 1000:.0f} mm, {served.skipped} steps "
          f"skipped: {'good' if good else 'BAD ' + wrong}")
    return 0 if good else 1


def teleoperate(body, served, program, hand, path, film):
    """Whether it went to its end."""
    end = time.monotonic() + 120
    while not select.select([program.stdout], [], [], 0)[0]:
        served.run(0.02)
        if time.monotonic() > end:
            return False
    if program.stdout.readline() != "leads\n":
        return False
    for joint in body.robot.joints:
        served.block(joint, False)
    body.on_step = film.look if film else None
    print(sum(seconds for _, seconds in path) + 0.5, file=program.stdin, flush=True)
    for angles, seconds in path:
        hand.to(angles, seconds * 0.9)
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            served.run(0.02)
    while program.poll() is None and time.monotonic() < end:
        served.run(0.02)
    return program.returncode == 0


if __name__ == "__main__":
    sys.exit(lead(*sys.argv[2:]) if sys.argv[1] == "--lead" else main(*sys.argv[1:]))
