# SPDX-License-Identifier: MIT
"""Tables on a terminal after Ctrl-S: unread_tables.py GRCTL GROUP. What is not shown is not kept: after
Ctrl-Q one sees how robots are, not how they were."""
import os
import pty
import signal
import sys
import time

PAUSED_S = 2.0  # time for 100 tables
HEAD = b"robot  "
grctl, group = sys.argv[1:]
child, terminal = pty.fork()
if child == 0:
    os.execv(grctl, [grctl, "-d", group, "--timeout", "500", "status", "--watch", "--interval", "20"])
try:
    seen = b""
    while seen.count(HEAD) < 3:
        seen += os.read(terminal, 65536)
    os.write(terminal, b"\x13")
    time.sleep(PAUSED_S)
    os.kill(child, signal.SIGINT)
    os.write(terminal, b"\x11")
    seen = b""
    try:
        while piece := os.read(terminal, 65536):
            seen += piece
    except OSError:
        pass  # it has ended
    _, status = os.waitpid(child, 0)
    child = 0
    print(f"{seen.count(HEAD)} tables came after {PAUSED_S} s; status {status}")
    sys.exit(0 if seen.count(HEAD) <= 20 and os.WEXITSTATUS(status) == 130 else 1)
finally:
    if child:
        os.kill(child, signal.SIGKILL)
