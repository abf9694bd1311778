# SPDX-License-Identifier: MIT
"""A full screen on a terminal that nobody reads: unread.py GRCTL ROBOT. It is filled to the last byte,
then another program asks for an emergency stop: its output and status are ours. At last the terminal is
read again, and the screen must come to its end."""
import fcntl
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
import time

STILL_S = 1.0  # so long nothing more comes: it is full
grctl, robot = sys.argv[1:]


def resize(rows):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("4H", rows, 120, 0, 0))


def held():
    return struct.unpack("i", fcntl.ioctl(terminal, termios.FIONREAD, b"\0" * 4))[0]


def read_until(words, limit_s=20):
    seen, until_s = b"", time.monotonic() + limit_s
    while words not in seen:
        assert time.monotonic() < until_s, seen[-300:]
        seen += os.read(terminal, 65536)


child, terminal = pty.fork()
if child == 0:
    os.environ["TERM"] = "xterm"
    os.execv(grctl, [grctl, "-d", robot, "--timeout", "500", "monitor"])
try:
    resize(40)
    read_until(b"KNEE_P")
    most, since_s, rows = -1, time.monotonic(), 40
    while time.monotonic() < since_s + STILL_S:
        rows = 70 - rows  # a picture of its own size is drawn whole
        resize(rows)
        time.sleep(0.05)
        if held() > most:
            most, since_s = held(), time.monotonic()
    stop = subprocess.run([grctl, "-d", robot, "--timeout", "3000", "estop"], text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(stop.stdout, end="")
    read_until(b"EMERGENCY STOP: R")
    os.write(terminal, b"q")
    try:
        while os.read(terminal, 65536):
            pass
    except OSError:
        pass  # it has ended
    _, status = os.waitpid(child, 0)
    child = 0
    assert status == 0, status
    sys.exit(stop.returncode)
finally:
    if child:
        os.kill(child, signal.SIGKILL)
