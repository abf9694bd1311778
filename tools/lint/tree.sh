#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: what stands at the top of the tree is what docs/design.md says (the table under
# "## The tree", first column), and there is no C++ source.
set -u

bad=0
# A tarball may be unpacked inside of another project's checkout.
if [ -e .git ] && git rev-parse --git-dir >/dev/null 2>&1; then
    files=$(git ls-files)
else
    files=$(find . -type f ! -path './build*' ! -path './.git/*' | sed 's,^\./,,')
fi
top=$(printf '%s\n' "$files" | sed 's,/.*,,' | sort -u)
told=$(awk '
    /^## / { open = /^## The tree/ }
    open && /^\| `/ { split($0, cell, "`"); print cell[2] }
    ' docs/design.md | sed 's,/$,,' | sort -u)

for name in $top; do
    if ! printf '%s\n' "$told" | grep -Fqx -- "$name"; then
        echo "docs/design.md:1: tree: $name stands at the top but not in the table"
        bad=1
    fi
done
for name in $told; do
    if ! printf '%s\n' "$top" | grep -Fqx -- "$name"; then
        echo "docs/design.md:1: tree: the table names $name, which is not there"
        bad=1
    fi
done
for file in $(printf '%s\n' "$files" | grep -E '\.(cpp|cc|cxx|c\+\+|hpp|hh|hxx)$'); do
    echo "$file:1: tree: C++ source; the project is C11"
    bad=1
done
exit $bad
