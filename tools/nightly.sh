#!/bin/sh
# SPDX-License-Identifier: MIT
# What takes too long for .ci/run, one stage after the other: `make nightly`. The page it writes,
# BUILD/nightly.md, has each stage with its end, time and last line, the seeds, and what failed. All
# run even when one fails. The last line is that of tests/run.sh, a stage each.
#
# usage: tools/nightly.sh [STAGE...]     (without a name: all of them)
# environment: BUILD=build; SEED=the date, of what is drawn by lot
set -u
cd "$(dirname "$0")/.." || exit 1

build=${BUILD:-build}
seed=${SEED:-$(date +%Y%m%d)}
logs=$build/logs/nightly
page=$build/nightly.md
mkdir -p "$logs" || exit 1

# stage_of NAME: what it runs, as arguments of make.
stage_of() {
    case $1 in
    memcheck) echo check-memcheck ;;
    san) echo check-san ;;
    fuzz) echo "fuzz FUZZ_S=60 FUZZ_SEED=$seed" ;;
    map) echo "check-map COUNT=0 SEED=$seed" ;;
    mutants) echo "check-mutants COUNT=300 SEED=$seed" ;;
    asserts) echo check-asserts ;;
    sequences) echo check-sequences ;;
    model) echo check-model ;;
    areas) echo "check-areas COUNT=60 CAP_S=60 SEED=$seed" ;;
    soak) echo "soak SEEDS=6 FROM=$((seed % 100000 * 6))" ;;
    abi) echo check-abi ;;
    ports) echo check-ports ;;
    deb) echo check-deb ;;
    wheel) echo check-wheel ;;
    roots) echo check-roots ;;
    cockpit) echo check-cockpit ;;
    api) echo check-api ;;
    analyse) echo analyse ;;
    analyzer) echo analyzer ;;
    families) echo check-families ;;
    physics) echo check-physics ;;
    fleet) echo check-fleet ;;
    scan) echo check-scan ;;
    stops) echo "test ONLY=serve_stop STOPS=16" ;;
    memory) echo "test ONLY=memory.sh ALLOCATIONS=all" ;;
    calls) echo "test ONLY=calls.sh CALLS=all" ;;
    matrix) echo "test ONLY=matrix RING=cli MATRIX=all" ;;
    *) return 1 ;;
    esac
}

[ $# -gt 0 ] || set -- san memcheck fuzz map mutants asserts sequences model soak abi ports deb \
    wheel roots analyse analyzer cockpit api families physics fleet scan stops memory calls \
    matrix areas
for name in "$@"; do
    stage_of "$name" >/dev/null || { echo "nightly: no stage is called $name" >&2; exit 2; }
done

# The page is whole after each stage: who ends the run in the morning has what ran.
write_page() {
    {
        echo '# What ran in the night'
        echo
        echo "$(uname -sm), $(git log -1 --format='%h: %s' 2>/dev/null || echo 'no checkout')," \
            "begun $began, seed $seed."
        echo "$passed passed, $failed failed."
        echo
        echo '| stage | end | minutes | last line | again by |'
        echo '| --- | --- | --- | --- | --- |'
        cat "$logs/rows"
        cat "$logs/failures"
    } >"$page.new" && mv "$page.new" "$page"
}

began=$(date '+%Y-%m-%d %H:%M')
passed=0
failed=0
: >"$logs/rows"
: >"$logs/failures"
for name in "$@"; do
    what=$(stage_of "$name")
    echo "== make $what"
    start=$(date +%s)
    # $what is a list of words.
    # shellcheck disable=SC2086
    if env -u MAKEFLAGS -u MAKELEVEL make --no-print-directory -j2 BUILD="$build" $what \
        >"$logs/$name.log" 2>&1 </dev/null; then
        end=passed
        passed=$((passed + 1))
    else
        end=FAILED
        failed=$((failed + 1))
        {
            printf '\n## %s\n\n```\n' "$name"
            grep -n -e '^FAIL' -e '^not ok' -e '^  not ok' "$logs/$name.log" | head -n 20
            tail -n 20 "$logs/$name.log"
            printf '```\n\nThe whole of it: %s\n' "$logs/$name.log"
        } >>"$logs/failures"
    fi
    took=$(($(date +%s) - start))
    last=$(grep -e ' passed, .* skipped' "$logs/$name.log" | tail -n 1)
    minutes=$((took / 60)).$((took % 60 / 6))
    echo "| $name | $end | $minutes | ${last:-none} | \`make $what\` |" >>"$logs/rows"
    tail -n 1 "$logs/rows"
    write_page
done
echo "the page: $page"
echo "$passed passed, $failed failed, 0 skipped"
[ $failed -eq 0 ]
