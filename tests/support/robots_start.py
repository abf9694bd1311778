# SPDX-License-Identifier: MIT
"""Every robot starts every command: robots_start.py GRCTL FOLDER prints a line "ok ROBOT" or
"not ok ROBOT: why" for each robot that is built in, for one of an own file of each kind of servo, of one
joint and of 64. Each command runs on a terminal and piped, on the simulator in process."""
import concurrent.futures
import fcntl
import json
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import threading
import time
import urllib.request

LIMIT_S = 60
SERVOS = ["STS3215", "SM8512BL", "HLS3930", "SCS0009", "XL430-W250", "XL-320", "PH42-020-S300-R",
          "H54-200-S500-R", "AX-12A", "MX-28", "LX-16A", "KRS-3301", "RS304MD"]
EXAMPLES = ["rover", "two-arms", "ax-body-xl330-head"]  # wheels, several lines
ESCAPES = re.compile(rb"\x1b(\[[0-9;?]*[A-Za-z]|[()][A-Z0-9]|[=>78])")
grctl, folder = os.path.abspath(sys.argv[1]), sys.argv[2]
environment = dict(os.environ, TERM="xterm", COLUMNS="80", LINES="24")
fork = threading.Lock()  # a pty must not reach the children of another thread


def ask(*words):
    return json.loads(subprocess.run([grctl, *words, "--json"], check=True, capture_output=True).stdout)


def own_file(name, servo, names, first=1, more=""):
    path = os.path.join(folder, name + ".yaml")
    with open(path, "w") as file:
        file.write(f"name: {name}\nfamily: {families[servo]}\n{more}joints:\n")
        for i, joint in enumerate(names):
            file.write(f"  - {{name: {joint}, id: {first + i}, servo: {servo}, limits_deg: [-50, 50]}}\n")
    return path


def example(name):
    """Its copy; 'left' and 'right' of its joints are words of other robots too."""
    path = os.path.join(folder, name + ".yaml")
    with open(f"docs/examples/robots/{name}.yaml") as text, open(path, "w") as file:
        for line in text:
            is_joint = re.search(r"name: (left|right), id|mirror: |joints: \[left, right\]", line)
            file.write(re.sub(r"\b(left|right)\b", r"\1_wheel", line) if is_joint else line)
    return path


class Robot:
    def __init__(self, word):
        self.word = word
        self.name = os.path.basename(word)
        self.joints = ask("--robot", word, "joints")["joints"]
        self.names = [joint["name"] for joint in self.joints]
        self.home = os.path.join(folder, "at-" + self.name)
        os.mkdir(self.home)
        self.motion = self.pose()

    def pose(self):
        path = os.path.join(self.home, "stand.yaml")
        angles = ", ".join(str(joint["init_deg"] * 3.14159 / 180) for joint in self.joints)
        model = ask("--robot", self.word, "robot", "show")
        with open(path, "w") as file:
            file.write(f"type: BodyMotion\nname: stand\ntargetBody: {model.get('model', model['name'])}\n"
                       "components:\n  - type: MultiValueSeq\n    content: JointPosition\n"
                       "    purpose: JointPosition\n    frameRate: 50\n    numFrames: 2\n"
                       f"    numParts: {len(self.joints)}\n    frames:\n"
                       f"      - [ {angles} ]\n      - [ {angles} ]\n")
        return path

    def words(self, *words):
        return [grctl, "-d", "sim", "--robot", self.word, "--timeout", "500", *words]


def known_by(name):
    return [name, name[2:]] if name[1:2] == "_" else [name]


class Run:
    """One command. What it writes is in `text`."""

    def __init__(self, robot, terminal, *words):
        self.text, self.terminal = b"", terminal
        if terminal:
            with fork:
                self.fd, side = pty.openpty()
                os.set_inheritable(side, False)
                fcntl.ioctl(side, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
                self.process = subprocess.Popen(robot.words(*words), stdin=side, stdout=side, stderr=side,
                                                cwd=robot.home, env=environment, start_new_session=True,
                                                preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
                os.close(side)
        else:
            self.process = subprocess.Popen(robot.words(*words), stdin=subprocess.DEVNULL,
                                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                            cwd=robot.home, env=environment)
            self.fd = self.process.stdout.fileno()

    def read(self):
        """Something more, or False at the end."""
        if not select.select([self.fd], [], [], LIMIT_S)[0]:
            self.process.kill()
            raise AssertionError(f"nothing more for {LIMIT_S} s")
        try:
            more = os.read(self.fd, 65536)
        except OSError:  # the terminal's other side is closed
            more = b""
        self.text += more
        return more != b""

    def until(self, *words):
        until_s = time.monotonic() + LIMIT_S
        while not all(word in ESCAPES.sub(b"", self.text) for word in words):
            assert time.monotonic() < until_s and self.read(), f"ended, or no {words}"

    def write(self, text):
        os.write(self.fd, text)

    def end(self, status):
        while self.read():
            pass
        got = self.process.wait()
        if self.terminal:
            os.close(self.fd)
        else:
            self.process.stdout.close()
        assert got == status, f"status {got}, not {status}"


def look(robot, run, all_names):
    text = ESCAPES.sub(b" ", run.text).decode(errors="replace")
    for word in ("Sanitizer", "runtime error", "Segmentation", "nan", "(null)"):
        assert not re.search(rf"\b{re.escape(word)}\b", text), f"says {word}"
    own = {known for name in robot.names for known in known_by(name)}
    # A table's head may be of several rows: "pan" is part of a name there.
    for name in (name for name in foreign if not any(name in mine for mine in own)):
        assert not re.search(rf"(?<![\w./-]){re.escape(name)}(?![\w.-])", text), f"says {name}, of another robot"
    if all_names:
        for name in robot.names:
            assert any(known in text for known in known_by(name)), f"does not say {name}"


def start_monitor(robot, terminal):
    run = Run(robot, terminal, "monitor")
    few = len(robot.names) <= 20
    known = [known_by(name)[-1][:5].encode() for name in (robot.names if few else robot.names[:1])]
    run.until(*known)
    if terminal and os.environ.get("SCREEN", "ncurses") == "ncurses":
        run.until(b"replies", b">")
        chosen = re.search(rb"([0-9]+)>([A-Za-z0-9_]{3})", ESCAPES.sub(b"", run.text))
        assert any(int(chosen[1]) == joint["motor"] and known[:3] == chosen[2].decode()
                   for joint in robot.joints for known in known_by(joint["name"])), chosen
        # Every arrow, so often that it comes round; groups; a nudge without torque.
        run.write((b"\x1b[B" * 3 + b"\x1b[C" + b"\x1b[A" * 2 + b"\x1b[D") * 30 + b"07]{")
        run.until(b"no torque there")
        run.write(b"q")
        run.end(0)
    else:
        run.process.send_signal(signal.SIGINT)
        run.end(130)
    look(robot, run, few and not terminal)


def start_serve(robot, terminal):
    run = Run(robot, terminal, "serve", "--port", "0", robot.home)
    run.until(b"#token=")
    while not (link := re.search(rb"(http://[0-9.]*:[0-9]+)/#token=", run.text)):
        run.read()
    for path in ("/", "/api/robot", "/api/state", "/api/motions"):
        with urllib.request.urlopen(link[1].decode() + path, timeout=LIMIT_S) as answer:
            body = answer.read()
            assert answer.status == 200 and body, path
            if path == "/api/robot":
                names = [joint["name"] for joint in json.loads(body)["joints"]]
                assert names == robot.names, names
    run.process.send_signal(signal.SIGINT)
    run.end(130)
    look(robot, run, False)


def start_other(robot, terminal, words, all_names):
    run = Run(robot, terminal, *words)
    run.end(0)
    look(robot, run, all_names)


def start_all(robot):
    for terminal in True, False:
        where = "on a terminal" if terminal else "piped"
        for words, all_names in ((["status"], True), (["doctor"], False), (["info"], True), (["joints"], True),
                                 (["plot", robot.motion], not terminal), (["show", robot.motion], False),
                                 (["robot", "show"], False), (["robot", "servos"], False),
                                 (["budget"], False), (["check", robot.motion], False)):
            try:
                start_other(robot, terminal, words, all_names)
            except AssertionError as wrong:
                return f"{words[0]} {where}: {wrong}"
        for command in start_monitor, start_serve:
            try:
                command(robot, terminal)
            except AssertionError as wrong:
                return f"{command.__name__[6:]} {where}: {wrong}"
    return None


families = {servo["model"]: servo["family"] for servo in ask("robot", "servos")["servos"]}
assert set(families.values()) == {families[servo] for servo in SERVOS}, "a family without a file here"
robots = [robot["name"] for robot in ask("robot", "list")["robots"]]
for servo in SERVOS:
    kind = servo.replace("-", "_")
    robots.append(own_file("own-" + servo, servo, [f"{kind}_{part}" for part in ("base", "arm", "hand")]))
robots.append(own_file("one", "STS3215", ["the_only_joint_of_a_robot_with_a_long_name_of_sixty_letters_abc"]))
robots.append(own_file("all64", "XL430-W250", [f"part_with_a_long_name_number_{i}" for i in range(64)], 150,
                       "line: {baud: 4000000}\n"))
robots += [example(name) for name in EXAMPLES]
robots = [Robot(word) for word in robots]
foreign = {known for robot in robots for name in robot.names for known in known_by(name)}
with concurrent.futures.ThreadPoolExecutor(12) as pool:
    for robot, wrong in zip(robots, pool.map(start_all, robots)):
        print(f"not ok {robot.name}: {wrong}" if wrong else f"ok {robot.name}", flush=True)
