# SPDX-License-Identifier: MIT
"""How well `grctl check --balance` foretells a fall: GR001 plays motions on a body of MuJoCo.

usage: balance.py GRCTL [--count N] [--seed N] [--table FILE] [MOTION...]

Each motion, and N variants by chance, starts from standing, is played by the library's engine in
virtual time, and holds for a second. A fall without a warning is a silent fall: the exit status is 1
then. The variants lean by ankles and hips, to all sides, fast and slowly, and come back.
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

from grobo import Description, Motion, errors
from grobo.physics import Body, Virtual

KINDS = ("lean", "hips", "rolls", "steps")
WARNINGS = ("zmp-margin", "no-support")


def mirrored(joint, angle):
    """The same on both sides."""
    return {f"R_{joint}": angle, f"L_{joint}": -angle}


def alike(joint, angle):
    return {f"R_{joint}": angle, f"L_{joint}": angle}


def variant(kind, chance, initial):
    """Key poses: times in seconds, and what differs from the initial posture in degrees."""
    def deg(most):
        return math.radians(chance.uniform(-most, most))

    if kind == "lean":
        away = mirrored("ANKLE_P", deg(18))
    elif kind == "hips":
        away = {**mirrored("HIP_P", deg(35)), "CHEST_P": math.radians(chance.uniform(-25, 0))}
    elif kind == "rolls":
        roll = deg(20)
        away = {**alike("ANKLE_R", roll), **alike("HIP_R", roll * chance.uniform(0, 1.2))}
    else:  # knees bend, one leg more than the other
        bend, other = (math.radians(chance.uniform(0, 30)) for _ in range(2))
        away = {"R_HIP_P": bend, "R_KNEE_P": -2 * bend, "R_ANKLE_P": -bend,
                "L_HIP_P": -other, "L_KNEE_P": 2 * other, "L_ANKLE_P": other}
    there = [a + away.get(name, 0) for name, a in initial.items()]
    here = list(initial.values())
    go, stay, back = chance.uniform(0.3, 1.5), chance.uniform(0, 1), chance.uniform(0.3, 1.5)
    times = [0, go, go + stay + 0.01, go + stay + back + 0.01]
    return times, [here, there, there, here]


def warned(grctl, path):
    """Whether the check warns of a fall."""
    done = subprocess.run([grctl, "--json", "check", "--balance", str(path)], capture_output=True,
                          text=True)
    report = json.loads(done.stdout)
    return any(word in json.dumps(report) for word in WARNINGS)


def fell(model, robot, path):
    """Whether it lies at the end; None: the engine refused the motion."""
    with Virtual(Body(model, robot)) as played:
        played.init()
        played.run(0.5)
        try:
            played.play(path)
        except errors.Error as refused:
            if not played.body.fallen:
                print(f"{path}: {refused}", file=sys.stderr)
                return None
        played.run(1)
        return played.body.fallen


def judge(grctl, model, robot, paths):
    counts = {(w, f): 0 for w in (False, True) for f in (False, True)}
    silent, refused = [], 0
    for path in paths:
        lies = fell(model, robot, path)
        if lies is None:
            refused += 1
            continue
        warns = warned(grctl, path)
        counts[warns, lies] += 1
        if lies and not warns:
            silent.append(path.name)
    return counts, silent, refused


def row(name, counts, refused):
    return (f"| {name} | {counts[False, False]} | {counts[True, True]} | {counts[True, False]} | "
            f"{counts[False, True]} | {refused} |")


def write_variants(folder, robot, seed, count):
    names = robot.joints
    body = robot.model
    initial = {name: float(body.joints[j].init_rad) for j, name in enumerate(names)}
    limits = robot.limits
    for kind in KINDS:
        chance = random.Random(f"{seed} {kind}")
        for n in range(count // len(KINDS)):
            times, rows = variant(kind, chance, initial)
            rows = [[min(max(a, limits[j][0]), limits[j][1]) for j, a in zip(names, r)] for r in rows]
            Motion.of(times, rows, kind="keys", robot=robot).save(folder / f"{kind}{n}.pseq")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("grctl")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--table")
    parser.add_argument("motions", nargs="*", type=Path)
    args = parser.parse_intermixed_args()
    robot = Description("gr001")
    lines = ["| motions | stands, no warning | falls, warned | stands, warned | falls, no warning | "
             "refused |", "|---|---|---|---|---|---|"]
    silent = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = folder / "gr001.xml"
        subprocess.run([args.grctl, "robot", "export", "gr001", "--mjcf", "-o", str(model)],
                       check=True)
        write_variants(folder, robot, args.seed, args.count)
        groups = [("of the tree", args.motions)]
        groups += [(f"{kind}, {args.count // len(KINDS)} variants", sorted(
            folder.glob(f"{kind}*.pseq"))) for kind in KINDS]
        for title, paths in groups:
            counts, unsaid, refused = judge(args.grctl, model, robot, paths)
            silent += unsaid
            lines.append(row(title, counts, refused))
            print(lines[-1], flush=True)
    if args.table:
        Path(args.table).write_text("\n".join(lines) + "\n")
    print(f"{len(silent)} silent falls{': ' if silent else ''}{' '.join(silent)}")
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())
