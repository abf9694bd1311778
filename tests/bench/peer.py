# SPDX-License-Identifier: MIT
"""Clients in Python that are measured beside ours: peer.py pyserial|dynamixel-sdk|rustypot N PATH

Makes N transactions, one at a time: reading a position of two bytes. Prints transactions a second
and microseconds of processor time of each. Ends with 77 where the package is missing.
"""
import sys
import time

who, n, path = sys.argv[1], int(sys.argv[2]), sys.argv[3]
try:
    if who == "pyserial":
        import serial

        port = serial.Serial(path, 115200, timeout=1)
        request = bytes([0xFA, 0xAF, 1, 0x0F, 0x2A, 2, 0, 1 ^ 0x0F ^ 0x2A ^ 2])

        def read():
            port.write(request)
            return len(port.read(10)) == 10

    elif who == "dynamixel-sdk":
        import dynamixel_sdk

        port = dynamixel_sdk.PortHandler(path)
        port.openPort()
        handler = dynamixel_sdk.PacketHandler(1.0)

        def read():
            return handler.read2ByteTxRx(port, 1, 36)[1] == 0

    else:
        import rustypot

        bus = rustypot.Sts3215PyController(path, 115200, 1)

        def read():
            return len(bus.sync_read_present_position([1])) == 1

except ImportError:
    sys.exit(77)
begin, begin_cpu = time.monotonic(), time.process_time()
good = sum(read() for _ in range(n))
took, cpu = time.monotonic() - begin, time.process_time() - begin_cpu
print("%.1f %.3f 0" % (n / took, cpu / n * 1e6))
sys.exit(0 if good * 100 >= n * 99 else 1)
