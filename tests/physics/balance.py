# SPDX-License-Identifier: MIT
"""How well `grctl check --balance` foretells a fall: GR001 plays motions on a body of MuJoCo.

usage: balance.py GRCTL [--count N] [--seed N] [--table FILE] [MOTION...]

Each motion, and N variants by chance, starts from standing, is played by the library's engine in
virtual time, and holds for a second. A fall without a warning is a silent fall. The exit status is 1
where there is one, or where more than 30 % of the motions that were warned of stand.

The variants: lean (ankles), hips (and chest), rolls (to the sides) and knees (one leg bends more) go
there and come back, fast or slowly, by angles alone. Speeds are motions of the tree played faster or
slower. Steps are step.pseq with another time, sway, height and place of the foot, by targets of waist
and feet.
"""

import argparse
import json
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from grobo import Description, Motion, errors
from grobo.physics import Body, Virtual

KINDS = ("lean", "hips", "rolls", "knees")
EDITED = ("speeds", "steps")
WARNINGS = ("zmp-margin", "no-support", "fall")
STANDS_MOST = 0.3  # of those that were warned of
TRANSLATION = re.compile(r"(name: (\w+)\s+index: \d+\s+(?:is\w+: \w+\s+)*translation: )\[([^]]*)\]")
TIME = re.compile(r"((?:time|maxTransitionTime): )([\d.]+)")


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
        away = mirrored("ANKLE_P", deg(28))
    elif kind == "hips":
        away = {**mirrored("HIP_P", deg(50)), "CHEST_P": math.radians(chance.uniform(-30, 0))}
    elif kind == "rolls":
        roll = deg(35)
        away = {**alike("ANKLE_R", roll), **alike("HIP_R", roll * chance.uniform(0, 1.2))}
    else:  # knees bend, one leg more than the other
        bend, other = (math.radians(chance.uniform(0, 40)) for _ in range(2))
        away = {"R_HIP_P": bend, "R_KNEE_P": -2 * bend, "R_ANKLE_P": -bend,
                "L_HIP_P": -other, "L_KNEE_P": 2 * other, "L_ANKLE_P": other}
    there = [a + away.get(name, 0) for name, a in initial.items()]
    here = list(initial.values())
    go, stay, back = chance.uniform(0.3, 1.5), chance.uniform(0, 1), chance.uniform(0.3, 1.5)
    times = [0, go, go + stay + 0.01, go + stay + back + 0.01]
    return times, [here, there, there, here]


def warned(grctl, path):
    """Whether the check warns of a fall: not by a ZMP that stays inside the soles."""
    done = subprocess.run([grctl, "--json", "check", "--balance", str(path)], capture_output=True,
                          text=True)
    return any(one["code"] in WARNINGS and "inside" not in one["message"]
               for one in json.loads(done.stdout)["diagnostics"])


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


def faster(text, factor):
    return TIME.sub(lambda at: f"{at[1]}{float(at[2]) / factor:.4f}", text)


def other_steps(text, chance):
    """step.pseq with another sway of the waist, and feet that go elsewhere."""
    sway, lift, stride = chance.uniform(0.3, 1.5), chance.uniform(0.5, 2), chance.uniform(-.02, .02)
    waist = chance.uniform(-0.012, 0.004)

    def place(at):
        x, y, z = (float(number) for number in at[3].split(","))
        if at[2] == "WAIST":
            y, z = y * sway, z + waist
        elif z > 0.0212:
            x, z = x + stride, 0.02115 + (z - 0.02115) * lift
        return f"{at[1]}[ {x:.5f}, {y:.5f}, {z:.5f} ]"

    return faster(TRANSLATION.sub(place, text), chance.uniform(0.6, 2.2))


def write_edited(folder, motions, seed, count):
    """The motions of the tree at other speeds, and other steps."""
    chance = random.Random(f"{seed} edited")
    step = next(path for path in motions if path.name == "step.pseq").read_text()
    for n in range(count):
        of = chance.choice(motions).read_text()
        (folder / f"speeds{n}.pseq").write_text(faster(of, chance.uniform(0.5, 3)))
        (folder / f"steps{n}.pseq").write_text(other_steps(step, chance))


def write_variants(folder, robot, seed, count):
    names = robot.joints
    body = robot.model
    initial = {name: float(body.joints[j].init_rad) for j, name in enumerate(names)}
    limits = robot.limits
    for kind in KINDS:
        chance = random.Random(f"{seed} {kind}")
        for n in range(count):
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
    silent, all_refused = [], 0
    all_counts = {(w, f): 0 for w in (False, True) for f in (False, True)}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = folder / "gr001.xml"
        subprocess.run([args.grctl, "robot", "export", "gr001", "--mjcf", "-o", str(model)],
                       check=True)
        each = args.count // len(KINDS + EDITED)
        write_variants(folder, robot, args.seed, each)
        write_edited(folder, args.motions, args.seed, each)
        groups = [("of the tree", args.motions)]
        groups += [(f"{kind}, {each} variants", sorted(folder.glob(f"{kind}*.pseq")))
                   for kind in KINDS + EDITED]
        for title, paths in groups:
            counts, unsaid, refused = judge(args.grctl, model, robot, paths)
            silent += unsaid
            all_counts = {key: all_counts[key] + n for key, n in counts.items()}
            all_refused += refused
            lines.append(row(title, counts, refused))
            print(lines[-1], flush=True)
    lines.append(row("all", all_counts, all_refused))
    print(lines[-1])
    if args.table:
        Path(args.table).write_text("\n".join(lines) + "\n")
    print(f"{len(silent)} silent falls{': ' if silent else ''}{' '.join(silent)}")
    stood, warnings = all_counts[True, False], all_counts[True, False] + all_counts[True, True]
    print(f"{stood} of {warnings} that were warned of stand")
    return 1 if silent or stood > STANDS_MOST * warnings else 0


if __name__ == "__main__":
    sys.exit(main())
