#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's page and that of a fleet: the pure modules in node, all of it in Chromium against
# `grctl serve`.
# PYTHON has Playwright installed, AXE is axe-core's axe.min.js; what is missing is skipped.
. tests/support/tap.sh

PYTHON=${PYTHON:-python3}
CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser)}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT

if command -v node >/dev/null; then
    cp tools/grctl/web/page/* "$scratch"
    echo '{"type": "module"}' >"$scratch/package.json"
    node tests/cockpit/unit.mjs "$scratch" >"$scratch/unit.tap"
    grep -v '^1\.\.' "$scratch/unit.tap"
    tap_count=$(grep -Ec '^(not )?ok ' "$scratch/unit.tap")
    [ "$tap_count" -gt 0 ] || check 'the modules of the page load' false
else
    skip 'the modules of the page' 'node is not installed'
fi
if [ -z "$CHROMIUM" ]; then
    skip 'the page in a browser' 'chromium is not installed: tools/setup.sh --cockpit'
elif ! "$PYTHON" -c 'import playwright' 2>/dev/null; then
    skip 'the page in a browser' 'the package playwright is not installed'
else
    export CHROMIUM
    for part in browser fleet; do
        FIRST=$tap_count "$PYTHON" -B "tests/cockpit/$part.py" "$@" >"$scratch/$part.tap"
        cat "$scratch/$part.tap"
        found=$(grep -Ec '^(not )?ok ' "$scratch/$part.tap")
        tap_count=$((tap_count + found))
        [ "$found" -gt 0 ] || [ $# -gt 0 ] || check "the browser starts for $part.py" false
    done
fi
done_testing
