# SPDX-License-Identifier: MIT
"""Trips each assertion by a sabotage, so that none is there for nothing.

usage: asserts.py [option]...
  --rows FILE           the sabotages: three lines each, see there
  --of "FOLDER..."      whose assertions are looked at
  --sources "FILE..."   C sources of the library
  --tests "FILE..."     objects of test programs, each with its own main
  --compile, --link, --libs "WORD..."   as in run.py
  --work DIR            a folder for what is built; nothing else is written
  --only TEXT           sabotages whose head has this text
  --jobs N              how many at a time

The head of a sabotage may begin with the test that its assertion ends: that one goes first, and is
enough. Where it does not, all are tried, those that take long last, and the test is printed.

A sabotage passes where a test is ended by the very assertion that it names. The last line is: N
passed (assertions tripped), N failed (sabotages that do not trip theirs, wrong anchors), N skipped
(assertions without a sabotage, which are printed).
"""
import argparse
import concurrent.futures
import os
import re
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True
import mutate  # noqa: E402
import run  # noqa: E402

# Each test gets the first; then those that took longer, some of them, the second.
SHORT_S, LONG_S = 1, 20
LONG_MAX = 8
HANGS = ()
MACRO = re.compile(r"GROBO_ASSERT\(")
# Line and function are the compiler's; the text would be that of the macros behind it.
SAID = re.compile(r"([^\s:]+):(\d+): (\w+): Assertion ")


class Assertion:
    """GROBO_ASSERT(text) in a function; `lines` of its file."""

    def __init__(self, path, function, text, lines):
        self.path, self.function, self.text, self.lines = path, function, text, lines
        self.name = f"{function}: {text}"


def assertions_of(path, functions, clean):
    for function in functions:
        for found in MACRO.finditer(clean, function.start, function.end):
            depth, end = 1, found.end()
            while depth > 0:
                depth += {"(": 1, ")": -1}.get(clean[end], 0)
                end += 1
            first = clean.count("\n", 0, found.start()) + 1
            lines = range(first, first + clean.count("\n", found.start(), end) + 1)
            text = mutate.squeeze(clean[found.end():end - 1])
            yield Assertion(path, function.name, text, lines)


def find(assertions, function, text):
    wanted = mutate.squeeze(text)
    found = [a for a in assertions if a.function == function and wanted in a.text]
    exact = [a for a in found if a.text == wanted]
    found = exact or found
    if len(found) != 1:
        raise run.Problem(f"{len(found)} assertions, not one: {function}: {text}")
    return found[0]


class Trip(run.Bench):
    def __init__(self, options, work):
        options.choose = ".*"
        super().__init__(options, work)
        groups = {os.path.splitext(os.path.basename(t))[0]: os.path.dirname(t)
                  for t in options.tests.split()}
        self.near = {t for t in self.tests if groups[t].endswith(("link", "port"))}
        self.small = {t for t in self.tests if groups[t].endswith("unit")}
        self.hits_of = {}

    def tripped(self, program, test, env, cpu_s):
        """Path and line of the assertion that ended the test, None, or HANGS."""
        try:
            done = subprocess.run([program, test], env=env, cwd=self.options.root, check=False,
                                  preexec_fn=run.limit(cpu_s), timeout=20 * cpu_s,
                                  errors="replace", stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        except subprocess.TimeoutExpired:
            return HANGS
        if done.returncode == -signal.SIGXCPU:
            return HANGS
        found = SAID.findall(done.stderr)
        return (found[-1][0], int(found[-1][1])) if found else None

    def order(self, mutant, hint):
        """All tests that may reach it: what is known, what ended for others of its file, what is
        named like it, small ones."""
        in_link = mutant.path.startswith("src/link/")
        stem = os.path.splitext(os.path.basename(mutant.path))[0]
        return sorted((t for t in self.tests if (t in self.near) == in_link or t == hint),
                      key=lambda t: (t != hint, -self.hits_of.get((mutant.path, t), 0),
                                     stem not in t, t not in self.small))

    def first_of(self, program, mutant, assertion, tests):
        """The first test that ends by the assertion; what others ended by; those that took long."""
        env = dict(os.environ, CMOCKA_MESSAGE_OUTPUT="TAP")
        seen, late = set(), []
        for test, cpu_s in tests:
            at = self.tripped(program, test, env, cpu_s)
            if at is HANGS:
                late.append(test)
            elif at is not None:
                path = mutant.path if at[0] == "<stdin>" else at[0]
                if path == assertion.path and at[1] in assertion.lines:
                    self.hits_of[(mutant.path, test)] = self.hits_of.get((mutant.path, test), 0) + 1
                    return test, seen, late
                seen.add(f"{path}:{at[1]}")
        return None, seen, late

    def judge(self, mutant, assertion, hint):
        """The test that ends by the assertion, or what was seen instead."""
        obj = self.make(mutant)
        if obj is None:
            return None, "does not compile, or changes nothing"
        program = obj[:-2]
        try:
            self.link([obj], program)
            tests = [(t, LONG_S if t == hint else SHORT_S) for t in self.order(mutant, hint)]
            test, seen, late = self.first_of(program, mutant, assertion, tests)
            if test is None:
                again = [(t, LONG_S) for t in late[:LONG_MAX]]
                test, more, late = self.first_of(program, mutant, assertion, again)
                seen |= more
        finally:
            for path in (program, obj):
                if os.path.exists(path):
                    os.unlink(path)
        took_long = ", and some take long" if test is None and late else ""
        return test, None if test else "trips " + (", ".join(sorted(seen)) or "nothing") + took_long


def read(path, functions, assertions):
    """A head, its sabotage, its assertion, where an anchor is wrong the reason, the known test."""
    for number, head, old, new in run.read_blocks(path):
        match = re.fullmatch(r"(?:(test_\w+): )?(?:([\w/]+\.c):)?(\w+) trips (\w+): (.*)", head)
        try:
            if not match:
                raise run.Problem("not '[TEST: ]FUNCTION trips FUNCTION: ASSERTED'")
            hint, file, name, function, text = match.groups()
            named = [f for f in functions.get(name, [])
                     if file is None or f.path.endswith("/" + file)]
            if len(named) != 1:
                raise run.Problem(f"missing anchor: one function {name}")
            assertion = find(assertions, function, text)
            yield head, run.Named(named[0], old, new), assertion, None, hint
        except run.Problem as problem:
            yield head, None, None, f"{path}:{number}: {problem}", None


def run_asserts(options, work):
    begun_s = time.monotonic()
    trip = Trip(options, work)
    by_file, functions = trip.functions()
    assertions = [a for path, found in by_file.items() if path.startswith(tuple(options.of.split()))
                  for a in assertions_of(path, found, mutate.blank(trip.texts[path]))]
    rows = [r for r in read(options.rows, functions, assertions)
            if not options.only or options.only in r[0]]
    passed, failed = set(), 0

    def judge(row):
        return (None, row[3]) if row[3] else trip.judge(row[1], row[2], row[4])

    for row in rows:
        if row[1] is not None:
            trip.original(row[1].path)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for row, (test, problem) in zip(rows, pool.map(judge, rows)):
            if problem:
                failed += 1
                print(f"{row[0]}: {problem}", flush=True)
            else:
                passed.add(row[2].name)
                if options.only or os.environ.get("V") or test != row[4]:
                    print(f"{row[0]}: {test}", flush=True)
    left = [] if options.only else [a for a in assertions if a.name not in
                                    {r[2].name for r in rows if r[2]}]
    for assertion in left:
        print(f"no sabotage: {assertion.path}:{assertion.lines[0]}: {assertion.name}")
    print(f"{len(passed)} of {len(assertions)} assertions tripped, in "
          f"{time.monotonic() - begun_s:.0f} s")
    print(f"{len(passed)} passed, {failed} failed, {len(left)} skipped")
    return 0 if passed and not failed else 1


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in ("rows", "of", "sources", "tests", "libs", "compile", "link", "work"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--only")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    return run.in_work_folder(parser.parse_args(), run_asserts)


if __name__ == "__main__":
    sys.exit(main())
