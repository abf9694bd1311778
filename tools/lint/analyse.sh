#!/bin/sh
# SPDX-License-Identifier: MIT
# What other programs say of what is not compiled: shellcheck of the shell's scripts, ruff and
# mypy of Python, tsc of the page. RUFF, MYPY, TSC are their commands. What is left out here is
# left out for the reason beside it; a single place says its own.
. tests/support/tap.sh

# SC2034, SC2154: a file that is sourced has what its readers set, and sets what they read.
# SC2148: such a file has no first line of its own. SC2010: the names that are listed are ours.
# SC2100, SC2209: a word that is a command's name is not run. SC1007: FOO= COMMAND empties FOO.
# SC1087: [ behind a variable begins a regular expression.
left_out=SC1007,SC1087,SC2010,SC2034,SC2100,SC2148,SC2154,SC2209

scripts=$(git ls-files '*.sh' .ci)
programs=$(git ls-files '*.py')
if command -v shellcheck >/dev/null; then
    # shellcheck disable=SC2086 # names here have no spaces
    check "shellcheck has nothing to say" shellcheck -S warning -x -e "$left_out" $scripts
else
    skip "shellcheck has nothing to say" "shellcheck is not installed"
fi
if "${RUFF:-ruff}" --version >/dev/null 2>&1; then
    # shellcheck disable=SC2086
    check "ruff has nothing to say" "${RUFF:-ruff}" check --no-cache --isolated \
        --select E4,E7,E9,F,B,W,PLE --ignore B905 $programs
else
    skip "ruff has nothing to say" "ruff is not installed"
fi
if "${MYPY:-mypy}" --version >/dev/null 2>&1; then
    check "mypy has nothing to say of the package" "${MYPY:-mypy}" --strict --cache-dir /dev/null \
        tools/python/grobo
else
    skip "mypy has nothing to say of the package" "mypy is not installed"
fi
if "${TSC:-tsc}" --version >/dev/null 2>&1; then
    check "tsc has nothing to say of the page" "${TSC:-tsc}" --noEmit --allowJs --checkJs \
        --strict false --target es2022 --module es2022 --moduleResolution bundler \
        --lib es2022,dom,dom.iterable tests/cockpit/page.d.ts tools/grctl/web/page/*.js
else
    skip "tsc has nothing to say of the page" "tsc is not installed"
fi
done_testing
