# SPDX-License-Identifier: MIT
"""Clients of the servos' bus with the habits that programs for such servos have; no code of ours.
usage: habits.py DEVICE HABIT; exit status 0 if the servos did what the habit needs."""
import os
import select
import sys
import termios
import tty


def open_at(speed):
    fd = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
    tty.setraw(fd)
    line = termios.tcgetattr(fd)
    line[4] = line[5] = speed
    termios.tcsetattr(fd, termios.TCSANOW, line)
    return fd


def packet(text):
    """Header and sum around what is between them."""
    body = bytes.fromhex(text)
    total = 0
    for byte in body:
        total ^= byte
    return b"\xfa\xaf" + body + bytes([total])


def some(fd, size, within_s=5.0):
    """What one read gives."""
    return os.read(fd, size) if select.select([fd], [], [], within_s)[0] else b""


def whole(fd, size, within_s=5.0):
    got = b""
    while len(got) < size and (more := some(fd, size - len(got), within_s)):
        got += more
    return got


def want(got, expected, what):
    if got != expected:
        sys.exit(f"{what}: {got.hex(' ')}, not {expected.hex(' ')}")


def back(motor, address, data):
    """A return packet without complaints."""
    reply = packet(f"{motor:02x} 00 {address:02x} {len(data):02x} 01 {data.hex()}")
    return b"\xfd\xdf" + reply[2:]


READ_TORQUE = packet("03 0f 24 01 00")
TORQUE_ON = packet("03 01 24 01 01 01")


def one_wire():
    """Reads back what it writes, then the reply."""
    fd = open_at(termios.B115200)
    for sent, reply in ((TORQUE_ON, b"\x07"), (READ_TORQUE, back(3, 0x24, b"\x01")),
                        (packet("03 00 1e 02 01 00 00"), b"")):
        os.write(fd, sent)
        want(whole(fd, len(sent)), sent, "echo")
        want(whole(fd, len(reply)), reply, "reply")


def one_read():
    """Takes what the first read gives for the whole reply."""
    fd = open_at(termios.B115200)
    for _ in range(5):
        os.write(fd, packet("03 09 00 00 01"))
        got = some(fd, 1024)
        want(got[:7], bytes.fromhex("fd df 03 00 2a 12 01"), "head")
        if len(got) != 26:
            sys.exit(f"{len(got)} bytes in one read, not 26")


def byte_by_byte():
    """Writes and reads single bytes; both at the servo's leisure."""
    fd = open_at(termios.B115200)
    for sent, reply in (TORQUE_ON, b"\x07"), (READ_TORQUE, back(3, 0x24, b"\x01")):
        got = b""
        for _ in range(20):  # servos forget a packet that stands still, as on a busy machine
            for byte in sent:
                os.write(fd, bytes([byte]))
            if got := some(fd, 1, 0.5):
                break
        for _ in reply[1:]:
            got += some(fd, 1)
        want(got, reply, "reply")


def other_rate():
    """Comes at a rate that nobody has, finds the servos' one, and takes one of them elsewhere."""
    fd = open_at(termios.B57600)
    os.write(fd, READ_TORQUE)
    want(whole(fd, 1, 0.3), b"", "at 57600")
    os.close(fd)
    fd = open_at(termios.B115200)
    os.write(fd, packet("03 01 06 01 01 09"))
    want(whole(fd, 1), b"\x07", "at 115200")
    os.close(fd)
    fd = open_at(termios.B230400)
    os.write(fd, READ_TORQUE)
    want(whole(fd, 9), back(3, 0x24, b"\x00"), "at 230400")
    os.write(fd, packet("ff 00 06 01 01 07"))
    os.close(fd)


def never_reads():
    """Asks for more than anybody holds, hears nothing of it, and leaves."""
    fd = open_at(termios.B115200)
    for _ in range(600):
        os.write(fd, packet("03 0f 00 8c 00"))
    os.close(fd)


globals()[sys.argv[2]]()
