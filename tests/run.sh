#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs test programs, adds up what they say in TAP, and ends with one line:
#   N passed, N failed, N skipped
#
# usage: tests/run.sh PROGRAM...
#   A program is an executable, or a shell script (*.sh, run by sh).
#   PROGRAM@DIR replays the files of a corpus: PROGRAM gets the files of DIR as arguments.
# environment:
#   TEST_JOBS=N         how many at a time. Without it as many as processors; beside them, first
#                       among equals, TEST_WAITERS for each of those in real time, which wait
#   TEST_WAITERS=4      fewer where all of it is slower, by sanitizers
#   TEST_TIMEOUT_S=900  how long one may take
#   TEST_ONLY=WORD      only tests in whose names this stands, a blank as good as an underscore: all
#                       of a program or script that is called so; of other programs those alone, of
#                       other scripts all, as their tests build on each other
#   TEST_WRAPPER=       put before each program, such as 'valgrind -q --error-exitcode=99'
#   TEST_LOGS=DIR       keep the logs there (default: a temporary directory)
#   TEST_FIRST=         names of long programs, which begin first: else the others wait for them
#   TEST_SLOWEST=5      how many of the slowest are told
#
# Counted as failed besides 'not ok': a crash, a time-out, an exit status other than 0 without a
# 'not ok', fewer results than planned, a program without any test, and one that leaves processes
# behind.
set -u

processors=$(getconf _NPROCESSORS_ONLN 2>/dev/null) || processors=2
limit_s=${TEST_TIMEOUT_S:-900}
wrapper=${TEST_WRAPPER:-}

alike() {
    tr ' -' '__'
}
only=$(printf %s "${TEST_ONLY:-}" | alike)
is_called() {
    name=${1%@*}
    case $(printf %s "${name##*/}" | alike) in
    *"$only"*) ;;
    *) return 1 ;;
    esac
}

# is_wanted PROGRAM: there is a test in it that is called so.
is_wanted() {
    is_called "$1" && return
    case $1 in
    *.sh) grep -E '^ *(test_case|test_that) ' "$1" ;;
    *@*) ;;
    *)
        # shellcheck disable=SC2086 # the wrapper may have options
        $wrapper "$1" --list </dev/null 2>/dev/null ;;
    esac | alike | grep -qF -e "$only"
}

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
    *)
        is_called "$program" || set -- "$TEST_ONLY"
        # $wrapper is a command with its options: it is meant to be split.
        # shellcheck disable=SC2086
        set -- $wrapper "$program" "$@"
        ;;
    esac
    begin=$(date +%s)
    # timeout makes a process group of itself and all that begins below it.
    # shellcheck disable=SC2016
    CMOCKA_MESSAGE_OUTPUT=TAP sh -c 'echo $$ >"$0" && exec timeout -k 5 "$@"' \
        "$logs/$number.group" "$limit_s" "$@" >"$logs/$number.log" 2>&1 </dev/null
    status=$?
    took=$(($(date +%s) - begin))
    end_group "$(cat "$logs/$number.group")"
    # On lines of their own, whatever the program's last line was.
    printf '\n@status %d\n@left %d\n@took %d\n' "$status" "$left" "$took" >>"$logs/$number.log"
    times >>"$logs/$number.log"
}

# end_group PID: what a program left behind; some of it ends by itself, as guards of the dead do.
end_group() {
    left=0
    tries=50
    while kill -s 0 -- "-$1" 2>/dev/null; do
        tries=$((tries - 1))
        if [ $tries -eq 0 ]; then
            # One that init has not buried yet has ended.
            ps -A -o pgid= -o stat= -o args= | awk -v group="$1" '$1 == group && $2 !~ /^Z/' \
                >"$logs/$number.left"
            [ ! -s "$logs/$number.left" ] || left=1
            cat "$logs/$number.left" >>"$logs/$number.log"
            rm "$logs/$number.left"
            kill -s KILL -- "-$1"
            return
        fi
        sleep 0.1
    done
}

# --pool LOGS JOBS LIST [NICE...]: runs a list, its first ones first.
case ${1:-} in
--one)
    run_one "$2" "$3"
    exit 0
    ;;
--pool)
    logs=$2
    jobs=$3
    list=$4
    shift 4
    sort -s -n -k 1,1 "$logs/$list" | cut -d ' ' -f 2- |
        "$@" xargs -P "$jobs" -n 1 sh "$0" --one "$logs"
    exit
    ;;
esac

if [ -n "${TEST_LOGS:-}" ]; then
    logs=$TEST_LOGS
    mkdir -p "$logs" || exit 1
    rm -f "$logs"/*.log "$logs/waiting" "$logs/working"
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
    [ -z "$only" ] || is_wanted "$program" || continue
    count=$((count + 1))
    printf '%d:%s\n' "$count" "$program"
done >"$logs/programs"
if [ $count -eq 0 ]; then
    echo "tests/run.sh: no test is called '$TEST_ONLY'"
    echo '0 passed, 0 failed, 0 skipped'
    exit 1
fi

# What runs in real time, and the rest. Under a wrapper all of it takes the processor all the time.
awk -v logs="$logs" -v first=" ${TEST_FIRST:-} " -v one_pool="${TEST_JOBS:-}$wrapper" '
{
    name = $0
    gsub(/^.*\/|\.sh$/, "", name)
    print (index(first, " " name " ") ? 1 : 2) " " $0 >(logs "/" \
        (one_pool == "" && /\/(cli|link|port)\// ? "waiting" : "working"))
}' "$logs/programs"
{
    [ ! -s "$logs/waiting" ] || echo "$((${TEST_WAITERS:-4} * processors)) waiting"
    [ ! -s "$logs/working" ] || echo "${TEST_JOBS:-$processors} working nice -n 5"
} | xargs -P 2 -L 1 sh "$0" --pool "$logs"

awk -v logs="$logs" -v limit_s="$limit_s" -v slow="${TEST_SLOWEST:-5}" '
function problem(text) { failed++; bad = 1; notes = notes "  " text "\n" }

# What needs the reference material, which users do not have, is one skip; all are told behind it.
function skip(text) {
    if (text ~ /reference material/) {
        skipped += !material
        sub(/; [^;]*reference material.*/, "", text)
        sub(/: [^:]*reference material.*/, "", text)
        material++
        of_material = of_material "      " text "\n"
    } else {
        skipped++
        skips = skips "skip  " text "\n"
    }
}

# A result line: "ok 3 - name", "not ok 3 - name", "ok 3 # SKIP why", and of cmocka
# "not ok 3 # SKIP name".
function result(line,    name) {
    results++
    if (line ~ /# *[Ss][Kk][Ii][Pp]/) {
        name = line
        sub(/^.*# *[Ss][Kk][Ii][Pp] */, "", name)
        sub(/\n$/, "", said)
        gsub(/\n/, "; ", said)
        skip(shown ": " name (said != "" ? ": " said : ""))
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
    if (!bad && plan < 0 && results > 0) {
        problem("ends without saying how many tests it has")
    }
    if (!bad && results == 0 && !skipped_all) {
        problem("holds no test")
    }
    if (left) {
        problem("left processes behind")
    }
}

# What the shell calls 1m2.5s.
function seconds(text,    parts) {
    split(text, parts, "m")
    return 60 * parts[1] + parts[2]
}

# The lines "@took SECONDS", the times of a shell, and those of what it ran.
function note_times(line,    words) {
    getline <log_file
    getline said_times <log_file
    split(said_times, words, " ")
    took = substr(line, 7) + 0
    times = times sprintf("%d slow  %s: %d s, the processor for %.1f s of them\n", took, shown, \
        took, seconds(words[1]) + seconds(words[2]))
}

{
    program = $0
    number = program
    sub(/:.*/, "", number)
    sub(/^[^:]*:/, "", program)
    shown = program
    log_file = logs "/" number ".log"
    output = notes = said = ""
    bad = results = not_ok = skipped_all = left = 0
    plan = -1
    status = 255
    while ((getline line < log_file) > 0) {
        if (line ~ /^@status /) {
            status = substr(line, 9) + 0
            continue
        }
        if (line ~ /^@left /) {
            left = substr(line, 7) + 0
            continue
        }
        if (line ~ /^@took /) {
            note_times(line)
            continue
        }
        output = output "  " line "\n"
        if (line ~ /^(not )?ok [0-9]+/) {
            result(line)
        } else if (line ~ /^1\.\.0 *#/) {
            skipped_all = 1
            plan = 0
            sub(/^1\.\.0 *# *([Ss][Kk][Ii][Pp])? */, "", line)
            skip(shown ": " line)
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
    if (material) {
        printf "skip  no reference material beside the checkout, which %d tests need:\n%s", \
            material, of_material
    }
    if (NR > 1) {
        slowest = "sort -rn | head -n " slow " | cut -d \" \" -f 2-"
        printf "%s", times | slowest
        close(slowest)
    }
    printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped
    exit failed > 0
}' "$logs/programs"
