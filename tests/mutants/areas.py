# SPDX-License-Identifier: MIT
"""Sabotages areas outside the core, a seeded sample of each, and writes a table of what was noticed.

usage: areas.py [option]... [AREA]...     (without a name: all of the file)
  --areas FILE         name, wanted percent, sources, tests: a line for each area
  --objects DIR        where the objects of the tests are, under the path of their sources
  --report FILE        the table; its rows of areas that are not run stay
  --libs, --compile, --link, --work, --seed, --count, --jobs, --only: as run.py has them

The interval is Wilson's, of 95 percent. The last line is: N passed, N failed, N skipped, an area each:
it has failed where the whole interval is below what is wanted. An area with no object is skipped.
"""
import argparse
import fnmatch
import glob
import math
import os
import sys

sys.dont_write_bytecode = True
import run  # noqa: E402

HEAD = """# What tests notice outside the core

Sabotages by the rules of tests/mutants/mutate.py, chosen by lot, one of each line first.

| area | tried | noticed | share | interval of 95 % | wanted | seed |
| --- | --- | --- | --- | --- | --- | --- |
"""


def wilson(hits, n, z=1.96):
    """The interval of a share, in percent."""
    if n == 0:
        return 0.0, 100.0
    share, more = hits / n, z * z / n
    middle = (share + more / 2) / (1 + more)
    half = z * math.sqrt(share * (1 - share) / n + more / (4 * n)) / (1 + more)
    return 100 * (middle - half), 100 * (middle + half)


def read_areas(path):
    for _, line in run.lines_of(path):
        name, wanted, sources, tests = line.split()
        yield name, int(wanted), sources.split(","), tests.split(",")


def objects_of(folder, patterns):
    found = sorted(glob.glob(os.path.join(folder, "tests", "*", "*.o")))
    return [path for path in found
            if any(fnmatch.fnmatch(os.path.basename(path)[:-2], p) for p in patterns)]


def rows_of(path):
    """Area -> its row of an earlier run."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        rows = [line for line in file.read().splitlines() if line.startswith("| ")]
    return {row.split("|")[1].strip(): row for row in rows[2:]}


def write_table(path, rows):
    with open(path + ".new", "w", encoding="utf-8") as file:
        file.write(HEAD + "".join(row + "\n" for row in rows.values()))
    os.replace(path + ".new", path)


def run_area(options, area):
    """True where as much was noticed as is wanted, None where nothing could be tried."""
    name, wanted, sources, tests = area
    options.sources = " ".join(sorted(path for p in sources for path in glob.glob(p)))
    options.tests = " ".join(objects_of(options.objects, tests))
    options.again = f"make check-areas AREA={name}"
    options.tally = (0, 0)
    if not options.tests or not options.sources:
        print(f"{name}: no objects of tests")
        return None
    print(f"== {name}", flush=True)
    run.in_work_folder(options, run.run_all)
    noticed, tried = options.tally
    if tried == 0:
        return False
    low, high = wilson(noticed, tried)
    rows = rows_of(options.report)
    rows[name] = (f"| {name} | {tried} | {noticed} | {100 * noticed / max(1, tried):.1f} % | "
                  f"{low:.1f} to {high:.1f} % | {wanted} % | {options.seed} |")
    print(rows[name], flush=True)
    write_table(options.report, rows)
    return high >= wanted


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in ("areas", "objects", "report", "libs", "compile", "link", "work"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--only")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--cap-s", type=float, default=0)
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    options.survivors = options.named = options.scope = None
    options.choose = ".*"
    areas = list(read_areas(options.areas))
    for name in options.names:
        if name not in [area[0] for area in areas]:
            sys.exit(f"areas: no area is called {name}")
    results = [run_area(options, area) for area in areas
               if not options.names or area[0] in options.names]
    print(f"the table: {options.report}")
    print(f"{results.count(True)} passed, {results.count(False)} failed, "
          f"{results.count(None)} skipped")
    return 0 if False not in results else 1


if __name__ == "__main__":
    sys.exit(main())
