# SPDX-License-Identifier: MIT
"""Writes the module grobo._abi: what cffi must know of the library, taken from the public headers.

usage: generate.py TOP CC OUT       writes OUT, a Python module
       generate.py TOP CC --print   prints the declarations, for a test that has a compiler check them

The C preprocessor reads the headers without those of the system, which stand-ins replace; what is
left are declarations. Those of functions that the shared library does not export are dropped.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

STAND_INS = {
    "stdbool.h": "",
    "stddef.h": "",
    "stdio.h": "",
    "pthread.h": "typedef unsigned long pthread_t;\n",
    "stdint.h": (
        "#define INT64_MAX 0x7fffffffffffffff\n#define INT64_C(n) n\n"
        "#define UINT8_MAX 255\n#define UINT16_MAX 65535\n#define UINT32_MAX 4294967295\n"
        "#define UINT64_C(n) n\n#define SIZE_MAX 0xffffffffffffffff\n"
    ),
}
# Locks and conditions differ by system, and nobody has one here.
DROPPED = re.compile(r"\bpthread_(mutex|cond)_t\b|\bgrobo_(mutex|cond)\b")
NUMBER = re.compile(r"^#define (GROBO_\w+) \(?(-?(?:0x[0-9A-Fa-f]+|\d+))[uUlL]*\)?$", re.M)


# What completes a type that others only point to.
IN_STORAGE = {"core/lines.h", "core/static.h", "core/sim_static.h"}


def headers(top):
    """The headers of the main shelf and of the core."""
    folder = Path(top, "include/grobo")
    found = sorted([*folder.glob("*.h"), *folder.glob("core/*.h")])
    return [name for p in found if (name := p.relative_to(folder).as_posix()) not in IN_STORAGE]


def preprocess(top, cc, *options):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in STAND_INS.items():
            Path(folder, name).write_text(text)
        command = [*cc.split(), "-E", "-P", "-nostdinc", "-U__GNUC__", "-I", folder]
        command += ["-I", f"{top}/include", "-I", f"{top}/ports/posix/include", *options]
        command += ["-x", "c", "-"]
        text = "".join(f"#include <grobo/{name}>\n" for name in headers(top))
        return subprocess.run(command, input=text, stdout=subprocess.PIPE, text=True, check=True).stdout


def statements(text):
    """The declarations, at the semicolons that stand in no braces."""
    depth, begin = 0, 0
    for at, char in enumerate(text):
        depth += (char == "{") - (char == "}")
        if char == ";" and depth == 0:
            yield text[begin : at + 1].strip()
            begin = at + 1


def is_wanted(statement, exported, opaque):
    data = re.match(r"extern const (\w+) \w+;", statement)
    if data and data.group(1) in opaque:
        return False
    if DROPPED.search(statement):
        return False
    if statement.startswith(("typedef", "struct", "enum", "union")) and "(" not in re.sub(
        r"\{.*\}", "", statement, flags=re.S
    ):
        return True
    if statement.startswith("typedef"):
        return True
    name = re.search(r"(\w+)\s*(?:\(|\[|;)", statement)
    return name is not None and name.group(1) in exported


def declarations(top, cc):
    exported = set(re.findall(r"^\s*(grobo_\w+);", Path(top, "src/libgrobo.map").read_text(), re.M))
    text = preprocess(top, cc)
    # cffi takes numbers as bounds of arrays, and the preprocessor leaves sums.
    text = re.sub(r"\[([-+*/() \d]+)\]", lambda m: f"[{int(eval(m.group(1)))}]", text)
    # What has no members here can only be pointed to.
    opaque = set(re.findall(r"typedef struct (\w+) \1;", text)) - set(re.findall(r"\} ?(\w+);", text))
    kept = [s for s in statements(text) if is_wanted(s, exported, opaque)]
    numbers = NUMBER.findall(preprocess(top, cc, "-dM"))
    lines = [f"#define {name} {value}" for name, value in sorted(numbers)]
    return "\n".join(lines + kept) + "\n"


def main():
    top, cc, out = sys.argv[1:4]
    text = declarations(top, cc)
    if out == "--print":
        sys.stdout.write(text)
        return
    import cffi

    ffi = cffi.FFI()
    ffi.set_source("grobo._abi", None)
    ffi.cdef(text)
    ffi.emit_python_code(out)


if __name__ == "__main__":
    main()
