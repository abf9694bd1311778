# SPDX-License-Identifier: MIT
"""Sabotages functions one by one and looks whether a test notices.

usage: run.py [option]...
  --sources "FILE..."   C sources in which the functions of the scope are looked for
  --tests "FILE..."     objects of test programs, each with its own main
  --libs "WORD..."      what they are linked with, the library last; a sabotaged object goes before it
  --compile "WORD..."   compiler and flags
  --link "WORD..."      compiler and flags to link with
  --scope FILE          patterns of function names: `unit PATTERN`, `function PATTERN`; default all
  --survivors FILE      mutants that no test can notice, each with its reason
  --named FILE          sabotages that are always tried
  --work DIR            a folder for what is built; nothing else is written
  --seed N --count N    which mutants, and how many that compile (0: all of them)
  --choose PATTERN      tests to run; default all
  --only ID[,ID...]     these mutants alone; `named`: all by hand
  --jobs N              how many at a time
  --cap-s N             give a mutant up after tests of N seconds of a processor, and try none of
                        the survivors (0: after all tests, also these)

Compiled into the same object as the original is no mutant; like one that does not compile it does
not count. Of the tests those run that reach the sabotaged line (reach.py), the quick ones first.
Noticed is what fails a test, crashes (what looks past the end of an array does), or
takes five times the processor time of the original. The last line is: N passed (noticed), N failed
(not noticed, or wrong anchors), N skipped (not noticed, with a reason in the file of survivors).
Exit status 0 if none failed and 95 % of all were noticed.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
import mutate  # noqa: E402
import reach  # noqa: E402

WANTED_PCT = 95
MEMORY_BYTES = 2 << 30
QUIET = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}

# What a file of tests has in common with others, and the program of all of them: it runs the tests
# of the file that its first argument names, or the one that the second names (tests/support/test.h).
# "--list" prints both of each; a file with a main of its own runs as a whole.
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
REGISTERS = ("main", "test_i_add", "test_i_around")
MAIN_BEGINS = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include "tests/support/test.h"
#define REGISTER(name) \\
    int main_of_##name(int argc, char **argv) __attribute__((weak)); \\
    test_fixture test_i_around_of_##name; \\
    static test_i_entry *tests_of_##name; \\
    void test_i_add_of_##name(test_i_entry *test) \\
    { \\
        test->next = tests_of_##name; \\
        tests_of_##name = test; \\
    }
"""
MAIN_ENDS = """
static const struct {
    const char *name;
    test_i_entry **tests;
    const test_fixture *around;
    int (*own_main)(int argc, char **argv);
} files[] = {
%s};
static void list(void)
{
    for (unsigned i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (files[i].own_main != NULL) {
            printf("%%s\\n", files[i].name);
            continue;
        }
        for (const test_i_entry *test = *files[i].tests; test != NULL; test = test->next) {
            printf("%%s %%s\\n", files[i].name, test->name);
        }
    }
}
/* Limits are set here, since Python begins a process much quicker where it has none to set. */
static void limit(void)
{
    const char *text = getenv("GROBO_CPU_S");
    if (text == NULL) {
        return; /* whoever began it has set them */
    }
    const rlim_t cpu_s = strtoul(text, NULL, 10);
    const struct rlimit cpu = {cpu_s, cpu_s + 1}, core = {0, 0};
    const struct rlimit bytes = {(rlim_t)MEMORY_BYTES, (rlim_t)MEMORY_BYTES};
    (void)setrlimit(RLIMIT_CPU, &cpu);
    (void)setrlimit(RLIMIT_CORE, &core);
    (void)setrlimit(RLIMIT_AS, &bytes);
}
int main(int argc, char **argv)
{
    limit();
    if (argc == 2 && strcmp(argv[1], "--list") == 0) {
        list();
        return 0;
    }
    for (unsigned i = 0; argc >= 2 && i < sizeof files / sizeof files[0]; i++) {
        if (strcmp(argv[1], files[i].name) == 0) {
            for (test_i_entry *test = *files[i].tests, *next; test != NULL; test = next) {
                next = test->next;
                if (argc == 2 || strcmp(argv[2], test->name) == 0) {
                    test_i_add(test);
                }
            }
            test_i_around = *files[i].around;
            return (files[i].own_main != NULL ? files[i].own_main : test_main)(1, argv) != 0;
        }
    }
    return 0;
}
"""


class Problem(Exception):
    """What ends the run: said in one line."""


# ---- the files beside this one -------------------------------------------------------------------

def lines_of(path):
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            if line.strip() and not line.startswith("#"):
                yield number, line.rstrip("\n")


def read_survivors(path):
    """Anchor -> reason. A reason is indented and stands below the anchors that it is for."""
    reasons, open_anchors, closed = {}, [], False
    for number, line in lines_of(path):
        if line[0] == " ":
            if not open_anchors:
                raise Problem(f"{path}:{number}: reason without a mutant")
            for anchor in open_anchors:
                reasons[anchor] = (reasons.get(anchor, "") + " " + line.strip()).strip()
            closed = True
        else:
            open_anchors = [] if closed else open_anchors
            closed = False
            open_anchors.append(line.strip())
            if line.strip() in reasons:
                raise Problem(f"{path}:{number}: the same mutant twice")
    missing = [a for a in open_anchors if not reasons.get(a)]
    if missing:
        raise Problem(f"{path}: no reason: {missing[0]}")
    return reasons


class Named(mutate.Mutant):
    """A sabotage written by hand: other text in one function."""

    def __init__(self, function, old, new):
        pattern = r"\s+".join(re.escape(word) for word in old.split())
        found = list(re.finditer(pattern, function.clean[function.start:function.end]))
        if len(found) != 1:
            raise Problem(f"{function.name}: found {len(found)} times, not once: {old}")
        span = (function.start + found[0].start(), function.start + found[0].end())
        super().__init__(function, "named", function.path, span, new)


def read_blocks(path):
    """Line number, head, old and new text of blocks of three lines: head, `- old`, `+ new`."""
    lines = list(lines_of(path))
    if len(lines) % 3 != 0:
        raise Problem(f"{path}: not in blocks of three lines")
    for i in range(0, len(lines), 3):
        (number, head), (_, old), (_, new) = lines[i:i + 3]
        if old[:2] != "- " or new[:1] != "+":
            raise Problem(f"{path}:{number}: not a head, '- old' and '+ new'")
        yield number, head, old[2:], new[2:]


def read_named(path, functions):
    """Sabotages written by hand; the head of a block is a function."""
    for number, name, old, new in read_blocks(path):
        if len(functions.get(name, [])) != 1:
            raise Problem(f"{path}:{number}: missing anchor: one function {name}")
        yield Named(functions[name][0], old, new)


def read_scope(path, by_file):
    """The functions that are sabotaged. Each pattern must name one at least."""
    chosen = set()
    for number, line in lines_of(path):
        kind, pattern = line.split()
        found = [f for functions in by_file.values() for f in functions
                 if re.fullmatch(pattern, f.name)]
        if kind not in ("unit", "function") or not found:
            raise Problem(f"{path}:{number}: missing anchor: {kind} {pattern}")
        for function in found:
            chosen.update(by_file[function.path] if kind == "unit" else [function])
    return chosen


# ---- building and running ------------------------------------------------------------------------

def limit(cpu_s):
    def apply():
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    return apply


class Builder:
    """Compiles sabotaged files."""

    def __init__(self, options, work):
        self.options, self.work = options, work
        self.texts, self.plain = {}, {}
        self.flags = ["-w", "-fwrapv"]
        more = ["-ftrivial-auto-var-init=zero"]
        if self.compile(".", "", os.path.join(work, "try.o"), more):
            self.flags += more  # what is not set is the same each time

    def functions(self):
        """The functions of the sources, by file and by name."""
        by_file, by_name = {}, {}
        for path in self.options.sources.split():
            with open(path, encoding="utf-8") as file:
                self.texts[path] = file.read()
            by_file[path] = mutate.functions_of(self.texts[path])
            for function in by_file[path]:
                function.path = path
                by_name.setdefault(function.name, []).append(function)
        return by_file, by_name

    @staticmethod
    def call(command, text=None):
        done = subprocess.run(command, input=text, text=True, capture_output=True, check=False)
        if done.returncode != 0:
            raise Problem(f"{command[0]} failed: {done.stderr.strip()[:2000]}")

    def compile(self, path, text, out, more=()):
        """True if it compiles. It comes by a pipe, so that no path is in the object."""
        command = shlex.split(self.options.compile) + self.flags + list(more) + [
            "-iquote", os.path.dirname(path), "-x", "c", "-", "-c", "-o", out]
        done = subprocess.run(command, input=text, text=True, check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return done.returncode == 0

    def original(self, path):
        """The bytes of the object that was not sabotaged."""
        if path not in self.plain:
            out = os.path.join(self.work, "plain.o")
            if not self.compile(path, self.texts[path], out):
                raise Problem(f"{path} does not compile")
            with open(out, "rb") as file:
                self.plain[path] = file.read()
        return self.plain[path]

    def make(self, mutant):
        """The object of a mutant, or None where it does not count."""
        out = os.path.join(self.work, f"{mutant.id}-{mutant.start}.o")
        if not self.compile(mutant.path, mutant.apply(self.texts[mutant.path]), out):
            return None
        with open(out, "rb") as file:
            same = file.read() == self.original(mutant.path)
        if same:
            os.unlink(out)
        return None if same else out


class Bench(Builder):
    """Compiles one file, links it with all tests into one program, runs the tests in it."""

    def __init__(self, options, work):
        super().__init__(options, work)
        more = ["-fsanitize=bounds,shift", "-fsanitize-undefined-trap-on-error"]
        if self.compile(".", "", os.path.join(work, "try.o"), more):
            self.flags += more  # what looks past the end of an array crashes
        self.killers_path = os.path.join(options.work, "killers.json")
        self.tests, self.killers, self.hits = [], self._killers(), {}
        self.main = os.path.join(work, "main.o")
        self.linker = self._linker()
        self.objects = self._tests_of(options.tests.split())

    def _killers(self):
        """Anchor -> the test that noticed it in an earlier run: only a hint which goes first."""
        try:
            with open(self.killers_path, encoding="utf-8") as file:
                return dict(json.load(file))
        except (OSError, ValueError):
            return {}

    def _linker(self):
        """gold where there is one: it links these objects twenty times as quickly."""
        out = os.path.join(self.work, "try")
        self.compile(".", "int main(void) { return 0; }", out + ".o")
        command = shlex.split(self.options.link) + ["-fuse-ld=gold", "-o", out, out + ".o"]
        done = subprocess.run(command, check=False, **QUIET)
        return ["-fuse-ld=gold"] if done.returncode == 0 else []

    def keep_killers(self):
        with open(self.killers_path, "w", encoding="utf-8") as file:
            json.dump(self.killers, file, indent=0)

    def _tests_of(self, objects):
        """Copies of the tests whose registers and mains have names of their own, and a main that
        runs the tests of one."""
        names, copies = [], []
        for path in objects:
            name = os.path.splitext(os.path.basename(path))[0]
            if not re.fullmatch(self.options.choose, name):
                continue
            copy = os.path.join(self.work, name + ".test.o")
            own = [f"--redefine-sym={symbol}={symbol}_of_{name}" for symbol in REGISTERS]
            self.call(["objcopy", *own, path, copy])
            names.append(name)
            copies.append(copy)
        rows = "".join(f'    {{"{n}", &tests_of_{n}, &test_i_around_of_{n}, main_of_{n}}},\n'
                       for n in names)
        source = f"#define MEMORY_BYTES {MEMORY_BYTES}LL\n" + MAIN_BEGINS + "".join(f"REGISTER({n})\n" for n in names) + MAIN_ENDS % rows
        self.call(shlex.split(self.options.compile) + ["-w", "-iquote", TOP, "-x", "c", "-", "-c",
                                                       "-o", self.main], source)
        self.tests = names
        return copies

    def link(self, objects, out):
        self.call(shlex.split(self.options.link) + self.linker + ["-o", out, self.main] +
                  self.objects + objects + shlex.split(self.options.libs))

    def run(self, program, test, cpu_s, marks=None):
        """True if the test passes, and the seconds of a processor that it took."""
        env = dict(os.environ, CMOCKA_TEST_ABORT="1", CMOCKA_MESSAGE_OUTPUT="TAP",
                   GROBO_CPU_S=str(cpu_s))
        if marks is not None:
            env["GROBO_REACH"] = marks
        process = subprocess.Popen([program, *test.split()], env=env, cwd=self.options.root,
                                   **QUIET)
        timer = threading.Timer(20 * cpu_s + 60, process.kill)
        timer.start()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        timer.cancel()
        return process.returncode == 0, used.ru_utime + used.ru_stime

    def recorder(self, mutants):
        """The objects that mark what is reached of the files of these mutants; none where the
        compiler cannot."""
        objects = [os.path.join(self.work, f"reach{i}.o") for i in range(1 + len(self.texts))]
        if not self.compile(".", reach.RECORDER, objects[0]):
            return []
        paths = sorted({m.path for m in mutants})
        for path, out in zip(paths, objects[1:]):
            if not self.compile(path, f'#line 1 "{path}"\n' + self.texts[path], out, reach.FLAGS):
                return []
        return objects[:1 + len(paths)]

    def measure(self, pool, mutants):
        """How long each test takes when nothing is sabotaged, by its name behind that of its file;
        and what they reach of the files of these mutants, None if that cannot be had."""
        program = os.path.join(self.work, "original")
        recorder = self.recorder(mutants)
        self.link(recorder, program)
        listed = subprocess.run([program, "--list"], text=True, capture_output=True, check=True)
        tests = sorted(set(listed.stdout.splitlines()))

        def one(test):
            path = os.path.join(self.work, test.replace(" ", "."))
            passed, took_s = self.run(program, test, 300, path)
            marks = reach.marks_of(path) if recorder else []
            return (took_s, marks) if passed else None

        measured = dict(zip(tests, pool.map(one, tests)))
        # What judges other tests of its file runs with them.
        for whole in sorted({t.split()[0] for t, result in measured.items() if result is None}):
            measured[whole] = one(whole)
            if measured[whole] is None:
                raise Problem(f"{whole} fails though nothing is sabotaged")
        measured = {test: result for test, result in measured.items() if result is not None}
        times = {test: took_s for test, (took_s, _) in measured.items()}
        if not recorder:
            return times, None
        return times, reach.Reach(program, {test: marks for test, (_, marks) in measured.items()})

    def order(self, mutant, times, reached):
        """The tests that may notice it: first what noticed it before, then what noticed others of
        its function and of its file, and what is quick."""
        hits = self.hits.setdefault(mutant.path, {})
        near = [t for a, t in list(self.killers.items()) if a.startswith(mutant.function + " |")]
        before = self.killers.get(mutant.anchor)
        tests = times if reached is None else reached.tests_of(mutant)
        return sorted(tests, key=lambda t: (t != before, (times[t] + 0.02) / (
            1 + hits.get(t, 0) + 8 * near.count(t)), t))

    def noticed_by(self, mutant, obj, times, reached):
        """The test that notices this object, or None."""
        program = obj[:-2]
        hits = self.hits.setdefault(mutant.path, {})
        spent_s = 0
        try:
            self.link([obj], program)
            for test in self.order(mutant, times, reached):
                passed, took_s = self.run(program, test, 2 + int(5 * times[test]))
                if not passed:
                    hits[test] = hits.get(test, 0) + 1
                    self.killers[mutant.anchor] = test
                    return test
                spent_s += took_s
                if 0 < self.options.cap_s < spent_s:
                    break
        finally:
            for path in (program, obj):
                if os.path.exists(path):
                    os.unlink(path)
        return None


# ---- the whole -----------------------------------------------------------------------------------

def sample(mutants, seed):
    """All of them in an order by lot: first one of each line, then a second of each, ... The lot of
    a mutant is in its name and the seed, so that a change elsewhere draws no others."""
    lines = {}
    for mutant in mutants:
        lot = hashlib.sha1(f"{seed} {mutant.anchor}".encode()).digest()
        lines.setdefault((mutant.path, mutant.line), []).append((lot, mutant.start, mutant))
    rounds = [sorted(of_line, key=lambda x: x[:2]) for of_line in lines.values()]
    for i in range(max(map(len, rounds), default=0)):
        of_round = [of_line[i] for of_line in rounds if len(of_line) > i]
        yield from (mutant for _, _, mutant in sorted(of_round, key=lambda x: x[:2]))


def choose(options, functions, by_file, reasons):
    """The mutants to try, and how many of them that compile are wanted."""
    scope = (read_scope(options.scope, by_file) if options.scope else
             {f for of_file in by_file.values() for f in of_file})
    order = [f for functions_of in by_file.values() for f in functions_of if f in scope]
    mutants = [m for f in order for m in mutate.mutants_of(f, f.path)]
    named = list(read_named(options.named, functions)) if options.named else []
    known = {m.anchor for m in mutants}
    for anchor in reasons:
        if anchor not in known:
            raise Problem(f"{options.survivors}: missing anchor: {anchor}")
    print(f"{len(mutants)} mutants of {len(scope)} functions, seed {options.seed}")
    if options.only == "named":
        return named, len(named)
    if options.only:
        wanted = options.only.split(",")
        found = [m for m in mutants + named if m.id in wanted]
        if len(found) != len(wanted):
            raise Problem(f"no mutant {options.only}")
        return found, len(found)
    wanted = options.count + len(named) if options.count > 0 else len(mutants) + len(named)
    return named + list(sample(mutants, options.seed)), wanted


def build(bench, pool, mutants, wanted):
    """Pairs of a mutant and its object, as many as wanted."""
    made, at = [], 0
    for path in {m.path for m in mutants}:
        bench.original(path)
    while at < len(mutants) and len(made) < wanted:
        part = mutants[at:at + min(64, wanted - len(made))]
        at += len(part)
        made += [(m, o) for m, o in zip(part, pool.map(bench.make, part)) if o is not None]
    return made, at - len(made)


def judge(results, reasons, options):
    noticed = failed = skipped = 0
    by = {}
    for mutant, test in results:
        if test is not None:
            noticed += 1
            file = test.split()[0]
            by[file] = by.get(file, 0) + 1
            if mutant.anchor in reasons:
                failed += 1
                noticed -= 1
                print(f"{options.survivors}: {test} notices it: {mutant.anchor}")
        elif mutant.anchor in reasons:
            skipped += 1
        else:
            failed += 1
        if options.only and test is not None:
            print(f"noticed by {test}: {mutant.anchor}")
    print("noticed by: " + ", ".join(f"{t} {n}" for t, n in sorted(by.items(), key=lambda x: -x[1])))
    return noticed, failed, skipped


def run_all(options, work):
    bench = Bench(options, work)
    by_file, functions = bench.functions()
    reasons = read_survivors(options.survivors) if options.survivors else {}
    mutants, wanted = choose(options, functions, by_file, reasons)
    begun_s = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        made, left_out = build(bench, pool, mutants, wanted)
        times, reached = bench.measure(pool, [mutant for mutant, _ in made])
        print(f"{len(made)} to try, {left_out} that do not compile or change nothing; "
              f"{len(times)} tests, {time.monotonic() - begun_s:.0f} s so far", flush=True)

        def test_of(pair):
            if options.cap_s > 0 and pair[0].anchor in reasons:
                return None  # it would take all tests; a run without a cap tries it
            return bench.noticed_by(*pair, times, reached)

        tests = pool.map(test_of, made)
        results = []
        for (mutant, _), test in zip(made, tests):
            results.append((mutant, test))
            if len(results) % 20 == 0 or len(results) == len(made):
                bench.keep_killers()
            if test is None and mutant.anchor not in reasons:
                print(f"not noticed: {mutant.anchor}\n    {mutant.path}:{mutant.line}; again: "
                      f"{options.again} ONLY={mutant.id}", flush=True)
    noticed, failed, skipped = judge(results, reasons, options)
    options.tally = (noticed, len(results))
    share_pct = 100 * noticed / max(1, len(results))
    print(f"{noticed} of {len(results)} noticed, {share_pct:.1f} %, "
          f"in {time.monotonic() - begun_s:.0f} s")
    print(f"{noticed} passed, {failed} failed, {skipped} skipped")
    return 0 if failed == 0 and results and (options.only or share_pct >= WANTED_PCT) else 1


def in_work_folder(options, run):
    """The exit status of run(options, work), in a folder that is gone when it ends."""
    options.root = os.getcwd()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # and leaves nothing behind
    os.makedirs(options.work, exist_ok=True)
    work = tempfile.mkdtemp(prefix="run-", dir=options.work)
    try:
        return run(options, work)
    except Problem as problem:
        print(f"mutants: {problem}")
        print("0 passed, 1 failed, 0 skipped")
        return 1
    finally:
        shutil.rmtree(work, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in ("sources", "tests", "libs", "compile", "link", "work"):
        parser.add_argument("--" + name, required=True)
    for name in ("scope", "survivors", "named", "only"):
        parser.add_argument("--" + name)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--cap-s", type=float, default=0)
    parser.add_argument("--choose", default=".*")
    parser.add_argument("--again", default="make check-mutants", help=argparse.SUPPRESS)
    return in_work_folder(parser.parse_args(), run_all)


if __name__ == "__main__":
    sys.exit(main())
