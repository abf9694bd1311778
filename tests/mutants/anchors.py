# SPDX-License-Identifier: MIT
"""Looks whether each sabotage still has its place in the sources, and tries none of them.

usage: anchors.py, in the top folder. One line for each that has lost it, and status 1.
"""
import glob
import os
import sys

sys.dont_write_bytecode = True
import asserts  # noqa: E402
import mutate  # noqa: E402
import rows  # noqa: E402
import run  # noqa: E402

HERE = "tests/mutants"
# What is not in CORE_SRCS of the Makefile.
OTHERS = ("src/base/memory.c", "src/team/", "src/motion/", "src/robots/file/", "src/body/",
          "src/link/", "ports/")
ASSERTED = ("src/bus/", "src/play/", "src/robot/", "src/link/")  # --of of check-asserts


def read_sources():
    """Texts by path; functions by file and by name, of the core and of all."""
    texts, core, core_names, names = {}, {}, {}, {}
    for path in sorted(glob.glob("src/**/*.c", recursive=True) + glob.glob("ports/common/*.c") +
                       glob.glob("ports/posix/*.c")):
        with open(path, encoding="utf-8") as file:
            texts[path] = file.read()
        found = mutate.functions_of(texts[path])
        in_core = not path.startswith(OTHERS)
        if in_core:
            core[path] = found
        for function in found:
            function.path = path
            names.setdefault(function.name, []).append(function)
            if in_core:
                core_names.setdefault(function.name, []).append(function)
    return texts, core, core_names, names


def lost_asserts(texts, names):
    assertions = [a for path, text in texts.items() if path.startswith(ASSERTED)
                  for a in asserts.assertions_of(path, mutate.functions_of(text), mutate.blank(text))]
    return [problem for _, _, _, problem, _ in asserts.read(HERE + "/asserts", names, assertions)
            if problem]


def lost_rows(names):
    found = rows.read_rows(HERE + "/rows", rows.read_map("docs/seed-map.md"), names)
    return [f"{HERE}/rows: {s.row.id}: {s.problem}" for s in found if s.problem]


def lost_named(core_names):
    lost = []
    for number, name, old, new in run.read_blocks(HERE + "/named"):
        try:
            if len(core_names.get(name, [])) != 1:
                raise run.Problem(f"not one function {name}")
            run.Named(core_names[name][0], old, new)
        except run.Problem as problem:
            lost.append(f"{HERE}/named:{number}: {problem}")
    return lost


def lost_survivors(core):
    scope = run.read_scope(HERE + "/scope", core)
    known = {m.anchor for f in scope for m in mutate.mutants_of(f, f.path)}
    return [f"{HERE}/survivors: no such mutant: {anchor}"
            for anchor in run.read_survivors(HERE + "/survivors") if anchor not in known]


def main():
    texts, core, core_names, names = read_sources()
    try:
        lost = (lost_asserts(texts, names) + lost_rows(names) + lost_named(core_names) +
                lost_survivors(core))
    except run.Problem as problem:
        lost = [str(problem)]
    for line in lost:
        print(line)
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main() if os.path.isdir(HERE) else 0)
