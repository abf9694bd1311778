# SPDX-License-Identifier: MIT
"""Independent clients against the simulator: clients.py CLIENT PORT. An assertion tells what differs."""
import os
import select
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from lerobot_alone import import_alone  # noqa: E402


# The makers' own give up some 34 ms after a request, LeRobot after 50; a busy machine needs longer.
PATIENCE_MS = 1000


def patient(line):
    """The port of a maker's client, which waits as long."""
    line.setPacketTimeout = lambda size: line.setPacketTimeoutMillis(PATIENCE_MS)
    return line


def dynamixel_sdk_2(port):
    import dynamixel_sdk as d

    line, packets = patient(d.PortHandler(port)), d.PacketHandler(2.0)
    assert line.openPort() and line.setBaudRate(1000000)
    assert packets.ping(line, 1)[:2] == (1200, 0)
    found, result = packets.broadcastPing(line)
    assert result == 0 and [found[i][0] for i in sorted(found)] == [1200, 1060, 1020]
    group = d.GroupSyncRead(line, packets, 132, 4)
    for i in (1, 2, 3):
        assert group.addParam(i)
    for read in (group.txRxPacket, group.fastSyncRead):
        assert read() == 0
        assert [group.getData(i, 132, 4) for i in (1, 2, 3)] == [2048] * 3
    assert packets.write1ByteTxRx(line, 1, 64, 1) == (0, 0)
    assert packets.write1ByteTxRx(line, 1, 7, 9) == (0, 7)
    assert packets.write4ByteTxRx(line, 1, 116, 5000) == (0, 6)
    assert packets.write4ByteTxRx(line, 1, 116, 2500) == (0, 0)
    arrives(lambda: packets.read4ByteTxRx(line, 1, 132)[0], 2500)
    bulk = d.GroupBulkRead(line, packets)
    assert bulk.addParam(1, 132, 4) and bulk.addParam(2, 144, 2)
    assert bulk.txRxPacket() == 0
    assert (bulk.getData(1, 132, 4), bulk.getData(2, 144, 2)) == (2500, 120)


# What ROS 2 drivers of the maker's do (dynamixel_hardware_interface): torque off, indirect addresses
# of what is written at 168 and of what is read at 578, then one block each.
def dynamixel_sdk_indirect(port):
    import dynamixel_sdk as d

    def places(i, first, registers):
        n = 0
        for address, size in registers:
            for k in range(size):
                assert packets.write2ByteTxRx(line, i, first + 2 * n, address + k) == (0, 0)
                n += 1
        return n

    line, packets = patient(d.PortHandler(port)), d.PacketHandler(2.0)
    assert line.openPort() and line.setBaudRate(1000000)
    for i in (1, 2):
        assert packets.read4ByteTxRx(line, i, 2)[1:] == (0, 0)
        assert packets.read2ByteTxRx(line, i, 168)[0] == 224
        assert packets.write1ByteTxRx(line, i, 64, 0) == (0, 0)
        assert places(i, 168, [(108, 4), (112, 4), (116, 4)]) == 12
        assert places(i, 578, [(132, 4), (128, 4), (126, 2), (144, 2)]) == 12
        assert packets.write1ByteTxRx(line, i, 64, 1) == (0, 0)
    goals = d.GroupSyncWrite(line, packets, 224, 12)
    for i, goal in ((1, 2500), (2, 1800)):
        block = (0).to_bytes(4, "little") + (0).to_bytes(4, "little") + goal.to_bytes(4, "little")
        assert goals.addParam(i, list(block))
    assert goals.txPacket() == 0
    group = d.GroupSyncRead(line, packets, 634, 12)
    for i in (1, 2):
        assert group.addParam(i)

    def positions():
        assert group.txRxPacket() == 0
        return [group.getData(i, 634, 4) for i in (1, 2)]

    arrives(positions, [2500, 1800])
    arrives(lambda: (positions(), group.getData(1, 644, 2))[1], 120)  # the supply sags in a move
    assert packets.read4ByteTxRx(line, 1, 116)[0] == 2500
    # Through the secondary id both move, and neither answers.
    for i in (1, 2):
        assert packets.write1ByteTxRx(line, i, 64, 0) == (0, 0)
        assert packets.write1ByteTxRx(line, i, 12, 9) == (0, 0)
        assert packets.write1ByteTxRx(line, i, 64, 1) == (0, 0)
    packets.write4ByteTxOnly(line, 9, 116, 2048)
    arrives(positions, [2048, 2048])


# A servo of each layout of protocol 2: number, firmware's place, torque, goal, position, its bytes,
# whether a fast read is answered (e-manual, protocol2: X430 from 45, X330 from 46, P from 12).
LAYOUTS = {
    "XL-320": (350, 2, 24, 30, 37, 2, False),
    "XM430-W350": (1020, 6, 64, 116, 132, 4, True),
    "MX-28-2": (30, 6, 64, 116, 132, 4, False),
    "PH54-200-S500-R": (2020, 6, 512, 564, 580, 4, True),
    "H54-200-S500-RA": (54025, 6, 512, 564, 580, 4, False),
    "H54-200-S500-R": (54024, 6, 562, 596, 611, 4, False),
    "XW540-T260": (1170, 6, 64, 116, 132, 4, True),
    "MX-106-2": (321, 6, 64, 116, 132, 4, False),
}


def dynamixel_sdk_layouts(port):
    import dynamixel_sdk as d

    line, packets = patient(d.PortHandler(port)), d.PacketHandler(2.0)
    assert line.openPort() and line.setBaudRate(1000000)
    for i, (name, row) in enumerate(LAYOUTS.items(), 1):
        number, firmware, torque, goal, position, size, fast = row
        read = {2: packets.read2ByteTxRx, 4: packets.read4ByteTxRx}[size]
        assert packets.ping(line, i)[:2] == (number, 0), name
        assert packets.read1ByteTxRx(line, i, firmware)[1:] == (0, 0), name
        group = d.GroupSyncRead(line, packets, position, size)
        assert group.addParam(i) and group.txRxPacket() == 0, name
        here = group.getData(i, position, size)
        assert (group.fastSyncRead() == 0) == fast, name
        assert packets.write1ByteTxRx(line, i, torque, 1) == (0, 0), name
        there = here + (30 if size == 2 else 100)
        data = list(there.to_bytes(size, "little"))
        assert packets.regWriteTxRx(line, i, goal, size, data) == (0, 0), name
        assert read(line, i, position)[0] == here, name
        packets.action(line, d.BROADCAST_ID)
        line.is_using = False
        arrives(lambda: abs(read(line, i, position)[0] - there) <= 3, True)  # noqa: B023 called at once
        assert packets.reboot(line, i) == (0, 0), name
        arrives(lambda: packets.read1ByteTxRx(line, i, torque)[:2], (0, 0))  # noqa: B023 as well


def dynamixel_sdk_1(port):
    import dynamixel_sdk as d

    line, packets = patient(d.PortHandler(port)), d.PacketHandler(1.0)
    assert line.openPort() and line.setBaudRate(1000000)
    assert [packets.ping(line, i)[:2] for i in (1, 2, 3)] == [(12, 0), (29, 0), (320, 0)]
    assert packets.write2ByteTxRx(line, 1, 30, 1024) == (0, 8)
    assert packets.write2ByteTxRx(line, 1, 30, 700) == (0, 0)
    arrives(lambda: packets.read2ByteTxRx(line, 1, 36)[0], 700)
    # MX have 4096 counts a turn, and gains.
    goals = d.GroupSyncWrite(line, packets, 30, 2)
    for i, goal in ((2, 3000), (3, 1000)):
        assert packets.write1ByteTxRx(line, i, 28, 40) == (0, 0)
        assert packets.read1ByteTxRx(line, i, 28) == (40, 0, 0)
        assert goals.addParam(i, list(goal.to_bytes(2, "little")))
    assert goals.txPacket() == 0
    arrives(lambda: [packets.read2ByteTxRx(line, i, 36)[0] for i in (2, 3)], [3000, 1000])


def rustypot_x(port):
    import rustypot

    arm = rustypot.Xl330PyController(port, 1000000, PATIENCE_MS / 1000)
    assert arm.ping(1) and not arm.ping(9)
    assert arm.sync_read_present_position([1, 2, 3]) == [0.0] * 3
    arm.set_fast_sync_read(True)
    assert arm.sync_read_present_position([1, 2, 3]) == [0.0] * 3


def rustypot_sts(port):
    import rustypot

    arm = rustypot.Sts3215PyController(port, 1000000, PATIENCE_MS / 1000)
    arrives(lambda: arm.scan([1, 2, 3, 4]), {1: 777, 2: 777, 3: 777})
    assert arm.sync_read_present_position([1, 2, 3]) == [0.0] * 3


def feetech(port, order=0, model=777, middle=2048, goal=3000):
    import scservo_sdk as s

    line, packets = patient(s.PortHandler(port)), s.PacketHandler(order)
    assert line.openPort() and line.setBaudRate(1000000)
    assert packets.ping(line, 1) == (model, 0, 0)
    assert packets.read2ByteTxRx(line, 1, 56) == (middle, 0, 0)
    if order == 0:
        group = s.GroupSyncRead(line, packets, 56, 2)
        assert all(group.addParam(i) for i in (1, 2, 3))
        assert group.txRxPacket() == 0
        assert [group.getData(i, 56, 2) for i in (1, 2, 3)] == [middle] * 3
    assert packets.write1ByteTxRx(line, 1, 40, 1) == (0, 0)
    assert packets.write2ByteTxRx(line, 1, 42, goal) == (0, 0)
    arrives(lambda: packets.read2ByteTxRx(line, 1, 56)[0], goal)


def feetech_hls(port):
    feetech(port, 0, 4106)


def feetech_smcl(port):
    feetech(port, 0, 6150)


def feetech_scs(port):
    feetech(port, 1, 1284, 512, 700)


def run_feetech(port, *words):
    """The output of feetech-cli, which stands beside this Python."""
    import pathlib
    import subprocess

    tool = pathlib.Path(sys.executable).with_name("feetech")
    done = subprocess.run([tool, "-p", port, "-b", "1000000", *words], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 or words[0] in ("scan", "info"), done.stdout + done.stderr
    return done.stdout


def feetech_cli(port):
    # It waits as short as the SDK, and says nothing was there: what it reads is read again.
    arrives(lambda: run_feetech(port, "scan").count(" 777 "), 3)
    arrives(lambda: "2048" in run_feetech(port, "info", "1"), True)
    run_feetech(port, "move", "2", "--position", "1500")
    arrives(lambda: "1500" in run_feetech(port, "info", "2"), True)
    run_feetech(port, "set-id", "3", "9", "-y")
    arrives(lambda: "9" in run_feetech(port, "scan"), True)


def lerobot_bus(port):
    import_alone()
    from lerobot.motors import Motor, MotorNormMode
    from lerobot.motors.feetech import FeetechMotorsBus

    names = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
    motors = {
        n: Motor(i + 1, "sts3215",
                 MotorNormMode.RANGE_0_100 if n == "gripper" else MotorNormMode.DEGREES)
        for i, n in enumerate(names)
    }
    bus = FeetechMotorsBus(port=port, motors=motors)
    patient(bus.port_handler)
    bus.connect()
    return bus, names


def lerobot_so101(port):
    bus, names = lerobot_bus(port)
    from lerobot.motors import MotorCalibration

    bus.disable_torque()
    bus.configure_motors()
    homes = bus.set_half_turn_homings()
    assert all(abs(offset) <= 1 for offset in homes.values()), homes
    ranges = {n: MotorCalibration(i + 1, 0, homes[n], 500, 3500) for i, n in enumerate(names)}
    bus.write_calibration(ranges)
    bus.calibration = bus.read_calibration()
    assert bus.is_calibrated
    fastest = 0
    for _ in range(10):  # the machine may be busy with something else for a second, or all the time
        began, n = time.monotonic(), 0
        while time.monotonic() < began + 1:
            angles = bus.sync_read("Present_Position")
            assert all(abs(angle - (50 if name == "gripper" else 0)) < 6
                       for name, angle in angles.items()), angles
            n += 1
        fastest = max(fastest, n)
        if fastest >= 200:
            break
    busy = os.getloadavg()[0] > os.cpu_count()
    assert busy or fastest >= 200, f"{fastest} a second"
    bus.enable_torque()
    bus.sync_write("Goal_Position", {n: 60.0 if n == "gripper" else 10.0 for n in names})
    arrives(lambda: round(bus.sync_read("Present_Position")["elbow_flex"]), 10)
    bus.disconnect()


SERVOS = 6
ROUNDS = 5
REQUEST_BYTES = 8 + SERVOS
STATE = 40, 31  # what grobo reads of a servo: first register, bytes


def busy_pct(reads, data_bytes, took_s):
    """How much of the time the wire of 1 Mbps was busy: a request for all, and a status of each."""
    return reads * (REQUEST_BYTES + SERVOS * (6 + data_bytes)) * 10e-6 / took_s * 100


def best_of(measure):
    """The best second of some: the machine may be busy with something else in another."""
    return max((measure() for _ in range(ROUNDS)), key=lambda found: found[1])


def rate_of(read, data_bytes):
    def measure():
        began, n = time.monotonic(), 0
        while time.monotonic() < began + 1:
            read()
            n += 1
        took_s = time.monotonic() - began
        return n / took_s, busy_pct(n, data_bytes, took_s)

    return best_of(measure)


def bare_reader(port, first, data_bytes):
    """An exchange without a client: the machine takes so long, whoever asks."""
    import termios
    import tty

    body = bytes([0xFE, 4 + SERVOS, 0x82, first, data_bytes, *range(1, SERVOS + 1)])
    frame = b"\xff\xff" + body + bytes([~sum(body) & 0xFF])
    line = os.open(port, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(line)
    set_up = termios.tcgetattr(line)
    set_up[4] = set_up[5] = termios.B1000000
    termios.tcsetattr(line, termios.TCSANOW, set_up)
    waiting = select.poll()
    waiting.register(line, select.POLLIN)
    while waiting.poll(50):  # what the client before had asked for
        os.read(line, 4096)

    def read():
        os.write(line, frame)
        left = SERVOS * (6 + data_bytes)
        while left > 0:
            assert waiting.poll(PATIENCE_MS), f"{left} bytes did not come"
            left -= len(os.read(line, 4096))
        assert left == 0

    return line, read


def rates(port):
    """Whole arms read a second: LeRobot, rustypot, ours and a bare loop, one after the other."""
    import rustypot

    bus, _ = lerobot_bus(port)
    told = {"LeRobot": rate_of(lambda: bus.sync_read("Present_Position", normalize=False), 2)}
    bus.disconnect()
    arm = rustypot.Sts3215PyController(port, 1000000, PATIENCE_MS / 1000)
    ids = list(range(1, SERVOS + 1))
    told["rustypot"] = rate_of(lambda arm=arm: arm.sync_read_present_position(ids), 2)
    del arm

    import grobo
    from grobo._lib import lib

    with grobo.connect(port, robot="so101", sense_interval=1e-6) as robot:
        stats = lib.grobo_robot_get_bus_stats(robot._runner.robot)

        def measure():
            began, frames, line = time.monotonic(), stats.tx_frames, stats.tx_bytes + stats.rx_bytes
            time.sleep(1)
            took_s = time.monotonic() - began
            line = stats.tx_bytes + stats.rx_bytes - line
            return (stats.tx_frames - frames) / took_s, line * 10e-6 / took_s * 100

        time.sleep(0.5)
        told["grobo"] = best_of(measure)
    for who, (first, data_bytes) in {"a bare loop": STATE, "a bare loop for angles": (56, 2)}.items():
        line, read = bare_reader(port, first, data_bytes)
        told[who] = rate_of(read, data_bytes)
        os.close(line)
    for who, (hz, pct) in told.items():
        beside_us = (100 - pct) / 100 * 1e6 / hz
        print(f"{who}: {hz:.0f} reads of the arm a second, the wire busy for {pct:.1f} % of the "
              f"time, {beside_us:.0f} us of each beside it")
    busy = os.getloadavg()[0] > os.cpu_count()
    machine = told["a bare loop"][1]  # what wakes of the system leave of the wire
    assert busy or told["grobo"][1] >= min(95, machine - 1), told


def arrives(position, goal):
    end = time.monotonic() + 30
    while position() != goal:
        assert time.monotonic() < end, "the servo did not arrive"


if __name__ == "__main__":
    globals()[sys.argv[1]](sys.argv[2])
