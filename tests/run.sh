#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs test programs, adds up what they say in TAP, and ends with one line:
#   N passed, N failed, N skipped
#
# usage: tests/run.sh PROGRAM...
#   A program is an executable, or a shell script (*.sh, run by sh).
#   PROGRAM@DIR replays the files of a corpus: PROGRAM gets the files of DIR as arguments.
# environment:
#   TEST_JOBS=2         how many at a time
#   TEST_TIMEOUT_S=120  how long one may take
#   TEST_WRAPPER=       put before each program, such as 'valgrind -q --error-exitcode=99'
#   TEST_LOGS=DIR       keep the logs there (default: a temporary directory)
#
# Counted as failed besides 'not ok': a crash, a time-out, an exit status other than 0 without a
# 'not ok', fewer results than planned, and a program without any test.
set -u

jobs=${TEST_JOBS:-2}
limit_s=${TEST_TIMEOUT_S:-120}
wrapper=${TEST_WRAPPER:-}

# Runs one program; its output goes to LOGS/NUMBER.log with a last line of our own.
run_one() {
    logs=$1
    number=${2%%:*}
    program=${2#*:}
    set --
    case $program in
    *@*)
        corpus=${program##*@}
        program=${program%@*}
        for file in "$corpus"/*; do
            [ -f "$file" ] && set -- "$@" "$file"
        done
        ;;
    esac
    case $program in
    *.sh) set -- sh "$program" ;;
    # $wrapper is a command with its options: it is meant to be split.
    # shellcheck disable=SC2086
    *) set -- $wrapper "$program" "$@" ;;
    esac
    CMOCKA_MESSAGE_OUTPUT=TAP timeout -k 5 "$limit_s" "$@" >"$logs/$number.log" 2>&1 </dev/null
    status=$?
    # On a line of its own, whatever the program's last line was.
    printf '\n@status %d\n' "$status" >>"$logs/$number.log"
}

if [ "${1:-}" = --one ]; then
    run_one "$2" "$3"
    exit 0
fi

if [ -n "${TEST_LOGS:-}" ]; then
    logs=$TEST_LOGS
    mkdir -p "$logs" || exit 1
    rm -f "$logs"/*.log
else
    logs=$(mktemp -d) || exit 1
    trap 'rm -rf "$logs"' EXIT
    trap 'exit 130' INT
    trap 'exit 143' TERM
fi

# With an empty list xargs would run itself once, and a run of nothing must not look like success.
if [ $# -eq 0 ]; then
    echo 'tests/run.sh: nothing to run'
    echo '0 passed, 0 failed, 0 skipped'
    exit 1
fi

count=0
for program in "$@"; do
    count=$((count + 1))
    printf '%d:%s\n' "$count" "$program"
done >"$logs/programs"
xargs -P "$jobs" -n 1 sh "$0" --one "$logs" <"$logs/programs"

awk -v logs="$logs" -v limit_s="$limit_s" '
function problem(text) { failed++; bad = 1; notes = notes "  " text "\n" }

# A result line: "ok 3 - name", "not ok 3 - name", "ok 3 # SKIP why", and of cmocka
# "not ok 3 # SKIP name".
function result(line,    name) {
    results++
    if (line ~ /# *[Ss][Kk][Ii][Pp]/) {
        skipped++
        name = line
        sub(/^.*# *[Ss][Kk][Ii][Pp] */, "", name)
        sub(/\n$/, "", said)
        gsub(/\n/, "; ", said)
        skips = skips "skip  " shown ": " name (said != "" ? ": " said : "") "\n"
    } else if (line ~ /^ok/) {
        passed++
    } else {
        failed++
        bad = 1
        not_ok++
    }
    said = ""
}

function judge(status) {
    if (status == 124 || status == 137) {
        problem("no end within " limit_s " s")
    } else if (status > 128) {
        problem("killed by signal " (status - 128))
    } else if (status != 0 && not_ok == 0) {
        problem("exit status " status " without a failed test")
    }
    if (!bad && plan >= 0 && results != plan) {
        problem(results " results for " plan " planned tests")
    }
    if (!bad && results == 0 && !skipped_all) {
        problem("holds no test")
    }
}

{
    program = $0
    number = program
    sub(/:.*/, "", number)
    sub(/^[^:]*:/, "", program)
    shown = program
    log_file = logs "/" number ".log"
    output = notes = said = ""
    bad = results = not_ok = skipped_all = 0
    plan = -1
    status = 255
    while ((getline line < log_file) > 0) {
        if (line ~ /^@status /) {
            status = substr(line, 9) + 0
            continue
        }
        output = output "  " line "\n"
        if (line ~ /^(not )?ok [0-9]+/) {
            result(line)
        } else if (line ~ /^1\.\.0 *#/) {
            skipped_all = 1
            plan = 0
            skipped++
            sub(/^1\.\.0 *# *([Ss][Kk][Ii][Pp])? */, "", line)
            skips = skips "skip  " shown ": " line "\n"
        } else if (line ~ /^1\.\.[0-9]+/) {
            # A program of several groups has a plan for each.
            plan = (plan < 0 ? 0 : plan) + substr(line, 4)
        } else if (line !~ /^#/ && line != "") {
            said = said line "\n"
        }
    }
    close(log_file)
    judge(status)
    if (bad) {
        printf "FAIL  %s\n%s%s", shown, output, notes
    } else {
        printf "pass  %s (%d)\n", shown, results
    }
}

END {
    printf "%s", skips
    printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped
    exit failed > 0
}' "$logs/programs"
