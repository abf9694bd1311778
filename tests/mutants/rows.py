# SPDX-License-Identifier: MIT
"""Sabotages the function of each row of docs/seed-map.md and expects the row's test to fail.

usage: rows.py [option]...
  --map FILE            docs/seed-map.md
  --rows FILE           blocks of three lines: `ROW FUNCTION`, `- old text`, `+ new text`
  --sources "FILE..."   C sources in which the functions are looked for
  --objects DIR         DIR/unit/test_x.o is the object of the test program unit/test_x.c
  --libs "WORD..."      what a test is linked with, the library last
  --compile "WORD..."   compiler and flags
  --link "WORD..."      compiler and flags to link with
  --work DIR            a folder for what is built; nothing else is written
  --seed N --count N    how many rows, chosen by chance (0: all of them)
  --only "ROW..."       these rows alone
  --jobs N              how many at a time

A row is killed when one of its tests fails by an assertion of a test source. A crash, a time-out
and an assertion of the library do not count. The sabotaged function must be one of the row's symbols
where one of them is a function, and must not return an error instead of its result. A test must pass
when nothing is sabotaged. The last line is: N passed (killed), N failed, N skipped (a test that
cannot run here). A row without a sabotage has failed. Exit status 0 if none failed.
"""
import argparse
import concurrent.futures
import os
import random
import re
import shlex
import subprocess
import sys
import threading
import time

sys.dont_write_bytecode = True
import run  # noqa: E402

TEST_LIMIT_S = 30


class Row:
    """A row of the map: the symbols and the tests that it names."""

    def __init__(self, cells):
        self.id, self.member = cells[0], cells[1]
        self.symbols = re.findall(r"`([^`]+)`", cells[2])
        self.tests = [t for t in re.findall(r"`([^`]+)`", cells[4])
                      if re.match(r"(unit|engine|link|port)/\w+\.c:", t)]


def read_map(path):
    rows = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            if re.match(r"\| *[A-Z]{2}\d\d *\|", line):
                row = Row([cell.strip() for cell in line.strip().strip("|").split("|")])
                rows[row.id] = row
    return rows


class Sabotage:
    """A sabotage of a row's function, or `problem`: why it is none."""

    def __init__(self, row, name, texts, functions):
        old, new = texts
        self.row, self.mutant, self.problem = row, None, None
        named = [s for s in row.symbols if s in functions]
        if len(functions.get(name, [])) != 1:
            self.problem = f"missing anchor: one function {name}"
        elif named and name not in named:
            self.problem = f"{name} is none of the row's functions: {', '.join(named)}"
        elif new.count("GROBO_ERR_") > old.count("GROBO_ERR_"):
            self.problem = f"{name}: an error instead of a result is no sabotage"
        else:
            try:
                self.mutant = run.Named(functions[name][0], old, new)
                self.mutant.id = f"{row.id}-{self.mutant.id}"
            except run.Problem as problem:
                self.problem = f"missing anchor: {problem}"


def read_rows(path, rows, functions):
    found = []
    for number, head, old, new in run.read_blocks(path):
        words = head.split()
        if len(words) != 2 or words[0] not in rows:
            raise run.Problem(f"{path}:{number}: not a row of the map and a function: {head}")
        found.append(Sabotage(rows[words[0]], words[1], (old, new), functions))
    return found


class Trial(run.Builder):
    """Builds and runs one test function of one test program."""

    def __init__(self, options, work):
        super().__init__(options, work)
        self.originals, self.lock = {}, threading.Lock()

    def link(self, test, objects, out):
        source = test.split(":")[0]
        program = os.path.join(self.options.objects, source[:-2] + ".o")
        self.call(shlex.split(self.options.link) + ["-o", out, program] + objects +
                  shlex.split(self.options.libs))

    def run(self, program, test):
        """'passed', 'skipped', 'asserted', or what else happened."""
        name = test.split(":")[1]
        env = dict(os.environ, CMOCKA_MESSAGE_OUTPUT="TAP")
        try:
            done = subprocess.run([program, name], env=env, cwd=self.options.root, check=False, text=True,
                                  preexec_fn=run.limit(TEST_LIMIT_S), timeout=2 * TEST_LIMIT_S,
                                  errors="replace", stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        except subprocess.TimeoutExpired:
            return f"no end within {2 * TEST_LIMIT_S} s"
        if done.returncode < 0:
            return f"killed by signal {-done.returncode}"
        # A test may be run with several fixtures or rows: a result for each.
        results = re.findall(rf"^(ok|not ok) \d+ (?:- |# SKIP ){name}(?:[,:] .*)?$", done.stdout, re.M)
        if "# SKIP" in done.stdout:
            return "skipped"
        if done.returncode == 0 and results and "not ok" not in results:
            return "passed"
        if "exception" in done.stdout:
            return "crashed"
        if re.search(r"tests/\S+:\d+: error: Failure!", done.stdout):
            return "asserted"
        return "failed without an assertion" if results else "did not run"

    def unharmed(self, test):
        """What the test does when nothing is sabotaged; a busy machine gets a second chance."""
        with self.lock:
            if test not in self.originals:
                source = test.split(":")[0]
                program = os.path.join(self.work, source.replace("/", "-")[:-2])
                if not os.path.exists(program):
                    self.link(test, [], program)
                said = self.run(program, test)
                self.originals[test] = said if said == "passed" else self.run(program, test)
            return self.originals[test]

    def judge(self, sabotage):
        """'killed', 'skipped', or why it is a failure."""
        if sabotage.problem:
            return sabotage.problem
        said = []
        for test in sabotage.row.tests:
            before = self.unharmed(test)
            if before != "passed":
                said.append(f"{test}: {before} though nothing is sabotaged")
        if any("skipped" not in text for text in said):
            return "; ".join(said)
        if len(said) == len(sabotage.row.tests):
            return "skipped"
        obj = self.make(sabotage.mutant)
        if obj is None:
            return "does not compile, or changes nothing"
        try:
            return self.try_all(sabotage, obj)
        finally:
            os.unlink(obj)

    def try_all(self, sabotage, obj):
        program, said = obj[:-2], []
        for test in sabotage.row.tests:
            if self.originals[test] != "passed":
                continue
            self.link(test, [obj], program)
            said.append(f"{test} {self.run(program, test)}")
            os.unlink(program)
            if said[-1].endswith(" asserted"):
                return "killed"
        return "survives: " + "; ".join(said)


def choose(options, sabotages):
    names = sorted({s.row.id for s in sabotages})
    if options.only:
        names = options.only.split()
        for name in names:
            if name not in {s.row.id for s in sabotages}:
                raise run.Problem(f"no sabotage of a row {name}")
    elif options.count > 0:
        names = random.Random(options.seed).sample(names, min(options.count, len(names)))
        print(f"{len(names)} rows, seed {options.seed}")
    return [s for s in sabotages if s.row.id in names]


def run_rows(options, work):
    begun_s = time.monotonic()
    trial = Trial(options, work)
    _, functions = trial.functions()
    rows = read_map(options.map)
    sabotages = read_rows(options.rows, rows, functions)
    missing = [] if options.only else sorted(set(rows) - {s.row.id for s in sabotages})
    chosen = choose(options, sabotages)
    failed, skipped = set(), set()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for sabotage, said in zip(chosen, pool.map(trial.judge, chosen)):
            if said == "killed":
                continue
            (skipped if said == "skipped" else failed).add(sabotage.row.id)
            anchor = sabotage.mutant.anchor if sabotage.mutant else sabotage.row.member
            print(f"{sabotage.row.id}: {said}: {anchor}", flush=True)
    killed = {s.row.id for s in chosen} - failed - skipped
    if missing:
        print(f"{len(missing)} rows have no sabotage: {' '.join(missing)}")
        failed.update(missing)
    print(f"{len(killed)} of {len({s.row.id for s in chosen})} rows killed, {len(rows)} in the map, in "
          f"{time.monotonic() - begun_s:.0f} s")
    print(f"{len(killed)} passed, {len(failed)} failed, {len(skipped - failed)} skipped")
    return 0 if killed and not failed else 1


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in ("map", "rows", "sources", "objects", "libs", "compile", "link", "work"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--only")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    return run.in_work_folder(parser.parse_args(), run_rows)


if __name__ == "__main__":
    sys.exit(main())
