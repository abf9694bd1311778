# SPDX-License-Identifier: MIT
"""Independent clients against the simulator: clients.py CLIENT PORT. An assertion tells what differs."""
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from lerobot_alone import import_alone  # noqa: E402


def dynamixel_sdk_2(port):
    import dynamixel_sdk as d

    line, packets = d.PortHandler(port), d.PacketHandler(2.0)
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


def dynamixel_sdk_1(port):
    import dynamixel_sdk as d

    line, packets = d.PortHandler(port), d.PacketHandler(1.0)
    assert line.openPort() and line.setBaudRate(1000000)
    assert [packets.ping(line, i)[:2] for i in (1, 2)] == [(12, 0), (29, 0)]
    assert packets.write2ByteTxRx(line, 1, 30, 1024) == (0, 8)
    assert packets.write2ByteTxRx(line, 1, 30, 700) == (0, 0)
    arrives(lambda: packets.read2ByteTxRx(line, 1, 36)[0], 700)


def rustypot_x(port):
    import rustypot

    arm = rustypot.Xl330PyController(port, 1000000, 0.1)
    assert arm.ping(1) and not arm.ping(9)
    assert arm.sync_read_present_position([1, 2, 3]) == [0.0] * 3
    arm.set_fast_sync_read(True)
    assert arm.sync_read_present_position([1, 2, 3]) == [0.0] * 3


def rustypot_sts(port):
    import rustypot

    arm = rustypot.Sts3215PyController(port, 1000000, 0.1)
    assert arm.scan([1, 2, 3, 4]) == {1: 777, 2: 777, 3: 777}
    assert arm.sync_read_present_position([1, 2, 3]) == [0.0] * 3


def feetech(port, order=0, model=777, middle=2048, goal=3000):
    import scservo_sdk as s

    line, packets = s.PortHandler(port), s.PacketHandler(order)
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


def feetech_scs(port):
    feetech(port, 1, 1284, 512, 700)


def run_feetech(port, *words):
    """The output of feetech-cli, which stands beside this Python."""
    import pathlib
    import subprocess

    tool = pathlib.Path(sys.executable).with_name("feetech")
    done = subprocess.run([tool, "-p", port, "-b", "1000000", *words], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def feetech_cli(port):
    found = run_feetech(port, "scan")
    assert "3 servo" in found and found.count(" 777 ") == 3, found
    assert "2048" in run_feetech(port, "info", "1")
    run_feetech(port, "move", "2", "--position", "1500")
    arrives(lambda: 1500 if "1500" in run_feetech(port, "info", "2") else 0, 1500)
    run_feetech(port, "set-id", "3", "9", "-y")
    assert "9" in run_feetech(port, "scan")


def lerobot_so101(port):
    import_alone()
    from lerobot.motors import Motor, MotorCalibration, MotorNormMode
    from lerobot.motors.feetech import FeetechMotorsBus

    names = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
    motors = {
        n: Motor(i + 1, "sts3215",
                 MotorNormMode.RANGE_0_100 if n == "gripper" else MotorNormMode.DEGREES)
        for i, n in enumerate(names)
    }
    bus = FeetechMotorsBus(port=port, motors=motors)
    bus.connect()
    again(bus.disable_torque)
    again(bus.configure_motors)
    homes = again(bus.set_half_turn_homings)
    assert all(abs(offset) <= 1 for offset in homes.values()), homes
    ranges = {n: MotorCalibration(i + 1, 0, homes[n], 500, 3500) for i, n in enumerate(names)}
    again(lambda: bus.write_calibration(ranges))
    bus.calibration = again(bus.read_calibration)
    assert bus.is_calibrated
    fastest = 0
    for _ in range(10):  # the machine may be busy with something else for a second
        began, n = time.monotonic(), 0
        while time.monotonic() < began + 1:
            angles = bus.sync_read("Present_Position", num_retry=5)
            assert all(abs(angle - (50 if name == "gripper" else 0)) < 6
                       for name, angle in angles.items()), angles
            n += 1
        fastest = max(fastest, n)
        if fastest >= 200:
            break
    assert fastest >= 200, f"{fastest} a second"
    again(bus.enable_torque)
    bus.sync_write("Goal_Position", {n: 60.0 if n == "gripper" else 10.0 for n in names})
    arrives(lambda: round(bus.sync_read("Present_Position", num_retry=5)["elbow_flex"]), 10)
    again(bus.disconnect)


def again(request):
    """It gives up 50 ms after a request: a busy machine gets a second chance, and a third."""
    for _ in range(2):
        try:
            return request()
        except ConnectionError:
            pass
    return request()


def arrives(position, goal):
    end = time.monotonic() + 10
    while position() != goal:
        assert time.monotonic() < end, "the servo did not arrive"


if __name__ == "__main__":
    globals()[sys.argv[1]](sys.argv[2])
