# SPDX-License-Identifier: MIT
"""A client that knows GR001 from the frames alone: bytes of the reference document, no code of
ours. usage: stranger.py DEVICE; one line on stdout for each thing that was as described."""
import os
import select
import sys
import termios
import time
import tty


def answer(fd, frame, size, within_s=5.0):
    """Writes a frame and reads just so many bytes."""
    os.write(fd, frame)
    got = b""
    end = time.monotonic() + within_s
    while len(got) < size:
        left = end - time.monotonic()
        if left <= 0 or not select.select([fd], [], [], left)[0]:
            break
        got += os.read(fd, size - len(got))
    return got


def state(fd, motor):
    """The 18 bytes of No.42 and torque: 54 09 FA AF id 0F 24 12 00 SUM 1A, 26 bytes back."""
    reply = answer(fd, bytes([0x54, 9, 0xFA, 0xAF, motor, 0x0F, 0x24, 0x12, 0,
                              motor ^ 0x0F ^ 0x24 ^ 0x12, 0x1A]), 26)
    total = 0
    for byte in reply[2:25]:
        total ^= byte
    if len(reply) != 26 or reply[:3] != bytes([0xFD, 0xDF, motor]) or total != reply[25]:
        sys.exit(f"motor {motor}: {reply.hex(' ')}")
    return reply[7], int.from_bytes(reply[13:15], "little", signed=True)


def reaches(fd, motor, angle_ddeg, within_s=10.0):
    end = time.monotonic() + within_s
    while abs(state(fd, motor)[1] - angle_ddeg) > 10:
        if time.monotonic() > end:
            sys.exit(f"motor {motor}: at {state(fd, motor)[1]}, not {angle_ddeg}")


fd = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(fd)
speed = termios.tcgetattr(fd)
speed[4] = speed[5] = termios.B115200
termios.tcsetattr(fd, termios.TCSANOW, speed)

if answer(fd, b"\x41\x00", 1) != b"\x07":
    sys.exit("no answer to the check")
print("check")

os.write(fd, bytes.fromhex("53 30 FA AF 00 00 24 02 14")
         + b"".join(bytes([m, 1]) for m in range(1, 21)) + b"\x26")
if any(state(fd, m)[0] != 1 for m in range(1, 21)):
    sys.exit("torque is not on everywhere")
print("torque")

os.write(fd, bytes.fromhex("53 6C FA AF 00 00 1E 05 14")
         + b"".join(bytes([m, 0, 0, 100, 0]) for m in range(1, 21)) + b"\x1B")
for motor in range(1, 21):
    reaches(fd, motor, 0)
print("posture")

os.write(fd, bytes.fromhex("53 0C FA AF 03 00 1E 04 01 84 03 0A 00 95"))
reaches(fd, 3, 900)
print("joint")
