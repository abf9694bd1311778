# SPDX-License-Identifier: MIT
"""The owner of a new SO-101 types at a terminal: `grctl setup` on a pty, six factory servos with id
1 of a simulator, whose cables and shafts the owner's hands move. Prints each step with its time and
keystrokes.

usage: typed_setup.py GRCTL DEVICE SIM_LOG MOTION, the commands of the simulator on descriptor 5
"""

import errno
import os
import pty
import re
import select
import subprocess
import sys
import time

GRCTL, DEVICE, SIM_LOG, MOTION = sys.argv[1:5]
SIM = 5
LIMIT_S = 60
JOINTS = ["gripper", "wrist_roll", "wrist_flex", "elbow_flex", "shoulder_lift", "shoulder_pan"]
NUMBER = {name: 16 - n for n, name in enumerate(JOINTS)}  # how the simulator calls its servo
WANTED = {name: 6 - n for n, name in enumerate(JOINTS)}
ANSI = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
BAR = re.compile(r"[░█]+[^\r\n]*")  # of a progress


class Terminal:
    """A command on a terminal of its own, and what a person sees and types there."""

    keys = 0
    began = time.monotonic()

    def __init__(self, *words, patient=()):
        """`patient`: options that nobody types, for a busy machine that answers late."""
        self.seen, self.at = "", 0
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.environ["TERM"] = "xterm"
            os.execv(GRCTL, [GRCTL, *patient, *words])
        Terminal.keys += len(" ".join(["grctl", *words])) + 1

    def read(self, wait_s):
        if select.select([self.fd], [], [], wait_s)[0]:
            try:
                data = os.read(self.fd, 4096)
            except OSError as error:
                if error.errno != errno.EIO:
                    raise
                return False
            text = ANSI.sub("", data.decode(errors="replace"))
            self.seen += BAR.sub("", text).replace("\r", "")
            return bool(data)
        return True

    def see(self, pattern):
        """Waits until a person has read this, behind what was read before."""
        end = time.monotonic() + LIMIT_S
        while True:
            found = re.compile(pattern).search(self.seen, self.at)
            if found:
                self.at = found.end()
                return found
            if time.monotonic() > end or not self.read(0.5):
                found = re.compile(pattern).search(self.seen, self.at)
                if found:
                    continue
                sys.exit(f"not seen: {pattern!r}; instead:\n{self.seen[self.at:][-1500:]}")

    def type(self, text):
        Terminal.keys += len(text)
        os.write(self.fd, text.encode())

    def end(self):
        while self.read(1):
            pass
        _, status = os.waitpid(self.pid, 0)
        os.close(self.fd)
        return os.waitstatus_to_exitcode(status)


def said():
    with open(SIM_LOG, encoding="utf-8", errors="replace") as log:
        return log.read().count("\n")


def hands(text):
    """What hands do: plugs and shafts of the simulator, which answers when it is done."""
    before = said()
    os.write(SIM, (text + "\n").encode())
    end = time.monotonic() + LIMIT_S
    while said() == before:
        if time.monotonic() > end:
            sys.exit(f"the simulator does not answer: {text}")
        time.sleep(0.005)


PATIENT = ("--timeout", "300")
# How far the owner's hands turn each joint: a little less than its limits.
RANGE_DEG = {"gripper": (-9, 99), "wrist_roll": (-150, 155), "wrist_flex": (-94, 94),
             "elbow_flex": (-95, 95), "shoulder_lift": (-99, 99), "shoulder_pan": (-109, 109)}
# What a machine that was away for a moment ends a motion with, as it has to.
BUSY = r"stopped for safety: (host stalled|lost replies)"
STEPS = []


def step(name):
    STEPS.append((name, time.monotonic() - Terminal.began, Terminal.keys))
    print(f"{name}: {STEPS[-1][1]:.1f} s, {STEPS[-1][2]} keys", flush=True)


def give(terminal, joint):
    terminal.see(f"plug in the servo of {joint} alone")
    hands(f"silent {NUMBER[joint]} off")
    terminal.type("\n")
    if WANTED[joint] == 1:
        terminal.see(f"{joint}: has the id 1 at 1000000 bps already")
    else:
        terminal.see(f"{joint}: id 1 -> {WANTED[joint]} at 1000000 bps, kept")
    hands(f"silent {NUMBER[joint]} on")


if __name__ == "__main__":
    hands("silent 16 off")
    t = Terminal("-d", DEVICE, "setup")
    t.see("name the robot; else no")
    t.type("so101\n")
    step("setup")
    for j in JOINTS[:3]:
        give(t, j)
        step(f"id of {j}")
    # The owner is called away, and the change of the fourth servo's id is cut off.
    t.see("plug in the servo of elbow_flex alone")
    t.type("\x03")
    t.end()
    hands(f"silent {NUMBER['elbow_flex']} off")
    for words in ("1", "id", "3", "--flash"), ("3", "lock", "0"):
        subprocess.run(
            [GRCTL, "-d", DEVICE, "--timeout", "500", "--robot", "so101", "-y", "servo-set", *words],
            check=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
    hands(f"silent {NUMBER['elbow_flex']} on")
    hands(f"silent {NUMBER['wrist_flex']} off")
    t = Terminal("-d", DEVICE, "--robot", "so101", "setup")
    t.see("of its 6 servos answer. Are they new")
    hands(f"silent {NUMBER['wrist_flex']} on")
    t.type("y\n")
    for j in JOINTS[:3]:
        t.see(f"servo of {j} alone")
        t.type("skip\n")
    t.see("plug in the servo of elbow_flex alone")
    hands(f"silent {NUMBER['elbow_flex']} off")
    t.type("\n")
    t.see("its lock was open, from a change that was cut off: closed")
    t.see("elbow_flex: has the id 3 ")
    hands(f"silent {NUMBER['elbow_flex']} on")
    step("what was cut off is finished")
    for j in JOINTS[4:]:
        give(t, j)
        step(f"id of {j}")
    t.see("plug in all of them")
    for j in JOINTS:
        hands(f"silent {NUMBER[j]} off")
    t.type("\n")
    t.see("its name, for -d")
    t.type("arm\n")
    step("named")
    t.see("calibrate it now")
    t.type("y\n")
    t.see("torque goes off when you press enter")
    t.type("\n")
    t.see("middle of its range, then press enter")
    t.type("\n")
    for j in JOINTS:
        for deg in (*RANGE_DEG[j], 0):
            hands(f"turn {NUMBER[j]} {deg}")
            t.see("shoulder_pan")  # it has read them again
            t.see("shoulder_pan")
    # A cable that comes loose for a moment ends nothing.
    hands(f"silent {NUMBER['wrist_flex']} on")
    t.see("shoulder_pan")
    t.see("shoulder_pan")
    hands(f"silent {NUMBER['wrist_flex']} off")
    t.see("shoulder_pan")
    t.type("\n")
    t.see("move it for the first time")
    step("calibrated")
    t.type("y\n")
    moved = t.see("gripper moved, and is limp again|" + BUSY)
    if t.end() != 0 and "moved" in moved.group():
        sys.exit("setup failed")
    step("moved for the first time")
    for tries in range(3):
        t = Terminal("-d", "arm", "play", MOTION, "--speed", "200", patient=PATIENT)
        ended = t.end()
        if ended == 0:
            break
        if not re.search(BUSY, t.seen) or tries == 2:
            sys.exit(f"it does not play: {t.seen[-1500:]}")
    step("it plays")
