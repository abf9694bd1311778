# SPDX-License-Identifier: MIT
"""Programs of others drive a body of MuJoCo: one client for each family of servos.

usage: clients.py GRCTL PYTHON [CLIENT...]   PYTHON has the clients' packages (FAMILY_CLIENTS)
       clients.py --client NAME PORT        what PYTHON runs

A head of two servos carries 0.1 kg at 0.15 m. The client finds both servos behind the
pseudo-terminal, switches the torque on, lifts the weight by 40 degrees and reads where it is. The
judge is the body, which no client sees: its joint is where the client says, within a degree, and
within 6 degrees of the goal (servos hang by their load). LeRobot's motor bus, without torch, does the
same with the elbow of an exported SO-101. The CPU time of the side of the simulator is reported beside
the real time.
"""

import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

UP = 40.0  # degrees
HEAD = """<mujoco><option gravity="0 0 -9.80665"/><worldbody><body name="base" pos="0 0 0.1">
<inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
<body name="yoke" pos="0 0 0.06"><joint name="pan" axis="0 0 1"/>
<inertial pos="0 0 0" mass="0.05" diaginertia="1e-5 1e-5 1e-5"/>
<body name="arm" pos="0 0 0.02"><joint name="tilt" axis="0 -1 0"/>
<inertial pos="0.15 0 0" mass="0.1" diaginertia="1e-5 1e-5 1e-5"/>
</body></body></body></worldbody></mujoco>"""
ROBOT = """name: head
family: {family}
line: {{baud: {baud}}}
joints:
  - {{name: pan, id: 1, servo: {servo}, limits_deg: [-90, 90]}}
  - {{name: tilt, id: 2, servo: {servo}, limits_deg: [-80, 80]}}
"""

# ---- the clients, each with what it reads at the end: degrees from the middle ---------------------


def patient(line):
    line.setPacketTimeout = lambda size: line.setPacketTimeoutMillis(1000)
    return line


def settle(read):
    """Reads until it does not change any more."""
    before = math.inf
    for _ in range(100):
        time.sleep(0.1)
        now = read()
        if abs(now - before) < 0.2:
            return now
        before = now
    raise AssertionError("it does not come to rest")


def registers(kit, protocol, port, torque, goal, present, size, middle, unit):
    """The makers' kits: PacketHandler with registers."""
    line = patient(kit.PortHandler(port))
    packets = kit.PacketHandler(protocol)
    assert line.openPort() and line.setBaudRate(1000000)
    write, read = ((packets.write4ByteTxRx, packets.read4ByteTxRx) if size == 4 else
                   (packets.write2ByteTxRx, packets.read2ByteTxRx))
    for i in (1, 2):
        assert packets.ping(line, i)[1] == 0
        assert packets.write1ByteTxRx(line, i, torque, 1)[0] == 0
        assert write(line, i, goal, middle)[0] == 0
    assert write(line, 2, goal, middle + round(UP / unit))[0] == 0
    return settle(lambda: (read(line, 2, present)[0] - middle) * unit)


def dynamixel_2(port):
    import dynamixel_sdk

    return registers(dynamixel_sdk, 2.0, port, 64, 116, 132, 4, 2048, 360 / 4096)


def dynamixel_1(port):
    import dynamixel_sdk

    return registers(dynamixel_sdk, 1.0, port, 24, 30, 36, 2, 512, 300 / 1024)


def feetech(port):
    import scservo_sdk

    return registers(scservo_sdk, 0, port, 40, 42, 56, 2, 2048, 360 / 4096)


def rustypot(port):
    import rustypot as kit

    arm = kit.Sts3215PyController(port, 1000000, 1.0)
    arm.sync_write_torque_enable([1, 2], [True, True])
    arm.sync_write_goal_position([1, 2], [0.0, math.radians(UP)])
    return settle(lambda: math.degrees(arm.sync_read_present_position([1, 2])[1]))


def lx16a(port):
    from pylx16a.lx16a import LX16A

    LX16A.initialize(port, 1.0)
    both = [LX16A(1), LX16A(2)]
    for servo in both:
        servo.move(120)
    both[1].move(120 + UP, 500)
    return settle(lambda: both[1].get_physical_angle() - 120)


def rs30x(port):
    import dicot.connections

    with dicot.connections.open(port) as line:
        both = [line.motor(i) for i in (1, 2)]
        for i, servo in enumerate(both, 1):
            servo.rom._id = i
            servo.torque_mode = "on"
        both[1].rotate(UP, 500)
        return settle(lambda: both[1].angle)


def lerobot(port):
    sys.path.insert(0, str(Path(__file__).parents[1] / "families"))
    from clients import lerobot_bus

    bus, names = lerobot_bus(port)
    bus.disable_torque()
    bus.configure_motors()
    bus.enable_torque()
    begin = {name: int(bus.read("Present_Position", name, normalize=False)) for name in names}
    goal = begin | {"elbow_flex": 2048 - round(UP * 4096 / 360)}
    bus.sync_write("Goal_Position", goal, normalize=False)
    at = settle(lambda: bus.sync_read("Present_Position", normalize=False)["elbow_flex"])
    bus.disconnect(disable_torque=False)
    return (2048 - at) * 360 / 4096


CLIENTS = {  # the family, its servo, its rate
    dynamixel_2: ("dynamixel2", "XL430-W250", 1000000),
    dynamixel_1: ("dynamixel1", "AX-12A", 1000000),
    feetech: ("feetech", "STS3215", 1000000),
    rustypot: ("feetech", "STS3215", 1000000),
    lx16a: ("lx16a", "LX-16A", 115200),
    rs30x: ("rs30x", "RS302CD", 115200),
    lerobot: ("so101", "", 0),
}

# ---- the body ------------------------------------------------------------------------------------


def judge(grctl, python, client, folder):
    """What the client says, and where the body is: degrees; CPU and real seconds."""
    from grobo import Description
    from grobo.physics import Body, Served

    family, servo, baud = CLIENTS[client]
    model, robot, joint = folder / f"{family}.xml", folder / f"{family}.yaml", "tilt"
    if servo:
        model.write_text(HEAD)
        robot.write_text(ROBOT.format(family=family, servo=servo, baud=baud))
    else:
        subprocess.run([grctl, "robot", "export", family, "--mjcf", "-o", str(model)], check=True)
        robot, joint = family, "elbow_flex"
    body = Body(model, Description(robot))
    with Served(body) as served:
        cpu, real = time.process_time(), time.monotonic()
        program = subprocess.Popen([python, __file__, "--client", client.__name__, served.device],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            while program.poll() is None and time.monotonic() < real + 120:
                served.run(0.05)
        finally:
            program.kill()
        said, wrong = program.communicate()
        cpu, real = time.process_time() - cpu, time.monotonic() - real
        if program.returncode != 0:
            raise AssertionError(wrong.strip().rpartition("\n")[2] or "no answer in 120 s")
        return float(said), abs(math.degrees(float(body.data.joint(joint).qpos[0]))), cpu, real


def main(grctl, python, *names):
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for client in CLIENTS:
            if names and client.__name__ not in names:
                continue
            try:
                said, there, cpu, real = judge(grctl, python, client, Path(folder))
            except AssertionError as wrong:
                failed += 1
                print(f"{client.__name__}: FAILED: {wrong}")
                continue
            good = abs(there - UP) < 6 and abs(said - there) < 1
            failed += not good
            print(f"{client.__name__}: it says {said:.1f}, the body is at {there:.1f} degrees: "
                  f"{'good' if good else 'BAD'}; CPU {cpu:.2f} s of {real:.2f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1] == "--client":
        print({client.__name__: client for client in CLIENTS}[sys.argv[2]](sys.argv[3]))
    else:
        sys.exit(main(*sys.argv[1:]))
