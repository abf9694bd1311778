# SPDX-License-Identifier: MIT
"""An IMU behind a pseudo-terminal: prints what a file says, 50 times a second, until it is gone.

usage: imu.py LINK FILE     LINK leads to the pseudo-terminal; the first line of FILE is printed
"""

import os
import sys
import time
import tty

own, other = os.openpty()
tty.setraw(other)
os.set_blocking(own, False)
os.symlink(os.ttyname(other), sys.argv[1])
while os.path.exists(sys.argv[2]):
    try:
        os.write(own, open(sys.argv[2], "rb").readline())
    except BlockingIOError:  # nobody reads yet
        pass
    time.sleep(0.02)
