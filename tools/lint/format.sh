#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: sources look as clang-format 14 writes them. Another version writes them another way, so
# without this one the gate says so and passes; `tools/setup.sh --check` installs it.
#
# usage: format.sh [--fix] FILE...
# environment: FORMATTED=FILE keeps which files were well written; only what has changed since is
#              looked at again
set -u

tool=
for candidate in clang-format-14 clang-format; do
    if "$candidate" --version 2>/dev/null | grep -q 'version 14\.'; then
        tool=$candidate
        break
    fi
done
mode=check
if [ "${1:-}" = --fix ]; then
    mode=fix
    shift
fi
if [ -z "$tool" ]; then
    echo 'format: no clang-format 14 here (tools/setup.sh --check installs it)' >&2
    [ $mode = check ]
    exit
fi
if [ $mode = fix ]; then
    exec "$tool" -i "$@"
fi
# The first line is the sum of what judged them.
keep=${FORMATTED:-}
if [ -n "$keep" ]; then
    trap 'rm -f "$keep.$$"' EXIT
    { { "$tool" --version && cat .clang-format; } | cksum && cksum "$@"; } >"$keep.$$" || exit 1
    if [ -f "$keep" ] && [ "$(head -n 1 "$keep")" = "$(head -n 1 "$keep.$$")" ]; then
        # The names of the project's files have no blanks.
        # shellcheck disable=SC2046
        set -- $(grep -vxF -f "$keep" "$keep.$$" | cut -d ' ' -f 3)
    fi
    [ $# -gt 0 ] || exit 0
fi
"$tool" --dry-run -Werror "$@" 2>&1 | awk '
/: error: / {
    split($0, part, ":")
    if (!count[part[1]]++) {
        first[part[1]] = part[2]
    }
}
END {
    for (file in count) {
        printf "%s:%d: format: %d places not as clang-format 14 writes them (make format)\n", file,
            first[file], count[file]
        bad = 1
    }
    exit bad
}' || exit
[ -z "$keep" ] || mv "$keep.$$" "$keep"
