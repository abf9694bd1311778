# SPDX-License-Identifier: MIT
"""Which tests reach a mutant: those alone can notice it.

The sabotaged files are compiled with a call at the head of each basic block (-fsanitize-coverage,
which gcc and clang have), which marks the address it was called from in a file that the processes
of a test share; addr2line makes function and line of it. A test reaches a mutant if it marked a
line of its statement, or the nearest line before that at which any test was seen. What has no line
of its own (a label of a switch, a function that is emptied) is reached with its function.
"""
import os
import re
import subprocess

FLAGS = ["-gdwarf-4", "-O0", "-fno-inline", "-fsanitize-coverage=trace-pc"]
RECORDER = """
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>
extern char __executable_start, etext;
static unsigned char *marks;
void __sanitizer_cov_trace_pc(void)
{
    if (marks != NULL) {
        marks[(char *)__builtin_return_address(0) - &__executable_start] = 1;
    }
}
__attribute__((constructor(101))) static void open_marks(void)
{
    const char *path = getenv("GROBO_REACH");
    size_t bytes = (size_t)(&etext - &__executable_start);
    int fd = path == NULL ? -1 : open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (fd >= 0 && ftruncate(fd, (off_t)bytes) == 0) {
        void *p = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
        marks = p == MAP_FAILED ? NULL : p;
    }
}
"""


def marks_of(path):
    """The addresses that one test marked."""
    with open(path, "rb") as file:
        found = [match.start() for match in re.finditer(rb"\x01", file.read())]
    os.unlink(path)
    return found


def lines_of(program, addresses):
    """Address -> (path, function, line), of a program that may be loaded anywhere."""
    with open(program, "rb") as file:
        fixed = file.read(18)[16] == 2  # ET_EXEC: its addresses are not from 0
    start = 0
    if fixed:
        names = subprocess.run(["nm", program], text=True, capture_output=True, check=True).stdout
        start = int(re.search(r"^(\w+) \w __executable_start$", names, re.M)[1], 16)
    ordered = sorted(addresses)
    # The call is before the address to which it returns.
    text = "".join(f"0x{start + a - 1:x}\n" for a in ordered)
    said = subprocess.run(["addr2line", "-f", "-e", program], input=text, text=True,
                          capture_output=True, check=True).stdout.splitlines()
    found = {}
    for i, address in enumerate(ordered):
        place = re.match(r"(.*):(\d+)", said[2 * i + 1])
        path = os.path.relpath(place[1]) if place else ""
        found[address] = (path, said[2 * i], int(place[2]) if place else 0)
    return found


class Reach:
    """Filled with the marks of each test, asked for the tests of each mutant."""

    def __init__(self, program, marks):
        """marks: test -> addresses"""
        lines = lines_of(program, {a for of_test in marks.values() for a in of_test})
        self.by_function = {}  # path, function -> line -> tests
        for test, addresses in marks.items():
            for address in addresses:
                path, function, line = lines[address]
                of_line = self.by_function.setdefault((path, function), {})
                of_line.setdefault(line, set()).add(test)

    def tests_of(self, mutant):
        seen = self.by_function.get((mutant.path, mutant.function), {})
        first, last = mutant.lines
        inside = {line for line in seen if first <= line <= last}
        before = [line for line in seen if line <= first]
        wanted = inside | ({max(before)} if before else set())
        if mutant.whole or not before:
            wanted = seen
        return set().union(*(seen[line] for line in wanted))
