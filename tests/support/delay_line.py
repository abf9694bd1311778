# SPDX-License-Identifier: MIT
"""A line that is far away: a pseudo-terminal joined to a device, each byte held back both ways.
usage: delay_line.py DEVICE DELAY_MS; prints the pseudo-terminal's name when it can be opened."""
import collections
import os
import select
import sys
import time
import tty


def main():
    delay_s = float(sys.argv[2]) / 1000
    device = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
    near, far = os.openpty()  # far stays open: the line outlives the programs that use it
    tty.setraw(device)
    tty.setraw(far)
    print(os.ttyname(far), flush=True)
    other = {device: near, near: device}
    held = collections.deque()  # (when due, where to, bytes), in order of time
    while True:
        wait_s = max(held[0][0] - time.monotonic(), 0) if held else None
        for fd in select.select([device, near], [], [], wait_s)[0]:
            data = os.read(fd, 4096)
            if not data:
                return
            held.append((time.monotonic() + delay_s, other[fd], data))
        while held and held[0][0] <= time.monotonic():
            _, fd, data = held.popleft()
            while data:
                data = data[os.write(fd, data):]


try:
    main()
except (KeyboardInterrupt, OSError):
    pass
