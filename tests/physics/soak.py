# SPDX-License-Identifier: MIT
"""GR001 plays its motions on a body that is pushed, and falls; its engine keeps the rules.

usage: soak.py GRCTL MOTION... [--minutes N] [--seed N]

In virtual time. Each episode begins upright, plays motions by chance, and is pushed at the waist or
at another link every few seconds, with 1 to 12 N for 50 to 300 ms; now and then a hand turns a joint.
Where the robot falls it goes on for 5 s, lying. What is judged, each 20 ms, is what the servos were
told, as the simulated servos have it:

  limits   a goal of a joint with torque lies within the joint's limits
  stopped  behind a stop of the engine (a trip), once its halt had 0.3 s, no goal moves
  error    a motion ends well, or the engine tripped

The exit status is 1 where a rule was broken.
"""

import argparse
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from grobo import Description, errors
from grobo.physics import Body, Virtual

LOOK = 0.02
LYING = 5.0
EPISODE = 60.0
HALTED = 0.3  # what a halt may take
MDEG = 180000 / 3.141592653589793
ROUNDED = 100  # of the wire's 0.1 degree


class Judge:
    """Looks at the servos' goals while a robot runs."""

    def __init__(self, robot):
        self.limits = [[angle * MDEG for angle in robot.limits[name]] for name in robot.joints]
        self.goals, self.looks, self.broken = [], 0, []
        self.tripped_at = None

    def look(self, made):
        goals = [view.target_mdeg if int(view.torque) == 1 else None for view in made.look()]
        if made.trips and self.tripped_at is None:
            self.tripped_at = made.now
        for j, goal in enumerate(goals):
            low, high = self.limits[j]
            if goal is not None and not low - ROUNDED <= goal <= high + ROUNDED:
                self.broken.append(f"{made.now:.2f} s: joint {j}: goal {goal} outside its limits")
            if (self.tripped_at is not None and made.now > self.tripped_at + HALTED
                    and goal not in (None, self.goals[j])):
                self.broken.append(f"{made.now:.2f} s: joint {j}: moves behind a stop")
        self.goals = goals
        self.looks += 1


class Episode:
    """One robot from standing to its end."""

    def __init__(self, model, robot, chance, judge, seed):
        self.body, self.chance, self.judge = Body(model, robot), chance, judge
        self.made = Virtual(self.body, seed=seed)
        self.links = [None] + [self.body.model.body(n).name for n in range(2, self.body.model.nbody)]
        self.next_push = self.next_look = 0.0
        self.fell_at, self.pushes, self.hand = None, 0, None
        self.body.on_step = self.step

    def step(self, body):
        now = self.made.now
        if now < self.next_look or not self.made._handle:
            return
        self.next_look = now + LOOK
        self.judge.look(self.made)
        if body.fallen and self.fell_at is None:
            self.fell_at = now
        if not body.held and now >= self.next_push:
            self.push(now)

    def push(self, now):
        if self.next_push > 0:
            direction = [self.chance.gauss(0, 1) for _ in range(3)]
            length = sum(d * d for d in direction) ** 0.5
            force = self.chance.uniform(1, 12)
            self.body.push([force * d / length for d in direction], self.chance.uniform(0.05, 0.3),
                           self.chance.choice(self.links))
            self.pushes += 1
            if self.hand:
                self.made.hand(self.hand, 0)
                self.hand = None
            elif self.chance.random() < 0.2:
                self.hand = self.chance.choice(self.body.robot.joints)
                self.made.hand(self.hand, self.chance.uniform(-0.3, 0.3))
        self.next_push = now + self.chance.uniform(1, 6)

    def over(self):
        lies = self.fell_at is not None and self.made.now > self.fell_at + LYING
        return lies or self.made.trips or self.made.now > EPISODE

    def run(self, motions):
        with self.made:
            self.made.init()
            while not self.over():
                try:
                    self.made.play(self.chance.choice(motions))
                except errors.Error as error:
                    if not self.made.trips:
                        self.judge.broken.append(f"{self.made.now:.2f} s: {error}")
                        break
                self.made.run(self.chance.uniform(0.1, 1))
            self.made.run(1)
            return self.made.now


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("grctl")
    parser.add_argument("motions", nargs="+", type=Path)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_intermixed_args()
    robot, chance = Description("gr001"), random.Random(args.seed)
    counts, broken, looks, total, begun = Counter(), 0, 0, 0.0, time.process_time()
    with tempfile.TemporaryDirectory() as name:
        model = Path(name) / "gr001.xml"
        subprocess.run([args.grctl, "robot", "export", "gr001", "--mjcf", "-o", str(model)],
                       check=True)
        while total < args.minutes * 60:
            judge = Judge(robot)
            episode = Episode(model, robot, chance, judge, counts["episodes"])
            total += episode.run(args.motions)
            counts["episodes"] += 1
            counts["pushes"] += episode.pushes
            counts["falls"] += episode.fell_at is not None
            for trip in episode.made.trips:
                counts[f"stops: {trip}"] += 1
            looks += judge.looks
            broken += len(judge.broken)
            for line in judge.broken[:5]:
                print(f"episode {counts['episodes']}, {line}", flush=True)
    print(f"{total:.0f} s, {looks} looks: " + ", ".join(f"{n} {what}" for what, n in counts.items()))
    print(f"{broken} broke a rule; {time.process_time() - begun:.0f} s of CPU")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
