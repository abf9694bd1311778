# SPDX-License-Identifier: MIT
"""Every command that drives or reads a robot x every robot, on the simulator in process.

usage: matrix.py GRCTL FOLDER LIST [all]

Robots: those that are built in, and of every kind of servo files of 1, 6 and 20 joints at the slowest
rate of the servos, the factory's and the fastest. Commands run piped and on a terminal, plain and with
--json. Every pair (command, kind of robot), (command, size), (command, rate), (command, way), (kind,
size and rate) and (kind, way) has a cell; `all`: every combination, and more sizes.

A cell is well where its status is 0, or what a line of LIST says, no signal ended it, --json gives
JSON, and nothing in its text is of another robot. LIST has the reviewed refusals, tab-separated:

    COMMAND  WHICH  STATUS  PATTERN  REASON

COMMAND is the name below or a pattern of it, WHICH a Python expression of `kind`, `n`, `bps`,
`name`, `tty` and `json`, PATTERN a regular expression of the only complaint. A line that no cell needed is
an error, too: it is stale. Prints "ok COMMAND" or "not ok COMMAND: why" for each command, and ends with status 1 if one is not
well. MATRIX_ONLY, a pattern of "COMMAND, ROBOT, ...", chooses cells."""
import collections
import concurrent.futures
import fcntl
import itertools
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import termios
import threading
import time

LIMIT_S = 60
MOST_CELLS = 400
ESCAPES = re.compile(rb"\x1b(\[[0-9;?]*[A-Za-z]|[()][A-Z0-9]|[=>78])")
# Kind of servo: its family, one model, the lowest id of a file.
KINDS = {"rs30x": ("rs30x", "RS301CR", 1), "dxl": ("dynamixel2", "XL430-W250", 1),
         "ax12": ("dynamixel1", "AX-12A", 1),
         "sts": ("feetech", "STS3215", 1), "scs": ("feetech", "SCS0009", 1),
         "lx16a": ("lx16a", "LX-16A", 1), "krs": ("ics", "KRS-3301", 0)}
# The slowest rate of each, the factory's, the fastest that the simulator of a robot's file takes.
RATES = {"rs30x": (9600, 115200, 460800), "dxl": (9600, 57600, 4000000), "ax12": (9600, 1000000),
         "sts": (38400, 1000000), "scs": (38400, 1000000), "lx16a": (115200,), "krs": (115200, 1250000)}
WAYS = list(itertools.product((False, True), (False, True)))  # terminal, --json
OTHERS = ("RS30x", "RS301CR", "RS302CD", "GR001", "R_KNEE_P", "R_HIP_Y", "L_ANKLE", "SO-101", "shoulder_pan")

grctl, folder, list_file = os.path.abspath(sys.argv[1]), sys.argv[2], sys.argv[3]
whole = sys.argv[4:] == ["all"]
sizes = (1, 2, 6, 17, 20, 22, 32, 40, 64) if whole else (1, 6, 20)
environment = dict(os.environ, TERM="xterm", COLUMNS="80", LINES="24")
fork = threading.RLock()  # a pty must not reach the children of another thread


def ask(*words):
    return json.loads(subprocess.run([grctl, *words, "--json"], check=True, capture_output=True).stdout)


class Robot:
    def __init__(self, kind, n, word, bps=0):
        self.kind, self.n, self.word, self.bps = kind, n, word, bps
        self.name = os.path.splitext(os.path.basename(word))[0]
        shown = ask("--robot", word, "robot", "show")
        self.model, self.family, self.wiring = shown["model"], shown["family"], shown["wiring"]
        self.joints = ask("--robot", word, "joints")["joints"]
        self.names = [joint["name"] for joint in self.joints]
        joint = self.joints[-1]
        self.last, self.id = joint["name"], joint["id"]
        low, high = joint["limits_deg"]
        self.near = joint["init_deg"] + (2 if joint["init_deg"] + 2 < high else -2)
        self.beyond = high + 5
        self.home = os.path.join(folder, "at-" + self.name)
        os.mkdir(self.home)
        self.write_motion()

    def write_motion(self):
        self.motion = os.path.join(self.home, "stand.yaml")
        angles = ", ".join(str(joint["init_deg"] * 3.14159 / 180) for joint in self.joints)
        with open(self.motion, "w") as file:
            file.write(f"type: BodyMotion\nname: stand\ntargetBody: {self.model}\n"
                       "components:\n  - type: MultiValueSeq\n    content: JointPosition\n"
                       "    purpose: JointPosition\n    frameRate: 20\n    numFrames: 3\n"
                       f"    numParts: {self.n}\n    frames:\n" + 3 * f"      - [ {angles} ]\n")


def rates(kind, n):
    if n > 20:
        return RATES[kind][-1:]
    # Twenty DYNAMIXEL at 9600 bps are not yet refused where a short move is asked for: it takes seconds.
    return RATES[kind][1:] if kind == "dxl" and n == 20 else RATES[kind]


def own_file(kind, n, bps):
    family, servo, first = KINDS[kind]
    if family == "ics" and n > 32:
        return None  # a line of ICS has 32 ids
    path = os.path.join(folder, f"{kind}-{n}-{bps}bps.yaml")
    with open(path, "w") as file:
        file.write(f"name: {kind}-{n}-{bps}bps\nfamily: {family}\nline: {{baud: {bps}}}\njoints:\n")
        for i in range(n):
            file.write(f"  - {{name: part{i + 1}, id: {first + i}, servo: {servo}, limits_deg: [-50, 50]}}\n")
    return Robot(kind, n, path, bps)


# Commands: words, as functions of the robot; input on standard input, if any, and of a terminal
# the keys that end it, after the text that shows that it has begun.
def command(words, piped=None, keys=None, after=None, end=None):
    return {"words": words, "piped": piped, "keys": keys, "after": after, "end": end}


D = ["-d", "sim"]
COMMANDS = {
    "robot show": command(lambda r: ["robot", "show"]),
    "robot check": command(lambda r: ["robot", "check", r.word if "/" in r.word else built_in_file(r.name)]),
    "joints": command(lambda r: ["joints", r.last]),
    "budget": command(lambda r: ["budget"]),
    "check": command(lambda r: ["check", r.motion]),
    "show": command(lambda r: ["show", r.motion]),
    "plot": command(lambda r: ["plot", "-y", "-o", "motion.svg", r.motion]),
    "convert": command(lambda r: ["convert", "-y", r.motion, "copy.m"]),
    "dry-run": command(lambda r: [*D, "play", "--dry-run", r.motion]),
    "info": command(lambda r: [*D, "info"]),
    "scan": command(lambda r: [*D, "scan", "--first", str(max(r.id - 3, 0)), "--last", str(r.id)]),
    "doctor": command(lambda r: [*D, "doctor"]),
    "doctor refused": command(lambda r: ["-d", "tcp:127.0.0.1:1", "doctor"]),
    "status refused": command(lambda r: ["-d", "tcp:127.0.0.1:1", "status"]),
    "robot new": command(lambda r: [*D, "robot", "new", "--family", "rs30x" if r.wiring == "board" else r.family,
                                    "-o", "found.yaml"]),
    "status": command(lambda r: [*D, "status"]),
    "watch": command(lambda r: [*D, "status", "-w", "-i", "20", r.last], after=r"motor .*\n.*\n|\{.*\n",
                     end=signal.SIGINT),
    "monitor": command(lambda r: [*D, "monitor"], after=r"(?s)(?=.*replies)(?=.*>)|motor .*\n.*\n|\{.*\n",
                       keys=b"q", end=signal.SIGINT),
    "servo on": command(lambda r: [*D, "servo", "on"]),
    "servo off": command(lambda r: [*D, "servo", "off", r.last]),
    "servo brake": command(lambda r: [*D, "servo", "brake"]),
    "servo-get": command(lambda r: [*D, "servo-get", r.last]),
    "servo-get key": command(lambda r: [*D, "servo-get", str(r.id), "temperature"]),
    "servo-set id": command(lambda r: [*D, "-y", "servo-set", r.last, "id", str(r.id), "--flash"]),
    "servo-set none": command(lambda r: [*D, "-y", "servo-set", r.last, "nonesuch", "1"]),
    "init": command(lambda r: [*D, "init", "--time", "100"]),
    "move": command(lambda r: [*D, "move", r.last, f"{r.near:g}", "100"]),
    "move beyond": command(lambda r: [*D, "move", r.last, f"{r.beyond:g}", "100"]),
    "pose": command(lambda r: [*D, "pose", "--time", "100", f"{r.last}={r.near:g}"]),
    "pose all": command(lambda r: [*D, "pose", "--time", "100"] + [f"{j['init_deg']:g}" for j in sorted(r.joints, key=lambda j: j['motor'])]),
    "pose file": command(lambda r: [*D, "pose", "--time", "100", f"@{r.motion}:1"]),
    "play": command(lambda r: [*D, "play", r.motion]),
    "play table": command(lambda r: [*D, "play", "--table", "--reverse", "--speed", "200", r.motion]),
    "play mirror": command(lambda r: [*D, "play", "--mirror", r.motion]),
    "play greet": command(lambda r: [*D, "play", "motions/greet.pseq"]),
    "stop": command(lambda r: [*D, "stop"]),
    "estop": command(lambda r: [*D, "estop"]),
    "estop reset": command(lambda r: [*D, "estop", "--reset"]),
    "record": command(lambda r: [*D, "-y", "record", "--key", "-o", "kept.yaml"], piped=" s", keys=b" s",
                      after="space"),
    "record limp": command(lambda r: [*D, "-y", "record", "--limp", "--key", r.last], piped=" s", keys=b" s",
                           after="space"),
    "teach": command(lambda r: [*D, "-y", "teach", "-o", "taught.yaml"], piped=" s", keys=b" s", after="space"),
    "follow": command(lambda r: ["follow", "--for", "0.2", f"{r.word}@sim", f"{r.word}@sim"]),
    "slot": command(lambda r: [*D, "slot", "1"]),
    "scenario": command(lambda r: [*D, "scenario", "1"]),
    "calibrate": command(lambda r: [*D, "-y", "calibrate", "--dry-run"]),
    "setup": command(lambda r: [*D, "-y", "setup"]),
    "first-contact": command(lambda r: [*D, "-y", "first-contact", "-o", "first"]),
    "replay": command(lambda r: ["replay", trace_of(r)]),
    "decode": command(lambda r: ["decode", trace_of(r)]),
    "shell": command(lambda r: [*D, "shell"], piped="joints\nstatus\np\nC\nt 200\nq\n", keys=b"p\rq\r", after=">"),
}


def built_in_file(name):
    return os.path.abspath(f"src/robots/{name}.yaml")


def trace_of(robot):
    """What was on the wire when the robot was read and one joint moved."""
    with fork:
        path = os.path.join(robot.home, "session.pcapng")
        if not os.path.exists(path):
            subprocess.run([grctl, "--robot", robot.word, "-d", "sim", "--trace", path, "move", robot.last,
                            f"{robot.near:g}", "100"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return path


def limited(process):
    """One that does not end is killed: that is its status then."""
    timer = threading.Timer(LIMIT_S, process.kill)
    timer.start()
    return timer


class Cell:
    """A run of a command: `status`, and what it wrote as `out` and `err`; on a terminal all is `out`."""

    def __init__(self, name, robot, tty, as_json):
        self.name, self.robot, self.tty, self.json = name, robot, tty, as_json
        self.home = os.path.join(robot.home, re.sub(r"\W", "_", f"{name}-{tty}-{as_json}"))
        os.mkdir(self.home)

    def __str__(self):
        how = ("on a terminal" if self.tty else "piped") + (", --json" if self.json else "")
        return f"{self.name}, {self.robot.name}, {how}"

    def words(self):
        words = COMMANDS[self.name]["words"](self.robot)
        return [grctl, *(["--json"] if self.json else []), "--robot", self.robot.word, "--timeout", "500", *words]

    def run(self):
        for name in "motions", "docs":
            os.symlink(os.path.abspath(name), os.path.join(self.home, name))
        env = dict(environment, XDG_CONFIG_HOME=os.path.join(self.home, "config"),
                   XDG_STATE_HOME=os.path.join(self.home, "state"))
        begin = time.monotonic()
        if self.tty:
            self.run_on_terminal(env)
        else:
            self.run_piped(env)
        self.took_s = time.monotonic() - begin
        self.out, self.err = (ESCAPES.sub(b"", text).decode(errors="replace").replace("\r", "")
                              for text in (self.out, self.err))
        return self

    def run_piped(self, env):
        with fork:
            process = subprocess.Popen(self.words(), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, cwd=self.home, env=env)
        kind = COMMANDS[self.name]
        limit = limited(process)
        first = b""
        if kind["end"]:
            while not re.search(kind["after"].encode(), first) and (line := process.stdout.readline()):
                first += line
            process.send_signal(kind["end"])
        self.out, self.err = process.communicate((kind["piped"] or "").encode())
        self.out = first + self.out
        self.status = process.returncode
        limit.cancel()

    def run_on_terminal(self, env):
        kind = COMMANDS[self.name]
        with fork:
            fd, side = pty.openpty()
            os.set_inheritable(side, False)
            fcntl.ioctl(side, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
            process = subprocess.Popen(self.words(), stdin=side, stdout=side, stderr=side, cwd=self.home, env=env,
                                       start_new_session=True,
                                       preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
            os.close(side)
        limit = limited(process)
        text, sent = b"", False
        while True:
            try:
                more = os.read(fd, 65536)
            except OSError:  # the terminal's other side is closed
                more = b""
            if not more:
                break
            text += more
            after = kind["after"]
            if not sent and after and re.search(after.encode(), ESCAPES.sub(b"", text)):
                sent = True
                if kind["keys"] and not (self.json and kind["end"]):
                    os.write(fd, kind["keys"])
                else:
                    process.send_signal(kind["end"])
        self.status = process.wait()
        limit.cancel()
        os.close(fd)
        self.out, self.err = text, b""


def crashes_of(cell):
    """What no cell may write: a list."""
    text = cell.out + cell.err
    for word in ("Sanitizer", "runtime error", "Segmentation", "assertion", "(null)"):
        if word in text:
            yield f"says {word}"
    if re.search(r"(?<![\w.-])-?nan\b|\binf\b", text):
        yield "a number that is none"
    if cell.json and not cell.tty:
        lines = cell.out.splitlines()
        for line in lines:
            try:
                json.loads(line)
            except ValueError:
                yield f"no JSON: {line[:200]}"
                return
        if cell.err and cell.status > 1 and cell.status < 128 and not (lines and '"error"' in lines[-1]):
            yield "no error in JSON"


def is_own(robot, word):
    return (robot.name == "gr001" or any(word in name for name in robot.names)
            or word.startswith("RS30") and robot.family == "rs30x"
            or word == "SO-101" and robot.name.startswith("so101"))


def untruths_of(cell):
    """What is of another robot: a list. Refusals say such things with reason."""
    text = cell.out + cell.err
    for word in (word for word in OTHERS if not is_own(cell.robot, word)):
        line = next((line for line in text.splitlines() if word in line), None)
        if line:
            yield f"is of another robot: {line.strip()[:200]}"
    for count in re.findall(r"\b(\d+) joints\b", text):
        if int(count) > cell.robot.n:
            yield f"{count} joints, where there are {cell.robot.n}"


def complaint_of(cell):
    """The only line of complaint, or what doctor found; without one, or with several, an empty one."""
    if cell.name == "doctor refused":
        return cell.out
    lines = [line for line in (cell.out if cell.tty else cell.err).splitlines() if line.startswith("grctl: ")]
    return lines[0] if len(lines) == 1 else ""


class Refusal:
    def __init__(self, line):
        self.command, self.which, self.status, self.pattern, self.reason = line.split("\t")
        self.used = 0

    def fits(self, cell):
        robot = cell.robot
        if not re.fullmatch(self.command, cell.name) or cell.status != int(self.status):
            return False
        scope = {"kind": robot.kind, "n": robot.n, "bps": robot.bps, "name": robot.name, "family": robot.family,
                 "wiring": robot.wiring, "tty": cell.tty, "json": cell.json}
        return bool(eval(self.which or "True", {}, scope) and re.search(self.pattern, complaint_of(cell)))


def wrongs_of(cell, refusals):
    wrongs = list(crashes_of(cell))
    ended = 130 if COMMANDS[cell.name]["end"] else 0
    fitting = next((refusal for refusal in refusals if refusal.fits(cell)), None)
    if fitting:
        fitting.used += 1
        cell.refusal = fitting
        return wrongs
    wrongs += untruths_of(cell)
    if cell.status not in (0, ended):
        said = (cell.out[-300:] if cell.tty else cell.err[-400:]).strip()
        wrongs.append(f"status {cell.status}: {said}")
    return wrongs


def pairwise(robots):
    """Cells that have every pair; each command with each kind, and sizes and ways in turn."""
    groups = collections.defaultdict(list)
    for robot in robots:
        groups[robot.kind].append(robot)
    kinds = sorted(groups)
    for i, name in enumerate(COMMANDS):
        for k, kind in enumerate(kinds):
            yield name, groups[kind][(i + k + i // 3) % len(groups[kind])], *WAYS[(i + k + k // 4) % 4]


def everything(robots):
    for name, robot, way in itertools.product(COMMANDS, robots, WAYS):
        yield name, robot, *way


def main():
    with open(list_file) as file:
        refusals = [Refusal(line.rstrip("\n")) for line in file if line.strip() and not line.startswith("#")]
    robots = [Robot("built-in", entry["n_joints"], entry["name"]) for entry in ask("robot", "list")["robots"]]
    robots += [robot for kind in KINDS for n in sizes
               for bps in rates(kind, n) if (robot := own_file(kind, n, bps))]
    cells = [Cell(*which) for which in (everything if whole else pairwise)(robots)]
    assert whole or len(cells) <= MOST_CELLS, f"{len(cells)} cells"
    only = os.environ.get("MATRIX_ONLY")
    cells = [cell for cell in cells if not only or re.search(only, str(cell))]
    cells.sort(key=lambda cell: -cell.robot.n / (cell.robot.bps or 1e6))  # the slow ones first
    wrongs = collections.defaultdict(list)
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        for cell in pool.map(Cell.run, cells):
            for wrong in wrongs_of(cell, refusals):
                wrongs[cell.name].append(f"{cell}: {wrong}")
            shutil.rmtree(cell.home)
    for name in COMMANDS:
        print(f"not ok {name}: " + "; ".join(wrongs[name]) if wrongs[name] else f"ok {name}")
    for refusal in refusals:
        of_many = re.search(r"\bn > (2\d|[3-9]\d)", refusal.which)  # which only `all` has
        if not refusal.used and not only and (whole or not of_many):
            print(f"not ok list: no cell needs: {refusal.command} {refusal.pattern}")
            wrongs["list"].append(refusal.pattern)
    bad = sum(len(of_command) for of_command in wrongs.values())
    refused = sum(1 for cell in cells if hasattr(cell, "refusal"))
    slow = sorted(cells, key=lambda cell: -cell.took_s)[:5]
    print(f"# {len(cells)} cells, {refused} refused by {len(refusals)} reviewed lines; the slowest: "
          + ", ".join(f"{cell} {cell.took_s:.1f} s" for cell in slow))
    sys.exit(1 if bad else 0)


main()
