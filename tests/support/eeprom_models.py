# SPDX-License-Identifier: MIT
"""What each servo model keeps over power-off is saved, changed and put back: eeprom_models.py GRCTL
FOLDER prints "ok FAMILY" or "not ok FAMILY" with the models that went wrong, and last how many
models and registers were tried. Every register that may be written gets another value, all in one
--restore; a second one puts them back, and all that is kept is as before."""
import concurrent.futures
import json
import os
import re
import subprocess
import sys

ID, BESIDE = 1, 9
# What decides how a servo is reached (by its flags a KRS is a slave, which is silent), and how its
# other values count.
LEFT = {"id", "baud", "protocol_type", "secondary_id", "operating_mode", "mode", "flags"}
BAUD = {"ics": "115200", "lx16a": "115200", "rs30x": "115200", "dynamixel1": "1000000",
        "dynamixel2": "1000000", "feetech": "1000000"}
grctl, folder = os.path.abspath(sys.argv[1]), sys.argv[2]


class Wrong(Exception):
    pass


def run(home, *words):
    done = subprocess.run([grctl, *words], capture_output=True, text=True, timeout=120,
                          env=dict(os.environ, XDG_STATE_HOME=home))
    if done.returncode:
        raise Wrong(f"{' '.join(words)}: status {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


class Model:
    """A simulated servo. One that cannot be a joint stands beside one that can, on a server."""

    def __init__(self, family, name, joint):
        self.family, self.name = family, name
        self.home = os.path.join(folder, name)
        os.mkdir(self.home)
        self.robot = os.path.join(self.home, "r.yaml")
        own = joint == name
        with open(self.robot, "w") as file:
            file.write(f"name: r\nfamily: {family}\njoints:\n  - {{name: p, id: {ID if own else BESIDE},"
                       f" servo: {joint}, limits_deg: [-50, 50]}}\n")
        self.servos = None if own else f"{BESIDE}={joint},{ID}={name}"

    def shell(self, *commands):
        """What is printed by commands on one fresh simulated robot."""
        script = os.path.join(self.home, "script")
        with open(script, "w") as file:
            file.write("\n".join(commands) + "\n")
        words = ["--robot", self.robot, "--json", "-y", "--timeout", "300", "-b", BAUD[self.family]]
        if not self.servos:
            return run(self.home, *words, "-d", "sim", "shell", script)
        with subprocess.Popen([grctl, "--json", "--robot", self.robot, "-b", BAUD[self.family], "sim",
                               "--servo", self.servos], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True) as sim:
            device = json.loads(sim.stdout.readline())["robots"][0]["device"]
            try:
                return run(self.home, *words, "-d", device, "shell", script)
            finally:
                sim.terminate()

    def registers(self, *commands):
        """All that it has, behind these commands."""
        lines = [json.loads(line) for line in self.shell(*commands, f"servo-get {ID}").splitlines()]
        return [line for line in lines if "registers" in line][-1]["registers"]

    def saved(self):
        found = os.path.join(self.home, "grctl", "eeprom")
        return [os.path.join(found, name) for name in sorted(os.listdir(found))]


def values(registers):
    return {one["name"]: one["value"] for one in registers if one["access"].startswith("kept")}


def tried(model):
    before = model.registers()
    other = {}
    for one in before:
        least, most = one["range"]
        if one["access"] == "kept rw" and one["name"] not in LEFT and most > least:
            other[one["name"]] = one["value"] - 1 if one["value"] > least else one["value"] + 1
    path = os.path.join(model.home, "other.json")
    with open(path, "w") as file:
        json.dump({"id": ID, "model": model.name, "registers": other}, file)
    changed = values(model.registers(f"servo-set {ID} --restore {path}"))
    expected = dict(values(before), **other)
    if changed != expected:
        raise Wrong(f"changed: {set(changed.items()) ^ set(expected.items())}")
    kept = model.saved()
    if len(kept) != 1:
        raise Wrong(f"saved: {kept}")
    with open(kept[0]) as file:
        if any(values(before)[name] != value for name, value in json.load(file)["registers"].items()):
            raise Wrong("what was saved is not what it kept")
    after = values(model.registers(f"servo-set {ID} --restore {path}",
                                   f"servo-set {ID} --restore {kept[0]}"))
    if after != values(before):
        raise Wrong(f"put back: {set(after.items()) ^ set(values(before).items())}")
    return len(other)


def result(model):
    try:
        return tried(model), None
    except (Wrong, subprocess.TimeoutExpired, KeyError, IndexError, ValueError, OSError) as why:
        return 0, f"{model.name}: {type(why).__name__}: {why}"


servos = json.loads(run(folder, "robot", "servos", "--json"))["servos"]
first = {one["family"]: one["model"] for one in reversed(servos) if one["joint"]}
models = [Model(one["family"], one["model"], one["model"] if one["joint"] else first[one["family"]])
          for one in servos]
with concurrent.futures.ThreadPoolExecutor(8) as pool:
    results = list(pool.map(result, models))
for family in first:
    wrong = [why for model, (_, why) in zip(models, results) if model.family == family and why]
    print(f"not ok {family}: {'; '.join(wrong)}" if wrong else f"ok {family}")
print(f"{len(models)} models, {sum(count for count, _ in results)} registers")
